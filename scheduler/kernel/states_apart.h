#pragma once
/// How far apart two states of one body are.

#include <cmath>

#include "brink/core/base/extended.h"

namespace brink {

/// How far a point of a body of that radius is at most in one state from where it is in the other [m].
inline double states_apart(const ExtendedState& s, const ExtendedState& t, double radius) {
  const RealVec d = s.position - t.position;
  return std::abs(d.x().high()) + std::abs(d.y().high()) + radius * std::abs((s.angle - t.angle).high());
}

}  // namespace brink
