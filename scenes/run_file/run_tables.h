#pragma once
/// A run's tables for other programs.

#include <filesystem>

namespace brink {

/// Writes bodies.csv, sites.csv, frames.csv, events.csv and contacts.csv into `folder`, which is made if need be; names of
/// columns end with their units, text is quoted where it must be (RFC 4180), a name that begins with = + - @ (or a tab) has an apostrophe before it, numbers have
/// all their digits.
/// @throws IoError where the run cannot be read or a file not written.
void write_csv_tables(const std::filesystem::path& run_file, const std::filesystem::path& folder);

}  // namespace brink
