#include "brink/scenes/files/written_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "brink/core/base/error.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// True if writing one of two paths would write the other: by identity where both exist, which sees through
/// links; by resolved name where one is still to be written.
bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code missing;
  if (fs::equivalent(a, b, missing)) return true;
  return fs::weakly_canonical(a, missing) == fs::weakly_canonical(b, missing);
}

/// By the first bytes of SQLite's file format. A shorter file leaves NULs at the end of `first`.
bool is_database(const fs::path& file) {
  std::error_code missing;
  if (!fs::is_regular_file(file, missing)) return false;
  std::string first(15, '\0');
  std::ifstream(file, std::ios::binary).read(first.data(), static_cast<std::streamsize>(first.size()));
  return first == "SQLite format 3";
}

}  // namespace

// Asked before anything is opened. Another program could still put a link there in between: this is a
// guard against mistakes, not against attackers.
void refuse_overwriting(const fs::path& file, const std::string& option, const std::vector<fs::path>& kept) {
  if (file.empty()) return;
  const auto refuse = [&](const std::string& what) {
    throw BadInput(
        fmt::format("{}: {} given, which is {}; allowed: another file", option, file.string(), what));
  };
  for (const fs::path& k : kept)
    if (!k.empty() && same_file(file, k)) refuse("read or kept by this command");
  if (is_database(file)) refuse("a database");
}

// That it is there already is no error; a file of that name is.
fs::path made_folder(const fs::path& dir) {
  std::error_code error;
  fs::create_directories(dir, error);
  if (error) throw IoError(fmt::format("{}: cannot make the folder: {}", dir.string(), error.message()));
  return dir;
}

void throw_not_written(const fs::path& file) {
  // Callers come here right after the write that failed, while errno is still its own.
  const int cause = errno;
  const std::string why = cause == ENOSPC ? "disk full" : std::strerror(cause);
  // What has no room is half a file. Where it could not be opened it is somebody's whole one.
  std::error_code error;
  if ((cause == ENOSPC || cause == EDQUOT || cause == EFBIG) && fs::is_regular_file(file, error))
    fs::remove(file, error);
  throw IoError(fmt::format("{}: could not be written: {}", file.string(), why));
}

}  // namespace brink
