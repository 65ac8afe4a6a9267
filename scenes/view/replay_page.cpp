/// A page is made of texts of Brink's own (page_assets.h) and of two of the run:
///
///     about      JSON: what there is (bodies, sites, shapes, springs), names of columns and kinds, facts
///     numbers    columns (PageNumbers): times, states, events, contacts, the trace, curves
///
/// A column holds one number of every row, as of every frame and body; about["arrays"] says in which order
/// they follow each other, and motion.js takes them apart. What is thinned or cut off is said in a notice
/// at the page's top. A live page asks for both again as the run goes on, and gets them whole.
#include "brink/scenes/view/replay_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "brink/core/base/error.h"
#include "brink/scenes/draw/color.h"
#include "brink/scenes/draw/draw.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_moment.h"
#include "brink/scenes/run_file/shape_json.h"
#include "brink/scenes/run_file/trace_file.h"
#include "brink/scenes/version.h"
#include "brink/scenes/view/interpolation_error.h"
#include "brink/scenes/view/page_assets.h"
#include "brink/scenes/view/page_numbers.h"
#include "brink/scenes/view/run_curves.h"
#include "brink/scenes/view/site_track.h"
#include "brink/scheduler/kernel/site_motion.h"

namespace brink {
namespace {

using Json = nlohmann::ordered_json;
using Column = std::vector<double>;

/// The page knows kinds by their place in this list.
/// The page gets their names in this order, too (about["kinds"]), and knows no others.
constexpr EventKind kKinds[] = {
    EventKind::collision, EventKind::zeno, EventKind::group, EventKind::undecided, EventKind::persist,
    EventKind::sleep,     EventKind::wake, EventKind::stick, EventKind::slip,      EventKind::lift};

/// "#rrggbb", as CSS and canvases take it.
std::string hex(const draw::Color& c) { return fmt::format("#{:06x}", c.argb() & 0xffffff); }
/// Red, green and blue 0..1, as WebGL takes them.
Json shares(const draw::Color& c) { return Json::array({c.red, c.green, c.blue}); }
Json xy(const Vec2& v) { return Json::array({v.x(), v.y()}); }

/// Columns of states, one after another: x, y, angle, vx, vy, omega.
/// Rows are frames times things, things within a frame by id: the page finds a state by frame * count + id.
class StateColumns {
 public:
  void add(const BodyState& s) {
    const double values[] = {s.pose.position.x(),  s.pose.position.y(),  s.pose.angle,
                             s.twist.velocity.x(), s.twist.velocity.y(), s.twist.omega};
    for (int c = 0; c < 6; ++c) columns_[c].push_back(values[c]);
  }
  const std::array<Column, 6>& columns() const { return columns_; }
  /// Names are those of COLUMNS in motion.js, behind a prefix.
  void put(PageNumbers& to, const std::string& prefix) const {
    const char* const names[] = {"x", "y", "angle", "vx", "vy", "omega"};
    for (int c = 0; c < 6; ++c) to.add(prefix + names[c], columns_[c]);
  }

 private:
  std::array<Column, 6> columns_;
};

/// One side of every event: a body, its place, its twist before and after; NaN where that is not known.
class SideColumns {
 public:
  void add(int id, const EventSide& side) {
    ids_.push_back(id);
    const Pose& p = side.after.pose;
    const Twist &b = side.before, &a = side.after.twist;
    const double values[] = {p.position.x(), p.position.y(), p.angle,        b.velocity.x(), b.velocity.y(),
                             b.omega,        a.velocity.x(), a.velocity.y(), a.omega};
    for (int c = 0; c < 9; ++c)
      columns_[c].push_back(side.known ? values[c] : std::numeric_limits<double>::quiet_NaN());
  }
  void put(PageNumbers& to, const std::string& who, const std::string& prefix) const {
    const char* const names[] = {"x", "y", "angle", "vx0", "vy0", "omega0", "vx", "vy", "omega"};
    to.add(who, ids_);
    for (int c = 0; c < 9; ++c) to.add(prefix + names[c], columns_[c]);
  }

 private:
  std::vector<std::int32_t> ids_;
  std::array<Column, 9> columns_;
};

/// The page in the making.
class ReplayPage {
 public:
  ReplayPage(const std::filesystem::path& file, const ReplayLimits& limits)
      : run_(file), limits_(limits), world_(run_.world()), palette_(world_), curves_(world_, run_) {
    run_.hold();  // frames and events fit together, though the run goes on
  }

  /// @pre gathered.
  /// The whole page as HTML.
  std::string page() const { return filled(); }
  /// What a live page asks for. Names that are no UTF-8 are mended, not refused: a run must be seen.
  std::string data() const {
    return Json{{"about", about_}, {"numbers", numbers_.text(live_)}}.dump(-1, ' ', false,
                                                                           Json::error_handler_t::replace);
  }

  /// Reads the run file and fills `about` and the numbers. Frames come before events: a curve counts
  /// collisions between frames that it has (RunCurves).
  void gather(bool live) {
    live_ = live;
    about_["live"] = live;
    frames();
    moving_sites();
    contacts();
    knots();
    events();
    if (!limits_.trace.empty()) trace();
    curves_.put(numbers_, about_);
    things();
    facts();
    about_["arrays"] = numbers_.arrays();
  }

 private:
  // -- numbers --

  /// Times and states of frames, and what the curves take from each frame.
  void frames() {
    const auto bodies = static_cast<std::int64_t>(world_.bodies.size());
    const std::int64_t count = run_.frame_count();
    // Rounded up: as few frames as the limit asks for, or fewer.
    const std::int64_t stride =
        std::max<std::int64_t>(1, (count * bodies + limits_.frame_rows - 1) / limits_.frame_rows);
    if (stride > 1) notices_.push_back(fmt::format("every {}. frame of {}", stride, count));
    Column& times = frame_times_;
    StateColumns& states = frame_states_;
    run_.each_frame(stride, [&](const RunFile::Frame& f) {
      times.push_back(f.t);
      for (const BodyState& s : f.states) states.add(s);
      // Frames that are thinned out are not in the curves either.
      curves_.add(f);
    });
    numbers_.add("frame_t", times);
    states.put(numbers_, "frame_");
  }

  /// Sites that move, by their motions as in the run, whatever frames there are. In the order of the sites, as the page takes them
  /// (motion.js): those of the k-th that moves are from site_first[k] on.
  void moving_sites() {
    std::vector<std::int32_t> first{0};
    Column times;
    StateColumns states;
    std::vector<const FixedSite*> moving;
    for (const FixedSite& site : world_.sites)
      if (SiteMotion(site).moves()) moving.push_back(&site);
    for (const FixedSite* site : moving) {
      if (!frame_times_.empty()) {
        const auto most =
            std::max<std::int64_t>(1000, limits_.knots / static_cast<std::int64_t>(moving.size()));
        const SiteTrack track = track_site(*site, frame_times_.front(), frame_times_.back(), most);
        for (std::size_t k = 0; k < track.times.size(); ++k)
          times.push_back(track.times[k]), states.add(track.states[k]);
        sites_off_ = std::max(sites_off_, track.off);
        if (!track.whole)
          notices_.push_back(fmt::format("motion of site {} up to {} s", site->name,
                                         track.times.empty() ? 0.0 : track.times.back()));
      }
      first.push_back(static_cast<std::int32_t>(times.size()));
    }
    numbers_.add("site_first", first);
    numbers_.add("site_t", times);
    states.put(numbers_, "site_");
  }

  /// Every event with both of its sides, in the file's order. Sides are what the page follows bodies by;
  /// place, normal and impulses are drawn.
  void events() {
    const std::int64_t count = run_.event_count(), limit = limits_.events;
    const std::int64_t first = live_ ? std::max<std::int64_t>(0, count - limit) : 0;
    const std::vector<Event> all = run_.events(first, limit);
    // Some are kept whole: there the page is exact, where with every second one it would be so nowhere. Of a run
    // that goes on they are those of now.
    if (count > limit && live_)
      notices_.push_back(
          fmt::format("the last {} events of {}: before them motions are interpolated", limit, count));
    else if (count > limit)
      notices_.push_back(
          fmt::format("the first {} events of {}: after them motions are interpolated", limit, count));
    about_["first_event"] = first;
    Column t, px, py, nx, ny, closing, along, across, gap;
    std::vector<std::int32_t> kind, site;
    SideColumns body, other;
    bool any_known = false, any_collision = false;
    // No cubic is held against a motion that has knots on the way.
    std::vector<Column> of_bodies = std::move(knot_times_);
    for (const Event& e : all) {
      const Contact& c = e.contact;
      t.push_back(c.time);
      kind.push_back(
          static_cast<std::int32_t>(std::find(std::begin(kKinds), std::end(kKinds), e.kind) - kKinds));
      body.add(c.body, e.body);
      other.add(c.other_body, e.other);
      site.push_back(c.other_site);
      // Files of before have events without states: then the cubic spans whole frames, across collisions.
      any_known = any_known || e.body.known;
      for (const int id : {c.body, c.other_body})
        if (id >= 0) of_bodies[id].push_back(c.time);
      any_collision = any_collision || e.kind == EventKind::collision;
      // In the world, not moved home: the page moves what it draws.
      px.push_back(c.point.x()), py.push_back(c.point.y());
      nx.push_back(c.normal.x()), ny.push_back(c.normal.y());
      closing.push_back(c.closing_speed), gap.push_back(c.gap);
      along.push_back(e.impulse_n), across.push_back(e.impulse_t);
      curves_.add(e);
    }
    for (Column& times : of_bodies) std::sort(times.begin(), times.end());
    const bool bends = lasting_ && !has_knots_;
    off_ = interpolation_error(world_, frame_times_, frame_states_.columns(), of_bodies, bends);
    // A run file of before the states at collisions.
    if (any_collision && !any_known) notices_.push_back("between frames motions are interpolated");
    unknown_ = run_.unknown_between_frames();
    if (!unknown_.empty()) notices_.push_back(unknown_);
    numbers_.add("event_t", t);
    numbers_.add("event_kind", kind);
    body.put(numbers_, "event_body", "b_");
    other.put(numbers_, "event_other", "o_");
    numbers_.add("event_site", site);
    for (const auto& [name, column] : {std::pair("px", &px),
                                       {"py", &py},
                                       {"nx", &nx},
                                       {"ny", &ny},
                                       {"closing", &closing},
                                       {"in", &along},
                                       {"it", &across},
                                       {"gap", &gap}})
      numbers_.add(std::string("event_") + name, *column);
  }

  /// How bodies move in islands, in the file's order. A twist before that is the twist after the body's knot before is NaN:
  /// the page knows it, and equal numbers pack well.
  void knots() {
    const std::int64_t count = run_.knot_count(), limit = limits_.knots;
    const std::int64_t first = live_ ? std::max<std::int64_t>(0, count - limit) : 0;
    const std::vector<TimedKnot> all = run_.knots(first, limit);
    const auto cut = run_.knots_end();
    has_knots_ = !all.empty() && count <= limit && !cut;
    if (count > limit)
      notices_.push_back(
          fmt::format("the {} {} states within islands of {}: {} them motions are interpolated",
                      live_ ? "last" : "first", limit, count, live_ ? "before" : "after"));
    else if (cut)
      notices_.push_back(
          fmt::format("states within islands up to {} s: after it motions are interpolated", *cut));
    knot_times_.resize(world_.bodies.size());
    Column t;
    std::vector<std::int32_t> body, events;
    std::array<Column, 9> columns;
    std::vector<const TimedKnot*> last(world_.bodies.size(), nullptr);
    for (const TimedKnot& k : all) {
      t.push_back(k.time), body.push_back(k.body), events.push_back(static_cast<std::int32_t>(k.events));
      knot_times_[k.body].push_back(k.time);
      const TimedKnot* before = std::exchange(last[k.body], &k);
      const auto known = [before](double is, double was) {
        return before && is == was ? std::numeric_limits<double>::quiet_NaN() : is;
      };
      const Twist was = before ? before->after : Twist{};
      const double values[] = {k.pose.position.x(),
                               k.pose.position.y(),
                               k.pose.angle,
                               known(k.before.velocity.x(), was.velocity.x()),
                               known(k.before.velocity.y(), was.velocity.y()),
                               known(k.before.omega, was.omega),
                               k.after.velocity.x(),
                               k.after.velocity.y(),
                               k.after.omega};
      for (int c = 0; c < 9; ++c) columns[c].push_back(values[c]);
    }
    numbers_.add("knot_t", t);
    numbers_.add("knot_body", body);
    numbers_.add("knot_events", events);
    const char* const names[] = {"x", "y", "angle", "vx0", "vy0", "omega0", "vx", "vy", "omega"};
    for (int c = 0; c < 9; ++c) numbers_.add(std::string("knot_") + names[c], columns[c]);
  }

  /// Contacts that lasted, a row for each stretch with its force [N].
  void contacts() {
    Column from, to, x, y, force;
    std::vector<std::int32_t> body, other;
    for (const LastedContact& c : run_.contacts()) {
      lasting_ = true;
      from.push_back(c.from), to.push_back(c.to);
      x.push_back(c.point.x()), y.push_back(c.point.y());
      force.push_back(c.normal_force);
      body.push_back(c.body), other.push_back(c.other_body);
    }
    numbers_.add("contact_from", from);
    numbers_.add("contact_to", to);
    numbers_.add("contact_body", body);
    numbers_.add("contact_other", other);
    numbers_.add("contact_x", x);
    numbers_.add("contact_y", y);
    numbers_.add("contact_force", force);
  }

  /// What the scheduler did; collisions are events.
  void trace() {
    std::vector<TraceMark> marks = read_trace(limits_.trace, static_cast<int>(world_.bodies.size()));
    // Before the limit is looked at: collisions shall not use it up.
    std::erase_if(marks, [](const TraceMark& m) { return m.kind == TraceKind::collision; });
    const auto limit = static_cast<std::size_t>(limits_.marks);
    if (marks.size() > limit) {
      notices_.push_back(fmt::format("the first {} marks of {} in the trace", limit, marks.size()));
      marks.resize(limit);
    }
    Column from, to;
    std::vector<std::int32_t> body, kind;
    for (const TraceMark& m : marks) {
      body.push_back(m.body);
      kind.push_back(static_cast<std::int32_t>(m.kind));
      from.push_back(m.from), to.push_back(m.to);
    }
    numbers_.add("trace_body", body);
    numbers_.add("trace_kind", kind);
    numbers_.add("trace_from", from);
    numbers_.add("trace_to", to);
    about_["trace_kinds"] = Json::array();
    for (int k = 0; k <= static_cast<int>(TraceKind::collision); ++k)
      about_["trace_kinds"].push_back(to_string(static_cast<TraceKind>(k)));
  }

  // -- what they are of --

  // Equal outlines are one shape of the page: copies tell theirs by a number.
  // Compared as JSON, which is what the page gets.
  int shape(const Outline& outline) {
    const std::string json = outline_to_json(outline);
    const auto [found, made] = shapes_.emplace(json, static_cast<int>(shapes_.size()));
    if (made) about_["shapes"].push_back(Json::parse(json));
    return found->second;
  }

  /// Bodies, sites and springs with their looks: the colours of `brink draw`, made here by the same
  /// palette.
  void things() {
    about_["shapes"] = about_["bodies"] = about_["sites"] = about_["springs"] = Json::array();
    for (std::size_t k = 0; k < world_.bodies.size(); ++k) {
      const draw::Oklch color = palette_.body(k);
      about_["bodies"].push_back({{"name", world_.bodies[k].name},
                                  {"mass", world_.bodies[k].mass},
                                  {"shape", shape(*world_.bodies[k].outline)},
                                  {"fill", hex(color.rgb())},
                                  {"line", hex(draw::Palette::line(color).rgb())},
                                  {"cell", shares(draw::Palette::cell(color).rgb())}});
    }
    for (const FixedSite& site : world_.sites)
      about_["sites"].push_back({{"name", site.name},
                                 {"shape", shape(*site.outline)},
                                 {"moving", SiteMotion(site).moves()},
                                 {"fill", hex(draw::Tones::site_fill.rgb())},
                                 {"line", hex(draw::Tones::ink.rgb())},
                                 {"cell", shares(draw::Tones::site_cell.rgb())}});
    for (const RunFile::Spring& s : run_.springs())
      about_["springs"].push_back({{"body", s.body},
                                   {"other", s.other < 0 ? Json() : Json(s.other)},
                                   {"at", xy(s.at)},
                                   {"other_at", xy(s.other_at)}});
  }

  /// What the page says of the run in words: title, ending, extent, the run file's meta, summary, options,
  /// work.
  void facts() {
    const auto meta = run_.meta();
    // Files of before lack some keys: these facts are left out.
    const auto of = [&](const char* key) { return meta.contains(key) ? meta.at(key) : std::string(); };
    // An extent of 0 has no scale.
    const Box extent = extent_of(run_, world_);
    const Vec2 size = (extent.high - extent.low).cwiseMax(1e-15);
    about_["title"] = world_.title.empty() ? of("scene") : world_.title;
    // meta's end_time is that of the last checkpoint while the run goes on; the last frame is later.
    const bool running = of("termination") == "running";
    about_["termination"] = fmt::format("{} at {} s", of("termination"),
                                        running ? fmt::format("{}", curves_.end()) : of("end_time"));
    about_["periods"] = xy(world_.periods.size);
    about_["gravity"] = xy(curves_.gravity());
    about_["extent"] = {extent.low.x(), extent.low.y(), extent.low.x() + size.x(), extent.low.y() + size.y()};
    about_["kinds"] = Json::array();
    for (const EventKind kind : kKinds) about_["kinds"].push_back(to_string(kind));
    about_["notice"] = fmt::format("{}", fmt::join(notices_, "; "));
    about_["facts"] = Json::array();
    // In the order in which they are shown.
    const auto fact = [&](const std::string& name, const std::string& value) {
      if (!value.empty()) about_["facts"].push_back({name, value});
    };
    for (const char* key :
         {"scene", "brink_version", "termination", "end_time", "wall_seconds", "state_hash"})
      fact(key, of(key));
    if (frame_times_.size() > 2 && unknown_.empty())
      fact("between frames", fmt::format("places to about {:.1g} m", off_));
    if (sites_off_ > 0.0) fact("sites that move", fmt::format("places to about {:.1g} m", sites_off_));
    // Without exceptions: a run that goes on has no summary yet, and an empty text is no JSON.
    const Json summary = Json::parse(of("summary"), nullptr, false),
               options = Json::parse(of("options"), nullptr, false);
    // Numbers of the summary that meta tells, too, are shown once.
    if (summary.is_object())
      for (const auto& [name, value] : summary.items())
        if (!value.is_object() && !meta.contains(name))
          fact(name, value.is_string() ? value.get<std::string>() : value.dump());
    if (options.is_object() && options.contains("solver"))
      for (const auto& [name, value] : options["solver"].items())
        fact("solver." + name, value.is_string() ? value.get<std::string>() : value.dump());
    if (summary.is_object() && summary.contains("work"))
      for (const auto& [name, value] : summary["work"].items()) fact("work." + name, value.dump());
  }

  // -- the page --

  /// The page's marks filled in. Each stands once in page.html.
  std::string filled() const {
    // "</script>" in a name would end the page's data; JSON reads \u003c as the same character.
    std::string about = about_.dump(-1, ' ', false, Json::error_handler_t::replace);
    for (std::size_t at = 0; (at = about.find('<', at)) != std::string::npos;)
      about.replace(at, 1, "\\u003c");
    std::string page(page::html());
    // The data come last: nothing in a run can look like a mark that is still to be filled.
    const auto put = [&page](std::string_view mark, std::string_view text) {
      page.replace(page.find(mark), mark.size(), text);
    };
    put("<!--TITLE-->", "Brink");  // the script sets the run's
    put("<!--STYLE-->", std::string(page::chart_style()) + std::string(page::style()));
    put("<!--CHARTS-->",
        page::chart_script().empty() ? "" : fmt::format("<script>{}</script>", page::chart_script()));
    put("<!--SCRIPT-->", page::script());
    put("<!--ABOUT-->", about);
    put("<!--NUMBERS-->", numbers_.text(live_));
    return page;
  }

  RunFile run_;
  ReplayLimits limits_;
  World world_;
  draw::Palette palette_;
  RunCurves curves_;
  Column frame_times_;
  StateColumns frame_states_;
  std::vector<Column> knot_times_;       ///< of every body
  bool live_ = false, lasting_ = false;  ///< lasting_: there are contacts that last
  bool has_knots_ = false;               ///< all of them
  std::string unknown_;                  ///< of motions between frames
  double off_ = 0.0;                     ///< what motions between frames are off by, about [m]
  double sites_off_ = 0.0;               ///< and those of sites that move [m]
  PageNumbers numbers_;
  Json about_;
  std::map<std::string, int> shapes_;
  std::vector<std::string> notices_;
};

}  // namespace

namespace {

/// What `of` says of the page; whatever is wrong in the run file is an IoError that names it.
template <class Of>
std::string gathered(const std::filesystem::path& run_file, const ReplayLimits& limits, bool live, Of&& of) {
  try {
    ReplayPage page(run_file, limits);
    page.gather(live);
    return of(page);
  } catch (const Json::exception& e) {
    throw IoError(fmt::format("{}: table meta: {}", run_file.string(), e.what()));
  } catch (const BadInput& e) {
    throw IoError(fmt::format("{}: cannot be shown: {}", run_file.string(), e.what()));
  }
}

}  // namespace

std::string replay_page_text(const std::filesystem::path& run_file, const ReplayLimits& limits, bool live) {
  return gathered(run_file, limits, live, [](const ReplayPage& page) { return page.page(); });
}

std::string replay_page_data(const std::filesystem::path& run_file, const ReplayLimits& limits, bool live) {
  return gathered(run_file, limits, live, [](const ReplayPage& page) { return page.data(); });
}

void write_replay_page(const std::filesystem::path& run_file, const std::filesystem::path& page,
                       const ReplayLimits& limits) {
  // Made whole before the file is opened: a run that cannot be read leaves a page of before as it is.
  const std::string text = replay_page_text(run_file, limits, false);
  std::ofstream out(page, std::ios::binary);
  out << text << std::flush;
  if (!out) throw_not_written(page);
}

}  // namespace brink
