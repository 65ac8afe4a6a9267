// Beside sines and cosines of 400 bits (Boost.Multiprecision).
#include "brink/core/base/sine_cosine.h"

#include <gtest/gtest.h>

#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <numbers>
#include <random>
#include <utility>

#include "brink/core/base/sine_cosine_pair.h"

namespace brink::sine_cosine_test {
namespace {

namespace mp = boost::multiprecision;
using Exact = mp::number<mp::cpp_bin_float<400, mp::backends::digit_base_2>>;

Exact exact(const DoubleDouble& x) { return Exact(x.high()) + Exact(x.low()); }

/// Units in the last place of the answer.
double units_off(double found, const Exact& wanted) {
  const double near = static_cast<double>(wanted);
  if (near == 0.0) return found == 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
  const double unit = std::ldexp(1.0, std::ilogb(near) - 52);
  return static_cast<double>(mp::abs(Exact(found) - wanted)) / unit;
}

/// Of an angle in double, in its own last place and in that of 1; and of one with a low part.
void expect_told(double angle, double low) {
  const SineCosine<double> ours = sine_cosine(angle);
  const Exact s = mp::sin(Exact(angle)), c = mp::cos(Exact(angle));
  ASSERT_LE(units_off(ours.sine, s), 1.5) << angle;
  ASSERT_LE(units_off(ours.cosine, c), 1.5) << angle;
  ASSERT_LE(static_cast<double>(mp::abs(Exact(ours.sine) - s)), 0.6 * 0x1p-53) << angle;
  ASSERT_LE(static_cast<double>(mp::abs(Exact(ours.cosine) - c)), 0.6 * 0x1p-53) << angle;
  const DoubleDouble in_two = DoubleDouble::sum(angle, low);
  const SineCosine<DoubleDouble> two = sine_cosine(in_two);
  ASSERT_LE(static_cast<double>(mp::abs(exact(two.sine) - mp::sin(exact(in_two)))), 0x1p-84) << angle;
  ASSERT_LE(static_cast<double>(mp::abs(exact(two.cosine) - mp::cos(exact(in_two)))), 0x1p-84) << angle;
}

TEST(SineCosine, IsRightAtAnyAngle) {
  std::mt19937_64 random(20261124);
  std::uniform_real_distribution<double> magnitude(-12.0, 13.5), part(-1.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const double angle = std::copysign(std::pow(10.0, magnitude(random)), part(random));
    expect_told(angle, angle * 0x1p-54 * part(random));
  }
}

// Of two side by side: small and large ones, at and near quarters of a turn, and none at all.
TEST(SineCosine, OfTwoHasTheBitsOfEach) {
  std::mt19937_64 random(20261129);
  std::uniform_real_distribution<double> magnitude(-12.0, 15.0), part(-1.0, 1.0);
  const double infinity = std::numeric_limits<double>::infinity();
  const auto any = [&]() -> double {
    switch (random() % 8) {
      case 0:
        return std::copysign(0.0, part(random));
      case 1:
        return static_cast<double>(random() % 4000) * (std::numbers::pi / 4) - 1500.0;
      case 2:
        return random() % 16 == 0 ? infinity : 0x1p20 * part(random);
      default:
        return std::copysign(std::pow(10.0, magnitude(random)), part(random));
    }
  };
  const auto bits = [](const SineCosine<double>& of) {
    return std::pair(std::bit_cast<std::uint64_t>(of.sine), std::bit_cast<std::uint64_t>(of.cosine));
  };
  for (int i = 0; i < 200000; ++i) {
    const double a = any(), b = any();
    const SineCosinePair both = sine_cosine(a, b);
    ASSERT_EQ(bits(both.of_a), bits(sine_cosine(a))) << a << " beside " << b;
    ASSERT_EQ(bits(both.of_b), bits(sine_cosine(b))) << b << " beside " << a;
  }
}

// Where a sine or cosine comes to 0, all of the angle's digits and more of pi's are needed.
TEST(SineCosine, IsRightNearEveryQuarterOfATurn) {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<long long> any(-(1LL << 44), 1LL << 44), few(-(1LL << 21), 1LL << 21);
  for (int i = 0; i < 12000; ++i) {
    const long long n = i < 4000 ? i - 2000 : i < 8000 ? few(random) : any(random);
    const double angle = static_cast<double>(n) * (std::numbers::pi / 2);
    expect_told(angle, 0.0);
    expect_told(std::nextafter(angle, 0.0), angle * 0x1p-55);
    expect_told(angle + std::numbers::pi / 4, 0.0);
  }
}

TEST(SineCosine, OfNothingIsExact) {
  for (const double zero : {0.0, -0.0}) {
    EXPECT_EQ(sine_cosine(zero).sine, 0.0);
    EXPECT_EQ(sine_cosine(zero).cosine, 1.0);
    EXPECT_EQ(sine_cosine(DoubleDouble(zero)).sine, 0.0);
    EXPECT_EQ(sine_cosine(DoubleDouble(zero)).cosine, 1.0);
  }
}

TEST(SineCosine, HugeAnglesAreTheLibrarysAndNothingElseIsANumber) {
  for (const double angle : {0x1p45, 1e17, 1e22, 1e300}) {
    EXPECT_NEAR(sine_cosine(angle).sine, std::sin(angle), 1e-15) << angle;
    EXPECT_NEAR(sine_cosine(DoubleDouble(angle)).cosine.high(), std::cos(angle), 1e-15) << angle;
  }
  for (const double none :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(std::isnan(sine_cosine(none).sine));
    EXPECT_TRUE(isnan(sine_cosine(DoubleDouble(none)).cosine));
  }
}

TEST(WithinHalfATurn, TakesWholeTurnsOffAndNothingElse) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> magnitude(-3.0, 13.5), part(-1.0, 1.0);
  for (int i = 0; i < 5000; ++i) {
    const double high = std::copysign(std::pow(10.0, magnitude(random)), part(random));
    const DoubleDouble angle = DoubleDouble::sum(high, high * 0x1p-54 * part(random));
    const DoubleDouble left = within_half_a_turn(angle);
    ASSERT_LE(std::abs(left.high()), std::numbers::pi * (1.0 + 1e-15));
    ASSERT_LE(static_cast<double>(mp::abs(mp::sin(exact(angle)) - mp::sin(exact(left)))), 0x1p-99) << high;
    ASSERT_LE(static_cast<double>(mp::abs(mp::cos(exact(angle)) - mp::cos(exact(left)))), 0x1p-99) << high;
  }
}

}  // namespace
}  // namespace brink::sine_cosine_test
