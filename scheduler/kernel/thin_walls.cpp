#include "brink/scheduler/kernel/thin_walls.h"

#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "brink/scheduler/kernel/tolerances.h"

namespace brink {

namespace {

using Point = boost::geometry::model::d2::point_xy<double>;
using BoxOfPoints = boost::geometry::model::box<Point>;

/// A wire's segment or arc in the world, the fixed site that it is of, and a box that holds it.
struct Wall {
  Site core;
  int site;
  Box box;

  Wall(const Site& placed, int of) : core(placed), site(of) {
    box.add(core.a);
    box.add(core.b);
    if (!is_arc()) return;
    // where the tangents at its ends meet: an arc of a quarter turn at most lies in that triangle
    const Vec2 chord = to_chord();
    box.add(core.center + chord * (core.arc_radius * core.arc_radius / chord.squaredNorm()));
  }
  bool is_arc() const { return core.kind == SiteKind::arc; }
  /// From the centre to the middle of the chord.
  Vec2 to_chord() const { return 0.5 * (core.a + core.b) - core.center; }
};

constexpr std::size_t kFewWalls = 16;  ///< which are looked at one by one
/// Walls are longer by this part at their ends, where the place of a crossing is asked for.
constexpr double kBeyondEnds = 1e-12;
/// A way past more images of the walls than this is not looked at.
constexpr double kMostImages = 1e4;

/// How far p is from the box, along the axis in which that is more [m]; 0 inside.
double distance_to(const Box& box, const Vec2& p) {
  return (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).maxCoeff();
}

BoxOfPoints box_of(const Vec2& p, const Vec2& q) {
  const Vec2 low = p.cwiseMin(q), high = p.cwiseMax(q);
  return {{low.x(), low.y()}, {high.x(), high.y()}};
}

/// On which side of the line, or the circle, that the wall is of p lies: 0 if that is lost in rounding.
int side(const Wall& wall, const Vec2& p) {
  const auto sign = [](double offset, double noise) { return offset > noise ? 1 : offset < -noise ? -1 : 0; };
  if (wall.is_arc()) {
    const double reach = p.lpNorm<1>() + wall.core.center.lpNorm<1>() + wall.core.arc_radius;
    return sign((p - wall.core.center).norm() - wall.core.arc_radius, kSideRounding * reach);
  }
  const Vec2 &a = wall.core.a, &b = wall.core.b, d = b - a;
  const double reach = p.lpNorm<1>() + a.lpNorm<1>() + b.lpNorm<1>();
  // twice the area between the wall and p: > 0 on its left
  return sign(cross(d, p - a), kSideRounding * reach * d.lpNorm<1>());
}

/// True if the straight way from p to q crosses the wall between its ends, and does not come back through it. @pre both
/// lie on a side of it.
bool crosses(const Wall& wall, const Vec2& p, const Vec2& q) {
  const Vec2 way = q - p;
  if (!wall.is_arc())
    // the wall's ends lie on two sides of the way, too
    return side(wall, p) != side(wall, q) &&
           (cross(way, wall.core.a - p) > 0.0) != (cross(way, wall.core.b - p) > 0.0);
  // |w + s way| = radius
  const Vec2 w = p - wall.core.center, chord = wall.to_chord();
  const double along = w.dot(way), length = way.squaredNorm(), radius = wall.core.arc_radius,
               off = (w.norm() - radius) * (w.norm() + radius), bend = along * along - length * off;
  if (!(bend > 0.0)) return false;
  const auto on_arc = [&](double s) {
    return s > 0.0 && s < 1.0 && (w + s * way).dot(chord) >= chord.squaredNorm();
  };
  const double root = std::sqrt(bend);
  return on_arc((-along - root) / length) != on_arc((-along + root) / length);
}

/// True if what is at place(t) goes through the wall between two times, at which it lies on a side of it: where it changes
/// sides it is between the wall's ends. Where that is, is found by halving the time.
bool goes_through(const Wall& wall, const std::function<Vec2(double)>& place, double from, double to) {
  const Vec2 p = place(from), q = place(to);
  const int before = side(wall, p);
  if (before == side(wall, q)) return crosses(wall, p, q);
  for (;;) {
    const double middle = from + 0.5 * (to - from);
    if (!(from < middle && middle < to)) break;
    (side(wall, place(middle)) == before ? from : to) = middle;
  }
  // by a little more than its ends: what goes right through a joint of two goes through one of them
  const Vec2 there = place(from);
  if (wall.is_arc()) {
    const Vec2 chord = wall.to_chord();
    return (there - wall.core.center).dot(chord) >= (1.0 - kBeyondEnds) * chord.squaredNorm();
  }
  const Vec2 d = wall.core.b - wall.core.a;
  const double along = d.dot(there - wall.core.a) / d.squaredNorm();
  return along >= -kBeyondEnds && along <= 1.0 + kBeyondEnds;
}

}  // namespace

struct ThinWalls::Tree {
  std::vector<Wall> walls;
  boost::geometry::index::rtree<std::pair<BoxOfPoints, int>, boost::geometry::index::quadratic<16>> boxes;
};

ThinWalls::ThinWalls(const Periods& periods) : tree_(std::make_unique<Tree>()), periods_(periods) {}
ThinWalls::~ThinWalls() = default;

void ThinWalls::add(const Site& core, int site) {
  const Wall& wall = tree_->walls.emplace_back(core, site);
  tree_->boxes.insert({box_of(wall.box.low, wall.box.high), count_++});
  extent_.add(wall.box.low);
  extent_.add(wall.box.high);
}

Box ThinWalls::clear_around(const Vec2& p) const {
  const Box here{p, p};
  // by a little less, so that no rounding puts a wall inside
  const auto clear = [&](double room) { return here.grown(room * (1.0 - 1e-9)); };
  if (!periods_.any()) return clear(room_about(p));
  double room = periods_.least();
  periods_.overlaps(here.grown(room), extent_, [&](const Image& image) {
    room = std::min(room, room_about(p - periods_.shift(image)));
  });
  return clear(room);
}

/// How far every side of a square about p may be away from it until it meets a wall [m].
double ThinWalls::room_about(const Vec2& p) const {
  double room = std::numeric_limits<double>::infinity();
  // By boxes, not by walls: a box holds its wall, so room about boxes is room about walls. The largest norm gives
  // the largest square; the tree knows the distance alone.
  if (tree_->walls.size() <= kFewWalls) {
    for (const Wall& wall : tree_->walls) room = std::min(room, distance_to(wall.box, p));
  } else {
    std::vector<std::pair<BoxOfPoints, int>> nearest;
    tree_->boxes.query(boost::geometry::index::nearest(Point(p.x(), p.y()), 1), std::back_inserter(nearest));
    const Box& box = tree_->walls[static_cast<std::size_t>(nearest.front().second)].box;
    // A disc of that radius meets no wall's box; the square inside it reaches 1 / sqrt(2) of it along the
    // axes.
    room = (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).norm() * std::numbers::sqrt2 * 0.5;
  }
  return room;
}

std::optional<int> ThinWalls::crossed(const Place& place, double from, double to, double turns) const {
  if (!periods_.any()) return crossed_image(place, from, to, turns);
  Box way;
  way.add(place(from));
  way.add(place(to));
  double images = 1.0;
  for (int axis = 0; axis < 2; ++axis)
    if (periods_.size[axis] > 0.0)
      images *= 1.0 + (way.extent()[axis] + extent_.extent()[axis]) / periods_.size[axis];
  if (!(images <= kMostImages)) return std::nullopt;
  std::optional<int> found;
  periods_.overlaps(way, extent_, [&](const Image& image) {
    const Vec2 shift = periods_.shift(image);
    if (!found) found = crossed_image([&](double t) { return Vec2(place(t) - shift); }, from, to, turns);
  });
  return found;
}

/// Whoever ends on the other side of a wall has gone through it or round an end of it: places along the way tell
/// which.
std::optional<int> ThinWalls::crossed_image(const Place& place, double from, double to, double turns) const {
  const Vec2 p = place(from), q = place(to);
  std::vector<std::pair<BoxOfPoints, int>> near;
  tree_->boxes.query(boost::geometry::index::intersects(box_of(p, q)), std::back_inserter(near));
  // The straight way between the ends is asked first: what comes back through the wall has crossed nothing for good. Then
  // an odd number of crossings between two places has led through.
  for (const auto& [box, k] : near) {
    const Wall& wall = tree_->walls[static_cast<std::size_t>(k)];
    if (side(wall, p) == 0 || side(wall, q) == 0 || !crosses(wall, p, q)) continue;
    // round its end, or through it?
    const int steps = 64 * (1 + static_cast<int>(std::min(std::abs(turns), 1000.0)));
    bool through = false;
    double last = from;  // where the side could be told
    for (int i = 1; i <= steps; ++i) {
      const double next = i == steps ? to : from + (to - from) * i / steps;
      // too near to tell: the way to the next place that tells counts as one
      if (side(wall, place(next)) == 0) continue;
      if (goes_through(wall, place, last, next)) through = !through;
      last = next;
    }
    if (through) return wall.site;
  }
  return std::nullopt;
}

}  // namespace brink
