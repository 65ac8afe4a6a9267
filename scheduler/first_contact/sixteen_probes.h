#pragma once
/// A canonical time (canonical_time.h) of a gap that several times can be asked for at once: all probes of four halvings are
/// taken side by side.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "brink/core/base/wide.h"
#include "brink/scheduler/first_contact/canonical_time.h"

namespace brink {

/// A distance, or what grows with it, at sixteen times, 2^spacing doubles from one to the next.
struct SixteenProbes {
  std::uint64_t first = 0;  ///< bits of the first time, which is >= 0 [s]
  unsigned spacing = 0;     ///< log2 of doubles
  alignas(sizeof(Four)) double measure[16];
  unsigned clear;  ///< bit i: at the i-th time it is more than the limit

  double time(unsigned i) const { return std::bit_cast<double>(first + (std::uint64_t{i} << spacing)); }

  /// Takes them all: measure_at(four times, their measures). To be called by functions that are BRINK_WIDE.
  template <class MeasureAt>
  [[gnu::always_inline]] void take(MeasureAt&& measure_at, double limit) {
    using FourBits = std::int64_t __attribute__((vector_size(32), may_alias));
    FourBits times = static_cast<std::int64_t>(first) + (FourBits{0, 1, 2, 3} << spacing), all{};
    for (int k = 0; k < 4; ++k) {
      Four measures;
      measure_at(reinterpret_cast<const Four&>(times), measures);
      reinterpret_cast<Four&>(measure[4 * k]) = measures;
      all |= (measures > limit) & (FourBits{1, 2, 4, 8} << 4 * k);
      times += FourBits{4, 4, 4, 4} << spacing;
    }
    clear = static_cast<unsigned>((all[0] | all[1]) | (all[2] | all[3]));
  }

  /// Where a bisection of the first `places`, a power of two, ends: the last of them that is clear, if all before are and no
  /// other is. The first is not asked, as it is the lower end.
  unsigned last_clear(unsigned places) const {
    const unsigned within = clear & ((1U << places) - 1U);
    unsigned place = 0;
    for (const unsigned half : {8U, 4U, 2U, 1U}) place += (within >> (place + half) & 1U) * half;
    return place;
  }
};

/// The greatest double whose root, rounded, is no more than `root`: a distance is more if and only if its square is more than
/// this. Takes a step or two. @pre root > 0, finite.
inline double greatest_square_within(double root) {
  double square = root * root;
  while (std::sqrt(square) > root) square = last_before(square);
  while (std::sqrt(next_after(square)) <= root) square = next_after(square);
  return square;
}

/// A time and what the distance is then [m].
struct ClearTime {
  double time, distance;
};

/// last_clear_time() of a distance less `reach`, near its root t; false: the ends are not sure to be clear, and not, closer
/// than twice the rounding, or they are not after `begin`. take(probes) takes probes, and distance_of(measure) is the distance.
/// `rounding`: of the gap [m]; `closing`: its speed [m/s]. Cost: sixteen distances once, or once more for every four bits that its rounding spans on the
/// clock.
///
/// A probe is the time with most trailing zeros between the ends. So four halvings ask for no others than sixteen places in a
/// row, where the bits of the first have three more zeros than their spacing asks for.
template <class Take, class DistanceOf>
[[gnu::always_inline]] inline bool last_clear_time_by_sixteens(Take&& take, DistanceOf&& distance_of,
                                                               double reach, double t, double begin,
                                                               double rounding, double closing,
                                                               ClearTime& found) {
  // The ends are three places from t, or more: so far that the gap is more than twice its rounding there. Late on the clock
  // these are three doubles, and nothing waits for a division.
  SixteenProbes probes;
  const double by_a_double = closing * ulp(t);  // so far it closes [m]
  if (!(2.25 * rounding < by_a_double)) {
    const double doubles = 2.0 + 2.25 * rounding / by_a_double;
    if (!(doubles < 1e6)) return false;
    probes.spacing = static_cast<unsigned>(std::bit_width(static_cast<unsigned>(doubles / 3.0)));
  }
  const std::uint64_t eight = std::uint64_t{8} << probes.spacing;
  probes.first = (std::bit_cast<std::uint64_t>(t) - eight / 2) & -eight;
  if (!(probes.time(0) > begin)) return false;
  take(probes);
  const double sure = 2.0 * rounding;
  if (!(distance_of(probes.measure[0]) - reach > sure) || !(distance_of(probes.measure[15]) - reach < -sure))
    return false;
  unsigned last = probes.last_clear(16);
  while (probes.spacing > 0) {
    probes.first += std::uint64_t{last} << probes.spacing;
    const unsigned halvings = std::min(probes.spacing, 4U);
    probes.spacing -= halvings;
    take(probes);
    last = probes.last_clear(1U << halvings);  // the others lie beyond the upper end
  }
  found = {probes.time(last), distance_of(probes.measure[last])};
  return true;
}

}  // namespace brink
