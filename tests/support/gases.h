#pragma once
/// Gases of equal bodies: in a box, and in a cell that repeats.

#include <cmath>
#include <numbers>

#include "brink/core/base/random.h"
#include "tests/support/worlds.h"

namespace brink::testing {

inline double gaussian(Random& r) {
  return std::sqrt(-2.0 * std::log(1.0 - r.uniform())) * std::cos(2.0 * std::numbers::pi * r.uniform());
}

/// `count` equal bodies on a square lattice, centred, so that they fill `packing` of it. Velocities are
/// Maxwellian with variance 1 an axis, their mean taken off; angular ones have standard deviation `spin`.
inline World lattice_gas(int count, const Shape& shape, double packing, double spin = 0.0,
                         std::uint64_t seed = 9) {
  World world;
  Random random(seed);
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  const double pitch = std::sqrt(shape.measure.size / packing), half = 0.5 * pitch * side;
  const Body like = body(shape, {0.0, 0.0}, {0.0, 0.0});
  Vec2 mean = Vec2::Zero();
  for (int k = 0; k < count; ++k) {
    Body b = like;
    b.initial.pose.position = {pitch * (k % side + 0.5) - half, pitch * (k / side + 0.5) - half};
    b.initial.twist = {{gaussian(random), gaussian(random)}, spin * gaussian(random)};
    mean += b.initial.twist.velocity / count;
    add(world, std::move(b));
  }
  for (Body& b : world.bodies) b.initial.twist.velocity -= mean;
  world.periods.size = Vec2::Constant(2.0 * half);
  return world;
}

/// The same between four walls.
inline World boxed(World world) {
  const double half = 0.5 * world.periods.size.x();
  world.periods = {};
  const Vec2 corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  for (int k = 0; k < 4; ++k) add(world, site(make_segment(corners[k], corners[(k + 1) % 4])));
  return world;
}

/// A star of `points` points, about `radius` from tip to centre: 2 `points` vertices, non-convex.
inline Shape star(int points, double radius, double inner = 0.5) {
  std::vector<Vec2> vertices;
  for (int k = 0; k < 2 * points; ++k) {
    const double angle = std::numbers::pi * k / points, r = k % 2 ? inner * radius : radius;
    vertices.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return make_polygon(vertices);
}

/// A wheel with that many teeth, between those radii.
inline Shape gear(int teeth, double tip, double root) {
  std::vector<Vec2> vertices;
  for (int k = 0; k < 4 * teeth; ++k) {
    // of each quarter of a tooth's part: up its side, along its tip, down, along the root
    const double angle = 0.5 * std::numbers::pi * k / teeth, r = k % 4 < 2 ? tip : root;
    vertices.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return make_polygon(vertices);
}

}  // namespace brink::testing
