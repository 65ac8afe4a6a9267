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

inline constexpr PairKey kDiscs{0, 1, -1, {}};
inline constexpr PairKey kWall{1, -1, 0, {}};

/// The contact of the discs, found on the parts' newest motions.
inline Certificate meeting(KernelParts& parts) {
  return *parts.search.search(kDiscs, parts.trajectories.body(0), &parts.trajectories.body(1), 0.0, 10.0);
}

}  // namespace brink::testing
