#pragma once
/// Bounding discs in free flight: cheap, certified bounds on when two can meet at all.

#include <algorithm>
#include <array>
#include <cmath>

#include "brink/core/base/geometry.h"
#include "brink/core/base/limits.h"
#include "brink/scheduler/broad_phase/cell_grid.h"
#include "brink/scheduler/broad_phase/tolerances.h"

namespace brink {

/// A bounding disc about a body's centre on its parabola, all under the same gravity; one cache line.
struct alignas(64) Flight {
  double x = 0.0, y = 0.0;    ///< place at `start` [m]; x is no number where it is not free
  double vx = 0.0, vy = 0.0;  ///< velocity at `start` [m/s]
  double start = 0.0;         ///< [s]
  double radius = 0.0;        ///< [m]
  Cell cell;
  int next = -1;              ///< in the list of its cell
  unsigned version : 29 = 0;  ///< raised when the motion changes
  unsigned free : 1 = 0;      ///< a parabola under the common gravity for ever
  unsigned plain : 1 = 0;     ///< a disc of which nothing is locked: collisions go the quick way
  unsigned disc : 1 = 0;      ///< the bounding disc is the body; the line's last bit, for FlightBatch

  /// Size of the numbers from which the place after s is computed [m].
  double magnitude(double s) const {
    return std::abs(x) + std::abs(y) + std::abs(s) * (std::abs(vx) + std::abs(vy));
  }
};

/// A span of time in which two outlines may touch; never: begin = infinity.
struct MeetingTimes {
  double begin = kForever;
  double end = kForever;
};

/// A flight seen from the present: where its centre is now.
struct Course {
  Vec2 place, velocity, gravity;
  double rounding;        ///< of the place [m]
  double speed_rounding;  ///< of the velocity [m/s]
  double radius;          ///< with that of the place
  bool disc;

  Course(const Flight& f, const Vec2& g, double now) : gravity(g), disc(f.disc) {
    const double s = now - f.start;
    place = Vec2(f.x + s * (f.vx + 0.5 * s * g.x()), f.y + s * (f.vy + 0.5 * s * g.y()));
    velocity = Vec2(f.vx + s * g.x(), f.vy + s * g.y());
    const double ways = s * s * g.lpNorm<1>();
    rounding = kFlightRounding * (f.magnitude(s) + ways);
    speed_rounding = velocity_rounding(f.vx, f.vy, s * g.x(), s * g.y());
    radius = f.radius * (1.0 + kFlightMargin) + rounding;
  }
  /// Of the sum of a velocity and of what gravity adds to it [m/s]: none where it adds nothing.
  static double velocity_rounding(double vx, double vy, double gx, double gy) {
    const double pull = std::abs(gx) + std::abs(gy);
    return pull == 0.0 ? 0.0 : kFlightRounding * (std::abs(vx) + std::abs(vy) + pull);
  }
  void displace(const Vec2& by) { place += by; }
  Vec2 after(double s) const { return place + s * (velocity + 0.5 * s * gravity); }
};

/// When the discs of two flights overlap, from `now` on: of a, seen from now, and of b moved by `shift`. Two
/// bare discs that recede never meet, where rounding cannot be all of it. About 50 flops, two divisions and a root; `early`:
/// most that never meet cost half, else all the same, without a branch, so that several are compared at once (FlightBatch).
template <bool early>
inline MeetingTimes meeting(const Course& a, double bx, double by, double bvx, double bvy, double b_start,
                            double b_radius, bool b_disc, double shift_x, double shift_y, double now) {
  const double s = now - b_start, gx = s * a.gravity.x(), gy = s * a.gravity.y();
  const double dx = a.place.x() - shift_x - (bx + s * (bvx + 0.5 * gx));
  const double dy = a.place.y() - shift_y - (by + s * (bvy + 0.5 * gy));
  const double wx = a.velocity.x() - (bvx + gx), wy = a.velocity.y() - (bvy + gy);
  const double approach = dx * wx + dy * wy;  // half the rate of the squared distance
  const double way = std::abs(s) * (std::abs(bvx) + std::abs(bvy));
  const double magnitude = std::abs(bx) + std::abs(by) + way;
  const double rounding = kFlightRounding * (magnitude + std::abs(s) * (std::abs(gx) + std::abs(gy)));
  const double approach_rounding =
      (a.rounding + rounding) * (std::abs(wx) + std::abs(wy)) +
      (a.speed_rounding + Course::velocity_rounding(bvx, bvy, gx, gy)) * (std::abs(dx) + std::abs(dy));
  const bool recedes = (approach >= approach_rounding) & a.disc & b_disc;
  if (early && recedes) return {};
  const double reach = a.radius + b_radius * (1.0 + kFlightMargin) + rounding;
  const double distance2 = dx * dx + dy * dy, beyond = distance2 - reach * reach;
  const double speed2 = wx * wx + wy * wy, offset = dx * wy - dy * wx;
  const double square = speed2 * reach * reach - offset * offset;  // free of cancellation
  const bool parts = recedes | ((approach >= 0.0) & (beyond > 0.0)), misses = square < 0.0;
  if (early && (parts || misses)) return {};
  const double root = std::sqrt(misses ? 0.0 : square);
  const double wait = beyond <= 0.0 ? 0.0 : beyond / (root - approach);
  // never later than it is, by a rounding of the clock
  const double begin = std::max(now, now + wait - kFlightRounding * (now + wait));
  const double end = speed2 > 0.0 ? now + (root - approach) / speed2 : kForever;
  const bool never = parts | misses;
  return {never ? kForever : begin, never ? kForever : end};
}
inline MeetingTimes meeting(const Course& a, const Flight& b, const Vec2& shift, double now) {
  return meeting<true>(a, b.x, b.y, b.vx, b.vy, b.start, b.radius, b.disc, shift.x(), shift.y(), now);
}

/// Times s >= 0, ascending, at which p + s (v + s a / 2) == 0; infinity where there are fewer than two.
inline std::array<double, 2> zeros(double p, double v, double a) {
  std::array<double, 2> s{kForever, kForever};
  if (a == 0.0) {
    if (v != 0.0) s[0] = -p / v;
  } else {
    const double discriminant = v * v - 2.0 * a * p;
    if (discriminant < 0.0) return s;
    const double q = -(v + std::copysign(std::sqrt(discriminant), v));  // free of cancellation
    if (q == 0.0) {
      s[0] = 0.0;
    } else {
      s[0] = q / a;
      s[1] = 2.0 * p / q;
    }
  }
  for (double& x : s)
    if (!(x >= 0.0)) x = kForever;
  if (s[1] < s[0]) std::swap(s[0], s[1]);
  return s;
}

/// stay_in() of a course without gravity: to the edge ahead along either axis, both at once and without a branch, as nobody
/// can tell which way it goes. At rest along an axis it is infinite, or no number, which is no minimum.
inline double straight_stay_in(const Box& box, const Course& c) {
  using Two = double __attribute__((vector_size(16)));
  const Two v = Two{c.velocity.x(), c.velocity.y()} + 0.0;
  const Two high{box.high.x(), box.high.y()}, low{box.low.x(), box.low.y()};
  const Two stay = ((v >= 0.0 ? high : low) - Two{c.place.x(), c.place.y()}) / v;
  return std::min(std::min(kForever, stay[0]), stay[1]);
}

/// How long from now the centre stays in the box; infinity: for ever. @pre it is in it.
inline double stay_in(const Box& box, const Course& c) {
  if (c.gravity.isZero(0.0)) return straight_stay_in(box, c);
  double stay = kForever;
  for (int axis = 0; axis < 2; ++axis) {
    if (c.gravity[axis] == 0.0) {  // straight on, to the edge ahead
      const double v = c.velocity[axis] + 0.0;
      stay =
          std::min(stay, std::max((box.high[axis] - c.place[axis]) / v, (box.low[axis] - c.place[axis]) / v));
      continue;
    }
    for (const double edge : {box.low[axis], box.high[axis]}) {
      if (!std::isfinite(edge)) continue;
      const auto s = zeros(c.place[axis] - edge, c.velocity[axis], c.gravity[axis]);
      const bool outward = edge == box.high[axis] ? c.velocity[axis] > 0.0 : c.velocity[axis] < 0.0;
      // on the edge and going in, the root at 0 is no exit
      stay = std::min(stay, s[0] == 0.0 && !outward ? s[1] : s[0]);
    }
  }
  return stay;
}

/// time_to() of a course without gravity that begins outside: the first edge that it meets beside the box. All four are
/// computed, without a branch, as nobody can tell ahead which it is.
inline double straight_time_to(const Box& box, const Course& c, double margin) {
  double first = kForever;
  for (int axis = 0; axis < 2; ++axis)
    for (const double edge : {box.low[axis], box.high[axis]}) {
      // no number, or infinite, where it moves along the edge
      const double s = (edge - c.place[axis]) / c.velocity[axis];
      const double across = c.place[1 - axis] + s * c.velocity[1 - axis];
      const bool ahead = s >= 0.0, above = across >= box.low[1 - axis] - margin,
                 below = across <= box.high[1 - axis] + margin;
      const bool meets = ahead & above & below;
      first = std::min(first, meets ? s : kForever);
    }
  return first;
}

/// How long from now until the centre can be in the box; infinity: never.
inline double time_to(const Box& box, const Course& c) {
  if (box.contains(c.place)) return 0.0;
  const double margin = kFlightMargin * (box.extent().lpNorm<1>() + c.place.lpNorm<1>());
  if (c.gravity.isZero(0.0)) return straight_time_to(box, c, margin);
  double first = kForever;
  for (int axis = 0; axis < 2; ++axis)
    for (const double edge : {box.low[axis], box.high[axis]})
      for (const double s : zeros(c.place[axis] - edge, c.velocity[axis], c.gravity[axis])) {
        if (s >= first) continue;
        const double across = c.after(s)[1 - axis];
        if (across >= box.low[1 - axis] - margin && across <= box.high[1 - axis] + margin) first = s;
      }
  return first;
}

}  // namespace brink
