#include "brink/core/base/extended.h"

#include <limits>
#include <tuple>
#include <utility>

namespace brink {

namespace {

/// A quarter of a turn in three parts: so many times the first two are exact (Cody & Waite 1980).
constexpr Real kQuarter[] = {0x1.921fb544p+0L, 0x1.0b4611a6p-34L, 2.02226624879595073239968462009475772e-21L};
constexpr int kBits = 33;  ///< of each of the first two
/// Fewer quarters than this, times either of the first two parts, fit into a Real with a bit to spare.
constexpr Real kMostQuarters = Real(1ULL << (std::numeric_limits<Real>::digits - kBits - 1));

}  // namespace

ExtendedRotation::ExtendedRotation(Real angle) {
  if (angle == 0) return;
  // rounding may choose either neighbour near an odd eighth of
  // a turn: `rest` is then an eighth and a rounding
  const Real quarters = std::rint(angle * (2 / std::numbers::pi_v<Real>));
  const bool few = std::abs(quarters) < kMostQuarters;
  // in this order: the first difference is exact (its two numbers are within
  // a factor of two of each other: Sterbenz), and the parts added up first
  // would be pi / 2 rounded, an error that every quarter adds
  const Real rest =
      few ? ((angle - quarters * kQuarter[0]) - quarters * kQuarter[1]) - quarters * kQuarter[2] : angle;
  cosine = std::cos(rest);
  sine = std::sin(rest);
  if (!few) return;
  const auto quarter = static_cast<long long>(quarters);
  // in two's complement the lowest bits tell the quadrant of negative numbers too
  if (quarter & 1) std::tie(cosine, sine) = std::pair(-sine, cosine);
  if (quarter & 2) cosine = -cosine, sine = -sine;
}

}  // namespace brink
