#pragma once
/// Where motions begin: a body's, and an integrator's.

#include <vector>

#include "brink/core/base/extended.h"
#include "brink/core/base/geometry.h"

namespace brink {

/// A body and the state at which its motion begins anew.
struct Restart {
  int body;
  ExtendedState state;
};

/// Where the integrator of a component was started. Of bodies that were grouped while running, what the
/// rounding of their places leaves over is kept beside what the integrator makes: who joins must not jump, not
/// even by that, into what it touches.
struct ComponentStart {
  int component = -1;
  double time = 0.0;  ///< [s]
  std::vector<BodyState> states;
  std::vector<Pose> lows;  ///< what their rounding left over; empty: nothing, never
};

}  // namespace brink
