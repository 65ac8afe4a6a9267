#include "brink/scheduler/first_contact/straight_discs.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/far_way.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/sixteen_probes.h"
#include "brink/scheduler/first_contact/straight_way.h"
#include "brink/scheduler/first_contact/tolerances.h"

namespace brink {

namespace {

// Of distances the squares are compared: nothing waits for their roots.

BRINK_WIDE void take(const StraightWay& way_a, const StraightWay& way_b, double limit,
                     SixteenProbes& probes) {
  const StraightWay a = way_a, b = way_b;  // nothing that is written is read by them
  const auto square_at = [&](const Four& t, Four& square) __attribute__((always_inline)) {
    const Four s_a = t - a.origin, s_b = t - b.origin;
    const Four x = (a.x + s_a * a.vx) - (b.x + s_b * b.vx), y = (a.y + s_a * a.vy) - (b.y + s_b * b.vy);
    square = x * x + y * y;
  };
  probes.take(square_at, limit);
}

BRINK_WIDE void take(const FarWay& way_a, const FarWay& way_b, double limit, SixteenProbes& probes) {
  const FarWay a = way_a, b = way_b;
  const auto square_at = [&](const Four& t, Four& square) __attribute__((always_inline)) {
    Four x, y;
    a.apart(b, t, x, y);
    square = x * x + y * y;
  };
  probes.take(square_at, limit);
}

/// The last time at which two ways are more than `reach` apart, as last_clear_time_by_sixteens() tells it.
template <class Way>
bool last_time_apart(const Way& a, const Way& b, double reach, double t, double begin, double rounding,
                     double closing, ClearTime& found) {
  const double limit = greatest_square_within(reach);
  const auto take_both = [&](SixteenProbes& probes) { take(a, b, limit, probes); };
  const auto root = [](double square) { return std::sqrt(square); };
  return last_clear_time_by_sixteens(take_both, root, reach, t, begin, rounding, closing, found);
}

/// The way from b to a at that time [m].
BRINK_WIDE void apart(const FarWay& a, const FarWay& b, double t, Vec2& way) {
  Four x, y;
  a.apart(b, Four{} + t, x, y);
  way = {x[0], y[0]};
}

/// Where places in doubles do not tell gaps to the contact tolerance by far, all searches see the pair from its own place, in
/// extended precision (PairView::put): so does this. What of straight_discs_meet() does not depend on places has been asked.
/// `noise`: of rates [m/s]. Cost: twice straight_discs_meet().
[[gnu::noinline]] bool far_discs_meet(const DiscMover& a, const DiscMover& b, double from, double to,
                                      const SearchLimits& limits, double noise, DiscContact& contact) {
  const FarWay far_a(*a.motion), far_b(*b.motion);
  const StraightWay way_a(*a.motion), way_b(*b.motion);
  const double reference = std::max(way_a.origin, way_b.origin), reach = b.radius + a.radius;
  if (!far_a.is_plain() || !far_b.is_plain()) return false;
  Vec2 d;
  apart(far_a, far_b, reference, d);
  const Vec2 w(way_a.vx - way_b.vx, way_a.vy - way_b.vy);
  const double approach = -d.dot(w), speed2 = w.squaredNorm(), offset = cross(d, w);
  const double distance = d.norm(), square = speed2 * reach * reach - offset * offset,
               clear = distance - reach;
  // what begins nearer may sink, be it seen from near or far
  if (!(approach > 0.0 && square > 0.0 && clear >= 4.0 * limits.tolerance)) return false;
  const double root = std::sqrt(square), s = clear * (distance + reach) / (approach + root);
  const double t = reference + s, closing = root / reach, speeds = way_a.speed() + way_b.speed();
  if (!(t >= from && t <= to && t >= 0x1p-90 && t <= 0x1p90 && closing > 16.0 * noise)) return false;
  const double place_noise = way_a.noise(t) + way_b.noise(t);
  const double rounding =
      place_noise * (kRealRoundoff / kRoundoff) + 8.0 * kRoundoff * ((d + s * w).lpNorm<1>() + s * speeds);
  if (!(rounding <= kFarOfTolerance * limits.tolerance)) return false;
  // at every probe the pair is as far: each lies within thirty-two times what the gap's rounding and the clock's are worth
  const double probed = 32.0 * (3.0 * rounding / closing + 8.0 * ulp(t));
  const double least = place_noise - 8.0 * kRoundoff * probed * speeds;
  if (!(least > (1.0 + 1e-9) * kFarOfTolerance * limits.tolerance)) return false;
  ClearTime met;
  if (!last_time_apart(far_a, far_b, reach, t, std::max(reference, 0.0), rounding, closing, met) ||
      met.time > to)
    return false;
  contact = {met.time, met.distance - b.radius - a.radius, closing};
  return true;
}

}  // namespace

bool straight_discs_meet(const DiscMover& a, const DiscMover& b, double from, double to,
                         const SearchLimits& limits, DiscContact& contact) {
  if (!a.motion->acceleration().linear.isZero(0.0) || !b.motion->acceleration().linear.isZero(0.0))
    return false;
  const StraightWay way_a(*a.motion), way_b(*b.motion);
  // by an instruction of its own: of std::max() a branch is made here, and which of the two it is cannot be foreseen
  const double reference = Vec2(way_a.origin, way_b.origin).maxCoeff(), reach = b.radius + a.radius;
  const double dx = way_a.x_at(reference) - way_b.x_at(reference),
               dy = way_a.y_at(reference) - way_b.y_at(reference);
  const double wx = way_a.vx - way_b.vx, wy = way_a.vy - way_b.vy;
  const double approach = -(dx * wx + dy * wy), speed2 = wx * wx + wy * wy, offset = dx * wy - dy * wx;
  const double distance = std::sqrt(dx * dx + dy * dy), square = speed2 * reach * reach - offset * offset;
  const double apart = distance - reach;
  if (!((reach > 0.0) & (approach > 0.0) & (square > 0.0) & (apart >= limits.tolerance))) return false;
  const double root = std::sqrt(square), s = apart * (distance + reach) / (approach + root);
  const double t = reference + s, closing = root / reach;
  const double noise =
      a.velocity_rounding + b.velocity_rounding + 16.0 * kEpsilon * (way_a.speed() + way_b.speed());
  const double place_noise = way_a.noise(t) + way_b.noise(t);
  const double instant = same_instant(t), slow = 0.5 * kSlowOfSize * smallest_radius(a.radius, b.radius);
  const bool in_time = (t >= from) & (t <= to), is_slow = speed2 * instant * instant <= slow * slow,
             is_near = place_noise <= kFarOfTolerance * limits.tolerance;
  if (!(in_time & is_slow & (closing > 16.0 * noise))) return false;
  if (!is_near) return far_discs_meet(a, b, from, to, limits, noise, contact);
  const double rounding = place_noise + 8.0 * kRoundoff * (std::abs(dx + s * wx) + std::abs(dy + s * wy));
  ClearTime met;
  if (!last_time_apart(way_a, way_b, reach, t, std::max(reference, 0.0), rounding, closing, met) ||
      met.time > to)
    return false;
  contact = {met.time, met.distance - b.radius - a.radius, closing};
  return true;
}

}  // namespace brink
