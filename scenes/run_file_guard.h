#pragma once
/// Inside the run file's door: what SQLite throws, as Brink's own error.

#include <SQLiteCpp/Exception.h>
#include <fmt/format.h>

#include <filesystem>

#include "brink/core/base/error.h"

namespace brink {

/// Runs f, turning what SQLite throws into an IoError that names the file.
template <class F>
auto guarded(const std::filesystem::path& file, F&& f) {
  try {
    return f();
  } catch (const SQLite::Exception& e) {
    throw IoError(fmt::format("{}: cannot be read or written as a run file: {}", file.string(), e.what()));
  }
}

}  // namespace brink
