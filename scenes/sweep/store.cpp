/// How processes share a sweep without a server:
///
///     open      make the tables, register as a worker and lock its byte, add what runs are missing
///     take      waiting -> running, with the worker's number; of two processes one succeeds
///     finish    running -> done, with the numbers
///     reclaim   running -> waiting, of workers whose byte is not locked any more
///
/// A process that is killed writes nothing. What tells of its end is its lock, which the system drops. So a
/// run is lost to nobody, and the worst that can happen is that it is made again.
#include "brink/scenes/sweep/store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "brink/core/base/error.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/run_file/database.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// [ms] for another process that writes; many may begin at once.
constexpr int kLongestWait = 60'000;
constexpr const char* kWhat = "results of a sweep";

// No column for the numbers: make_tables() adds those, as it does to files of another version.
constexpr const char* kTables = R"(
CREATE TABLE IF NOT EXISTS worker (id INTEGER PRIMARY KEY AUTOINCREMENT, started TEXT);
CREATE TABLE IF NOT EXISTS run (id INTEGER PRIMARY KEY, key TEXT UNIQUE, scene TEXT, settings TEXT, overrides TEXT,
  state TEXT, worker INTEGER, termination TEXT, state_hash TEXT);
)";

constexpr std::int64_t kOpening = 0;  ///< the byte of whoever opens the file; workers count from 1

/// Which workers are alive: one byte of a file each, locked while its process lives.
/// Locks of open file descriptions (F_OFD), not of the process: threads share them, and the system drops
/// them when the last descriptor closes, however the process ends.
class WorkerLocks {
 public:
  explicit WorkerLocks(const fs::path& file) : fd_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (fd_ < 0) throw IoError(fmt::format("{}: cannot be opened: {}", file.string(), std::strerror(errno)));
  }
  ~WorkerLocks() { ::close(fd_); }
  WorkerLocks(const WorkerLocks&) = delete;
  WorkerLocks& operator=(const WorkerLocks&) = delete;

  /// Waits until the byte is free.
  /// A worker's own byte is always free, as numbers are given once; the opening's may be held by another
  /// process.
  void hold(std::int64_t worker) const { set(worker, F_WRLCK); }
  void let_go(std::int64_t worker) const { set(worker, F_UNLCK); }
  /// @pre not this process's own worker.
  /// Its lock does not stand in its own way: it would be told as gone.
  /// Asks for the lock without taking it: F_UNLCK in the answer says that it could be had. A failed call
  /// counts as free.
  bool held_by_another(std::int64_t worker) const {
    struct flock lock = byte(worker, F_WRLCK);
    return ::fcntl(fd_, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  }

 private:
  /// Waits if it must. @throws IoError, as where the file system has no such locks.
  void set(std::int64_t worker, short type) const {
    struct flock lock = byte(worker, type);
    if (::fcntl(fd_, F_OFD_SETLKW, &lock) != 0)
      throw IoError(fmt::format("sweep.lock: byte {} cannot be locked: {}", worker, std::strerror(errno)));
  }
  /// The one byte of a worker; it need not exist in the file, which stays empty.
  static struct flock byte(std::int64_t worker, short type) {
    struct flock lock {};
    lock.l_type = type;
    lock.l_whence = SEEK_SET;
    lock.l_start = worker;
    lock.l_len = 1;
    return lock;
  }
  int fd_;
};

/// Axis and value of each, in the experiment's order, for questions in SQL (docs/sweep.md).
std::string settings_json(const Experiment& experiment, const SweepRun& run) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t k = 0; k < experiment.axes.size(); ++k) json[experiment.axes[k].name] = run.values[k];
  return json.dump();
}

}  // namespace

/// In this order: the lock file is opened before the database and closed after it.
/// The open database. Calls of several threads come one after another (locked()); SQLite itself puts those
/// of processes in order.
struct SweepStore::Impl {
  fs::path file;
  WorkerLocks locks;
  SQLite::Database db;
  std::int64_t worker = 0;
  std::mutex mutex;

  explicit Impl(const fs::path& dir)
      : file(made_folder(dir) / "sweep.db"),
        locks(dir / "sweep.lock"),
        db(open_database(file, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, kLongestWait)) {
    require_ours();
    locks.hold(kOpening);  // turning the write-ahead log on does not wait for others
    db.exec("PRAGMA journal_mode = WAL");
    // With a write-ahead log NORMAL keeps the file whole through a crash of the machine. Its last rows may
    // be missing then, and those runs are made again.
    db.exec("PRAGMA synchronous = NORMAL");
    locks.let_go(kOpening);
  }

  /// Nothing is written into a database of another kind.
  void require_ours() {
    if (db.execAndGet("SELECT count(*) FROM sqlite_master").getInt64() == 0) return;  // new
    for (const char* table : {"worker", "run"})
      if (!db.tableExists(table))
        throw IoError(
            fmt::format("{}: not the results of a sweep: table {} is missing", file.string(), table));
  }

  // Another version may have more counters: their columns are added, and are NULL in rows of before.
  void make_tables() {
    db.exec(kTables);
    // ALTER TABLE has no "IF NOT EXISTS": what is there is asked first. One transaction with the rest, so
    // no other process adds the same column meanwhile.
    std::set<std::string> present;
    for (SQLite::Statement info(db, "SELECT name FROM pragma_table_info('run')"); info.executeStep();)
      present.insert(info.getColumn(0).getString());
    for (const std::string& name : sweep_columns())
      if (!present.contains(name)) db.exec(fmt::format("ALTER TABLE run ADD COLUMN {} REAL", name));
  }

  // AUTOINCREMENT never gives a number twice: a row's worker is one process for ever.
  void add_worker() {
    db.exec("INSERT INTO worker (started) VALUES (datetime('now'))");
    worker = db.getLastInsertRowid();
    locks.hold(worker);
  }

  /// One row each, waiting. Up to kMostSweepRuns of them in one transaction: one statement, bound anew.
  void add_runs(const Experiment& experiment) {
    // What is there already, done or not, stays: keys are unique.
    SQLite::Statement insert(db,
                             "INSERT OR IGNORE INTO run (key, scene, settings, overrides, state) "
                             "VALUES (?, ?, ?, ?, 'waiting')");
    for (const SweepRun& run : experiment.runs) {
      insert.bind(1, run.key);
      insert.bind(2, run.scene.string());
      insert.bind(3, settings_json(experiment, run));
      insert.bind(4, nlohmann::json(run.overrides).dump());
      insert.exec();
      insert.reset();
    }
  }

  /// Runs f alone among this process's threads; what SQLite throws becomes an IoError that names the file.
  template <class F>
  auto locked(F&& f) {
    const std::lock_guard lock(mutex);
    return guarded(file, f, kWhat);
  }

  int reclaim() {
    // IMMEDIATE: two processes that reclaim at once would both read before either writes.
    SQLite::Transaction transaction(db, SQLite::TransactionBehavior::IMMEDIATE);
    // Collected first: rows that a statement is still reading are not changed under it.
    std::vector<std::int64_t> gone;
    SQLite::Statement workers(db, "SELECT DISTINCT worker FROM run WHERE state = 'running'");
    while (workers.executeStep()) {
      const std::int64_t other = workers.getColumn(0).getInt64();
      if (other != worker && !locks.held_by_another(other)) gone.push_back(other);
    }
    int freed = 0;
    for (const std::int64_t other : gone) {
      SQLite::Statement free(
          db, "UPDATE run SET state = 'waiting', worker = NULL WHERE state = 'running' AND worker = ?");
      free.bind(1, other);
      freed += free.exec();
    }
    transaction.commit();
    return freed;
  }

  /// The row that `select` stands on: termination, state_hash, then sweep_columns() in their order.
  /// @throws BadInput on a column of another type; reading() makes an IoError of it.
  static SweepResult row_of(SQLite::Statement& select) {
    // What stands in a column is checked, as the file may come from anywhere.
    SweepResult row;
    const auto require = [](bool right, const std::string& column) {
      if (!right) throw BadInput(column + " is not of the type that stands there");
    };
    require(select.getColumn(0).isText(), "termination");
    require(select.getColumn(1).isText(), "state_hash");
    row.termination = select.getColumn(0).getString();
    row.state_hash = select.getColumn(1).getString();
    // a run that could not start has none
    require((row.state_hash.size() == 16 || row.state_hash.empty()) &&
                row.state_hash.find_first_not_of("0123456789abcdef") == std::string::npos,
            "state_hash");
    int column = 2;
    for (const std::string& name : sweep_columns()) {
      const SQLite::Column value = select.getColumn(column++);
      require(value.isNull() || value.isFloat() || value.isInteger(), name);
      row.numbers[name] = value.isNull() ? std::nan("") : value.getDouble();
      const double x = row.numbers[name];
      require(!std::isinf(x), name);
      require(!(name == "collisions" || name == "end_time") || std::isnan(x) || x >= 0.0, name);
      require(name != "collisions" || std::isnan(x) || x == std::floor(x), name);
    }
    return row;
  }

  /// Of one run; nothing if it is not done. Leaves the statement ready for the next one.
  std::optional<SweepResult> result(SQLite::Statement& select, const SweepRun& run) {
    select.bind(1, run.key);
    std::optional<SweepResult> found;
    if (select.executeStep()) found = row_of(select);
    select.reset();
    return found;
  }
};

SweepStore::SweepStore(const fs::path& dir, const Experiment& experiment) {
  const auto open = [&] {
    impl_ = std::make_unique<Impl>(dir);
    // All in one transaction: a second process sees either nothing or a worker with its lock and runs.
    SQLite::Transaction transaction(impl_->db, SQLite::TransactionBehavior::IMMEDIATE);
    // The worker's lock is taken before the commit: who sees its number in a row finds the byte locked.
    impl_->make_tables();
    impl_->add_worker();
    impl_->add_runs(experiment);
    transaction.commit();
  };
  guarded(dir / "sweep.db", open, kWhat);
  // What processes that have died left behind is waiting again before anything is taken.
  reclaim();
}

SweepStore::~SweepStore() = default;

bool SweepStore::take(const SweepRun& run) {
  return impl_->locked([&] {
    // One statement: of two processes only one finds the run waiting.
    SQLite::Statement update(
        impl_->db, "UPDATE run SET state = 'running', worker = ? WHERE key = ? AND state = 'waiting'");
    update.bind(1, impl_->worker);
    update.bind(2, run.key);
    return update.exec() == 1;
  });
}

void SweepStore::finish(const SweepRun& run, const SweepResult& result) {
  impl_->locked([&] {
    std::string columns;
    for (const std::string& name : sweep_columns()) columns += ", " + name + " = ?";
    SQLite::Statement update(impl_->db, "UPDATE run SET state = 'done', termination = ?, state_hash = ?" +
                                            columns + " WHERE key = ?");
    int at = 0;
    // NaN is stored as NULL by SQLite, and read back as NaN by row_of().
    update.bind(++at, result.termination);
    update.bind(++at, result.state_hash);
    for (const std::string& name : sweep_columns()) update.bind(++at, result.numbers.at(name));
    update.bind(++at, run.key);
    update.exec();
  });
}

void SweepStore::let_go(const SweepRun& run) {
  impl_->locked([&] {
    // Its own runs alone: another process may have reclaimed and taken this one meanwhile.
    SQLite::Statement update(impl_->db,
                             "UPDATE run SET state = 'waiting', worker = NULL WHERE key = ? AND worker = ? "
                             "AND state = 'running'");
    update.bind(1, run.key);
    update.bind(2, impl_->worker);
    update.exec();
  });
}

int SweepStore::reclaim() {
  return impl_->locked([&] { return impl_->reclaim(); });
}

std::vector<std::optional<SweepResult>> SweepStore::results(const Experiment& experiment) {
  return impl_->locked([&] {
    std::string columns;
    for (const std::string& name : sweep_columns()) columns += ", " + name;
    SQLite::Statement select(
        impl_->db, "SELECT termination, state_hash" + columns + " FROM run WHERE key = ? AND state = 'done'");
    return reading(impl_->file, "run", [&] {
      // Looked for in the whole table: a run of another state would never be made, and nobody would say why.
      if (impl_->db
              .execAndGet("SELECT count(*) FROM run WHERE state IS NULL OR state NOT IN ('waiting', "
                          "'running', 'done')")
              .getInt() > 0)
        throw BadInput("a state that is none");
      std::vector<std::optional<SweepResult>> all;
      for (const SweepRun& run : experiment.runs) all.push_back(impl_->result(select, run));
      return all;
    });
  });
}

const fs::path& SweepStore::file() const { return impl_->file; }

}  // namespace brink
