#pragma once
/// Small worlds for the kernel's parts, each looked at by itself.

#include "brink/scheduler/kernel/kernel_parts.h"
#include "tests/support/worlds.h"

namespace brink::testing {

/// Disc 0 flies at 2 m/s towards disc 1, which rests 3 m ahead; both have radius 0.5 m and mass 1 kg: they
/// meet at t = 1. A wall stands at x = 5.
inline World two_discs(double restitution = 1.0) {
  World world;
  world.materials[0].restitution = restitution;
  add(world, body(make_disc(0.5), {0.0, 0.0}, {2.0, 0.0}));
  add(world, body(make_disc(0.5), {3.0, 0.0}, {0.0, 0.0}));
  add(world, site(make_segment({5.0, -2.0}, {5.0, 2.0}, 0.0)));
  return world;
}

/// The two discs joined by a spring and falling; a third flies by itself above them.
inline World on_a_spring() {
  World world = two_discs();
  world.gravity = {0.0, -1.0};
  SpringForce spring;
  spring.body_a = 0;
  spring.body_b = 1;
  spring.stiffness = 5.0;
  spring.rest_length = 2.5;
  world.forces.push_back(spring);
  add(world, body(make_disc(0.5), {0.0, 9.0}, {1.0, 0.0}));
  return world;
}

/// A disc of radius 0.5 m, or a box 1 m wide, of 1 kg and with its centre at `height` [m], over a floor whose top is y = 0,
/// under 10 m/s^2.
inline World on_floor(const Shape& shape, double friction = 0.5, const Vec2& velocity = {0.0, 0.0},
                      double height = 0.5) {
  World world;
  world.gravity = {0.0, -10.0};
  world.materials[0].friction = friction;
  world.materials[0].restitution = 0.5;
  add(world, body(shape, {0.0, height}, velocity));
  add(world, site(make_box(40.0, 1.0), {0.0, -0.5}));
  return world;
}

/// An island holds the bodies from now on, as they are.
inline std::vector<int> hold(KernelParts& parts, const std::vector<int>& bodies) {
  std::vector<Restart> held;
  for (const int k : bodies) held.push_back({k, parts.trajectories.state_now(k)});
  std::vector<int> changed;
  parts.trajectories.hold(held, changed);
  return changed;
}

inline IslandMembers members_of(KernelParts& parts, const std::set<int>& bodies) {
  return {parts.world, parts.trajectories, parts.search, parts.run.time(), bodies};
}

inline constexpr PairKey kOnFloor{0, -1, 0, {}};
inline constexpr PairKey kDiscs{0, 1, -1, {}};
inline constexpr PairKey kWall{1, -1, 0, {}};

/// The contact of the discs, found on the parts' newest motions.
inline Certificate meeting(KernelParts& parts) {
  return *parts.search.search(kDiscs, parts.trajectories.body(0), &parts.trajectories.body(1), 0.0, 10.0);
}

}  // namespace brink::testing
