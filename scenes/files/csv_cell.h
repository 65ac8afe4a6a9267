#pragma once
/// Text in tables for other programs.

#include <string>

namespace brink {

/// A cell of a CSV file: text that would be more than one cell or line is put in quotes (RFC 4180).
std::string csv_cell(const std::string& text);

/// A cell of text that may come from anywhere: what a spreadsheet would run as a formula, and that is no number, gets an
/// apostrophe before it.
std::string csv_text(const std::string& text);

}  // namespace brink
