#pragma once
/// States beyond double precision: each number is a double and its low-order part (double_double.h).
///
/// A collision rounds a body's state once. In long runs between curved walls those roundings add up like a
/// random walk that the chords amplify (n^1.5 roundings after n hits); so motions start from states kept in two
/// doubles, and collisions are resolved in them.

#include <cmath>
#include <limits>
#include <numbers>

#include "brink/core/base/geometry.h"
#include "brink/core/base/sine_cosine.h"

namespace brink {

using Real = DoubleDouble;
/// Bounds the relative error of an operation.
inline constexpr double kRealEpsilon = 0x1p-100;
using RealVec = Eigen::Matrix<Real, 2, 1>;

/// The plane's products once more, in a namespace of their own: expressions of doubles must not come here.
namespace extended {
inline Real cross(const RealVec& a, const RealVec& b) { return a.x() * b.y() - a.y() * b.x(); }
inline RealVec perp(const RealVec& v) { return {-v.y(), v.x()}; }
inline RealVec cross(Real omega, const RealVec& r) { return {-omega * r.y(), omega * r.x()}; }
}  // namespace extended

/// A twist in extended precision; see Twist.
struct ExtendedTwist {
  RealVec velocity = RealVec::Zero();
  Real omega = 0;

  ExtendedTwist() = default;
  ExtendedTwist(const RealVec& v, Real w) : velocity(v), omega(w) {}
  ExtendedTwist(const Twist& t) : velocity(t.velocity.cast<Real>()), omega(t.omega) {}  // NOLINT: widening

  Twist rounded() const { return {velocity.cast<double>(), static_cast<double>(omega)}; }
  RealVec at(const RealVec& r) const { return velocity + extended::cross(omega, r); }
};

/// A rotation in extended precision.
struct ExtendedRotation {
  Real cosine = 1, sine = 0;

  ExtendedRotation() = default;
  /// By an angle [rad]. Cost: sine_cosine().
  explicit ExtendedRotation(const Real& angle) {
    if (angle == 0) return;
    const SineCosine<Real> of = sine_cosine(angle);
    cosine = of.cosine;
    sine = of.sine;
  }

  RealVec operator*(const RealVec& d) const {
    if (sine == 0 && cosine == 1) return d;
    return {cosine * d.x() - sine * d.y(), sine * d.x() + cosine * d.y()};
  }
};

/// A body's state in extended precision; see BodyState.
struct ExtendedState {
  RealVec position = RealVec::Zero();
  Real angle = 0;
  ExtendedTwist twist;

  ExtendedState() = default;
  ExtendedState(const BodyState& s)  // NOLINT: widening
      : position(s.pose.position.cast<Real>()), angle(s.pose.angle), twist(s.twist) {}

  /// With what its rounding left over.
  ExtendedState(const BodyState& s, const BodyState& low)
      : position(Real::sum(s.pose.position.x(), low.pose.position.x()),
                 Real::sum(s.pose.position.y(), low.pose.position.y())),
        angle(Real::sum(s.pose.angle, low.pose.angle)),
        twist({Real::sum(s.twist.velocity.x(), low.twist.velocity.x()),
               Real::sum(s.twist.velocity.y(), low.twist.velocity.y())},
              Real::sum(s.twist.omega, low.twist.omega)) {}

  BodyState rounded() const {
    return {{position.cast<double>(), static_cast<double>(angle)}, twist.rounded()};
  }
  /// What rounding leaves over: *this == rounded() + low().
  BodyState low() const {
    const RealVec& v = twist.velocity;
    return {{{position.x().low(), position.y().low()}, angle.low()},
            {{v.x().low(), v.y().low()}, twist.omega.low()}};
  }
  /// Rounded as seen from `base`, the angle brought within half a turn before: nothing is lost far away, or
  /// after many turns, by what is near the base.
  BodyState seen_from(const Vec2& base) const {
    const bool within = abs(angle) < std::numbers::pi;
    const Real reduced = within ? angle : within_half_a_turn(angle);
    return {{(position - base.cast<Real>()).cast<double>(), static_cast<double>(reduced)}, twist.rounded()};
  }
  ExtendedState shifted(const Vec2& by) const {
    ExtendedState s = *this;
    s.position += by.cast<Real>();
    return s;
  }
  /// Where a point of its frame is.
  RealVec to_world(const Vec2& local) const {
    return position + ExtendedRotation(angle) * local.cast<Real>();
  }
  /// The state `moment` later, to first order: for moments as short as a rounding of the clock.
  ExtendedState moved(Real moment) const {
    ExtendedState s = *this;
    // what adds nothing is left out: the sums are the same bits
    if (twist.velocity.x() != 0 || twist.velocity.y() != 0) s.position += moment * twist.velocity;
    if (twist.omega != 0) s.angle += moment * twist.omega;
    return s;
  }
};

}  // namespace brink
