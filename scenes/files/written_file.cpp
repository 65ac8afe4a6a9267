#include "brink/scenes/files/written_file.h"

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
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

std::string said_of(int cause) { return cause == ENOSPC ? "disk full" : std::strerror(cause); }

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

void write_whole(const fs::path& file, std::string_view text) {
  std::error_code missing;
  const fs::path whole = fs::exists(file, missing) ? fs::canonical(file) : file;
  std::string beside = whole.string() + ".XXXXXX";
  const int out = ::mkstemp(beside.data());  // never through a link
  // The file of before stays: only what is beside it is half a file.
  const auto fail = [&] {
    const int cause = errno;
    if (out >= 0) ::close(out);
    if (out >= 0) fs::remove(beside, missing);
    throw IoError(fmt::format("{}: could not be written: {}", whole.string(), said_of(cause)));
  };
  if (out < 0) fail();
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = ::write(out, text.data() + at, text.size() - at);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail();
    at += static_cast<std::size_t>(written);
  }
  // as other new files are, which mkstemp() keeps to their owner; of one that is there, as that is
  struct stat before {};
  const mode_t mask = ::umask(0);
  ::umask(mask);
  const mode_t mode = ::stat(whole.c_str(), &before) == 0 ? before.st_mode & 07777 : 0666 & ~mask;
  if (::fchmod(out, mode) != 0 || ::fsync(out) != 0) fail();
  if (::rename(beside.c_str(), whole.c_str()) != 0) fail();
  ::close(out);
}

void throw_not_written(const fs::path& file) {
  // Callers come here right after the write that failed, while errno is still its own.
  const int cause = errno;
  // What has no room is half a file. Where it could not be opened it is somebody's whole one.
  std::error_code error;
  if ((cause == ENOSPC || cause == EDQUOT || cause == EFBIG) && fs::is_regular_file(file, error))
    fs::remove(file, error);
  throw IoError(fmt::format("{}: could not be written: {}", file.string(), said_of(cause)));
}

}  // namespace brink
