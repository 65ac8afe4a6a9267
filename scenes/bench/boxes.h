#pragma once
/// Two boxes that spin freely and meet once, elastic and without friction, in long double: the slow way,
/// looking every tenth of a millisecond and halving. Reference for benchmarks.

#include "brink/core/base/error.h"
#include "brink/core/world/world.h"

namespace brink::bench {

/// A box of width x height [m] about its centre on its free flight.
struct SpinningBox {
  long double x, y, angle;  ///< at t = 0
  long double vx, vy, omega;
  long double mass, inertia;
  long double half_width, half_height;

  SpinningBox(const Body& body, double width, double height);
  SpinningBox at(long double t) const;
};

struct BoxCollision {
  long double time = 0.0L;  ///< [s]
  SpinningBox end[2];       ///< at the end
};

/// @throws BadInput unless they meet exactly once before `end` [s].
BoxCollision meet(const SpinningBox& a, const SpinningBox& b, double end);

}  // namespace brink::bench
