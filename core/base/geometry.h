#pragma once
/// The plane: vectors, poses, twists. SI units, radians; angles grow counter-clockwise and are never wrapped.

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <numbers>

#include "brink/core/base/sine_cosine.h"

namespace brink {

using Vec2 = Eigen::Vector2d;

inline constexpr double kQuarterTurn = std::numbers::pi / 2;  ///< [rad]

/// Of two coordinates, both written at once. Vec2(x, y) writes one after the other: what reads both at once, as sums of vectors
/// do, waits until they are in memory.
inline Vec2 vector_of(double x, double y) {
  using Two = double __attribute__((vector_size(16), aligned(alignof(Vec2)), may_alias));
  Vec2 v;
  *reinterpret_cast<Two*>(v.data()) = Two{x, y};
  return v;
}

/// z component of a x b.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// v turned by +90 degrees.
inline Vec2 perp(const Vec2& v) { return vector_of(-v.y(), v.x()); }

/// omega z x r: the velocity [m/s] of a point at r [m] on a body that turns at omega [rad/s].
inline Vec2 cross(double omega, const Vec2& r) { return vector_of(-omega * r.y(), omega * r.x()); }

/// Where a body is: position of its origin in the world [m] and its angle [rad].
struct Pose {
  Vec2 position = Vec2::Zero();
  double angle = 0.0;
};

/// How a body moves: velocity of its origin in the world [m/s], and angular velocity [rad/s].
struct Twist {
  Vec2 velocity = Vec2::Zero();
  double omega = 0.0;

  /// Velocity of the body's point that is at r = p - position, in world axes.
  Vec2 at(const Vec2& r) const { return velocity + cross(omega, r); }
};

/// When a point at d [m] that moves at v [m/s] comes within `reach` of the origin [s]; infinity: never, or it
/// is there and leaves. Free of cancellation: the miss distance is told to a rounding of |d|.
inline double time_until_within(const Vec2& d, const Vec2& v, double reach) {
  const double distance = d.norm(), approach = -d.dot(v), offset = cross(d, v);
  const double square = v.squaredNorm() * reach * reach - offset * offset;
  if (approach <= 0.0 || square < 0.0) return std::numeric_limits<double>::infinity();
  return (distance - reach) * (distance + reach) / (approach + std::sqrt(square));
}

struct BodyState {
  Pose pose;
  Twist twist;
};

/// Linear [m/s^2] and angular [rad/s^2] acceleration.
struct Acceleration {
  Vec2 linear = Vec2::Zero();
  double angular = 0.0;
};

/// A pose with its sine and cosine taken once: use it where many points are moved between frames.
struct Frame {
  Vec2 origin = Vec2::Zero();
  double cosine = 1.0;
  double sine = 0.0;

  Frame() = default;
  explicit Frame(const Pose& pose) : Frame(pose.position, sine_cosine(pose.angle)) {}
  Frame(const Vec2& position, const SineCosine<double>& of_angle)
      : origin(position), cosine(of_angle.cosine), sine(of_angle.sine) {}

  Vec2 direction_to_world(const Vec2& d) const {
    return vector_of(cosine * d.x() - sine * d.y(), sine * d.x() + cosine * d.y());
  }
  Vec2 direction_to_local(const Vec2& d) const {
    return vector_of(cosine * d.x() + sine * d.y(), -sine * d.x() + cosine * d.y());
  }
  Vec2 to_world(const Vec2& p) const { return origin + direction_to_world(p); }
  Vec2 to_local(const Vec2& p) const { return direction_to_local(p - origin); }
};

/// Axis-aligned box; starts empty.
struct Box {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high = Vec2::Constant(-std::numeric_limits<double>::infinity());

  bool empty() const { return !(low.x() <= high.x() && low.y() <= high.y()); }
  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Box& b) {
    low = low.cwiseMin(b.low);
    high = high.cwiseMax(b.high);
  }
  Box grown(double margin) const {
    Box b = *this;
    b.low.array() -= margin;
    b.high.array() += margin;
    return b;
  }
  bool overlaps(const Box& b) const {
    return low.x() <= b.high.x() && b.low.x() <= high.x() && low.y() <= b.high.y() && b.low.y() <= high.y();
  }
  bool contains(const Vec2& p) const {
    return low.x() <= p.x() && p.x() <= high.x() && low.y() <= p.y() && p.y() <= high.y();
  }
  Vec2 center() const { return 0.5 * (low + high); }
  Vec2 extent() const { return high - low; }
};

}  // namespace brink
