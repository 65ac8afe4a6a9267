#include "brink/core/world/straight_joints.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>

#include "brink/core/shapes/outline.h"

namespace brink {

namespace {

/// An end of a straight side, in the world; where the plane repeats, in the first period.
struct End {
  Vec2 place;
  int site;     ///< of the world
  int side;     ///< of its outline
  bool starts;  ///< the side begins here
};

/// A straight side where it stands.
Site in_world(Site side, const Frame& frame) {
  side.a = frame.to_world(side.a);
  side.b = frame.to_world(side.b);
  return side;
}

/// The way from a place to the first period [m].
Vec2 to_first_period(const Vec2& p, const Periods& periods) {
  Vec2 by = Vec2::Zero();
  for (int axis = 0; axis < 2; ++axis)
    if (const double size = periods.size[axis]; size > 0.0) by[axis] = -size * std::floor(p[axis] / size);
  return by;
}

/// Adds an end to the others; where the plane repeats, once more past the far edge if it lies at the near one.
void add_end(End end, const Periods& periods, double tolerance, std::vector<End>& ends) {
  end.place += to_first_period(end.place, periods);
  const std::size_t first = ends.size();
  ends.push_back(end);
  for (int axis = 0; axis < 2; ++axis)
    if (periods.size[axis] > 0.0 && end.place[axis] <= tolerance)
      for (std::size_t k = first, count = ends.size(); k < count; ++k) {
        End image = ends[k];
        image.place[axis] += periods.size[axis];
        ends.push_back(image);
      }
}

/// Ends that are near each other, pair by pair, of different sides.
template <class Visit>
void each_pair(std::vector<End>& ends, double tolerance, Visit&& visit) {
  // along a slanting line, on which the ends of rows and columns have places of their own
  const auto along = [](const End& e) { return 0.7548776662 * e.place.x() + 0.6558656180 * e.place.y(); };
  std::sort(ends.begin(), ends.end(), [&](const End& a, const End& b) { return along(a) < along(b); });
  for (std::size_t k = 0; k < ends.size(); ++k)
    for (std::size_t m = k + 1; m < ends.size() && along(ends[m]) - along(ends[k]) <= tolerance; ++m)
      if ((ends[m].site != ends[k].site || ends[m].starts != ends[k].starts) &&
          (ends[m].place - ends[k].place).norm() <= tolerance)
        visit(ends[k], ends[m]);
}

/// A side of a solid without thickness, on its line: the same for all that lie on it, whichever way they run.
struct Side {
  double angle, offset;  ///< of the line [rad], [m]
  double from, to;       ///< along it [m]
  bool forwards;
  int site, side;  ///< site < 0: an image of one, where the plane repeats
};

/// `origin`: near all sides, so that offsets of short ones are not rounded more than places are.
Side on_its_line(Site s, const Vec2& origin, int site, int side) {
  s.a -= origin;
  s.b -= origin;
  Vec2 along = (s.b - s.a).normalized();
  constexpr double kUpright = 1e-9;  // by roundings either way
  const bool forwards = along.x() > kUpright || (along.x() >= -kUpright && along.y() > 0.0);
  if (!forwards) along = -along;
  const double from = along.dot(s.a), to = along.dot(s.b);
  return {std::atan2(along.y(), along.x()),
          cross(along, s.a),
          std::min(from, to),
          std::max(from, to),
          forwards,
          site,
          side};
}

/// Runs of neighbours in order that differ by no more than `most` in what is asked of them.
template <class Value, class Visit>
void each_run(std::span<Side> sides, double most, Value&& value, Visit&& visit) {
  std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) { return value(a) < value(b); });
  for (std::size_t begin = 0, end; begin < sides.size(); begin = end) {
    for (end = begin + 1; end < sides.size() && value(sides[end]) - value(sides[end - 1]) <= most;) ++end;
    if (end - begin > 1) visit(sides.subspan(begin, end - begin));
  }
}

/// Adds a side to the others, and where the plane repeats its images beside it.
void add_side(const Site& side, const Vec2& origin, const Periods& periods, int s, int k,
              std::vector<Side>& sides) {
  sides.push_back(on_its_line(side, origin, s, k));
  for (int axis = 0; axis < 2; ++axis)
    for (const double by : {-periods.size[axis], periods.size[axis]})
      if (by != 0.0) sides.push_back(on_its_line(side, origin - by * Vec2::Unit(axis), -1, -1));
}

/// Sides of one line along all of which sides lie that run the other way.
template <class Visit>
void each_covered(std::span<Side> line, double tolerance, Visit&& visit) {
  for (const bool forwards : {false, true}) {
    std::vector<std::pair<double, double>> covers;  // apart from each other, in order
    std::vector<const Side*> in_order;
    for (const Side& s : line)
      if (s.forwards != forwards) in_order.push_back(&s);
    std::sort(in_order.begin(), in_order.end(),
              [](const Side* a, const Side* b) { return a->from < b->from; });
    for (const Side* s : in_order)
      if (!covers.empty() && s->from <= covers.back().second + tolerance)
        covers.back().second = std::max(covers.back().second, s->to);
      else
        covers.emplace_back(s->from, s->to);
    for (const Side& s : line) {
      if (s.forwards != forwards || s.site < 0) continue;
      auto after = std::upper_bound(covers.begin(), covers.end(), s.from + tolerance,
                                    [](double at, const auto& c) { return at < c.first; });
      if (after != covers.begin() && s.to <= std::prev(after)->second + tolerance) visit(s);
    }
  }
}

/// How a site moves, in words that are the same for all that move as one; those that turn do so about the same place. Nothing: of
/// what turns where the plane repeats, for its images turn about other places.
std::optional<std::string> motion_of(const FixedSite& site, const Periods& periods) {
  std::string how;
  bool turns = false;
  if (const auto* constant = std::get_if<ConstantMotion>(&site.motion)) {
    const Twist& t = constant->twist;
    how = fmt::format("{} {} {}", t.velocity.x(), t.velocity.y(), t.omega);
    turns = t.omega != 0.0;
  } else if (const auto* formulas = std::get_if<FormulaMotion>(&site.motion)) {
    for (const std::optional<Formula>* f : {&formulas->x, &formulas->y, &formulas->angle})
      how += (*f ? (*f)->text() : "") + "|";
    turns = formulas->angle.has_value();
  }
  if (!turns) return how;
  if (periods.any()) return std::nullopt;
  return how + fmt::format(" about {} {}", site.pose.position.x(), site.pose.position.y());
}

/// Sites that keep their places against each other.
std::vector<std::vector<int>> that_move_as_one(const World& world) {
  std::map<std::string, std::vector<int>> groups;
  for (int s = 0; s < static_cast<int>(world.sites.size()); ++s)
    if (const auto how = motion_of(world.sites[s], world.periods)) groups[*how].push_back(s);
  std::vector<std::vector<int>> all;
  for (auto& [how, sites] : groups) all.push_back(std::move(sites));
  return all;
}

/// Notes joints and covered sides among some of the sites, in outlines of their own.
void note_joints(const World& world, const std::vector<int>& among, double tolerance,
                 std::map<int, Outline>& joined) {
  std::vector<End> ends;
  std::vector<Side> sides;
  for (const int s : among) {
    const FixedSite& site = world.sites[s];
    const Frame frame(site.pose);
    for (int k = 0; k < static_cast<int>(site.outline->sites.size()); ++k) {
      if (site.outline->sites[k].kind != SiteKind::segment) continue;
      const Site side = in_world(site.outline->sites[k], frame);
      add_end({side.a, s, k, true}, world.periods, tolerance, ends);
      add_end({side.b, s, k, false}, world.periods, tolerance, ends);
      if (side.solid && side.radius == 0.0)
        add_side(side, world.sites[among.front()].pose.position, world.periods, s, k, sides);
    }
  }
  const auto outline_of = [&](int site) -> Outline& {
    return joined.try_emplace(site, *world.sites[site].outline).first->second;
  };
  const auto note = [&](const End& end) {
    Outline& outline = outline_of(end.site);
    Site& side = outline.sites[end.side];
    (end.starts ? side.straight_a : side.straight_b) = true;
    for (Sample& sample : outline.samples)
      if (sample.arc_site < 0 && sample.p == (end.starts ? side.a : side.b)) sample.hollow = true;
  };
  const auto side_of = [&](const End& end) {
    const FixedSite& site = world.sites[end.site];
    return in_world(site.outline->sites[end.side], Frame(site.pose));
  };
  each_pair(ends, tolerance, [&](const End& a, const End& b) {
    if (a.site == b.site && !world.periods.any()) return;  // the outline knows its own joints
    Site in = side_of(a), out = side_of(b);
    if (in.solid != out.solid) return;
    // Sides of solids have their inside to the left, so the one goes on where the other ends. Of a wire they may run either way.
    if (in.solid && a.starts == b.starts) return;
    if (a.starts) std::swap(in.a, in.b);
    if (!b.starts) std::swap(out.a, out.b);
    if (!go_on_straight(in, out)) return;
    note(a);
    note(b);
  });
  constexpr double kOneDirection = 1e-10;
  each_run(
      sides, kOneDirection, [](const Side& s) { return s.angle; },
      [&](std::span<Side> parallel) {
        each_run(
            parallel, tolerance, [](const Side& s) { return s.offset; },
            [&](std::span<Side> line) {
              each_covered(line, tolerance,
                           [&](const Side& s) { outline_of(s.site).sites[s.side].covered = true; });
            });
      });
}

}  // namespace

std::vector<std::shared_ptr<const Outline>> with_straight_joints(const World& world, double tolerance) {
  std::map<int, Outline> joined;
  for (const std::vector<int>& sites : that_move_as_one(world)) note_joints(world, sites, tolerance, joined);
  std::vector<std::shared_ptr<const Outline>> outlines;
  for (const FixedSite& site : world.sites) outlines.push_back(site.outline);
  for (auto& [site, outline] : joined) outlines[site] = std::make_shared<const Outline>(std::move(outline));
  return outlines;
}

}  // namespace brink
