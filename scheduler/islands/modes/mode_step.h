#pragma once
/// One explicit step of bodies in given modes: Dormand & Prince 5(4).

#include "brink/scheduler/islands/modes/mode_forces.h"

namespace brink {

/// Places and velocities after the step, and how far the two orders are apart.
struct ModeTrial {
  std::vector<BodyState> states, error;
  bool finite = true;
};

/// From `from` at t over h > 0 [s]. Nothing is projected. Cost: seven times forces_in(). Source: Dormand & Prince 1980,
/// "A family of embedded Runge-Kutta formulae".
ModeTrial try_step(const ModeProblem& problem, const std::vector<MotionMode>& modes, double t,
                   const std::vector<BodyState>& from, double h);

}  // namespace brink
