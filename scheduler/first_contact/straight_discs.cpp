#include "brink/scheduler/first_contact/straight_discs.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/sixteen_probes.h"
#include "brink/scheduler/first_contact/straight_way.h"
#include "brink/scheduler/first_contact/tolerances.h"

namespace brink {

namespace {

BRINK_WIDE void take(const StraightWay& way_a, const StraightWay& way_b, double reach,
                     SixteenProbes& probes) {
  const StraightWay a = way_a, b = way_b;  // nothing that is written is read by them
  const auto distance_at = [&](const Four& t, Four& distance) __attribute__((always_inline)) {
    const Four s_a = t - a.origin, s_b = t - b.origin;
    const Four x = (a.x + s_a * a.vx) - (b.x + s_b * b.vx), y = (a.y + s_a * a.vy) - (b.y + s_b * b.vy);
    const Four square = x * x + y * y;
    distance = Four{std::sqrt(square[0]), std::sqrt(square[1]), std::sqrt(square[2]), std::sqrt(square[3])};
  };
  probes.take(distance_at, reach);
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
  if (!(in_time & is_slow & (closing > 16.0 * noise) & is_near)) return false;
  const double rounding = place_noise + 8.0 * kRoundoff * (std::abs(dx + s * wx) + std::abs(dy + s * wy));
  ClearTime met;
  const auto take_both = [&](SixteenProbes& probes) { take(way_a, way_b, reach, probes); };
  if (!last_clear_time_by_sixteens(take_both, reach, t, std::max(reference, 0.0), rounding, closing, met) ||
      met.time > to)
    return false;
  contact = {met.time, met.distance - b.radius - a.radius, closing};
  return true;
}

}  // namespace brink
