#include "brink/core/base/extended.h"

#include <gtest/gtest.h>

#include <random>

namespace brink {
namespace {

/// The library's own functions, whatever the number of turns.
void expect_is_rotation_by(Real angle) {
  const ExtendedRotation r(angle);
  constexpr Real rounding = 4 * std::numeric_limits<Real>::epsilon();
  EXPECT_LE(std::abs(r.cosine - std::cos(angle)), rounding) << static_cast<double>(angle);
  EXPECT_LE(std::abs(r.sine - std::sin(angle)), rounding) << static_cast<double>(angle);
}

TEST(ExtendedRotation, IsThatOfTheLibraryAtAnyAngle) {
  std::mt19937_64 random(20261123);
  std::uniform_real_distribution<double> magnitude(-12.0, 14.0), low(-1.0, 1.0);
  for (int i = 0; i < 100000; ++i) {
    const double high = std::copysign(std::pow(10.0, magnitude(random)), low(random));
    expect_is_rotation_by(high + Real(high) * 0x1p-54L * low(random));
  }
}

TEST(ExtendedRotation, IsExactNearEveryQuarterOfATurn) {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<long long> quarters(-(1LL << 30), 1LL << 30);
  for (int i = 0; i < 100000; ++i) {
    const long long n = i < 1000 ? i - 500 : quarters(random);
    const Real angle = n * (std::numbers::pi_v<Real> / 2);
    expect_is_rotation_by(angle);
    expect_is_rotation_by(std::nextafter(angle, Real(0)));
    expect_is_rotation_by(static_cast<double>(angle));
  }
}

TEST(ExtendedRotation, ByNothingIsNone) {
  EXPECT_EQ(ExtendedRotation(0).cosine, 1);
  EXPECT_EQ(ExtendedRotation(0).sine, 0);
  EXPECT_EQ(ExtendedRotation(0) * RealVec(2, 3), RealVec(2, 3));
}

}  // namespace
}  // namespace brink
