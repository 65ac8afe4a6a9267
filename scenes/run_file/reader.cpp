/// Reading run files: class RunFile. A file may come from anywhere, so nothing that it says is used
/// before it is checked: values by Row (type and range), tables by reading(), which turns whatever is
/// thrown inside it into an IoError that names the file and the table.
///
/// Frames are found by their row numbers: a frame is as many rows as there are bodies, so frame k is
/// the rows k * bodies + 1 .. (k + 1) * bodies. The frame of a time is a binary search over the times
/// of frames, one row read a step.
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>

#include "brink/core/base/error.h"
#include "brink/core/world/world_hash.h"
#include "brink/scenes/run_file/checkpoint_seal.h"
#include "brink/scenes/run_file/database.h"
#include "brink/scenes/run_file/row.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/shape_json.h"
#include "brink/scenes/run_file/tables.h"
#include "brink/scenes/version.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

/// As guarded() calls the file: "cannot be read or written as a run file".
constexpr const char* kWhat = "a run file";

/// Options that a run may be gone on with at another value: they decide what is refused, not what happens.
constexpr const char* kFree[] = {"/output/max_frame_rows"};

/// "solver.order was "index", is now "depth"" for every option that differs; empty if none does.
/// @throws BadInput if `was` is not JSON.
std::string differences(const std::string& was, const std::string& is) {
  if (was == is) return {};
  // parse() without exceptions gives a discarded value, which is no object.
  const auto a = nlohmann::json::parse(was, nullptr, false), b = nlohmann::json::parse(is, nullptr, false);
  if (!a.is_object()) throw BadInput("options: not a JSON object");
  // Flat, {"/solver/order": "index"}: every leaf has one key in both, whatever the nesting.
  const auto old_values = a.flatten(), new_values = b.flatten();
  std::string text;
  const auto value = [](const nlohmann::json& j, const std::string& key) {
    return j.contains(key) ? j.at(key).dump() : std::string("absent");
  };
  auto all = old_values;
  all.update(new_values);
  for (const char* key : kFree) all.erase(key);
  for (const auto& [key, unused] : all.items()) {
    const std::string before = value(old_values, key), now = value(new_values, key);
    if (before != now)
      text += fmt::format("{}{} was {}, is now {}", text.empty() ? "" : "; ", key, before, now);
  }
  return text;
}

/// The kind that has this word in column `kind`. By the words of to_string(), with which the recorder
/// writes, so that the two cannot differ. @throws BadInput where no kind has it.
EventKind kind_from(const std::string& word) {
  // `lift` is the last of the enum.
  for (int k = 0; k <= static_cast<int>(EventKind::lift); ++k) {
    if (word == to_string(static_cast<EventKind>(k))) return static_cast<EventKind>(k);
  }
  throw BadInput(fmt::format("event of unknown kind '{}'", word));
}

/// The mode that has this word in column `mode` of table `contact`. @throws BadInput where none has it.
ContactMode mode_from(const std::string& word) {
  // `none` (0) is never recorded.
  for (int k = 1; k <= static_cast<int>(ContactMode::roll); ++k)
    if (word == to_string(static_cast<ContactMode>(k))) return static_cast<ContactMode>(k);
  throw BadInput(fmt::format("contact of unknown mode '{}'", word));
}

/// Value and slope at time t of the cubic through (0, a, va) and (h, b, vb), s = t / h.
/// Exact for motions of constant acceleration, which are quadratic; a cubic holds them.
///
/// p = a + va t + c2 t^2 + c3 t^3 with p(h) = b gives c2 + c3 h = (d - va) / h, and with p'(h) = vb it
/// gives 2 c2 + 3 c3 h = (vb - va) / h. Twice the first taken from the second leaves c3.
std::pair<double, double> hermite(double a, double va, double b, double vb, double h, double s) {
  const double d = (b - a) / h;
  // With d the mean slope: c2 and c3 are fixed by value and slope at t = h.
  const double c2 = (3 * d - 2 * va - vb) / h, c3 = (va + vb - 2 * d) / (h * h), t = s * h;
  // Horner's scheme, for the value and for its derivative.
  return {a + t * (va + t * (c2 + t * c3)), va + t * (2 * c2 + 3 * t * c3)};
}

/// A state that is known.
struct KnownState {
  double t = 0.0;
  BodyState state;
};

/// The state at t of the cubics through two known states of one body: x, y and angle, each on its own.
/// Angles are not wrapped, so whole turns between the two are not lost.
BodyState between(const KnownState& left, const KnownState& right, double t) {
  const BodyState &a = left.state, &b = right.state;
  const double h = right.t - left.t;
  // Never so of what states_at() gives, left.t <= t < right.t; of others the quotients would be
  // infinite.
  if (!(h > 0.0)) return a;
  BodyState m;
  const double s = (t - left.t) / h;
  for (int i = 0; i < 2; ++i) {
    std::tie(m.pose.position[i], m.twist.velocity[i]) =
        hermite(a.pose.position[i], a.twist.velocity[i], b.pose.position[i], b.twist.velocity[i], h, s);
  }
  std::tie(m.pose.angle, m.twist.omega) =
      hermite(a.pose.angle, a.twist.omega, b.pose.angle, b.twist.omega, h, s);
  return m;
}

}  // namespace

namespace {

/// Columns of a lasted contact, in the order in which Impl::contacts() takes them by number. What rows
/// are asked for, and in which order, comes behind.
constexpr const char* kContactColumns =
    "SELECT t_begin, t_end, mode, body, other, site, sample, outline_site, sample_on_body, px, py, nx, "
    "ny, force_n, force_t FROM contact ";

/// Columns of both sides of an event, nine a side: place, twist before, twist after. They stand behind
/// other columns, hence the comma.
constexpr const char* kStateColumns =
    ", x, y, angle, vx_before, vy_before, omega_before, vx, vy, omega, other_x, other_y, other_angle, "
    "other_vx_before, other_vy_before, other_omega_before, other_vx, other_vy, other_omega";

constexpr const char* kKnotColumns =
    "SELECT t, body, x, y, angle, vx_before, vy_before, omega_before, vx, vy, omega, events FROM knot ";

/// The side of an event whose nine columns begin at column number `first`.
/// @throws BadInput where x is a number and one of the others is none.
EventSide side_in(const Row& row, int first) {
  EventSide side;
  side.known = !std::isnan(row.real_or_nan(first));
  // x alone tells: a side is recorded whole or not at all.
  if (!side.known) return side;
  const auto at = [&](int i) { return row.real(first + i); };
  side.before = {{at(3), at(4)}, at(5)};
  side.after = {{{at(0), at(1)}, at(2)}, {{at(6), at(7)}, at(8)}};
  return side;
}

}  // namespace

/// The open file, and what every question needs of it: how many bodies and sites there are, which
/// bounds the ids in all other tables. What SQLite or Row throws in a member that does not itself call
/// reading() is the caller's to wrap.
struct RunFile::Impl {
  fs::path file;
  mutable SQLite::Database db;
  std::int64_t bodies = 0, sites = 0;
  bool has_states = false,
       has_knots = false;  ///< of bodies at collisions, in islands; files of before have none

  // Looked for at once, so that any other database is told as what it is not.
  explicit Impl(const fs::path& f) : file(f), db(open_database(f, SQLite::OPEN_READONLY, kBusyMilliseconds)) {
    for (const char* table : {"meta", "body", "site", "frame", "event", "work", "checkpoint"})
      if (!db.tableExists(table))
        throw IoError(fmt::format("{}: not a run file: table {} is missing", f.string(), table));
    bodies = rows_numbered_from_zero("body");
    sites = rows_numbered_from_zero("site");
    has_states = has_column("event", "other_omega");
    has_knots = db.tableExists("knot");
  }

  /// How many rows a table of things has, whose ids are 0, 1, 2 ...
  std::int64_t rows_numbered_from_zero(const char* table) const {
    return reading(file, table, [&] {
      SQLite::Statement get(db, fmt::format("SELECT count(*), min(id), max(id) FROM {}", table));
      get.executeStep();
      const Row row(get);
      const std::int64_t rows = row.count(0, std::numeric_limits<int>::max());
      // Three numbers tell it, as `id` is the primary key of what a run makes: no two are equal.
      if (rows > 0 && (row.count(1) != 0 || row.count(2) != rows - 1)) throw BadInput("rows are missing");
      return rows;
    });
  }

  /// True if the table has that column. Columns may be added without a new schema number, so those of
  /// files from before are asked for one by one.
  bool has_column(const std::string& table, const std::string& column) const {
    SQLite::Statement get(db, "SELECT count(*) FROM pragma_table_info(?) WHERE name = ?");
    get.bind(1, table);
    get.bind(2, column);
    return get.executeStep() && get.getColumn(0).getInt64() > 0;
  }

  /// Whole frames in the file. Rows are numbered from 1 without holes, `bodies` rows a frame.
  std::int64_t frames() const {
    // Rows beyond the last whole frame are those of a frame that was under way.
    const std::int64_t rows = db.execAndGet("SELECT ifnull(max(rowid), 0) FROM frame").getInt64();
    return bodies > 0 && rows > 0 ? rows / bodies : 0;
  }
  /// The same, for who needs one. @throws BadInput where there is none.
  std::int64_t some_frames() const {
    const std::int64_t count = frames();
    if (count == 0) throw BadInput(bodies > 0 ? "it holds no whole frame yet" : "its scene has no bodies");
    return count;
  }
  /// Time of frame `index` [s], from its first row. @throws BadInput where that row is missing.
  double frame_time(std::int64_t index) const {
    SQLite::Statement get(db, "SELECT t FROM frame WHERE rowid = ?");
    get.bind(1, index * bodies + 1);
    if (!get.executeStep()) throw BadInput(fmt::format("frame {} is missing", index));
    return Row(get).real(0);
  }
  /// The last frame at or before t, or 0.
  std::int64_t frame_index(double t) const {
    std::int64_t low = 0, high = some_frames();
    // Frame `low` is at or before t, or it is the first; frame `high` is after t, or it is beyond the
    // last.
    while (high - low > 1) {
      const std::int64_t middle = low + (high - low) / 2;
      (frame_time(middle) <= t ? low : high) = middle;
    }
    return low;
  }
  /// A body at an event or a knot.
  struct Passed {
    double t = 0.0;
    std::int64_t events = 0;  ///< before it
    bool is_event = false;
    int body = -1;
    EventSide side;

    /// In this order they happened: knots of an instant may be of before or after its events.
    bool operator<(const Passed& b) const {
      return std::tie(t, events, is_event) < std::tie(b.t, b.events, b.is_event);
    }
  };

  /// How bodies pass through events and knots of [from, to], in their order.
  /// Calls f(time, body, side) for each owner that is a body of which something is told; fixed sites are
  /// left out, and so are events without states.
  template <class F>
  void each_side_between(double from, double to, F&& f) const {
    std::vector<Passed> all;
    add_knots_between(from, to, all);
    add_events_between(from, to, all);
    std::stable_sort(all.begin(), all.end());
    for (const Passed& p : all) f(p.t, p.body, p.side);
  }

  void add_knots_between(double from, double to, std::vector<Passed>& all) const {
    if (!has_knots) return;  // of before
    SQLite::Statement get(db, std::string(kKnotColumns) + "WHERE t BETWEEN ? AND ? ORDER BY rowid");
    get.bind(1, from);
    get.bind(2, to);
    while (get.executeStep()) {
      const TimedKnot k = knot_in(Row(get));
      all.push_back({k.time, k.events, false, k.body, {true, {k.pose, k.after}, k.before}});
    }
  }

  TimedKnot knot_in(const Row& row) const {
    const auto twist = [&row](int i) { return Twist{{row.real(i), row.real(i + 1)}, row.real(i + 2)}; };
    TimedKnot k;
    k.time = row.real(0);
    k.body = static_cast<int>(row.count(1, bodies));
    k.pose = {{row.real(2), row.real(3)}, row.real(4)};
    k.before = twist(5);
    k.after = twist(8);
    k.events = row.count(11);
    return k;
  }

  void add_events_between(double from, double to, std::vector<Passed>& all) const {
    if (!has_states) return;  // of before
    // Inclusive at both ends: a frame may stand before or after a collision of its own time.
    SQLite::Statement get(db, std::string("SELECT t, body, other") + kStateColumns +
                                  ", seq FROM event WHERE t BETWEEN ? AND ? ORDER BY seq");
    get.bind(1, from);
    get.bind(2, to);
    while (get.executeStep()) {
      const Row row(get);
      for (int side = 0; side < 2; ++side) {
        const int body = row.id_or_none(1 + side, bodies);
        if (body < 0) continue;
        // Behind t, body and other: columns 3 .. 11 are of `body`, 12 .. 20 of `other`.
        if (const EventSide how = side_in(row, 3 + 9 * side); how.known)
          all.push_back({row.real(0), row.count(21), true, body, how});
      }
    }
  }

  /// Takes the rows of frame `index` from a statement that has come there.
  void next_frame(SQLite::Statement& get, std::int64_t index, Frame& frame) const {
    frame.states.clear();
    // The first row gives the frame's time, and every other one must have the same.
    while (static_cast<std::int64_t>(frame.states.size()) < bodies && get.executeStep()) {
      const Row row(get);
      const double t = row.real(0);
      // Rows come by number; body ids must come as they were written, or states would go to
      // the wrong bodies.
      const bool next = row.count(7) == static_cast<std::int64_t>(frame.states.size());
      if (!next || (!frame.states.empty() && t != frame.t))
        throw BadInput(fmt::format("frame {} is mixed up", index));
      frame.t = t;
      frame.states.push_back(
          {{{row.real(1), row.real(2)}, row.real(3)}, {{row.real(4), row.real(5)}, row.real(6)}});
    }
    if (static_cast<std::int64_t>(frame.states.size()) != bodies)
      throw BadInput(fmt::format("frame {} is not whole", index));
  }
  /// Frame `index`, 0 <= index < frames(). Cost: its own rows alone, as rowid is the table's key.
  Frame read_frame(std::int64_t index) const {
    Frame frame;
    SQLite::Statement get(db,
                          "SELECT t, x, y, angle, vx, vy, omega, body FROM frame WHERE rowid > ? AND rowid "
                          "<= ? ORDER BY rowid");
    get.bind(1, index * bodies);
    get.bind(2, (index + 1) * bodies);
    next_frame(get, index, frame);
    return frame;
  }

  /// Those that the clause chooses, once `bind` has given it its values.
  /// The clause is a literal of this file; values from outside come by `bind`, never as text of SQL.
  template <class Bind>
  std::vector<LastedContact> contacts(const char* which, Bind&& bind) const {
    return reading(file, "contact", [&] {
      std::vector<LastedContact> all;
      if (!db.tableExists("contact")) return all;  // of before there was one
      SQLite::Statement get(db, std::string(kContactColumns) + which);
      bind(get);
      while (get.executeStep()) {
        const Row row(get);
        all.push_back({row.real(0),
                       row.real(1),
                       mode_from(row.text(2)),
                       static_cast<int>(row.count(3, bodies)),
                       row.id_or_none(4, bodies),
                       row.id_or_none(5, sites),
                       static_cast<int>(row.count(6, std::numeric_limits<int>::max())),
                       static_cast<int>(row.count(7, std::numeric_limits<int>::max())),
                       row.count(8, 2) != 0,
                       {row.real(9), row.real(10)},
                       {row.real(11), row.real(12)},
                       row.real(13),
                       row.real(14)});
        // Who reads on asks for one of the two by the other's being -1.
        if ((all.back().other_body < 0) == (all.back().other_site < 0))
          throw BadInput("a contact has one other owner, a body or a site");
      }
      return all;
    });
  }
};

// Tables first, then the schema: a database of another program is told as no run file at all, a run
// file of another Brink by its number.
RunFile::RunFile(const fs::path& file) : impl_(guarded(file, [&] { return std::make_unique<Impl>(file); })) {
  const std::string schema = meta("schema_version").value_or("");
  if (schema != std::to_string(kRunFileSchema)) {
    throw IoError(fmt::format("{}: table meta: schema_version '{}'; this program reads {}", file.string(),
                              schema, kRunFileSchema));
  }
}
RunFile::~RunFile() = default;
RunFile::RunFile(RunFile&&) noexcept = default;

void RunFile::hold() {
  // What a transaction sees is what there was when it first read something.
  reading(impl_->file, "frame", [&] {
    impl_->db.exec("BEGIN");
    return impl_->frames();
  });
}

std::map<std::string, std::string> RunFile::meta() const {
  return reading(impl_->file, "meta", [&] {
    std::map<std::string, std::string> all;
    SQLite::Statement get(impl_->db, "SELECT key, value FROM meta");
    while (get.executeStep()) all[Row(get).text(0)] = Row(get).text(1);
    return all;
  });
}

// By way of the whole table, which has fifteen rows.
std::optional<std::string> RunFile::meta(const std::string& key) const {
  const auto all = meta();
  const auto found = all.find(key);
  return found == all.end() ? std::nullopt : std::optional(found->second);
}

// Of a run that goes on or was killed it is the time of the last checkpoint, and 0 before the first.
double RunFile::end_time() const {
  return reading(impl_->file, "meta", [&] { return number_in(meta("end_time").value_or("")); });
}

// Parsed and written anew, so that what is printed is one line of sound JSON whatever the file holds.
// Of a run that has not ended the key is missing, and the empty text is an error like any other.
std::string RunFile::summary() const {
  return reading(impl_->file, "meta", [&] {
    const auto json = nlohmann::ordered_json::parse(meta("summary").value_or(""));
    if (!json.is_object()) throw BadInput("summary: not a JSON object");
    return json.dump();
  });
}

// Of a file of before the scene alone is known, which is as it was named in the folder where it was run.
std::vector<std::filesystem::path> RunFile::files() const {
  return reading(impl_->file, "meta", [&] {
    std::vector<std::filesystem::path> all{impl_->file};
    const auto take = [&all](const std::filesystem::path& file) {
      std::error_code missing;
      if (std::filesystem::exists(file, missing)) all.push_back(file);
    };
    take(meta("scene").value_or(""));
    for (const auto& file : nlohmann::json::parse(meta("files").value_or("[]")))
      take(file.get<std::string>());
    return all;
  });
}

// An outline for each row. Copies that shared one when the run was made have equal ones here.
std::vector<RunFile::BodyRow> RunFile::bodies() const {
  return reading(impl_->file, "body", [&] {
    std::vector<BodyRow> rows;
    SQLite::Statement get(impl_->db, "SELECT id, name, mass, inertia, shape FROM body ORDER BY id");
    while (get.executeStep()) {
      const Row row(get);
      rows.push_back({row.id_or_none(0, impl_->bodies), row.text(1), row.real(2), row.real(3),
                      outline_from_json(row.text(4))});
    }
    return rows;
  });
}

std::vector<FixedSite> RunFile::sites() const {
  return reading(impl_->file, "site", [&] {
    std::vector<FixedSite> sites;
    SQLite::Statement get(impl_->db, "SELECT name, kind, shape FROM site ORDER BY id");
    while (get.executeStep()) {
      const Row row(get);
      // Ids are 0, 1, 2 ... (rows_numbered_from_zero()): a site's place in the vector is its id.
      FixedSite& site = sites.emplace_back(fixed_site_from_json(row.text(2)));
      site.name = row.text(0);
      site.kind = row.text(1);
    }
    return sites;
  });
}

namespace {

/// world.periodic of the options.
/// In metres, 0 along an axis that does not repeat. @throws what nlohmann's accessors throw of options
/// that are not as a run writes them; BadInput below zero.
Vec2 periods_in(const std::string& options) {
  const nlohmann::json::json_pointer periodic("/world/periodic");
  const auto json = nlohmann::json::parse(options);
  if (!json.contains(periodic)) return Vec2::Zero();
  const Vec2 size{json.at(periodic).at(0).get<double>(), json.at(periodic).at(1).get<double>()};
  if (!(size.minCoeff() >= 0.0)) throw BadInput("options: world.periodic is below zero");
  return size;
}

}  // namespace

World RunFile::world() const {
  World world;
  world.title = meta("title").value_or("");
  // Bodies start as in the first frame; pictures of other times bring their own states.
  const Frame first = frame_at(0.0);
  for (BodyRow& row : bodies()) {
    Body& body = world.bodies.emplace_back();
    body.name = std::move(row.name);
    body.mass = row.mass;
    body.inertia = row.inertia;
    body.outline = std::make_shared<const Outline>(std::move(row.outline));
    body.initial = first.states.at(row.id);
  }
  world.sites = sites();
  // Damping is not stored, as no picture shows it.
  for (const Spring& s : springs())
    world.forces.push_back(SpringForce{s.body, s.other, s.at, s.other_at, s.stiffness, 0.0, s.rest_length});
  for (AttractForce& a : attractions()) world.forces.emplace_back(std::move(a));
  world.periods.size =
      reading(impl_->file, "meta", [&] { return periods_in(meta("options").value_or("{}")); });
  return world;
}

std::int64_t RunFile::event_count() const {
  return reading(impl_->file, "event", [&] {
    return impl_->db.execAndGet("SELECT ifnull(max(seq) + 1, 0) FROM event").getInt64();
  });
}

std::string RunFile::unknown_between_frames() const {
  return reading(impl_->file, "event", [&]() -> std::string {
    // a run that goes on has none yet
    const auto summary = nlohmann::json::parse(meta("summary").value_or(""), nullptr, false);
    const auto number = [](const nlohmann::json& of, const char* name) {
      return of.is_object() && of.contains(name) && of[name].is_number() ? of[name].get<double>() : 0.0;
    };
    const double collisions = number(summary, "collisions");
    const std::int64_t known =
        impl_->db.execAndGet("SELECT count(*) FROM event WHERE kind = 'collision'").getInt64();
    if (static_cast<double>(known) < collisions)
      return fmt::format(
          "{} of {} collisions were recorded: between frames bodies are led straight through the others",
          known, collisions);
    const auto work = summary.is_object() && summary.contains("work") ? summary["work"] : nlohmann::json();
    if (impl_->frames() <= 2 && number(work, "right_hand_sides") > number(work, "solver_steps"))
      return "between two frames alone nothing tells how far motions by an integrator are off";
    return "";
  });
}

std::vector<Event> RunFile::events(std::int64_t first, std::int64_t most) const {
  return reading(impl_->file, "event", [&] {
    std::vector<Event> all;
    // A run file of before has no columns of states.
    SQLite::Statement get(
        impl_->db,
        "SELECT seq, t, kind, body, other, site, px, py, nx, ny, closing_speed, impulse_n, impulse_t, "
        "gap, outline_site, sample, sample_on_body, t_low" +
            std::string(impl_->has_states ? kStateColumns : "") +
            " FROM event WHERE seq >= ? ORDER BY seq LIMIT ?");
    get.bind(1, first);
    get.bind(2, most);
    while (get.executeStep()) {
      const Row row(get);
      Event e;
      e.seq = static_cast<std::uint64_t>(row.count(0));
      e.kind = kind_from(row.text(2));
      // In the order of Contact's members, which is not that of the columns. Only the time has to be a
      // finite number: SQLite keeps NaN as NULL, and of all others that comes back as NaN.
      e.contact = {row.real(1),
                   row.real_or_nan(17),
                   row.id_or_none(3, impl_->bodies),
                   row.id_or_none(4, impl_->bodies),
                   row.id_or_none(5, impl_->sites),
                   row.id_or_none(14),
                   row.id_or_none(15),
                   row.count(16, 2) != 0,
                   {row.real_or_nan(6), row.real_or_nan(7)},
                   {row.real_or_nan(8), row.real_or_nan(9)},
                   row.real_or_nan(10),
                   row.real_or_nan(13)};
      e.impulse_n = row.real_or_nan(11);
      e.impulse_t = row.real_or_nan(12);
      if (impl_->has_states) {
        // Behind the eighteen columns of above.
        e.body = side_in(row, 18);
        e.other = side_in(row, 27);
      }
      all.push_back(e);
    }
    return all;
  });
}

std::int64_t RunFile::knot_count() const {
  return reading(impl_->file, "knot", [&] {
    return impl_->has_knots ? impl_->db.execAndGet("SELECT ifnull(max(rowid), 0) FROM knot").getInt64() : 0;
  });
}

std::optional<double> RunFile::knots_end() const {
  return reading(impl_->file, "knot", [&]() -> std::optional<double> {
    if (!impl_->has_knots) return std::nullopt;
    const nlohmann::json::json_pointer limit("/output/max_knots");
    const auto options = nlohmann::json::parse(meta("options").value_or("{}"));
    if (!options.contains(limit) || knot_count() < options.at(limit).get<std::int64_t>()) return std::nullopt;
    SQLite::Statement get(impl_->db, "SELECT t FROM knot ORDER BY rowid DESC LIMIT 1");
    return get.executeStep() ? Row(get).real(0) : 0.0;
  });
}

std::vector<TimedKnot> RunFile::knots(std::int64_t first, std::int64_t most) const {
  return reading(impl_->file, "knot", [&] {
    std::vector<TimedKnot> all;
    if (!impl_->has_knots) return all;
    SQLite::Statement get(impl_->db, std::string(kKnotColumns) + "WHERE rowid > ? ORDER BY rowid LIMIT ?");
    get.bind(1, first);
    get.bind(2, most);
    while (get.executeStep()) all.push_back(impl_->knot_in(Row(get)));
    return all;
  });
}

std::vector<RunFile::Spring> RunFile::springs() const {
  return reading(impl_->file, "meta", [&] {
    const auto json = nlohmann::json::parse(meta("springs").value_or("[]"));
    // null is the anchor of a spring that joins one body alone. All other ids must be of bodies that
    // there are.
    const auto body = [&](const nlohmann::json& j) {
      const int id = j.get<int>();
      if (id < 0 || id >= impl_->bodies) throw BadInput("springs: no such body");
      return id;
    };
    const auto vector = [](const nlohmann::json& j) {
      return Vec2(j.at(0).get<double>(), j.at(1).get<double>());
    };
    std::vector<Spring> all;
    for (const auto& j : json)
      all.push_back({body(j.at("body")), j.at("other").is_null() ? -1 : body(j.at("other")),
                     vector(j.at("at")), vector(j.at("other_at")), j.at("stiffness").get<double>(),
                     j.at("rest_length").get<double>()});
    return all;
  });
}

std::vector<AttractForce> RunFile::attractions() const {
  return reading(impl_->file, "meta", [&] {
    std::vector<AttractForce> all;
    for (const auto& j : nlohmann::json::parse(meta("attractions").value_or("[]"))) {
      AttractForce& a = all.emplace_back();
      a.bodies = j.at("bodies").get<std::vector<int>>();
      for (const int id : a.bodies)
        if (id < 0 || id >= impl_->bodies) throw BadInput("attractions: no such body");
      a.center = {j.at("center").at(0).get<double>(), j.at("center").at(1).get<double>()};
      a.strength = j.at("strength").get<double>();
      a.power = j.at("power").get<double>();
    }
    return all;
  });
}

FieldOptions RunFile::field_options() const {
  return reading(impl_->file, "meta", [&] {
    FieldOptions field;
    const auto options = nlohmann::json::parse(meta("options").value_or("{}"));
    const auto table = options.value("field", nlohmann::json::object());
    // What a file of before does not have keeps its default.
    const auto take = [&table](const char* key, auto& value) { value = table.value(key, value); };
    take("resolution", field.resolution);
    take("band", field.band);
    take("primitives", field.primitives);
    take("mesh_error", field.mesh_error);
    take("readback", field.readback);
    take("passes", field.passes);
    take("truncated", field.truncated);
    take("context", field.context);
    take("brute_force_below", field.brute_force_below);
    take("list_cap", field.list_cap);
    if (std::string why; !field.is_valid(&why)) throw BadInput("options: field: " + why);
    return field;
  });
}

std::vector<LastedContact> RunFile::contacts_at(double t) const {
  const double end = end_time();
  // [t_begin, t_end), but that those that outlast the run count at its end, too. Of a run that was killed the end is
  // its last checkpoint, and contacts are told of beyond it.
  return impl_->contacts("WHERE t_begin <= ?1 AND (?1 < t_end OR (t_end = ?1 AND ?1 >= ?2)) ORDER BY rowid",
                         [&](SQLite::Statement& get) {
                           get.bind(1, t);
                           get.bind(2, end);
                         });
}

std::vector<LastedContact> RunFile::contacts() const {
  return impl_->contacts("ORDER BY rowid", [](SQLite::Statement&) {});
}

std::optional<ResumePoint> RunFile::checkpoint() const {
  const auto of = meta();
  const auto text = [&](const char* key) { return of.contains(key) ? of.at(key) : std::string(); };
  return reading(impl_->file, "checkpoint", [&]() -> std::optional<ResumePoint> {
    SQLite::Statement get(impl_->db,
                          "SELECT t, state, frames, events, wall_seconds, contacts, knots FROM checkpoint");
    if (!get.executeStep()) return std::nullopt;
    const Row row(get);
    // The bytes belong to the statement until its next step, so they are copied into the point.
    const SQLite::Column blob = get.getColumn(1);
    const auto* bytes = static_cast<const std::byte*>(blob.getBlob());
    ResumePoint point{
        row.real(0), {bytes, bytes + blob.getBytes()}, row.real(4), row.count(2), row.count(3), row.count(5),
        row.count(6)};
    // A seal that does not hold throws: what is damaged is never given out.
    point.state = unsealed(point, run_identity(text("brink_version"), text("options"), text("world_hash")));
    // A recorder keeps a single row. Of two nobody could say which of them counts the rows of the file.
    if (get.executeStep()) throw BadInput("more than one row");
    return point;
  });
}

void RunFile::require_same(const Scene& scene) const {
  const std::string name = impl_->file.string();
  // Version, options, world: from what differs for everything to what differs in one scene.
  if (const std::string was = meta("brink_version").value_or(""); was != version()) {
    throw BadInput(
        fmt::format("{}: written by brink {}, this is {}: the bits could differ", name, was, version()));
  }
  const std::string differ = reading(
      impl_->file, "meta", [&] { return differences(meta("options").value_or(""), scene.options_json); });
  if (!differ.empty())
    throw BadInput(fmt::format("{}: --resume needs the options it was started with: {}", name, differ));
  // Of the world the file has no more than a hash, so what differs in it cannot be told.
  const std::string was = meta("world_hash").value_or(""), is = world_hash_text(scene.world);
  if (was != is) {
    throw BadInput(
        fmt::format("{}: --resume needs the scene it was started with: bodies, sites, materials or forces of "
                    "{} differ (hash was {}, is now {})",
                    name, scene.path.string(), was, is));
  }
}

namespace {

/// Every table is made as Brink makes it: what is inserted finds its columns.
/// By its text, so another spelling of the same columns is refused, too. @throws IoError naming the
/// first table that differs.
void require_tables(const fs::path& file, SQLite::Database& db) {
  // SQLite keeps the text of each CREATE statement: equal texts, equal tables.
  SQLite::Database made(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  made.exec(kRunFileTables);
  SQLite::Statement wanted(made, "SELECT name, sql FROM sqlite_master WHERE type = 'table'");
  SQLite::Statement found(db, "SELECT sql FROM sqlite_master WHERE type = 'table' AND name = ?");
  while (wanted.executeStep()) {
    const std::string name = wanted.getColumn(0).getString();
    found.reset();
    found.bind(1, name);
    if (!found.executeStep() || found.getColumn(0).getString() != wanted.getColumn(1).getString())
      throw IoError(fmt::format("{}: table {}: is not as a run makes it", file.string(), name));
  }
}

}  // namespace

void RunFile::require_sound() const {
  // The first fault is enough.
  const auto pages = [&] { return impl_->db.execAndGet("PRAGMA integrity_check(1)").getString(); };
  if (const std::string found = guarded(impl_->file, pages, kWhat); found != "ok")
    throw IoError(fmt::format("{}: the database is damaged: {}", impl_->file.string(), found));
  guarded(impl_->file, [&] { require_tables(impl_->file, impl_->db); });
  // Opens the seal as well: a damaged snapshot is told before a resume has written anything.
  const auto point = checkpoint();
  // All rows first .. first + counted - 1 are there. Those behind them are not looked at: going on
  // drops them.
  const auto require = [&](const char* table, std::int64_t first, std::int64_t counted) {
    reading(impl_->file, table, [&] {
      // Counting between two row numbers finds holes that max(rowid) would not.
      SQLite::Statement get(impl_->db,
                            fmt::format("SELECT count(*) FROM {} WHERE rowid BETWEEN ? AND ?", table));
      get.bind(1, first);
      get.bind(2, first + counted - 1);
      get.executeStep();
      if (get.getColumn(0).getInt64() != counted)
        throw BadInput("rows are missing that the checkpoint counts");
      return 0;
    });
  };
  require("frame", 1, point ? point->frames : 0);
  // Events are numbered from 0, by their own key; the others by SQLite, from 1.
  require("event", 0, point ? point->events : 0);
  require("contact", 1, point ? point->contacts : 0);
  require("knot", 1, point ? point->knots : 0);
}

std::pair<double, double> RunFile::time_range() const {
  return reading(impl_->file, "frame", [&] {
    // Two rows are read for it. Whether the frames between are in order is told by who reads them,
    // each_frame().
    const std::pair range(impl_->frame_time(0), impl_->frame_time(impl_->some_frames() - 1));
    if (range.first > range.second) throw BadInput("frames are not in the order of time");
    return range;
  });
}

std::int64_t RunFile::frame_count() const {
  return reading(impl_->file, "frame", [&] { return impl_->frames(); });
}

void RunFile::each_frame(std::int64_t stride, const std::function<void(const Frame&)>& f) const {
  reading(impl_->file, "frame", [&] {
    const std::int64_t frames = impl_->some_frames(), bodies = impl_->bodies;
    // One statement for all frames: it steps on from row to row, where one a frame would search each time.
    SQLite::Statement get(
        impl_->db, "SELECT t, x, y, angle, vx, vy, omega, body FROM frame WHERE rowid <= ? ORDER BY rowid");
    get.bind(1, frames * bodies);
    Frame frame;
    double before = -std::numeric_limits<double>::infinity();
    for (std::int64_t k = 0; k < frames; ++k) {
      impl_->next_frame(get, k, frame);
      if (!(frame.t >= before)) throw BadInput("frames are not in the order of time");
      before = frame.t;
      // Also those that the stride leaves out have been read and checked.
      if (k % stride == 0 || k + 1 == frames) f(frame);
    }
    return 0;
  });
}

RunFile::Frame RunFile::frame_at(double t) const {
  return reading(impl_->file, "frame", [&] { return impl_->read_frame(impl_->frame_index(t)); });
}

RunFile::Frame RunFile::states_at(double t) const {
  return reading(impl_->file, "frame", [&] {
    const std::int64_t index = impl_->frame_index(t);
    Frame a = impl_->read_frame(index);
    // Before the first frame, at a frame's own time, and after the last one there is nothing to go
    // between.
    if (t <= a.t || index + 1 >= impl_->frames()) return a;
    const Frame b = impl_->read_frame(index + 1);
    if (!(b.t > a.t)) throw BadInput("frames are not in the order of time");
    // What is known of each body before and after t: first the frames around it, then its own
    // collisions and knots between.
    std::vector<KnownState> left, right;
    std::vector<bool> met(a.states.size(), false);  // after t
    for (const BodyState& s : a.states) left.push_back({a.t, s});
    for (const BodyState& s : b.states) right.push_back({b.t, s});
    impl_->each_side_between(a.t, b.t, [&](double when, int body, const EventSide& side) {
      // The last of before t, and the first of after it: with its twist as it came.
      if (when <= t)
        left[body] = {when, side.after};
      else if (!met[body])
        right[body] = {when, {side.after.pose, side.before}};
      if (when > t) met[body] = true;
    });
    for (std::size_t k = 0; k < a.states.size(); ++k) a.states[k] = between(left[k], right[k], t);
    a.t = t;
    return a;
  });
}

}  // namespace brink
