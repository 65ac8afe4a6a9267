#pragma once
/// States beyond double precision: 64 bits of mantissa (x87), carried as a double and its low-order part.
///
/// A collision rounds a body's state once. In long runs between curved walls those roundings add up like a
/// random walk that the chords amplify (n^1.5 roundings after n hits); so motions start from states kept to
/// 64 bits, and collisions are resolved in them. Where long double is double, nothing is lost but this.

#include <cmath>
#include <limits>
#include <numbers>

#include "brink/core/base/geometry.h"

namespace brink {

using Real = long double;
/// The distance from 1 to the next Real.
inline constexpr Real kRealEpsilon = std::numeric_limits<Real>::epsilon();
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
  /// By an angle [rad], told to a rounding or two, of 1, however many turns it is. Cost: a library's sine and
  /// cosine of what is left of it within an eighth of a turn; of 2^30 quarters of a turn or more, the library's
  /// own, which is ten times as slow.
  explicit ExtendedRotation(Real angle);

  RealVec operator*(const RealVec& d) const {
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
  ExtendedState(const BodyState& s, const BodyState& low) : ExtendedState(s) {
    position += low.pose.position.cast<Real>();
    angle += low.pose.angle;
    twist.velocity += low.twist.velocity.cast<Real>();
    twist.omega += low.twist.omega;
  }

  BodyState rounded() const {
    return {{position.cast<double>(), static_cast<double>(angle)}, twist.rounded()};
  }
  /// What rounding leaves over: *this == rounded() + low().
  BodyState low() const {
    const ExtendedState r(rounded());
    return {{(position - r.position).cast<double>(), static_cast<double>(angle - r.angle)},
            {(twist.velocity - r.twist.velocity).cast<double>(),
             static_cast<double>(twist.omega - r.twist.omega)}};
  }
  /// Rounded as seen from `base`, the angle brought within half a turn before: nothing is lost far away, or
  /// after many turns, by what is near the base.
  BodyState seen_from(const Vec2& base) const {
    // by its sine and cosine, which are exact for any number of turns
    const bool within = std::abs(angle) < std::numbers::pi_v<Real>;
    const Real reduced = within ? angle : std::atan2(std::sin(angle), std::cos(angle));
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
    s.position += moment * twist.velocity;
    s.angle += moment * twist.omega;
    return s;
  }
};

}  // namespace brink
