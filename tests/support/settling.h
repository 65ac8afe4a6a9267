#pragma once
/// Worlds under gravity in which something settles, slides or rolls, and whether it lies still.

#include "tests/support/worlds.h"

namespace brink::testing {

constexpr double kEarth = 9.81;  ///< [m/s^2]

/// Nothing in it yet, one material.
inline World heavy_world(double restitution, double friction) {
  World world;
  world.gravity = {0.0, -kEarth};
  world.materials[0].restitution = restitution;
  world.materials[0].friction = friction;
  return world;
}
inline void add_floor(World& world) { add(world, site(make_segment({-100.0, 0.0}, {100.0, 0.0}))); }

inline SolverOptions lasting() {
  SolverOptions options;
  options.persistent = true;
  return options;
}

/// Runs on to t; how it ended if not there, else empty.
inline std::string go_on(Simulator& simulator, double t) {
  const RunSummary summary = simulator.run(until(t));
  return summary.termination == Termination::reached_end ? "" : summary.termination_text();
}

inline bool same_place(const BodyState& a, const BodyState& b) {
  return a.pose.position == b.pose.position && a.pose.angle == b.pose.angle &&
         a.twist.velocity == b.twist.velocity && a.twist.omega == b.twist.omega;
}
inline bool at_rest(const BodyState& s) { return s.twist.velocity.isZero(0.0) && s.twist.omega == 0.0; }
inline bool all_at_rest(const Simulator& simulator) {
  for (const BodyState& s : simulator.states())
    if (!at_rest(s)) return false;
  return true;
}

}  // namespace brink::testing
