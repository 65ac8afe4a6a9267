#include "brink/scenes/run_file/database.h"

#include <sqlite3.h>

namespace brink {
namespace fs = std::filesystem;

/// The settings belong to the connection and not to the file: each that is opened gets them anew.
SQLite::Database open_database(const fs::path& file, int flags, int busy_milliseconds) {
  // Beside a journal there may be half a transaction, of a run that was killed in the first moment of its file or in the
  // last: only who may write can take it back. One that is still being made is left alone.
  if (flags == SQLite::OPEN_READONLY && fs::exists(file.string() + "-journal"))
    flags = SQLite::OPEN_READWRITE;
  // Debian's SQLite reads names that begin with "file:" as URIs; an absolute path begins with a slash.
  SQLite::Database db(fs::absolute(file).string(), flags, busy_milliseconds);
  // Against a file made to do harm: no statement may corrupt it (DEFENSIVE), and what its schema would
  // run (functions, triggers, views) is not run.
  sqlite3_db_config(db.getHandle(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(db.getHandle(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(db.getHandle(), SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(db.getHandle(), SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  // Cells of a damaged page are told as damage before they are followed out of the page.
  db.exec("PRAGMA cell_size_check = ON");
  return db;
}

/// For people: SQLite's own words, but for the cause that they hide most often.
std::string why_failed(const SQLite::Exception& e, const fs::path& file) {
  constexpr std::uintmax_t kLittle = 1 << 16;  // less than a page and its log need
  std::error_code unknown;
  const fs::space_info space = fs::space(fs::absolute(file).parent_path(), unknown);
  // Extended codes hold the primary one in their low byte. On a full disk a log may fail as an i/o
  // error, or as a file that cannot be opened.
  const bool io = (e.getErrorCode() & 0xff) == SQLITE_IOERR || (e.getErrorCode() & 0xff) == SQLITE_CANTOPEN;
  const bool full = (e.getErrorCode() & 0xff) == SQLITE_FULL || (io && !unknown && space.available < kLittle);
  return full ? "disk full" : e.what();
}

}  // namespace brink
