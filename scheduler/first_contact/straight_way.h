#pragma once
/// How a disc goes that nothing accelerates.

#include <cmath>

#include "brink/scheduler/first_contact/tolerances.h"

namespace brink {

/// A disc's way without acceleration: places with Motion::place's own bits.
struct StraightWay {
  double origin, x, y, vx, vy;

  explicit StraightWay(const Motion& m)
      : origin(m.origin()),
        x(m.start().pose.position.x()),
        y(m.start().pose.position.y()),
        vx(m.start().twist.velocity.x()),
        vy(m.start().twist.velocity.y()) {}
  double x_at(double t) const { return x + (t - origin) * vx; }
  double y_at(double t) const { return y + (t - origin) * vy; }
  double speed() const { return std::abs(vx) + std::abs(vy); }  ///< of both coordinates [m/s]
  /// Rounding of its place at time t, or more [m]: MotionRounding.
  double noise(double t) const {
    return kRoundoff * (4.0 * std::abs(t - origin) * speed() + std::abs(x_at(t)) + std::abs(y_at(t)));
  }
};

}  // namespace brink
