#pragma once
/// Inside the door to SQLite: databases are opened with distrust, and what is wrong with them is Brink's own
/// error. A run file or the results of a sweep may come from anywhere, and may be cut, mixed up or made to do
/// harm.

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <fmt/format.h>

#include <filesystem>

#include "brink/core/base/error.h"

namespace brink {

/// How long a run file waits for another program that writes it [ms].
inline constexpr int kBusyMilliseconds = 10'000;

/// Opens `file` as it is called: never as a URI ("file:x?mode=ro") or as ":memory:". Triggers, views and
/// functions of the file's own schema are not run, and damaged pages are looked for.
/// @throws SQLite::Exception.
SQLite::Database open_database(const std::filesystem::path& file, int flags, int busy_milliseconds);

/// What SQLite says; "disk full" where that is the cause.
std::string why_failed(const SQLite::Exception& e, const std::filesystem::path& file);

/// Runs f, turning what SQLite throws into an IoError that names the file.
template <class F>
auto guarded(const std::filesystem::path& file, F&& f, const char* what = "a run file") {
  try {
    return f();
  } catch (const SQLite::Exception& e) {
    throw IoError(
        fmt::format("{}: cannot be read or written as {}: {}", file.string(), what, why_failed(e, file)));
  }
}

/// Runs f, which reads `table`, turning whatever is wrong with what stands there (SQLite, JSON, shapes,
/// numbers) into an IoError that names the file and the table.
template <class F>
auto reading(const std::filesystem::path& file, const char* table, F&& f) {
  try {
    return f();
  } catch (const IoError&) {
    throw;
  } catch (const std::exception& e) {
    throw IoError(fmt::format("{}: table {}: cannot be read: {}", file.string(), table, e.what()));
  }
}

}  // namespace brink
