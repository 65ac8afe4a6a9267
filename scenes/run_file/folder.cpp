/// The folder of a run: its lock, and reading what an earlier run left there without touching it.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "brink/scenes/files/written_file.h"
#include "brink/scenes/run_file/database.h"
#include "brink/scenes/run_file/run_file.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// Reading a database that was last written with a write-ahead log makes an empty log beside it if there is
/// none. Taken away again: nobody else can be writing, since the folder is locked.
class LogsAsTheyWere {
 public:
  explicit LogsAsTheyWere(const fs::path& file)
      : log_(file.string() + "-wal"), index_(file.string() + "-shm"), had_log_(fs::exists(log_)) {}
  // A log that was there, or that holds something, stays.
  ~LogsAsTheyWere() {
    std::error_code none;
    if (had_log_ || fs::file_size(log_, none) != 0 || none) return;
    fs::remove(log_, none);
    fs::remove(index_, none);
  }
  LogsAsTheyWere(const LogsAsTheyWere&) = delete;
  LogsAsTheyWere& operator=(const LogsAsTheyWere&) = delete;

 private:
  fs::path log_, index_;
  bool had_log_;
};

/// An advisory lock on a folder; the system lets it go when the process ends, however it ends.
int locked(const fs::path& dir) {
  const int fd = ::open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0)
    throw IoError(fmt::format("{}: cannot open the folder: {}", dir.string(), std::strerror(errno)));
  // Without waiting: the other run holds it to its end.
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
  ::close(fd);
  throw IoError(
      fmt::format("{}: another run is writing into this folder; choose another --out", dir.string()));
}

/// True if there is a database without anything in it.
/// A run that is killed before its first commit leaves such a one. @throws IoError of what is no
/// database.
bool holds_nothing(const fs::path& file) {
  return guarded(file, [&] {
    SQLite::Database db = open_database(file, SQLite::OPEN_READONLY, 10'000);
    return db.execAndGet("SELECT count(*) FROM sqlite_master").getInt64() == 0;
  });
}

}  // namespace

// The folder is locked, not a file in it, so that the lock leaves nothing behind.
RunFolder::RunFolder(const fs::path& dir) : file_(made_folder(dir) / "run.db"), lock_(locked(dir)) {}
// The lock goes with it: who is moved from must not close it.
RunFolder::RunFolder(RunFolder&& other) noexcept
    : file_(std::move(other.file_)), lock_(std::exchange(other.lock_, -1)) {}
RunFolder::~RunFolder() {
  // Closing lets the lock go: programs that were started meanwhile have not got the descriptor
  // (O_CLOEXEC).
  if (lock_ >= 0) ::close(lock_);
}

void RunFolder::read(const std::function<void(const RunFile&)>& f) const {
  if (!fs::exists(file_)) return;
  // Made before the database is opened, destroyed after it is closed.
  const LogsAsTheyWere tidy(file_);
  if (!holds_nothing(file_)) f(RunFile(file_));
}

std::optional<ResumePoint> RunFolder::resume_point(const Scene& scene) const {
  std::optional<ResumePoint> point;
  // Another scene is told before damage: it is what a person can change.
  read([&](const RunFile& earlier) {
    earlier.require_same(scene);
    earlier.require_sound();
    point = earlier.checkpoint();
  });
  return point;
}

}  // namespace brink
