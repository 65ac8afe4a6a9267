#include "brink/scenes/draw/view.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "brink/core/shapes/distance.h"
#include "brink/scenes/draw/draw.h"

namespace brink {
namespace {

/// Larger sites than this many times the bodies' surroundings are shown in part only.
/// A bin four times as large as its heap is seen whole; a floor without end is not.
constexpr double kWhole = 4.0;
/// Sites farther than this many times the size of the bodies' box are not shown.
constexpr double kFar = 20.0;

/// The box of the outline's surface at a pose [m]: cores with their thickness, arcs with their bulge.
/// Tight, where Outline::bounds turned with the body would not be. Cost: all sites.
Box bounds_at(const Outline& outline, const Pose& pose) {
  const Frame frame(pose);
  Box box;
  for (const Site& site : outline.sites) {
    Box core;
    core.add(frame.to_world(site.a));
    core.add(frame.to_world(site.b));
    if (site.kind == SiteKind::arc) {
      const Vec2 center = frame.to_world(site.center);
      const Vec2 from = frame.direction_to_world(site.a - site.center);
      // An arc reaches farthest right, up, left, down where it passes these directions: angles are
      // counted from its start in the direction in which it runs.
      for (int quarter = 0; quarter < 4; ++quarter) {
        const Vec2 axis = quarter % 2 == 0 ? Vec2(quarter < 2 ? 1 : -1, 0) : Vec2(0, quarter < 2 ? 1 : -1);
        const double turn = std::atan2(cross(from, axis), from.dot(axis)) * (site.sweep > 0 ? 1.0 : -1.0);
        if (turn >= 0.0 && turn <= std::abs(site.sweep)) core.add(center + site.arc_radius * axis);
      }
    }
    box.add(core.grown(site.radius));
  }
  return box;
}

/// The point of the outline's cores that is nearest to `to`, all in the world [m]. Cost: all sites.
Vec2 nearest_point(const Outline& outline, const Pose& pose, const Vec2& to) {
  const Frame frame(pose);
  const Vec2 q = frame.to_local(to);
  Nearest best;
  best.distance = std::numeric_limits<double>::infinity();
  for (const Site& site : outline.sites) {
    const Nearest n = nearest_on(site, q);
    if (n.distance < best.distance) best = n;
  }
  return frame.to_world(best.point);
}

/// What sizes are compared by: a row of bodies is as large as it is long.
double longer_side(const Box& box) { return box.extent().maxCoeff(); }

}  // namespace

// The view grows in three steps: the bodies; the nearest point of every site that is not too far from them;
// then of each such site all of it, or, where it is much larger than what there is so far, the part beside
// it.
Box automatic_view(const World& world, std::span<const BodyState> bodies, std::span<const Pose> sites) {
  std::vector<Box> whole;
  for (std::size_t k = 0; k < world.sites.size(); ++k)
    whole.push_back(bounds_at(*world.sites[k].outline, sites[k]));
  Box core;
  for (std::size_t k = 0; k < world.bodies.size(); ++k)
    core.add(bounds_at(*world.bodies[k].outline, bodies[k].pose));
  // Without bodies everything is shown.
  if (core.empty()) {
    for (const Box& box : whole) core.add(box);
    return core;
  }
  // a spring is seen whole, so its anchor is
  Box near = core;
  for (const Force& force : world.forces)
    if (const auto* spring = std::get_if<SpringForce>(&force); spring && spring->body_b < 0)
      near.add(spring->at_b);
  std::vector<std::size_t> shown;
  // By the nearest point of each site, as a floor 1000 m long may begin far away and still pass
  // below the bodies.
  for (std::size_t k = 0; k < world.sites.size(); ++k) {
    const Vec2 point = nearest_point(*world.sites[k].outline, sites[k], core.center());
    if ((point - core.center()).norm() > kFar * longer_side(core)) continue;
    near.add(point);
    shown.push_back(k);
  }
  Box view = near;
  // Of what is larger than kWhole times the near box only the part beside it is seen.
  // What is nearest to the bodies with a quarter of its size around: so much of a long floor is shown.
  const Box surroundings = near.grown(0.25 * longer_side(near));
  for (const std::size_t k : shown) {
    Box box = whole[k];
    if (longer_side(box) > kWhole * longer_side(near)) {
      if (!box.overlaps(surroundings)) continue;
      box.low = box.low.cwiseMax(surroundings.low);
      box.high = box.high.cwiseMin(surroundings.high);
    }
    view.add(box);
  }
  return view;
}

namespace draw {

View fitted(const Box& box, double margin, int width, int height) {
  // Nothing to be seen: a metre about the origin, so that the scale is a number.
  const Vec2 center = box.empty() ? Vec2(0.0, 0.0) : box.center();
  const Vec2 extent = box.empty() ? Vec2(1.0, 1.0) : box.extent();
  const double side = extent.maxCoeff() > 0.0 ? extent.maxCoeff() : 1.0;
  const Vec2 wanted = extent.array() + 2.0 * margin * side;
  // A flat box (bodies on a line) is as wide as its other side asks; the floor keeps divisions finite.
  const double floor = 1e-9 * side;
  View view;
  view.width = width;
  view.height = height;
  // The tighter of the two sides decides; the other one sees more than was asked for.
  view.scale = std::min(width / std::max(wanted.x(), floor), height / std::max(wanted.y(), floor));
  const Vec2 half = Vec2(width, height) / (2.0 * view.scale);
  view.window.low = center - half;
  view.window.high = center + half;
  return view;
}

double round_length(double x) {
  // power <= x < 10 power: of 5, 2 and 1 times the power the first that fits is the largest.
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= x) return digit * power;
  return power;
}

}  // namespace draw
}  // namespace brink
