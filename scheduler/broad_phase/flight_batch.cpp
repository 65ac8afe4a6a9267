#include "brink/scheduler/broad_phase/flight_batch.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace brink {

namespace {

// A flight is two rows: x, y, vx, vy; and start, radius, the cell, and what ends with the bit `disc`.
static_assert(sizeof(Flight) == 2 * sizeof(Four) && offsetof(Flight, x) == 0 && offsetof(Flight, y) == 8 &&
              offsetof(Flight, vx) == 16 && offsetof(Flight, vy) == 24 && offsetof(Flight, start) == 32 &&
              offsetof(Flight, radius) == 40 && std::endian::native == std::endian::little);

using FourBits = std::int64_t __attribute__((vector_size(32)));

#define BRINK_INLINE [[gnu::always_inline]] inline

BRINK_INLINE void all_alike(double of, Four& to) { to = Four{of, of, of, of}; }
BRINK_INLINE void size_of(const Four& of, Four& to) {
  constexpr std::int64_t rest = std::numeric_limits<std::int64_t>::max();  // all but the sign
  to = reinterpret_cast<Four>(reinterpret_cast<FourBits>(of) & FourBits{rest, rest, rest, rest});
}
BRINK_INLINE void root_of(const Four& of, Four& to) {
  to = Four{std::sqrt(of[0]), std::sqrt(of[1]), std::sqrt(of[2]), std::sqrt(of[3])};
}

/// Four flights side by side.
struct FourFlights {
  Four x, y, vx, vy, start, radius;
  FourBits last;  ///< of each line: below 0 of a disc

  BRINK_INLINE FourFlights(const Flight& a, const Flight& b, const Flight& c, const Flight& d) {
    const auto row = [](const double& first) __attribute__((always_inline))->const Four& {
      return reinterpret_cast<const Four&>(first);
    };
    // rows become columns, in registers
    const Four even_ab = __builtin_shufflevector(row(a.x), row(b.x), 0, 4, 2, 6),
               odd_ab = __builtin_shufflevector(row(a.x), row(b.x), 1, 5, 3, 7),
               even_cd = __builtin_shufflevector(row(c.x), row(d.x), 0, 4, 2, 6),
               odd_cd = __builtin_shufflevector(row(c.x), row(d.x), 1, 5, 3, 7);
    x = __builtin_shufflevector(even_ab, even_cd, 0, 1, 4, 5);
    y = __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 4, 5);
    vx = __builtin_shufflevector(even_ab, even_cd, 2, 3, 6, 7);
    vy = __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 6, 7);
    const Four starts_ab = __builtin_shufflevector(row(a.start), row(b.start), 0, 4, 2, 6),
               rests_ab = __builtin_shufflevector(row(a.start), row(b.start), 1, 5, 3, 7),
               starts_cd = __builtin_shufflevector(row(c.start), row(d.start), 0, 4, 2, 6),
               rests_cd = __builtin_shufflevector(row(c.start), row(d.start), 1, 5, 3, 7);
    start = __builtin_shufflevector(starts_ab, starts_cd, 0, 1, 4, 5);
    radius = __builtin_shufflevector(rests_ab, rests_cd, 0, 1, 4, 5);
    last = reinterpret_cast<FourBits>(__builtin_shufflevector(rests_ab, rests_cd, 2, 3, 6, 7));
  }
};

/// meeting<false>(), four times: the same operations in the same order. Without gravity nothing is added where that adds 0.
template <bool kFall>
BRINK_INLINE void begin_of(const Course& a, double now, const FourFlights& b, Four& begin) {
  const Four s = now - b.start;
  Four gx{}, gy{};
  if constexpr (kFall) {
    gx = s * a.gravity.x();
    gy = s * a.gravity.y();
  }
  const Four dx = a.place.x() - (b.x + s * (kFall ? b.vx + 0.5 * gx : b.vx)),
             dy = a.place.y() - (b.y + s * (kFall ? b.vy + 0.5 * gy : b.vy));
  const Four wx = a.velocity.x() - (kFall ? b.vx + gx : b.vx),
             wy = a.velocity.y() - (kFall ? b.vy + gy : b.vy);
  const Four approach = dx * wx + dy * wy;
  Four since, speed_x, speed_y, far_x, far_y, pull_x, pull_y, across_x, across_y, apart_x, apart_y, root;
  size_of(s, since);
  size_of(b.vx, speed_x);
  size_of(b.vy, speed_y);
  size_of(b.x, far_x);
  size_of(b.y, far_y);
  size_of(gx, pull_x);
  size_of(gy, pull_y);
  size_of(wx, across_x);
  size_of(wy, across_y);
  size_of(dx, apart_x);
  size_of(dy, apart_y);
  const Four magnitude = far_x + far_y + since * (speed_x + speed_y);
  const Four rounding = kFlightRounding * (kFall ? magnitude + since * (pull_x + pull_y) : magnitude);
  Four approach_rounding = (a.rounding + rounding) * (across_x + across_y);
  if constexpr (kFall) {
    const Four pull = pull_x + pull_y;
    const Four of_speed = pull == Four{} ? Four{} : kFlightRounding * (speed_x + speed_y + pull);
    approach_rounding += (a.speed_rounding + of_speed) * (apart_x + apart_y);
  }
  const Four reach = a.radius + b.radius * (1.0 + kFlightMargin) + rounding;
  const Four beyond = dx * dx + dy * dy - reach * reach;
  const Four speed2 = wx * wx + wy * wy, offset = dx * wy - dy * wx;
  const Four square = speed2 * reach * reach - offset * offset;
  constexpr Four none{};
  const std::int64_t all = a.disc ? -1 : 0;
  const FourBits misses = square < none, disc{all, all, all, all};
  const FourBits parts = ((approach >= approach_rounding) & disc & (b.last < FourBits{})) |
                         ((approach >= none) & (beyond > none));
  root_of(misses ? none : square, root);
  const Four wait = beyond <= none ? none : beyond / (root - approach);
  const Four earliest = now + wait - kFlightRounding * (now + wait);
  Four never, at_once;
  all_alike(kForever, never);
  all_alike(now, at_once);
  begin = (parts | misses) ? never : (at_once < earliest ? earliest : at_once);
}

/// Bit i: the i-th of `bodies` may be met before `end`; `begins`: when at the soonest.
template <bool kFall>
BRINK_INLINE unsigned met_of(const int* bodies, int count, const Flight* flights, const Course& course,
                             double now, double before, double* begins) {
  const Course a = course;  // nothing that is written below is read by it
  Four end;
  all_alike(before, end);
  FourBits met{};
  for (int i = 0; i < count; i += 4) {
    const int* const of = bodies + i;
    const FourFlights b(flights[of[0]], flights[of[1]], flights[of[2]], flights[of[3]]);
    Four begin;
    begin_of<kFall>(a, now, b, begin);
    reinterpret_cast<Four&>(begins[i]) = begin;
    met |= ((begin < end) & FourBits{1, 2, 4, 8}) << i;
  }
  return static_cast<unsigned>((met[0] | met[1]) | (met[2] | met[3]));
}

#undef BRINK_INLINE

}  // namespace

BRINK_WIDE unsigned FlightBatch::meet(int count, const Flight* flights, const Course& a, double now,
                                      double before) {
  // the last four are whole: somebody in the place of who is not there
  for (int i = 0; i < 3; ++i) bodies_[count + i] = bodies_[0];
  const bool fall = a.gravity.x() != 0.0 || a.gravity.y() != 0.0;
  const unsigned met = fall ? met_of<true>(bodies_, count, flights, a, now, before, begin_)
                            : met_of<false>(bodies_, count, flights, a, now, before, begin_);
  return met & ((1U << count) - 1U);
}

}  // namespace brink
