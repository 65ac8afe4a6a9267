#pragma once
/// Times that depend on a function alone, not on where a search for them was begun.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace brink {

/// The next double above t. @pre 0 <= t, finite.
inline double next_after(double t) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(t + 0.0) + 1);
}

/// The last double below t. @pre 0 < t.
inline double last_before(double t) { return std::bit_cast<double>(std::bit_cast<std::uint64_t>(t) - 1); }

/// Distance to the next double above |t|. @pre finite.
inline double ulp(double t) { return next_after(std::abs(t)) - std::abs(t); }

/// Times closer than this [s] are one instant: contacts that are simultaneous in exact arithmetic differ by
/// roundings.
inline double same_instant(double t) {
  return 32.0 * std::numeric_limits<double>::epsilon() * std::max(1.0, std::abs(t));
}

/// The coarsest dyadic double strictly between low and high: the one with most trailing zero bits. Bisecting
/// with it visits the same probes from every starting interval. @pre 0 <= low < high; returns low if nothing
/// lies between.
inline double coarsest_between(double low, double high) {
  const auto l = std::bit_cast<std::uint64_t>(low + 0.0), last = std::bit_cast<std::uint64_t>(high) - 1;
  if (last <= l) return low;
  // below the highest bit in which they differ, `last` may be cleared and is still above l
  const int k = 63 - std::countl_zero(l ^ last);
  return std::bit_cast<double>(last >> k << k);
}

/// The last double at which `gap` is still > 0, by bisection on dyadic probes. @pre gap(low) > 0 >=
/// gap(high), both beyond rounding noise if the answer is to be canonical; 0 <= low < high.
template <class Gap>
double last_clear_time(Gap&& gap, double low, double high) {
  for (;;) {
    const double probe = coarsest_between(low, high);
    if (probe == low) return low;
    const bool clear = gap(probe) > 0.0;  // two selects: the sign cannot be predicted
    low = clear ? probe : low;
    high = clear ? high : probe;
  }
}

/// The same of a gap that costs little: with every probe the two of which one comes next, so that a processor computes
/// all three side by side. The one branch is whether there is another round: where nothing lies between, a probe is the
/// lower end, which is clear.
template <class Gap>
double last_clear_time_by_threes(Gap&& gap, double low, double high) {
  using Bits = std::uint64_t;
  const auto between = [](Bits l, Bits h) {  // coarsest_between(), and l where nothing lies between
    const int k = 63 - std::countl_zero((l ^ (h - 1)) | 1U);
    return (h - 1) >> k << k;
  };
  // as masks, all bits or none: of a choice between two a compiler makes a branch, and computes the one alone
  const auto is_clear = [&](Bits probe) {
    return -static_cast<Bits>(gap(std::bit_cast<double>(probe)) > 0.0);
  };
  const auto chosen = [](Bits first, Bits a, Bits b) { return b ^ ((a ^ b) & first); };
  Bits l = std::bit_cast<Bits>(low + 0.0), h = std::bit_cast<Bits>(high);
  while (h - l > 1) {
    const Bits probe = between(l, h), before = between(l, probe), after = between(probe, h);
    const Bits clear = is_clear(probe), clear_before = is_clear(before), clear_after = is_clear(after);
    l = chosen(clear, probe, l);
    h = chosen(clear, h, probe);
    const Bits next = chosen(clear, after, before), next_clear = chosen(clear, clear_after, clear_before);
    l = chosen(next_clear, next, l);
    h = chosen(next_clear, h, next);
  }
  return std::bit_cast<double>(l);
}

}  // namespace brink
