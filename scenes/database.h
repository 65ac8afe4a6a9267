#pragma once
/// Inside the door to SQLite: what it throws, as Brink's own error.

#include <SQLiteCpp/Exception.h>
#include <fmt/format.h>

#include <filesystem>

#include "brink/core/base/error.h"

namespace brink {

/// Runs f, turning what SQLite throws into an IoError that names the file.
template <class F>
auto guarded(const std::filesystem::path& file, F&& f, const char* what = "a run file") {
  try {
    return f();
  } catch (const SQLite::Exception& e) {
    throw IoError(fmt::format("{}: cannot be read or written as {}: {}", file.string(), what, e.what()));
  }
}

}  // namespace brink
