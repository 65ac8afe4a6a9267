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

/// A wire's segment in the world, the fixed site that it is of, and the box about it.
struct Wall {
  Vec2 a, b;
  int site;
  Box box;

  Wall(const Vec2& from, const Vec2& to, int of) : a(from), b(to), site(of) {
    box.add(a);
    box.add(b);
  }
};

constexpr std::size_t kFewWalls = 16;  ///< which are looked at one by one

/// How far p is from the box, along the axis in which that is more [m]; 0 inside.
double distance_to(const Box& box, const Vec2& p) {
  return (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).maxCoeff();
}

BoxOfPoints box_of(const Vec2& p, const Vec2& q) {
  const Vec2 low = p.cwiseMin(q), high = p.cwiseMax(q);
  return {{low.x(), low.y()}, {high.x(), high.y()}};
}

/// On which side of the line through the wall p lies: 0 if that is lost in rounding.
int side(const Wall& wall, const Vec2& p) {
  const Vec2 d = wall.b - wall.a, w = p - wall.a;
  const double reach = p.lpNorm<1>() + wall.a.lpNorm<1>() + wall.b.lpNorm<1>();
  // twice the area between the wall and p: > 0 on its left
  const double offset = cross(d, w), noise = kSideRounding * reach * d.lpNorm<1>();
  return offset > noise ? 1 : offset < -noise ? -1 : 0;
}

/// True if the straight way from p to q crosses the wall between its ends. @pre p and q lie on two sides.
bool crosses(const Wall& wall, const Vec2& p, const Vec2& q) {
  const Vec2 way = q - p;
  // the wall's ends lie on two sides of the way
  return (cross(way, wall.a - p) > 0.0) != (cross(way, wall.b - p) > 0.0);
}

}  // namespace

struct ThinWalls::Tree {
  std::vector<Wall> walls;
  boost::geometry::index::rtree<std::pair<BoxOfPoints, int>, boost::geometry::index::quadratic<16>> boxes;
};

ThinWalls::ThinWalls() : tree_(std::make_unique<Tree>()) {}
ThinWalls::~ThinWalls() = default;

void ThinWalls::add(const Vec2& a, const Vec2& b, int site) {
  tree_->boxes.insert({box_of(a, b), count_++});
  tree_->walls.emplace_back(a, b, site);
}

Box ThinWalls::clear_around(const Vec2& p) const {
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
  // by a little less, so that no rounding puts a wall inside
  return Box{p, p}.grown(room * (1.0 - 1e-9));
}

/// Whoever ends on the other side of a wall has gone through it or round an end of it: places along the way tell
/// which.
std::optional<int> ThinWalls::crossed(const std::function<Vec2(double)>& place, double from, double to,
                                      double turns) const {
  const Vec2 p = place(from), q = place(to);
  std::vector<std::pair<BoxOfPoints, int>> near;
  tree_->boxes.query(boost::geometry::index::intersects(box_of(p, q)), std::back_inserter(near));
  // A path that comes back to the side where it began has crossed nothing for good, so ends on two sides
  // are asked for first. Then each crossing between two places changes the side, and an odd number has led
  // through.
  for (const auto& [box, k] : near) {
    const Wall& wall = tree_->walls[static_cast<std::size_t>(k)];
    if (side(wall, p) * side(wall, q) >= 0 || !crosses(wall, p, q)) continue;
    // round its end, or through it?
    const int steps = 64 * (1 + static_cast<int>(std::min(std::abs(turns), 1000.0)));
    bool through = false;
    Vec2 last = p;
    // of the last place whose side could be told
    int last_side = side(wall, p);
    for (int i = 1; i <= steps; ++i) {
      const Vec2 next = i == steps ? q : place(from + (to - from) * i / steps);
      const int next_side = side(wall, next);
      // too near to tell: the way to the next place that tells counts as one
      if (next_side == 0) continue;
      if (next_side != last_side && crosses(wall, last, next)) through = !through;
      last = next;
      last_side = next_side;
    }
    if (through) return wall.site;
  }
  return std::nullopt;
}

}  // namespace brink
