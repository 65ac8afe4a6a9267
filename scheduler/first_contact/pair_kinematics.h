#pragma once
/// How one outline's sample moves in the other outline's frame, with certified bounds.

#include <algorithm>
#include <limits>

#include "brink/core/base/geometry.h"
#include "brink/core/base/sine_cosine_pair.h"
#include "brink/core/shapes/outline.h"
#include "brink/integrators/motion.h"

namespace brink {

/// Of two outlines' bounding discs the smaller; of a mere point and another, the other's [m].
inline double smallest_radius(double ra, double rb) {
  return ra > 0.0 && rb > 0.0 ? std::min(ra, rb) : std::max(ra, rb);
}
inline double smallest_radius(const Outline& a, const Outline& b) {
  return smallest_radius(a.bounding_radius, b.bounding_radius);
}

/// An outline at one moment, and the frame in which it is looked at.
struct Placed {
  Frame frame;
  Twist twist;
  double angle = std::numeric_limits<double>::quiet_NaN();  ///< of the frame [rad]

  Placed() = default;
  Placed(const Outline& outline, const BodyState& s) { move(outline, s); }

  /// To another moment. Sine and cosine are taken only if the angle has changed.
  void move(const Outline& outline, const BodyState& s) {
    const double now = angle_of(outline, s);
    if (now == angle)
      frame.origin = s.pose.position;
    else
      frame = Frame(Pose{s.pose.position, now});
    angle = now;
    twist = s.twist;
  }
  /// The same of two, side by side where both turn.
  static void move_both(Placed& a, const Outline& outline_a, const BodyState& state_a, Placed& b,
                        const Outline& outline_b, const BodyState& state_b) {
    const double now_a = angle_of(outline_a, state_a), now_b = angle_of(outline_b, state_b);
    if (now_a != a.angle && now_b != b.angle) {
      const SineCosinePair both = sine_cosine(now_a, now_b);
      a = Placed(Frame(state_a.pose.position, both.of_a), state_a.twist, now_a);
      b = Placed(Frame(state_b.pose.position, both.of_b), state_b.twist, now_b);
      return;
    }
    a.move(outline_a, state_a);
    b.move(outline_b, state_b);
  }

 private:
  Placed(const Frame& of, const Twist& by, double turned) : frame(of), twist(by), angle(turned) {}
  static double angle_of(const Outline& outline, const BodyState& s) {
    return is_centred_disc(outline) ? 0.0 : s.pose.angle;
  }
};

/// Bounds on how sample owner S and site owner T move against each other over a window of time.
struct RelativeBounds {
  double speed = 0.0;         ///< of S's origin against T's [m/s]
  double acceleration = 0.0;  ///< likewise [m/s^2]
  double spin_s = 0.0, alpha_s = 0.0;
  double spin_t = 0.0, alpha_t = 0.0;
  Vec2 pull = Vec2::Zero();  ///< S's acceleration against T's, in the world, to within pull_radius [m/s^2]
  double pull_radius = 0.0;

  RelativeBounds() = default;
  RelativeBounds(const MotionBounds& s, const MotionBounds& t)
      : speed((s.velocity - t.velocity).norm() + s.velocity_radius + t.velocity_radius),
        acceleration((s.acceleration - t.acceleration).norm() + s.acceleration_radius +
                     t.acceleration_radius),
        spin_s(s.spin()),
        alpha_s(s.alpha),
        spin_t(t.spin()),
        alpha_t(t.alpha),
        pull(s.acceleration - t.acceleration),
        pull_radius(s.acceleration_radius + t.acceleration_radius) {}

  /// Of two outlines on their motions over [from, to].
  static RelativeBounds over(const Outline& s, const Motion& motion_s, const Outline& t,
                             const Motion& motion_t, double from, double to) {
    const bool parabolas = motion_s.is_ballistic() && motion_t.is_ballistic();
    RelativeBounds b = parabolas ? of_parabolas(motion_s, motion_t, from, to)
                                 : RelativeBounds(motion_s.bounds(from, to), motion_t.bounds(from, to));
    if (is_centred_disc(s)) b.spin_s = b.alpha_s = 0.0;
    if (is_centred_disc(t)) b.spin_t = b.alpha_t = 0.0;
    return b;
  }

  /// Bodies that fall together do not part: tighter than the difference of their bounds, and quick.
  static RelativeBounds of_parabolas(const Motion& s, const Motion& t, double from, double to) {
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    const double since_s = middle - s.origin(), since_t = middle - t.origin();
    const Acceleration &as = s.acceleration(), &at = t.acceleration();
    const Twist &ws = s.start().twist, &wt = t.start().twist;
    RelativeBounds b;
    b.pull = as.linear - at.linear;
    b.acceleration = b.pull.norm();
    b.speed = ((ws.velocity + since_s * as.linear) - (wt.velocity + since_t * at.linear)).norm() +
              half * b.acceleration;
    b.alpha_s = std::abs(as.angular);
    b.alpha_t = std::abs(at.angular);
    b.spin_s = std::abs(ws.omega + since_s * as.angular) + half * b.alpha_s;
    b.spin_t = std::abs(wt.omega + since_t * at.angular) + half * b.alpha_t;
    return b;
  }

  RelativeBounds swapped() const {
    RelativeBounds r = *this;
    std::swap(r.spin_s, r.spin_t);
    std::swap(r.alpha_s, r.alpha_t);
    r.pull = -r.pull;
    return r;
  }
};

/// A sample's place and velocity in T's frame at one moment.
struct SamplePath {
  Vec2 q;           ///< place [m]
  Vec2 rate;        ///< dq/dt [m/s]
  double arm;       ///< distance from S's origin [m]
  double distance;  ///< from T's origin [m]
  double
      magnitude;  ///< sum of the speeds that `rate` was computed from: its rounding error is a few eps of it
};

inline SamplePath sample_path(const Placed& s, const Placed& t, const Vec2& p_local) {
  const Vec2 r = s.frame.direction_to_world(p_local);
  const Vec2 rho = r + (s.frame.origin - t.frame.origin);  // in this order: origins may be far away
  const Vec2 w = s.twist.at(r) - t.twist.at(rho);
  SamplePath path;
  path.q = t.frame.direction_to_local(rho);
  path.rate = t.frame.direction_to_local(w);
  path.arm = p_local.norm();
  path.distance = rho.norm();
  path.magnitude = s.twist.velocity.lpNorm<1>() + std::abs(s.twist.omega) * path.arm +
                   t.twist.velocity.lpNorm<1>() + std::abs(t.twist.omega) * path.distance;
  return path;
}

/// Of S's own origin, wherever S has turned to.
inline SamplePath origin_path(const BodyState& s, const Placed& t) {
  const Vec2 rho = s.pose.position - t.frame.origin, w = s.twist.velocity - t.twist.at(rho);
  return {t.frame.direction_to_local(rho), t.frame.direction_to_local(w), 0.0, rho.norm(),
          s.twist.velocity.lpNorm<1>() + t.twist.velocity.lpNorm<1>() + std::abs(t.twist.omega) * rho.norm()};
}

/// Bounds on |dq/dt| and |d2q/dt2| in T's turning frame over the next `window` seconds. With rho = p - x_T
/// and w = rho' - omega_T x rho: q'' = R_T^T (rho'' - alpha_T x rho - 2 omega_T x w - omega_T x (omega_T x
/// rho)).
struct PathBounds {
  double speed = 0.0;
  double acceleration = 0.0;
  double turning = 0.0;  ///< what of `acceleration` comes of the two that turn, not of the pull between them
  /// Bound on |d2 rho/dt2|. The distance from T's origin is the same in both frames: d2|q|/dt2 is no less than minus this,
  /// however fast T turns.
  double inertial_acceleration = 0.0;
};

inline PathBounds path_bounds(const SamplePath& path, const RelativeBounds& b, double window) {
  const double inertial_speed = b.speed + b.spin_s * path.arm;
  const double own = (b.alpha_s + b.spin_s * b.spin_s) * path.arm,
               inertial_acceleration = b.acceleration + own;
  if (b.spin_t == 0.0 && b.alpha_t == 0.0)
    return {inertial_speed, inertial_acceleration, own, inertial_acceleration};
  const double rho = path.distance + inertial_speed * window;
  const double speed = inertial_speed + b.spin_t * rho;
  const double centrifugal = (b.alpha_t + b.spin_t * b.spin_t) * rho, coriolis = 2.0 * b.spin_t * speed;
  return {speed, inertial_acceleration + centrifugal + coriolis, own + centrifugal + coriolis,
          inertial_acceleration};
}

/// Bound on how the path accelerates against a unit direction that is fixed in T's frame, `world` now, over the
/// window of `bounds` [m/s^2], >= 0: of what pulls S against T only the part against the direction counts, as far
/// as that may turn.
inline double acceleration_against(const Vec2& world, const RelativeBounds& b, const PathBounds& bounds,
                                   double window) {
  // asked first: 0 times a window without end is no number
  const double turned = b.spin_t > 0.0 ? b.spin_t * window * b.pull.norm() : 0.0;
  const double along = world.dot(b.pull) - turned;
  return std::min(bounds.acceleration, std::max(0.0, b.pull_radius - along) + bounds.turning);
}

}  // namespace brink
