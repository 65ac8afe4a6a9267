#include "brink/core/base/extended.h"

#include <limits>
#include <tuple>
#include <utility>

namespace brink {

namespace {

/// A quarter of a turn in three parts: so many times the first two are exact (Cody & Waite 1980).
constexpr Real kQuarter[] = {0x1.921fb544p+0L, 0x1.0b4611a6p-34L, 2.02226624879595073239968462009475772e-21L};
constexpr int kBits = 33;  ///< of each of the first two
constexpr Real kMostQuarters = Real(1ULL << (std::numeric_limits<Real>::digits - kBits - 1));

}  // namespace

ExtendedRotation::ExtendedRotation(Real angle) {
  if (angle == 0) return;
  const Real quarters = std::rint(angle * (2 / std::numbers::pi_v<Real>));
  const bool few = std::abs(quarters) < kMostQuarters;
  const Real rest =
      few ? ((angle - quarters * kQuarter[0]) - quarters * kQuarter[1]) - quarters * kQuarter[2] : angle;
  cosine = std::cos(rest);
  sine = std::sin(rest);
  if (!few) return;
  const auto quarter = static_cast<long long>(quarters);
  if (quarter & 1) std::tie(cosine, sine) = std::pair(-sine, cosine);
  if (quarter & 2) cosine = -cosine, sine = -sine;
}

}  // namespace brink
