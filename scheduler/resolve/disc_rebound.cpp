#include "brink/scheduler/resolve/disc_rebound.h"

#include <algorithm>
#include <cmath>

#include "brink/scheduler/resolve/tolerances.h"

namespace brink {

namespace {

/// A disc at one time, all but its spin.
/// Place and velocity in extended precision, from the start and what rounding left over of it.
struct Moving {
  Real x, y, vx, vy;
  double ax, ay;

  Moving(const Motion& m, double t) {
    const BodyState &s = m.start(), &low = m.start_low();
    const Vec2& a = m.acceleration().linear;
    ax = a.x();
    ay = a.y();
    const Real since = static_cast<Real>(t) - m.origin();
    vx = static_cast<Real>(s.twist.velocity.x()) + low.twist.velocity.x();
    vy = static_cast<Real>(s.twist.velocity.y()) + low.twist.velocity.y();
    x = static_cast<Real>(s.pose.position.x()) + low.pose.position.x();
    y = static_cast<Real>(s.pose.position.y()) + low.pose.position.y();
    // without forces the velocity stays, and half of the products are saved
    if (a.isZero(0.0)) {
      x += since * vx;
      y += since * vy;
      return;
    }
    x += since * (vx + Real(0.5) * since * a.x());
    y += since * (vy + Real(0.5) * since * a.y());
    vx += since * a.x();
    vy += since * a.y();
  }
};

/// A value as a double and what that leaves over.
void split(Real value, double& high, double& low) {
  high = static_cast<double>(value);
  low = static_cast<double>(value - high);
}

/// The start at `time` of the parabola on which `disc`, now with the velocity (vx, vy), passes through the
/// place where it was `delay` from then.
DiscRebound::Start start_after(const Motion& motion, double time, const Moving& disc, Real vx, Real vy,
                               Real delay) {
  DiscRebound::Start start;
  // Both parabolas have the same acceleration. So they are at one place `delay` from now if their places
  // now differ by what their velocities make of it.
  BodyState &s = start.state, &low = start.low;
  split(disc.x + delay * (disc.vx - vx), s.pose.position.x(), low.pose.position.x());
  split(disc.y + delay * (disc.vy - vy), s.pose.position.y(), low.pose.position.y());
  split(vx, s.twist.velocity.x(), low.twist.velocity.x());
  split(vy, s.twist.velocity.y(), low.twist.velocity.y());
  // Without friction nothing turns at the rim: angle and spin go on as they were.
  const BodyState &before = motion.start(), &before_low = motion.start_low();
  const double alpha = motion.acceleration().angular;
  const Real omega = static_cast<Real>(before.twist.omega) + before_low.twist.omega;
  const Real angle = static_cast<Real>(before.pose.angle) + before_low.pose.angle;
  const Real since = static_cast<Real>(time) - motion.origin();
  split(angle + since * (omega + Real(0.5) * since * alpha), s.pose.angle, low.pose.angle);
  split(omega + since * alpha, s.twist.omega, low.twist.omega);
  return start;
}

/// Sum of the speeds at a disc's edge.
double speed_of(const DiscRebound::Start& s, const Moving& before, double radius) {
  return static_cast<double>(std::abs(before.vx) + std::abs(before.vy)) +
         std::abs(s.state.twist.omega) * radius;
}

}  // namespace

/// With d = x_a - x_b and w = v_a - v_b at `time`:
///   delay   (|d| - r_a - r_b - level) / closing,  closing = -d.w / |d|
///   n       d / |d| after that delay
///   p       -(1 + e) n.w / (1 / m_a + 1 / m_b)
///   after   v_a + p n / m_a  and  v_b - p n / m_b
/// Accelerations are the same before and after, so the velocities of `time` change by as much as those of the
/// moment of contact.
std::optional<DiscRebound> rebound(const DiscSide& a, const DiscSide& b, const Vec2& shift, double time,
                                   double latest, double level, double restitution) {
  const Moving disc_a(*a.motion, time), disc_b(*b.motion, time);
  Real dx = disc_a.x - (disc_b.x + shift.x()), dy = disc_a.y - (disc_b.y + shift.y());
  const Real wx = disc_a.vx - disc_b.vx, wy = disc_a.vy - disc_b.vy;
  Real length = std::sqrt(dx * dx + dy * dy);
  const Real closing = -(dx * wx + dy * wy) / length;
  if (!(closing > 0) || !(a.inverse_mass + b.inverse_mass > 0.0)) return std::nullopt;
  DiscRebound r;
  // To first order, as in the general response: the delay is a few ticks of the clock, and what an
  // acceleration adds to the way goes with their square.
  r.delay = std::clamp((length - b.radius - a.radius - level) / closing, Real(-latest), Real(latest));
  // relative motion to first order: accelerations come in with the rate, below
  dx += r.delay * wx;
  dy += r.delay * wy;
  length = std::sqrt(dx * dx + dy * dy);
  r.gap = static_cast<double>(length - b.radius - a.radius);
  const Real nx = dx / length, ny = dy / length;
  const Real rate =
      nx * (wx + r.delay * (disc_a.ax - disc_b.ax)) + ny * (wy + r.delay * (disc_a.ay - disc_b.ay));
  // turned round within the delay: no impulse is due
  if (!(rate < 0)) return std::nullopt;
  // The rate is that of the moment of contact, and -restitution times it the one after.
  const Real impulse = -(Real(1) + restitution) * rate / (static_cast<Real>(a.inverse_mass) + b.inverse_mass);
  r.impulse = static_cast<double>(impulse);
  const Real push_a = a.inverse_mass * impulse, push_b = b.inverse_mass * impulse;
  r.a = start_after(*a.motion, time, disc_a, disc_a.vx + push_a * nx, disc_a.vy + push_a * ny, r.delay);
  r.b = start_after(*b.motion, time, disc_b, disc_b.vx - push_b * nx, disc_b.vy - push_b * ny, r.delay);
  r.magnitude = std::max(speed_of(r.a, disc_a, a.radius), speed_of(r.b, disc_b, b.radius));
  return r;
}

/// As above with 1 / m_b = 0 and v_b = 0; the gap is the distance from the wall's middle line, less half its
/// thickness and the disc's radius.
std::optional<DiscRebound> rebound(const DiscSide& disc, const WallSide& wall, double time, double latest,
                                   double level, double restitution) {
  const Moving at(*disc.motion, time);
  const Real tx = wall.end.x() - wall.begin.x(), ty = wall.end.y() - wall.begin.y();
  const Real dx = at.x - wall.begin.x(), dy = at.y - wall.begin.y();
  const Real length2 = tx * tx + ty * ty, along = dx * tx + dy * ty;
  // 0 and length^2 are the ends: beyond them an end is nearest
  if (!(along > 0) || !(along < length2)) return std::nullopt;
  // The wall's normal is (ty, -tx) / length or its opposite: the one that points to the disc.
  const Real length = std::sqrt(length2), side = ty * wall.normal.x() - tx * wall.normal.y() < 0 ? -1 : 1;
  const Real nx = side * ty / length, ny = -side * tx / length;
  // Abreast, but met with a normal that is not the wall's: the contact is with an end, to rounding.
  if (nx * wall.normal.x() + ny * wall.normal.y() < kSameDirection) return std::nullopt;
  const Real closing = -(nx * at.vx + ny * at.vy);
  if (!(closing > 0)) return std::nullopt;
  DiscRebound r;
  const Real gap = nx * dx + ny * dy - wall.radius - disc.radius;
  // its normal is the same wherever the disc is abreast of it: nothing is looked at again after the delay
  r.delay = std::clamp((gap - level) / closing, Real(-latest), Real(latest));
  r.gap = static_cast<double>(gap - r.delay * closing);
  const Real rate = -closing + r.delay * (nx * at.ax + ny * at.ay);
  if (!(rate < 0)) return std::nullopt;
  const Real change = -(Real(1) + restitution) * rate;
  r.impulse = static_cast<double>(change / disc.inverse_mass);
  r.a = start_after(*disc.motion, time, at, at.vx + change * nx, at.vy + change * ny, r.delay);
  r.magnitude = speed_of(r.a, at, disc.radius);
  return r;
}

}  // namespace brink
