/// Writing run files: class RunFileRecorder.
///
/// All rows go through prepared statements into one transaction that is open while rows wait:
///
///     a row:         begin a transaction if there is none, insert, commit if due (rows or time)
///     a checkpoint:  put it into the same transaction, commit
///     the end:       meta, work, indices, commit, leave the write-ahead log
///
/// So at any moment the file on the disk is whole up to some row, and a checkpoint never counts rows
/// that are not there. Whatever writes does so inside writing(): after one failure nothing is written
/// any more.
#include "brink/scenes/run_file/run_file.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "brink/core/base/error.h"
#include "brink/core/base/hash.h"
#include "brink/core/world/world_hash.h"
#include "brink/scenes/run_file/checkpoint_seal.h"
#include "brink/scenes/run_file/database.h"
#include "brink/scenes/run_file/shape_json.h"
#include "brink/scenes/run_file/tables.h"
#include "brink/scenes/version.h"
#include "brink/scheduler/kernel/site_motion.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
/// Rows are committed after so many, or after so long: what a kill can take.
constexpr std::int64_t kRowsPerCommit = 20'000;
constexpr auto kTimePerCommit = std::chrono::milliseconds(250);
/// The index of frames by body costs a sort and about as many entries as rows: of longer runs it is
/// left out, and who asks for one body's path reads the whole table.
constexpr std::int64_t kMostIndexed = 2'000'000;  ///< frame rows
/// Who stops a run does not want to wait for its indices, a microsecond a row: of more rows there are none
/// until it has gone on to its end.
constexpr std::int64_t kMostIndexedOfStopped = 200'000;  ///< rows of all kinds

/// The state hash as the summary prints it.
std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }
/// The shortest text that reads back as the same double.
std::string number(double x) { return fmt::format("{}", x); }

/// What pictures need of the springs.
/// A JSON array of the springs alone, in the order of World::forces, with places in the bodies' frames
/// [m]. Damping is left out, other kinds of force, too.
std::string springs_json(const World& world) {
  auto all = nlohmann::ordered_json::array();
  const auto pair = [](const Vec2& v) { return nlohmann::ordered_json::array({v.x(), v.y()}); };
  for (const Force& force : world.forces)
    if (const auto* s = std::get_if<SpringForce>(&force))
      all.push_back({{"body", s->body_a},
                     {"other", s->body_b < 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(s->body_b)},
                     {"at", pair(s->at_a)},
                     {"other_at", pair(s->at_b)},
                     {"stiffness", s->stiffness},
                     {"rest_length", s->rest_length}});
  return all.dump();
}

/// What curves of energy need of the attractions, likewise.
std::string attractions_json(const World& world) {
  auto all = nlohmann::ordered_json::array();
  for (const Force& force : world.forces)
    if (const auto* a = std::get_if<AttractForce>(&force))
      all.push_back({{"bodies", a->bodies},
                     {"center", {a->center.x(), a->center.y()}},
                     {"strength", a->strength},
                     {"power", a->power}});
  return all.dump();
}

/// Moves DIR/run.db, with its write-ahead log, to the first free DIR/run-<n>.db.
/// The log goes first: killed in between, the next try finds run-<n>.db still free and brings
/// the two together.
void keep_earlier(const fs::path& file) {
  if (!fs::exists(file)) return;
  int n = 1;
  const auto kept = [&] { return file.parent_path() / fmt::format("run-{}.db", n); };
  // The folder is locked, so nobody else takes the name that is found free.
  while (fs::exists(kept())) ++n;
  std::error_code error;
  const fs::path wal = file.string() + "-wal";
  if (fs::exists(wal)) fs::rename(wal, kept().string() + "-wal", error);
  if (!error) fs::rename(file, kept(), error);
  if (error) throw IoError(fmt::format("{}: cannot be moved aside: {}", file.string(), error.message()));
  // SQLite makes the log's index anew.
  fs::remove(file.string() + "-shm", error);
}

/// Frame times are whole multiples of the interval, by one product (Records::frame_due()): so equality is exact.
bool on_the_clock(double t, double interval) {
  // At t = 0 there is a frame whatever the interval. Else the nearest multiple is the only one that t
  // can be.
  return t == 0.0 || (interval > 0.0 && std::round(t / interval) * interval == t);
}

}  // namespace

/// The open file, its prepared statements and what waits to be committed.
struct RunFileRecorder::Impl {
  // In this order: the folder is locked before the database opens and until it is closed; statements and
  // the transaction go before the database that they belong to.
  RunFolder folder;
  SQLite::Database db;
  std::optional<SQLite::Statement> insert_frame, insert_site_frame, insert_event, insert_contact, insert_knot;
  std::optional<SQLite::Transaction> transaction;
  std::int64_t rows_waiting = 0;
  Clock::time_point waiting_since;
  std::int64_t frames = 0, events = 0, contacts = 0, knots = 0;  // rows in the file
  std::int64_t most_knots = 0;
  std::int64_t bodies = 0;
  std::vector<std::pair<int, SiteMotion>> moving_sites;  ///< by id
  double sites_asked_for = -1.0;                         ///< when get_ready() was to follow them to [s]
  double wall_before = 0.0, waited = 0.0;                // [s]
  std::uint64_t identity = 0;
  Clock::time_point begun = Clock::now();  ///< the simulation
  std::optional<ResumePoint> resume_point;
  bool resumes_off_the_clock = false;  ///< no frame of the time of the resume point is kept
  std::string failed;                  // why nothing more is written

  Impl(RunFolder locked, Open how) : folder(std::move(locked)), db(opened_file(how)) {
    // Others read the last commit while this one writes, and neither waits for the other.
    db.exec("PRAGMA journal_mode = WAL");
    // a log that a crash of the machine cuts short is still consistent
    db.exec("PRAGMA synchronous = NORMAL");
  }

  // A fresh run moves what is there aside, before SQLite could go on with its log.
  SQLite::Database opened_file(Open how) const {
    if (how == Open::fresh) keep_earlier(folder.file());
    return open_database(folder.file(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, kBusyMilliseconds);
  }

  /// Runs f, which writes. After a failure the rows that waited are given up and nothing more is written.
  template <class F>
  void writing(F&& f) {
    if (!failed.empty()) throw IoError(failed);
    try {
      guarded(folder.file(), f);
    } catch (const IoError& e) {
      failed = e.what();
      // Rolls back: the file stays at its last commit.
      transaction.reset();
      throw;
    }
  }

  // A transaction is begun by its first row, so that an idle run holds none.
  void begin() {
    if (transaction) return;
    transaction.emplace(db);
    waiting_since = Clock::now();
  }
  // Readers of the file see all rows up to here from now on.
  void commit() {
    if (!transaction) return;
    transaction->commit();
    transaction.reset();
    rows_waiting = 0;
  }
  // Asked after every row and by poll(): where rows are rare, nothing else would end the wait.
  void commit_if_due() {
    if (!transaction) return;
    if (rows_waiting >= kRowsPerCommit || Clock::now() - waiting_since >= kTimePerCommit) commit();
  }
  void put_checkpoint(const ResumePoint& row, std::span<const std::byte> snapshot);
  /// Wall-clock seconds of the simulation up to now: those of before a resume, and those since it
  /// began here without the pauses (leave_out()).
  double wall() const {
    return wall_before + std::chrono::duration<double>(Clock::now() - begun).count() - waited;
  }

  /// A key of `meta` gets a new value. @pre inside a transaction, or it is committed by itself.
  void set_meta(const std::string& key, const std::string& value) {
    SQLite::Statement put(db, "INSERT OR REPLACE INTO meta VALUES (?, ?)");
    put.bind(1, key);
    put.bind(2, value);
    put.exec();
  }

  // Parts of beginning and of going on, which happen once, and of single rows.
  void write_meta(const Scene& scene);
  void write_bodies(const World& world);
  void write_sites(const World& world);
  void start_fresh(const Scene& scene);
  void start_again(const Scene& scene);
  void drop_rows_after_checkpoint(const Scene& scene);
  void drop_early_end_frame(double interval);
  void drop_site_frames(double interval);
  void prepare_inserts();
  void put_state(SQLite::Statement& put, const BodyState& s);
  void put_site_frames(double t);
  void put_side(SQLite::Statement& put, int first, const EventSide& side);
};

/// With their whole paths: who reads them may be in another folder.
std::string files_json(const Scene& scene) {
  nlohmann::json files = nlohmann::json::array();
  for (const fs::path& file : scene.files) files.push_back(fs::absolute(file).lexically_normal().string());
  // A name may have bytes that are no UTF-8.
  return files.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// All keys of a run that begins; `summary` comes when it ends. Version, options and world hash are
/// what resuming compares, and what the seal of a checkpoint is made with: they are written once and
/// never changed but for limits in the options.
void RunFileRecorder::Impl::write_meta(const Scene& scene) {
  set_meta("schema_version", std::to_string(kRunFileSchema));
  set_meta("brink_version", std::string(version()));
  set_meta("scene", scene.path.string());
  set_meta("files", files_json(scene));
  set_meta("title", scene.world.title);
  set_meta("options", scene.options_json);
  set_meta("scene_text", scene.text);
  set_meta("overrides", nlohmann::json(scene.overrides).dump());
  set_meta("springs", springs_json(scene.world));
  set_meta("attractions", attractions_json(scene.world));
  set_meta("world_hash", world_hash_text(scene.world));
  set_meta("duration", number(scene.duration));
  // Until finish(). Of a run that is killed these stay, but for time and seconds, which checkpoints tell.
  set_meta("termination", "running");
  set_meta("end_time", "0");
  set_meta("state_hash", "");
  set_meta("wall_seconds", "0");
}

/// A row a body, in the order of their ids, with the JSON of its outline about the centre of mass.
void RunFileRecorder::Impl::write_bodies(const World& world) {
  SQLite::Statement put(db, "INSERT INTO body VALUES (?, ?, ?, ?, ?)");
  const Outline* last = nullptr;  // copies share an outline: write its JSON once
  std::string shape;
  for (std::size_t id = 0; id < world.bodies.size(); ++id) {
    const Body& body = world.bodies[id];
    if (body.outline.get() != last) {
      last = body.outline.get();
      shape = outline_to_json(*last);
    }
    put.bind(1, static_cast<std::int64_t>(id));
    put.bind(2, body.name);
    put.bind(3, body.mass);
    put.bind(4, body.inertia);
    put.bind(5, shape);
    put.exec();
    put.reset();
  }
}

/// A row a fixed site, in the order of their ids. `owner` stays NULL: all of them are the scene's.
void RunFileRecorder::Impl::write_sites(const World& world) {
  SQLite::Statement put(db, "INSERT INTO site VALUES (?, ?, NULL, ?, ?)");
  for (std::size_t id = 0; id < world.sites.size(); ++id) {
    const FixedSite& site = world.sites[id];
    put.bind(1, static_cast<std::int64_t>(id));
    put.bind(2, site.name);
    put.bind(3, site.kind);
    put.bind(4, fixed_site_to_json(site));
    put.exec();
    put.reset();
  }
}

/// Tables, views and all that does not change, committed before the first frame: whoever opens the file
/// from now on finds a run file.
void RunFileRecorder::Impl::start_fresh(const Scene& scene) {
  begin();
  // In the transaction, too: SQLite takes back tables like rows.
  db.exec(kRunFileTables);
  db.exec(kRunFileViews);
  write_meta(scene);
  write_bodies(scene.world);
  write_sites(scene.world);
  commit();
}

/// A run that was stopped recorded where it stopped. Gone on with, it has no frame there unless the frame
/// clock says so.
/// Else going on would leave a frame that a run which nobody stopped does not have.
void RunFileRecorder::Impl::drop_early_end_frame(double interval) {
  const double t = resume_point ? resume_point->t : 0.0;
  if (on_the_clock(t, interval)) return;
  resumes_off_the_clock = true;
  // Of the rows that the checkpoint counts only the last frame can be it.
  SQLite::Statement drop(db, "DELETE FROM frame WHERE t = ? AND rowid > ?");
  drop.bind(1, t);
  drop.bind(2, frames - bodies);
  // exec() says how many rows went: those of one frame, or none where the frame was not told.
  frames -= drop.exec();
}

/// Those of the frames that have been dropped. By time, as a site that cannot be moved on has no row at a frame; of
/// a world without bodies, whose frames have no rows either, what is kept is what the frame clock says.
void RunFileRecorder::Impl::drop_site_frames(double interval) {
  if (bodies > 0) {
    db.exec("DELETE FROM site_frame WHERE t > (SELECT coalesce(max(t), -1) FROM frame)");
    return;
  }
  const double t = resume_point ? resume_point->t : -1.0;
  SQLite::Statement drop(db, fmt::format("DELETE FROM site_frame WHERE t {} ?",
                                         resume_point && on_the_clock(t, interval) ? ">" : ">="));
  drop.bind(1, t);
  drop.exec();
}

/// Takes the tables back to what the checkpoint counts, or to nothing where there is none. Leaves
/// `frames`, `events` and `contacts` as the numbers of rows that are there, so that the next rows go on
/// from them.
/// Work counters and indices are start_again()'s.
void RunFileRecorder::Impl::drop_rows_after_checkpoint(const Scene& scene) {
  if (resume_point) {
    frames = resume_point->frames;
    events = resume_point->events;
    contacts = resume_point->contacts;
    knots = resume_point->knots;
    wall_before = resume_point->wall_seconds;
  }
  db.exec(fmt::format("DELETE FROM frame WHERE rowid > {}", frames));
  db.exec(fmt::format("DELETE FROM event WHERE rowid >= {}", events));  // seq counts from 0
  db.exec(fmt::format("DELETE FROM contact WHERE rowid > {}", contacts));
  db.exec(fmt::format("DELETE FROM knot WHERE rowid > {}", knots));
  drop_early_end_frame(scene.output.frame_interval);
  drop_site_frames(scene.output.frame_interval);
  // Without a resume point there must be none: it would count rows that have just gone.
  db.exec("DELETE FROM checkpoint");
  if (!resume_point) return;
  // The seal covers the counts: with another number of frames the checkpoint is sealed anew.
  resume_point->frames = frames;
  put_checkpoint(*resume_point, resume_point->state);
}

/// All of it in one transaction: killed before its next checkpoint, the run goes on from the same rows again.
void RunFileRecorder::Impl::start_again(const Scene& scene) {
  // A run killed before its first commit leaves a database without tables.
  if (!db.tableExists("meta")) return start_fresh(scene);
  begin();
  drop_rows_after_checkpoint(scene);
  db.exec("DELETE FROM work");
  // Indices slow down inserting; finish() makes them again.
  db.exec(kDropIndices);
  set_meta("options", scene.options_json);  // the same, but for limits
  set_meta("termination", "running");
  set_meta("duration", number(scene.duration));
  commit();
}

/// Puts a checkpoint in the place of the last one, sealed together with the other columns of its row.
/// The caller commits.
void RunFileRecorder::Impl::put_checkpoint(const ResumePoint& row, std::span<const std::byte> snapshot) {
  const std::vector<std::byte> state = sealed(row, snapshot, identity);
  constexpr std::size_t kMost = std::numeric_limits<int>::max();  // SQLite's own bound
  if (state.size() > kMost)
    throw IoError(
        fmt::format("checkpoint: a state of {} bytes; at most {} can be kept", state.size(), kMost));
  db.exec("DELETE FROM checkpoint");
  SQLite::Statement put(db, "INSERT INTO checkpoint VALUES (?, ?, ?, ?, ?, ?, ?)");
  put.bind(1, row.t);
  // The bytes outlive the statement, which ends with this function; a snapshot may be large.
  put.bindNoCopy(2, state.data(), static_cast<int>(state.size()));
  put.bind(3, row.frames);
  put.bind(4, row.events);
  put.bind(5, row.wall_seconds);
  put.bind(6, row.contacts);
  put.bind(7, row.knots);
  put.exec();
}

/// After the tables are there: SQLite prepares a statement for tables that exist alone.
void RunFileRecorder::Impl::prepare_inserts() {
  insert_frame.emplace(db, "INSERT INTO frame VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  insert_site_frame.emplace(db, "INSERT INTO site_frame VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
  // Nine columns a side from x on; NULL in all of them where nothing is known of the side.
  insert_event.emplace(
      db,
      "INSERT INTO event VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
      "?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert_contact.emplace(db, "INSERT INTO contact VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  insert_knot.emplace(db, "INSERT INTO knot VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
}

/// What both constructors do once the folder is locked and the resume point known.
/// @throws IoError; the file is then as it was at its last commit.
void RunFileRecorder::open(RunFolder folder, const Scene& scene, Open how, std::optional<ResumePoint> point) {
  const fs::path file = folder.file();
  guarded(file, [&] {
    impl_ = std::make_unique<Impl>(std::move(folder), how);
    // Of this run, not of the file: on a resume the seal is made anew where options differ in their
    // limits.
    impl_->identity = run_identity(std::string(version()), scene.options_json, world_hash_text(scene.world));
    impl_->bodies = static_cast<std::int64_t>(scene.world.bodies.size());
    impl_->most_knots = scene.output.max_knots;
    impl_->resume_point = std::move(point);
    // Motions of their own, beside those of the simulator: poses at frames are functions of time alone.
    for (std::size_t id = 0; id < scene.world.sites.size(); ++id)
      if (SiteMotion motion(scene.world.sites[id]); motion.moves())
        impl_->moving_sites.emplace_back(static_cast<int>(id), std::move(motion));
    how == Open::fresh ? impl_->start_fresh(scene) : impl_->start_again(scene);
    impl_->prepare_inserts();
  });
}

RunFileRecorder::RunFileRecorder(RunFolder folder, const Scene& scene, Open how,
                                 std::optional<ResumePoint> point) {
  open(std::move(folder), scene, how, std::move(point));
}

RunFileRecorder::RunFileRecorder(const fs::path& dir, const Scene& scene, Open how) {
  RunFolder folder(dir);
  // Every check of a resume comes before the file is opened for writing.
  std::optional<ResumePoint> point;
  if (how == Open::resume) point = folder.resume_point(scene);
  open(std::move(folder), scene, how, std::move(point));
}

// Rows that still wait are committed, so a run that an exception ends keeps all that it has told.
RunFileRecorder::~RunFileRecorder() {
  // What could not be written once is not tried again: the transaction has been given up.
  if (!impl_ || !impl_->failed.empty()) return;
  try {
    impl_->commit();
  } catch (const std::exception&) {
    // the file stays at its last commit, which is whole; a destructor has nobody to tell
  }
}

const fs::path& RunFileRecorder::file() const { return impl_->folder.file(); }
const std::optional<ResumePoint>& RunFileRecorder::resume_point() const { return impl_->resume_point; }

bool RunFileRecorder::has_frame_of(double t) const {
  return impl_->resume_point && impl_->resume_point->t == t && !impl_->resumes_off_the_clock;
}

/// From column 3 on.
/// The six columns that `frame` and `site_frame` share, and the row with them.
void RunFileRecorder::Impl::put_state(SQLite::Statement& put, const BodyState& s) {
  put.bind(3, s.pose.position.x());
  put.bind(4, s.pose.position.y());
  put.bind(5, s.pose.angle);
  put.bind(6, s.twist.velocity.x());
  put.bind(7, s.twist.velocity.y());
  put.bind(8, s.twist.omega);
  put.exec();
  // reset() keeps what is bound: the time is bound once for all rows of a frame.
  put.reset();
}

/// Where the moving sites are at t [s]. Times only grow, so each motion forgets what lies before:
/// memory does not grow with the run.
void RunFileRecorder::Impl::put_site_frames(double t) {
  SQLite::Statement& put = *insert_site_frame;
  for (auto& [id, site] : moving_sites) {
    if (sites_asked_for != t) site.extend(t);
    // A formula that cannot be followed to t ends the run by itself; here the row is left out, and so it is where the
    // run was stopped on the way there.
    if (!(site.motion().end() >= t) || !site.motion().remembers(t)) continue;
    put.bind(1, t);
    put.bind(2, id);
    put_state(put, site.motion().state(t));
    site.forget_before(t);
  }
}

/// Nine columns from number `first` on, or nine NULLs.
void RunFileRecorder::Impl::put_side(SQLite::Statement& put, int first, const EventSide& side) {
  // In the order of the columns: place, twist before, twist after.
  const BodyState& s = side.after;
  const Twist& b = side.before;
  const double reals[] = {s.pose.position.x(),  s.pose.position.y(),  s.pose.angle,
                          b.velocity.x(),       b.velocity.y(),       b.omega,
                          s.twist.velocity.x(), s.twist.velocity.y(), s.twist.omega};
  for (int i = 0; i < 9; ++i) side.known ? put.bind(first + i, reals[i]) : put.bind(first + i);
}

bool RunFileRecorder::get_ready(double t) {
  constexpr std::uint64_t cells = 1024;  // some milliseconds
  impl_->sites_asked_for = t;
  bool ready = true;
  for (auto& [id, site] : impl_->moving_sites)
    if (site.extend(t, cells).status == Extent::Status::unfinished) {
      // only the motion from t on is asked for, unless the run is stopped before
      site.forget_before(site.motion().end());
      ready = false;
    }
  return ready;
}

// A frame is never cut by a commit: that comes after its last row.
void RunFileRecorder::frame(double t, std::span<const BodyState> states) {
  impl_->writing([&] {
    impl_->begin();
    SQLite::Statement& put = *impl_->insert_frame;
    put.bind(1, t);
    for (std::size_t k = 0; k < states.size(); ++k) {
      put.bind(2, static_cast<std::int64_t>(k));
      impl_->put_state(put, states[k]);
    }
    impl_->put_site_frames(t);
    impl_->frames += static_cast<std::int64_t>(states.size());
    impl_->rows_waiting += static_cast<std::int64_t>(states.size());
    impl_->commit_if_due();
  });
}

void RunFileRecorder::event(const Event& event) {
  impl_->writing([&] {
    impl_->begin();
    const Contact& c = event.contact;
    SQLite::Statement& put = *impl_->insert_event;
    const auto id_or_null = [&put](int column, int id) { id < 0 ? put.bind(column) : put.bind(column, id); };
    put.bind(1, static_cast<std::int64_t>(event.seq));
    put.bind(2, c.time);
    // Words of enums are literals: they outlive the statement.
    put.bindNoCopy(3, to_string(event.kind));
    id_or_null(4, c.body);
    id_or_null(5, c.other_body);
    id_or_null(6, c.other_site);
    const double reals[] = {c.point.x(),     c.point.y(),     c.normal.x(),    c.normal.y(),
                            c.closing_speed, event.impulse_n, event.impulse_t, c.gap};
    // NaN becomes NULL in SQLite, and is read back as NaN.
    for (int i = 0; i < 8; ++i) put.bind(7 + i, reals[i]);
    id_or_null(15, c.site);
    id_or_null(16, c.sample);
    put.bind(17, c.sample_on_body ? 1 : 0);
    put.bind(18, c.time_low);
    impl_->put_side(put, 19, event.body);
    impl_->put_side(put, 28, event.other);
    put.exec();
    put.reset();
    // Numbers count from 0 without holes, also over a resume: the last one says how many rows there are.
    impl_->events = static_cast<std::int64_t>(event.seq) + 1;
    ++impl_->rows_waiting;
    impl_->commit_if_due();
  });
}

// Told at the ends of stretches, so rows are in the order of t_end and not of t_begin.
void RunFileRecorder::contact_lasted(const LastedContact& c) {
  impl_->writing([&] {
    impl_->begin();
    SQLite::Statement& put = *impl_->insert_contact;
    put.bind(1, c.from);
    put.bind(2, c.to);
    // -1 is NULL: of other body and other site one always is.
    const int ids[] = {c.body, c.other_body, c.other_site, c.site, c.sample};
    for (int i = 0; i < 5; ++i) ids[i] < 0 ? put.bind(3 + i) : put.bind(3 + i, ids[i]);
    put.bindNoCopy(8, to_string(c.mode));
    put.bind(9, c.normal_force);
    put.bind(10, c.tangential_force);
    put.bind(11, c.sample_on_body ? 1 : 0);
    const double reals[] = {c.point.x(), c.point.y(), c.normal.x(), c.normal.y()};
    for (int i = 0; i < 4; ++i) put.bind(12 + i, reals[i]);
    put.exec();
    put.reset();
    ++impl_->contacts;
    ++impl_->rows_waiting;
    impl_->commit_if_due();
  });
}

// Beyond the limit nothing is kept: what is in the file is then exact up to there, not coarser everywhere.
void RunFileRecorder::knot(const Knot& k) {
  if (impl_->knots >= impl_->most_knots) return;
  impl_->writing([&] {
    impl_->begin();
    SQLite::Statement& put = *impl_->insert_knot;
    put.bind(1, k.time);
    put.bind(2, k.body);
    const double reals[] = {k.pose.position.x(),   k.pose.position.y(),   k.pose.angle,
                            k.before.velocity.x(), k.before.velocity.y(), k.before.omega,
                            k.after.velocity.x(),  k.after.velocity.y(),  k.after.omega};
    for (int i = 0; i < 9; ++i) put.bind(3 + i, reals[i]);
    put.bind(12, impl_->events);
    put.exec();
    put.reset();
    ++impl_->knots;
    ++impl_->rows_waiting;
    impl_->commit_if_due();
  });
}

void RunFileRecorder::checkpoint(double t, const std::vector<std::byte>& state) {
  impl_->writing([&] {
    impl_->begin();
    // All rows of before are in this transaction or in earlier ones, so these counts hold whatever
    // comes.
    impl_->put_checkpoint({t, {}, impl_->wall(), impl_->frames, impl_->events, impl_->contacts, impl_->knots},
                          state);
    // For a run that is killed: how far it had come.
    impl_->set_meta("end_time", number(t));
    impl_->set_meta("wall_seconds", number(impl_->wall()));
    impl_->commit();
  });
}

// Inside writing(), so a full disk is told here, too, and not first at the next event.
void RunFileRecorder::poll() {
  impl_->writing([&] { impl_->commit_if_due(); });
}

void RunFileRecorder::simulation_begins() {
  if (impl_->resume_point)
    while (!get_ready(impl_->resume_point->t)) {
    }
  impl_->begun = Clock::now();
}

void RunFileRecorder::leave_out(double seconds) { impl_->waited += seconds; }

// The last rows, then all that says how the run ended, in one transaction: a file that has a
// termination has every row. Only then the journal changes, which SQLite does outside of any
// transaction.
void RunFileRecorder::finish(const RunSummary& summary, const std::string& summary_json) {
  impl_->writing([&] {
    impl_->begin();
    impl_->set_meta("termination", summary.termination_text());
    impl_->set_meta("end_time", number(summary.end_time));
    impl_->set_meta("state_hash", hex(summary.state_hash));
    impl_->set_meta("wall_seconds", number(summary.wall_seconds));
    impl_->set_meta("summary", summary_json);
    SQLite::Statement put(impl_->db, "INSERT OR REPLACE INTO work VALUES (?, ?, ?)");
    WorkCounters::for_each(summary.work, [&](const char* name, auto value, const char* unit) {
      put.bind(1, name);
      put.bind(2, static_cast<double>(value));
      put.bind(3, unit);
      put.exec();
      put.reset();
    });
    // Made once all rows are in, rather than kept up to date row by row.
    const std::int64_t rows = impl_->frames + 2 * impl_->events + impl_->knots;
    if (summary.termination != Termination::stopped || rows <= kMostIndexedOfStopped) {
      impl_->db.exec(kRunFileIndices);
      if (impl_->frames <= kMostIndexed) impl_->db.exec(kFrameIndex);
    }
    impl_->commit();
    impl_->insert_frame.reset();
    impl_->insert_site_frame.reset();
    impl_->insert_event.reset();
    impl_->insert_contact.reset();
    impl_->insert_knot.reset();
    impl_->db.tryExec(
        "PRAGMA journal_mode = DELETE");  // one plain file; not possible while somebody reads it
  });
}

}  // namespace brink
