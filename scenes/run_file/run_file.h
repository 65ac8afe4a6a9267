#pragma once
/// The run file: everything a run did, in one SQLite 3 database (`run.db`). The one door to SQLite.
///
/// Tables (times in s, lengths in m, angles in rad and never wrapped):
///
///     meta        key, value         text; see below
///     body        id, name, mass, inertia, shape         shape: JSON about the centre of mass (shape_json.h)
///     site        id, name, owner, kind, shape           the scene's fixed sites; owner NULL: the scene
///     frame       t, body, x, y, angle, vx, vy, omega    rows in time order; within a time by body
///     event       seq, t, kind, body, other, site, px, py, nx, ny, closing_speed, impulse_n, impulse_t, gap,
///                 outline_site, sample, sample_on_body, t_low   other NULL: a fixed site, and `site` is its
///                 id in the site table; else `site` is NULL. outline_site and sample say which Voronoi site
///                 and which sample of the two outlines met. x .. omega: of a collision of free bodies, how
///                 `body` comes out of it, *_before with what twist it came; other_x .. likewise; else NULL
///     site_frame  t, site, x, y, angle, vx, vy, omega    poses of the sites that move, at every frame
///     contact     t_begin, t_end, body, other, site, outline_site, sample, mode, force_n, force_t,
///                 sample_on_body, px, py, nx, ny         contacts that lasted, in the order of their ends;
///                 mode: rest, stick, slip, roll. A row is one stretch of a mode, with its forces [N], place
///                 and normal at its end (scheduler/run/lasted_contact.h). At the end of a run come those
///                 that last still, with its time as t_end
///     knot        t, body, x, y, angle, vx_before, vy_before, omega_before, vx, vy, omega, events
///                 how bodies move in islands (scheduler/run/knot.h): a place with the twist before and after;
///                 events: how many rows of `event` came before it. Of each body in the order of time. At most
///                 output.max_knots: the first ones
///     work        counter, value, unit                   written at the end
///     checkpoint  t, state, frames, events, wall_seconds, contacts, knots   one row, the last one: the
///                 simulator's snapshot, sealed by a checksum (checkpoint_seal.h), and how many rows of
///                 `frame`, `event`, `contact` and `knot` came before it
///
/// Views with units in their columns' names: energy_over_time, body_path, contacts_of, timeline. A run that
/// ends makes indices by body (of frames up to 2 million rows; one that was stopped after more than
/// 200 000 rows makes none).
///
/// meta: schema_version, brink_version, scene, files (JSON: the scene's file and its data files, whole paths), title, options (JSON), scene_text, overrides (JSON), springs
/// (JSON: body, other or null, at, other_at), attractions (JSON: bodies, center, strength, power), world_hash, termination ("running"
/// until the end), duration, end_time, state_hash, wall_seconds, summary (the JSON of `brink run --json`).
///
/// Rows are committed every 20 000 rows or 0.25 s. After a kill at any moment the file opens and holds all
/// but those last rows; a checkpoint is committed together with every row before it. While a run goes on the
/// journal is a write-ahead log (`run.db-wal`, which belongs to the file), so that others may read it
/// meanwhile; a finished file is a single file.
///
/// A run file is read with distrust: whatever is wrong in it is an IoError that names the file and the table.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "brink/core/fields/field_options.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/run/recorder.h"

namespace brink {

/// Raised when a column changes its meaning; added columns and keys do not count.
inline constexpr int kRunFileSchema = 2;

/// Where a stopped or killed run can go on.
struct ResumePoint {
  double t = 0.0;  ///< [s]
  std::vector<std::byte> state;
  double wall_seconds = 0.0;                                     ///< spent before
  std::int64_t frames = 0, events = 0, contacts = 0, knots = 0;  ///< rows before
};

class RunFile;

/// A folder that a run writes its run file into, locked until destruction or death: one run at a time.
class RunFolder {
 public:
  /// Makes the folder if need be, and locks it. @throws IoError, also if another run writes there.
  explicit RunFolder(const std::filesystem::path& dir);
  ~RunFolder();
  RunFolder(RunFolder&&) noexcept;

  const std::filesystem::path& file() const { return file_; }  ///< DIR/run.db, there or not
  /// Calls f with the run file that is there; does nothing if there is none, or an empty one (a run killed in
  /// its first moments leaves such). Leaves the file, and what is beside it, byte for byte as it was.
  void read(const std::function<void(const RunFile&)>& f) const;
  /// Where the run of `scene` in this folder can go on; nothing if it has to begin again. Every check of a
  /// resume is made here, before anything is written.
  /// @throws BadInput if the file is of another scene or other options, naming what differs; IoError.
  std::optional<ResumePoint> resume_point(const Scene& scene) const;

 private:
  std::filesystem::path file_;
  int lock_ = -1;
};

/// Writes a run file as the run goes. After a failure (a full disk) nothing more is written: the file stays
/// at its last commit, which is whole, and every later call fails the same way.
class RunFileRecorder final : public Recorder {
 public:
  enum class Open {
    fresh,   ///< a new file; one that is there already is kept as run-1.db, run-2.db ...
    resume,  ///< goes on with the file that is there: rows after its checkpoint are dropped, all of them if
             ///< it has none
  };

  /// Opens DIR/run.db, making the folder if need be.
  /// @throws IoError if it cannot be opened or written, or another run writes there.
  /// @throws BadInput (resume) if the file is of another scene or other options, naming what differs.
  RunFileRecorder(const std::filesystem::path& dir, const Scene& scene, Open how);
  /// The same in a folder that is locked already. `point` (resume): what folder.resume_point(scene) said;
  /// rows after it are dropped in one transaction with the checkpoint that counts them.
  RunFileRecorder(RunFolder folder, const Scene& scene, Open how, std::optional<ResumePoint> point);
  ~RunFileRecorder() override;

  const std::filesystem::path& file() const;
  /// Set after opening to resume, if the file has a checkpoint.
  const std::optional<ResumePoint>& resume_point() const;
  /// True if a run goes on from there, and the frame clock has a frame there, which is kept.
  bool has_frame_of(double t) const;

  /// Follows sites that move by formulas, by an instalment. Where a frame comes before they are at its time, it has no
  /// rows of theirs.
  bool get_ready(double t) override;
  void frame(double t, std::span<const BodyState> states) override;
  void event(const Event& event) override;
  void contact_lasted(const LastedContact& contact) override;
  void knot(const Knot& knot) override;
  void checkpoint(double t, const std::vector<std::byte>& state) override;

  /// Commits what has waited longer than 0.25 s. Call now and then where rows are rare.
  void poll();

  /// From now on wall-clock seconds are the simulation's: what comes before, the motion of sites up to where a run goes
  /// on among it, is made here, and may take long.
  void simulation_begins();

  /// So many wall-clock seconds were not the simulation's: checkpoints do not count them.
  void leave_out(double seconds);

  /// Closes the run: its termination, its counters, and `summary_json` as it is printed.
  void finish(const RunSummary& summary, const std::string& summary_json);

 private:
  void open(RunFolder folder, const Scene& scene, Open how, std::optional<ResumePoint> point);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A row of `knot`.
struct TimedKnot : Knot {
  std::int64_t events =
      0;  ///< that were told before it: knots of an event's time may come before or after it
};

/// Reads a run file, of a finished, killed or going run. Everything read is checked: numbers are finite, ids
/// are of bodies and sites that there are, frames are whole; every member throws IoError where they are not.
class RunFile {
 public:
  struct BodyRow {
    int id = 0;
    std::string name;
    double mass = 0.0, inertia = 0.0;
    Outline outline;  ///< about the centre of mass
  };
  struct Frame {
    double t = 0.0;
    std::vector<BodyState> states;  ///< by body id
  };

  /// @throws IoError if the file cannot be opened or is not a run file of a schema known here.
  explicit RunFile(const std::filesystem::path& file);
  ~RunFile();
  RunFile(RunFile&&) noexcept;

  /// From now on all that is read is of one moment, also while a run goes on: tables fit together.
  void hold();

  std::map<std::string, std::string> meta() const;
  std::optional<std::string> meta(const std::string& key) const;
  /// What nobody may write over while this run is worth keeping: its file, and what it was made of (the scene's file and
  /// its data files), as far as they are there still.
  std::vector<std::filesystem::path> files() const;
  std::vector<BodyRow> bodies() const;
  std::vector<FixedSite> sites() const;
  /// What pictures need of the world: title, bodies with their states in the first frame, fixed sites,
  /// springs, attractions. Materials and other forces are not kept in tables of a run file, but meta's scene_text is.
  World world() const;
  std::int64_t event_count() const;
  /// What cannot be told of motions between frames, for people; empty: nothing. Collisions that were not recorded are led
  /// straight through, and between two frames alone nothing tells how far an integrator's motions are off.
  std::string unknown_between_frames() const;
  /// At most so many, from number `first` on, in the order of their numbers.
  std::vector<Event> events(std::int64_t first = 0,
                            std::int64_t most = std::numeric_limits<std::int64_t>::max()) const;
  /// None in files of before.
  std::int64_t knot_count() const;
  /// Where knots end although the run goes on, as there are no more than output.max_knots [s].
  std::optional<double> knots_end() const;
  /// At most so many, behind the first `first`; of each body in the order of time.
  std::vector<TimedKnot> knots(std::int64_t first = 0,
                               std::int64_t most = std::numeric_limits<std::int64_t>::max()) const;
  struct Spring {
    int body = 0, other = -1;  ///< -1: anchored
    Vec2 at, other_at;         ///< in the bodies' frames; the anchor in the world [m]
    double stiffness = 0.0, rest_length = 0.0;
  };
  std::vector<Spring> springs() const;
  /// None in files of before.
  std::vector<AttractForce> attractions() const;
  /// The scene's `[field]`: pictures of a run are drawn by it, too. @throws IoError if it is not valid.
  FieldOptions field_options() const;
  /// Those that lasted at time t [s]: from <= t < to, and at the end of the run those that last still.
  std::vector<LastedContact> contacts_at(double t) const;
  /// All of them.
  std::vector<LastedContact> contacts() const;
  /// The last checkpoint, its seal opened.
  std::optional<ResumePoint> checkpoint() const;
  /// meta's `end_time` [s].
  double end_time() const;
  /// meta's `summary`, a JSON object in one line.
  std::string summary() const;

  /// @throws BadInput if this run is not of `scene` with its options and of this version, naming what
  /// differs.
  void require_same(const Scene& scene) const;
  /// @throws IoError if pages of the database are damaged, or rows are missing that the checkpoint counts.
  /// Cost: reads the whole file.
  void require_sound() const;

  /// Times of the first and last whole frame [s].
  std::pair<double, double> time_range() const;
  /// Whole frames in the file.
  std::int64_t frame_count() const;
  /// Calls f with every `stride`-th frame from the first on, and with the last. Cost: reads every row once.
  void each_frame(std::int64_t stride, const std::function<void(const Frame&)>& f) const;
  /// The last whole frame at or before t, or the first one. Cost: a binary search.
  Frame frame_at(double t) const;
  /// States at t for a picture: between two of a body's recorded states (frames, and its collisions and knots
  /// with the twist before and after) the cubic with their poses and twists; outside the time range, the nearest frame.
  /// Exact for constant accelerations, but for files of before, which know nothing of bodies at collisions.
  Frame states_at(double t) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brink
