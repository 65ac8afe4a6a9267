// Beside functions of 400 bits (Boost.Multiprecision).
#include "brink/core/base/elementary.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <numbers>
#include <random>

namespace brink::elementary_test {
namespace {

namespace mp = boost::multiprecision;
using Exact = mp::number<mp::cpp_bin_float<400, mp::backends::digit_base_2>>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRounded = 0.5 + 1e-9;

/// Units in the last place of the answer.
double units_off(double found, const Exact& wanted) {
  const double near = static_cast<double>(wanted);
  if (near == 0.0) return found == 0.0 ? 0.0 : kInfinity;
  return static_cast<double>(mp::abs(Exact(found) - wanted)) / std::ldexp(1.0, std::ilogb(near) - 52);
}

class Elementary : public ::testing::Test {
 protected:
  /// Of any sign, as likely between each two powers of ten.
  double any(double least_power, double most_power) {
    const double size = std::pow(10.0, least_power + (most_power - least_power) * part_(random_));
    return part_(random_) < 0.5 ? -size : size;
  }
  static constexpr int kCases = 5000;
  std::mt19937_64 random_{20261124};
  std::uniform_real_distribution<double> part_{0.0, 1.0};
};

TEST_F(Elementary, ExponentialIsRightToAUnit) {
  for (int i = 0; i < kCases; ++i) {
    const double x = std::clamp(any(-10.0, 2.9), -700.0, 700.0);
    ASSERT_LE(units_off(exponential(x), mp::exp(Exact(x))), 1.0) << x;
    if (std::abs(x) > 600.0) continue;
    const DoubleDouble two = exponential(DoubleDouble(x, x * 0x1p-55));
    const Exact wanted = mp::exp(Exact(x) + Exact(x * 0x1p-55));
    ASSERT_LE(static_cast<double>(mp::abs((Exact(two.high()) + Exact(two.low())) / wanted - 1)), 0x1p-90)
        << x;
  }
  EXPECT_EQ(exponential(0.0), 1.0);
  EXPECT_EQ(exponential(1e3), kInfinity);
  EXPECT_EQ(exponential(-kInfinity), 0.0);
  EXPECT_TRUE(std::isnan(exponential(std::nan(""))));
}

TEST_F(Elementary, LogarithmAndPowersAreRounded) {
  for (int i = 0; i < kCases; ++i) {
    const double x = std::abs(any(i % 2 ? -300.0 : -1.0, i % 2 ? 300.0 : 1.0)), y = any(-2.0, 2.0);
    ASSERT_LE(units_off(logarithm(x), mp::log(Exact(x))), kRounded) << x;
    const Exact wanted = mp::pow(Exact(x), Exact(y));
    if (wanted < 1e-290 || wanted > 1e300) continue;
    ASSERT_LE(units_off(power(x, y), wanted), std::abs(y) == 4.0 ? 1.5 : kRounded) << x << "^" << y;
  }
  EXPECT_EQ(power(-2.0, 5.0), -32.0);
  EXPECT_EQ(power(-2.0, -6.0), 0x1p-6);
  EXPECT_EQ(power(0.0, 0.5), 0.0);
  EXPECT_EQ(power(0.0, -0.5), kInfinity);
  EXPECT_EQ(power(1e200, 7.0), kInfinity);
  EXPECT_EQ(logarithm(1.0), 0.0);
  EXPECT_EQ(logarithm(0.0), -kInfinity);
  EXPECT_TRUE(std::isnan(logarithm(-1.0)));
  EXPECT_TRUE(std::isnan(power(-2.0, 0.5)));
}

TEST_F(Elementary, AnglesAreRounded) {
  for (int i = 0; i < kCases; ++i) {
    const double y = any(-8.0, 8.0), x = any(-8.0, 8.0), c = std::clamp(any(-6.0, 0.0), -1.0, 1.0);
    ASSERT_LE(units_off(angle_of(y, x), mp::atan2(Exact(y), Exact(x))), kRounded) << y << ", " << x;
    ASSERT_LE(units_off(arc_cosine(c), mp::acos(Exact(c))), 1.0) << c;
  }
  EXPECT_EQ(angle_of(0.0, 1.0), 0.0);
  EXPECT_EQ(angle_of(0.0, -1.0), std::numbers::pi);
  EXPECT_EQ(angle_of(-1.0, 0.0), -std::numbers::pi / 2);
  EXPECT_EQ(arc_cosine(1.0), 0.0);
  EXPECT_EQ(arc_cosine(-1.0), std::numbers::pi);
  EXPECT_TRUE(std::isnan(arc_cosine(1.5)));
}

}  // namespace
}  // namespace brink::elementary_test
