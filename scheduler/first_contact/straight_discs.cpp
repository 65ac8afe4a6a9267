#include "brink/scheduler/first_contact/straight_discs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "brink/core/base/limits.h"
#include "brink/core/base/wide.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/tolerances.h"

namespace brink {

namespace {

using Bits = std::uint64_t;  ///< of a time >= 0: in the order of times

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

/// Two centres at sixteen times, 2^spacing doubles from one to the next.
struct Looks {
  Bits first;
  unsigned spacing;
  alignas(sizeof(Four)) double distance[16];  ///< [m]
  unsigned clear;  ///< bit i: at the i-th time they are farther apart than they reach

  double time(unsigned i) const { return std::bit_cast<double>(first + (Bits{i} << spacing)); }
};

BRINK_WIDE void take(const StraightWay& way_a, const StraightWay& way_b, double reach, Looks& looks) {
  using FourBits = std::int64_t __attribute__((vector_size(32), may_alias));
  const StraightWay a = way_a, b = way_b;  // nothing that is written below is read by them
  const auto first = static_cast<std::int64_t>(looks.first);
  FourBits time = first + (FourBits{0, 1, 2, 3} << looks.spacing), clear{};
  for (int k = 0; k < 4; ++k) {
    const Four t = reinterpret_cast<const Four&>(time), s_a = t - a.origin, s_b = t - b.origin;
    const Four x = (a.x + s_a * a.vx) - (b.x + s_b * b.vx), y = (a.y + s_a * a.vy) - (b.y + s_b * b.vy);
    const Four square = x * x + y * y;
    const Four distance{std::sqrt(square[0]), std::sqrt(square[1]), std::sqrt(square[2]),
                        std::sqrt(square[3])};
    reinterpret_cast<Four&>(looks.distance[4 * k]) = distance;
    clear |= (distance - reach > Four{}) & (FourBits{1, 2, 4, 8} << 4 * k);
    time += FourBits{4, 4, 4, 4} << looks.spacing;
  }
  looks.clear = static_cast<unsigned>((clear[0] | clear[1]) | (clear[2] | clear[3]));
}

/// Where a bisection of sixteen places ends: the last of them that is clear, if all before are and no other is. The first
/// is not asked, as it is the lower end.
unsigned last_clear_of(unsigned clear) {
  unsigned place = 0;
  for (const unsigned half : {8U, 4U, 2U, 1U}) place += (clear >> (place + half) & 1U) * half;
  return place;
}

/// last_clear_time() of the two, and how far apart they are then, near the root t: all probes of four halvings are looked at
/// side by side. A probe is the time with most trailing zeros between the ends, so it is first the middle of sixteen
/// places of which the first has three zeros more than their spacing asks for. False if the ends are not
/// sure to be clear, and not: closer than twice the rounding, or not after `begin`. `rounding`: of the gap [m]; `closing`: its
/// speed [m/s].
bool meet_last_clear(const StraightWay& a, const StraightWay& b, double reach, double t, double begin,
                     double rounding, double closing, double& time, double& distance) {
  // The ends lie three places from t, or more: so far that the gap is more than its rounding there.
  const double ticks = 2.0 + 3.0 * rounding / (closing * ulp(t));
  if (!(ticks < 1e6)) return false;
  Looks looks;
  looks.spacing = static_cast<unsigned>(std::bit_width(static_cast<unsigned>(ticks / 3.0)));
  const Bits eight = Bits{8} << looks.spacing;
  looks.first = (std::bit_cast<Bits>(t) - eight / 2) & -eight;
  if (!(looks.time(0) > begin)) return false;
  take(a, b, reach, looks);
  const double sure = 2.0 * rounding;
  if (!(looks.distance[0] - reach > sure) || !(looks.distance[15] - reach < -sure)) return false;
  unsigned last = last_clear_of(looks.clear);
  while (looks.spacing > 0) {
    looks.first += Bits{last} << looks.spacing;
    const unsigned halvings = std::min(looks.spacing, 4U);
    looks.spacing -= halvings;
    take(a, b, reach, looks);
    const unsigned within = (1U << (1U << halvings)) - 1U;  // the others lie beyond the upper end
    last = last_clear_of(looks.clear & within);
  }
  time = looks.time(last);
  distance = looks.distance[last];
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
  if (!(in_time & is_slow & (closing > 16.0 * noise) & is_near)) return false;
  const double rounding = place_noise + 8.0 * kRoundoff * (std::abs(dx + s * wx) + std::abs(dy + s * wy));
  double met, far;
  if (!meet_last_clear(way_a, way_b, reach, t, std::max(reference, 0.0), rounding, closing, met, far) ||
      met > to)
    return false;
  contact = {met, far - b.radius - a.radius, closing};
  return true;
}

}  // namespace brink
