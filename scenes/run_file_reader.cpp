#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <tuple>

#include "brink/core/base/error.h"
#include "brink/scenes/run_file.h"
#include "brink/scenes/run_file_guard.h"
#include "brink/scenes/shape_json.h"
#include "brink/scenes/version.h"
#include "brink/scenes/world_hash.h"

namespace brink {
namespace fs = std::filesystem;
namespace {

constexpr int kBusyMilliseconds = 10'000;

/// "solver.order was "index", is now "depth"" for every option that differs.
std::string differences(const std::string& was, const std::string& is) {
  const auto a = nlohmann::json::parse(was, nullptr, false), b = nlohmann::json::parse(is, nullptr, false);
  if (a.is_discarded() || b.is_discarded()) return "the options differ";
  const auto old_values = a.flatten(), new_values = b.flatten();
  std::string text;
  const auto value = [](const nlohmann::json& j, const std::string& key) {
    return j.contains(key) ? j.at(key).dump() : std::string("absent");
  };
  auto all = old_values;
  all.update(new_values);
  for (const auto& [key, unused] : all.items()) {
    const std::string before = value(old_values, key), now = value(new_values, key);
    if (before != now)
      text += fmt::format("{}{} was {}, is now {}", text.empty() ? "" : "; ", key, before, now);
  }
  return text.empty() ? "the options differ" : text;
}

int id_or_none(const SQLite::Column& column) { return column.isNull() ? -1 : column.getInt(); }

EventKind kind_from(const std::string& word, const fs::path& file) {
  for (int k = 0; k <= static_cast<int>(EventKind::undecided); ++k) {
    if (word == to_string(static_cast<EventKind>(k))) return static_cast<EventKind>(k);
  }
  throw IoError(fmt::format("{}: event of unknown kind '{}'", file.string(), word));
}

/// Value and slope at time t of the cubic through (0, a, va) and (h, b, vb), s = t / h.
std::pair<double, double> hermite(double a, double va, double b, double vb, double h, double s) {
  const double d = (b - a) / h;
  const double c2 = (3 * d - 2 * va - vb) / h, c3 = (va + vb - 2 * d) / (h * h), t = s * h;
  return {a + t * (va + t * (c2 + t * c3)), va + t * (2 * c2 + 3 * t * c3)};
}

BodyState between(const BodyState& a, const BodyState& b, double h, double s) {
  BodyState m;
  for (int i = 0; i < 2; ++i) {
    std::tie(m.pose.position[i], m.twist.velocity[i]) =
        hermite(a.pose.position[i], a.twist.velocity[i], b.pose.position[i], b.twist.velocity[i], h, s);
  }
  std::tie(m.pose.angle, m.twist.omega) =
      hermite(a.pose.angle, a.twist.omega, b.pose.angle, b.twist.omega, h, s);
  return m;
}

}  // namespace

struct RunFile::Impl {
  fs::path file;
  mutable SQLite::Database db;
  std::int64_t bodies = 0;

  explicit Impl(const fs::path& f) : file(f), db(f, SQLite::OPEN_READONLY, kBusyMilliseconds) {
    if (!db.tableExists("meta") || !db.tableExists("frame")) {
      throw IoError(fmt::format("{}: a database, but not a run file", f.string()));
    }
    bodies = db.execAndGet("SELECT count(*) FROM body").getInt64();
  }

  /// Whole frames in the file. Rows are numbered from 1 without holes, `bodies` rows a frame.
  std::int64_t frames() const {
    const std::int64_t rows = db.execAndGet("SELECT ifnull(max(rowid), 0) FROM frame").getInt64();
    return bodies > 0 ? rows / bodies : 0;
  }
  double frame_time(std::int64_t index) const {
    SQLite::Statement get(db, "SELECT t FROM frame WHERE rowid = ?");
    get.bind(1, index * bodies + 1);
    if (!get.executeStep()) throw IoError(fmt::format("{}: frame {} is missing", file.string(), index));
    return get.getColumn(0).getDouble();
  }
  /// The last frame at or before t, or 0.
  std::int64_t frame_index(double t) const {
    std::int64_t low = 0, high = frames();
    if (high == 0) throw BadInput(fmt::format("{}: the run file holds no frame yet", file.string()));
    while (high - low > 1) {
      const std::int64_t middle = low + (high - low) / 2;
      (frame_time(middle) <= t ? low : high) = middle;
    }
    return low;
  }
  Frame read_frame(std::int64_t index) const {
    Frame frame;
    SQLite::Statement get(
        db, "SELECT t, x, y, angle, vx, vy, omega FROM frame WHERE rowid > ? AND rowid <= ? ORDER BY rowid");
    get.bind(1, index * bodies);
    get.bind(2, (index + 1) * bodies);
    while (get.executeStep()) {
      const auto real = [&get](int column) { return get.getColumn(column).getDouble(); };
      frame.t = real(0);
      frame.states.push_back({{{real(1), real(2)}, real(3)}, {{real(4), real(5)}, real(6)}});
    }
    return frame;
  }
};

bool is_run_file(const fs::path& file) {
  if (!fs::exists(file)) return false;
  return guarded(file, [&] {
    return SQLite::Database(file, SQLite::OPEN_READONLY, kBusyMilliseconds).tableExists("meta");
  });
}

RunFile::RunFile(const fs::path& file) : impl_(guarded(file, [&] { return std::make_unique<Impl>(file); })) {
  const std::string schema = meta("schema_version").value_or("");
  if (schema != std::to_string(kRunFileSchema)) {
    throw IoError(
        fmt::format("{}: schema_version '{}'; this program reads {}", file.string(), schema, kRunFileSchema));
  }
}
RunFile::~RunFile() = default;
RunFile::RunFile(RunFile&&) noexcept = default;

std::map<std::string, std::string> RunFile::meta() const {
  return guarded(impl_->file, [&] {
    std::map<std::string, std::string> all;
    SQLite::Statement get(impl_->db, "SELECT key, value FROM meta");
    while (get.executeStep()) all[get.getColumn(0).getString()] = get.getColumn(1).getString();
    return all;
  });
}

std::optional<std::string> RunFile::meta(const std::string& key) const {
  const auto all = meta();
  const auto found = all.find(key);
  return found == all.end() ? std::nullopt : std::optional(found->second);
}

std::vector<RunFile::BodyRow> RunFile::bodies() const {
  return guarded(impl_->file, [&] {
    std::vector<BodyRow> rows;
    SQLite::Statement get(impl_->db, "SELECT id, name, mass, inertia, shape FROM body ORDER BY id");
    while (get.executeStep()) {
      rows.push_back({get.getColumn(0).getInt(), get.getColumn(1).getString(), get.getColumn(2).getDouble(),
                      get.getColumn(3).getDouble(), outline_from_json(get.getColumn(4).getString())});
    }
    return rows;
  });
}

std::vector<FixedSite> RunFile::sites() const {
  return guarded(impl_->file, [&] {
    std::vector<FixedSite> sites;
    SQLite::Statement get(impl_->db, "SELECT name, kind, shape FROM site ORDER BY id");
    while (get.executeStep()) {
      FixedSite& site = sites.emplace_back(fixed_site_from_json(get.getColumn(2).getString()));
      site.name = get.getColumn(0).getString();
      site.kind = get.getColumn(1).getString();
    }
    return sites;
  });
}

World RunFile::world() const {
  World world;
  world.title = meta("title").value_or("");
  const Frame first = frame_at(0.0);
  for (const BodyRow& row : bodies()) {
    Body& body = world.bodies.emplace_back();
    body.name = row.name;
    body.mass = row.mass;
    body.inertia = row.inertia;
    body.outline = std::make_shared<const Outline>(row.outline);
    body.initial = first.states.at(row.id);
  }
  world.sites = sites();
  const auto options = nlohmann::json::parse(meta("options").value_or("{}"), nullptr, false);
  const nlohmann::json::json_pointer periodic("/world/periodic");
  if (options.is_object() && options.contains(periodic))
    world.periods.size = {options.at(periodic).at(0).get<double>(), options.at(periodic).at(1).get<double>()};
  return world;
}

std::vector<Event> RunFile::events() const {
  return guarded(impl_->file, [&] {
    std::vector<Event> all;
    SQLite::Statement get(
        impl_->db,
        "SELECT seq, t, kind, body, other, site, px, py, nx, ny, closing_speed, impulse_n, impulse_t, "
        "gap, outline_site, sample, sample_on_body, t_low FROM event ORDER BY seq");
    while (get.executeStep()) {
      const auto real = [&get](int column) { return get.getColumn(column).getDouble(); };
      Event e;
      e.seq = static_cast<std::uint64_t>(get.getColumn(0).getInt64());
      e.kind = kind_from(get.getColumn(2).getString(), impl_->file);
      e.contact = {real(1),
                   real(17),
                   id_or_none(get.getColumn(3)),
                   id_or_none(get.getColumn(4)),
                   id_or_none(get.getColumn(5)),
                   id_or_none(get.getColumn(14)),
                   id_or_none(get.getColumn(15)),
                   get.getColumn(16).getInt() != 0,
                   {real(6), real(7)},
                   {real(8), real(9)},
                   real(10),
                   real(13)};
      e.impulse_n = real(11);
      e.impulse_t = real(12);
      all.push_back(e);
    }
    return all;
  });
}

std::optional<ResumePoint> RunFile::checkpoint() const {
  return guarded(impl_->file, [&]() -> std::optional<ResumePoint> {
    SQLite::Statement get(impl_->db, "SELECT t, state, frames, events, wall_seconds FROM checkpoint");
    if (!get.executeStep()) return std::nullopt;
    const auto blob = get.getColumn(1);
    const auto* bytes = static_cast<const std::byte*>(blob.getBlob());
    return ResumePoint{get.getColumn(0).getDouble(),
                       {bytes, bytes + blob.getBytes()},
                       get.getColumn(4).getDouble(),
                       get.getColumn(2).getInt64(),
                       get.getColumn(3).getInt64()};
  });
}

void RunFile::require_same(const Scene& scene) const {
  const std::string name = impl_->file.string();
  if (const std::string was = meta("brink_version").value_or(""); was != version()) {
    throw BadInput(
        fmt::format("{}: written by brink {}, this is {}: the bits could differ", name, was, version()));
  }
  if (const std::string was = meta("options").value_or(""); was != scene.options_json) {
    throw BadInput(fmt::format("{}: --resume needs the options it was started with: {}", name,
                               differences(was, scene.options_json)));
  }
  const std::string was = meta("world_hash").value_or(""),
                    is = fmt::format("{:016x}", world_hash(scene.world));
  if (was != is) {
    throw BadInput(
        fmt::format("{}: --resume needs the scene it was started with: bodies, sites, materials or forces of "
                    "{} differ (hash was {}, is now {})",
                    name, scene.path.string(), was, is));
  }
}

std::pair<double, double> RunFile::time_range() const {
  return guarded(impl_->file, [&] {
    const std::int64_t count = impl_->frames();
    if (count == 0) throw BadInput(fmt::format("{}: the run file holds no frame yet", impl_->file.string()));
    return std::pair(impl_->frame_time(0), impl_->frame_time(count - 1));
  });
}

RunFile::Frame RunFile::frame_at(double t) const {
  return guarded(impl_->file, [&] { return impl_->read_frame(impl_->frame_index(t)); });
}

RunFile::Frame RunFile::states_at(double t) const {
  return guarded(impl_->file, [&] {
    const std::int64_t index = impl_->frame_index(t);
    Frame a = impl_->read_frame(index);
    if (t <= a.t || index + 1 >= impl_->frames()) return a;
    const Frame b = impl_->read_frame(index + 1);
    const double h = b.t - a.t, s = (t - a.t) / h;
    for (std::size_t k = 0; k < a.states.size(); ++k) a.states[k] = between(a.states[k], b.states[k], h, s);
    a.t = t;
    return a;
  });
}

}  // namespace brink
