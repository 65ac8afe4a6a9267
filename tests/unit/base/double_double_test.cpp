// Beside binary numbers of 400 bits (Boost.Multiprecision), in which sums and products of these are exact.
#include "brink/core/base/double_double.h"

#include "brink/core/base/double_double_pair.h"

#include <gtest/gtest.h>

#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <random>

namespace brink::double_double_test {
namespace {

namespace mp = boost::multiprecision;
using Exact = mp::number<mp::cpp_bin_float<400, mp::backends::digit_base_2>>;
constexpr double kEpsilonOfTwo = 0x1p-100;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Exact exact(const DoubleDouble& x) { return Exact(x.high()) + Exact(x.low()); }

/// Numbers of any sign whose sizes span 80 powers of two, with every kind of low part.
class Numbers {
 public:
  DoubleDouble next() {
    const double high = std::ldexp(1.0 + part_(random_), size_(random_)) * (part_(random_) < 0.5 ? -1 : 1);
    return part_(random_) < 0.2 ? DoubleDouble(high)
                                : DoubleDouble::sum(high, high * (part_(random_) - 0.5) * 0x1p-52);
  }

 private:
  std::mt19937_64 random_{20261124};
  std::uniform_real_distribution<double> part_{0.0, 1.0};
  std::uniform_int_distribution<int> size_{-40, 40};
};

double relative_error(const DoubleDouble& found, const Exact& wanted) {
  if (wanted == 0) return found == 0.0 ? 0.0 : kInfinity;
  return static_cast<double>(mp::abs((exact(found) - wanted) / wanted));
}

void expect_normalized(const DoubleDouble& x) { EXPECT_EQ(x.high() + x.low(), x.high()); }

/// To the bit, the sign of zero included.
void expect_same(const DoubleDouble& found, const DoubleDouble& wanted) {
  if (isnan(wanted)) {
    EXPECT_TRUE(isnan(found));
    return;
  }
  EXPECT_EQ(std::bit_cast<std::uint64_t>(found.high()), std::bit_cast<std::uint64_t>(wanted.high()));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(found.low()), std::bit_cast<std::uint64_t>(wanted.low()));
}

// Numbers of every size, and some that are none: two at once are as one by one.
TEST(DoubleDoublePair, TellsTheBitsOfNumbersOneByOne) {
  using Pair = DoubleDoublePair<error_free::Default>;
  Numbers numbers;
  std::mt19937_64 random(7);
  const double special[] = {0.0,     -0.0,    0x1p-961,  0x1p-500,   0x1p-1070,    -0x1p1000,
                            0x1p700, 0x1p994, kInfinity, -kInfinity, std::nan(""), 1e308};
  const auto next = [&] {
    return random() % 6 ? numbers.next() : DoubleDouble(special[random() % std::size(special)]);
  };
  const auto expect_both = [](const Pair& found, const DoubleDouble& x, const DoubleDouble& y) {
    expect_same(found.x(), x);
    expect_same(found.y(), y);
  };
  for (int i = 0; i < 100000 && !testing::Test::HasFailure(); ++i) {
    const DoubleDouble ax = next(), ay = next(), bx = next(), by = next();
    const Pair a(ax, ay), b(bx, by);
    expect_both(a + b, ax + bx, ay + by);
    expect_both(a - b, ax - bx, ay - by);
    expect_both(-a, -ax, -ay);
    expect_both(a * bx, ax * bx, ay * bx);
    expect_both(a * bx.high(), ax * bx.high(), ay * bx.high());
    expect_both(a.plus(bx.high(), by.high()), ax + bx.high(), ay + by.high());
    expect_same(a.dot(b), ax * bx + ay * by);
  }
}

// Of sizes that occur, where no product leaves its range, nobody need look whether one has.
TEST(DoubleDoublePair, InRangeIsTheSameWithoutALook) {
  using Looking = BasicDoubleDouble<error_free::Default>;
  using InRange = BasicDoubleDouble<error_free::InRange<error_free::Default>>;
  using LookingPair = DoubleDoublePair<error_free::Default>;
  using InRangePair = DoubleDoublePair<error_free::InRange<error_free::Default>>;
  std::mt19937_64 random(8);
  const auto part = [&] {
    const double size = std::ldexp(1.0 + 0x1p-53 * static_cast<double>(random() >> 11),
                                   static_cast<int>(random() % 200) - 100);
    return random() % 2 ? size : -size;
  };
  const auto next = [&] {
    const double high = part();
    return Looking::sum(high, high * 0x1p-54 * (1.0 - 0x1p-52 * static_cast<double>(random() >> 11)));
  };
  const auto expect_alike = [](const InRange& found, const Looking& wanted) {
    expect_same(Looking(found.high(), found.low()), wanted);
  };
  const auto in_range = [](const Looking& x) { return InRange(x.high(), x.low()); };
  for (int i = 0; i < 100000 && !testing::Test::HasFailure(); ++i) {
    const Looking a = next(), b = next(), c = next();
    const InRange x = in_range(a), y = in_range(b), z = in_range(c);
    expect_alike(x + y, a + b);
    expect_alike(x * y, a * b);
    expect_alike(x * y.high(), a * b.high());
    expect_alike(x / y, a / b);
    const LookingPair p(a, b), q(b, c);
    const InRangePair r(x, y), s(y, z);
    expect_alike(r.dot(s), p.dot(q));
    expect_alike((r + s).x(), (p + q).x());
    expect_alike((r * z).y(), (p * c).y());
    EXPECT_EQ(r.lies_between(0x1p-20, 0x1p20),
              std::abs(a.high()) >= 0x1p-20 && std::abs(a.high()) <= 0x1p20 &&
                  std::abs(b.high()) >= 0x1p-20 && std::abs(b.high()) <= 0x1p20);
  }
}

// Two vectors at once are as one after the other, whether ranges are looked at or not.
template <class Product>
class DoubleDoublePairsOf : public testing::Test {};
using Products = testing::Types<error_free::Default, error_free::InRange<error_free::Default>>;
TYPED_TEST_SUITE(DoubleDoublePairsOf, Products);

TYPED_TEST(DoubleDoublePairsOf, TellTheBitsOfVectorsOneByOne) {
  using Pair = DoubleDoublePair<TypeParam>;
  using Pairs = DoubleDoublePairs<TypeParam>;
  using Number = typename Pair::Number;
  Numbers numbers;
  const auto next = [&] {
    const DoubleDouble x = numbers.next();
    return Number(x.high(), x.low());
  };
  const auto expect_alike = [](const Number& found, const Number& wanted) {
    expect_same({found.high(), found.low()}, {wanted.high(), wanted.low()});
  };
  const auto expect_both = [&](const Pairs& found, const Pair& first, const Pair& second) {
    expect_alike(found.first().x(), first.x());
    expect_alike(found.first().y(), first.y());
    expect_alike(found.second().x(), second.x());
    expect_alike(found.second().y(), second.y());
  };
  for (int i = 0; i < 100000 && !testing::Test::HasFailure(); ++i) {
    const Pair a(next(), next()), b(next(), next()), c(next(), next()), d(next(), next());
    const Number s = next(), t = next();
    const Pairs both(a, b);
    expect_both(both + Pairs(c, d), a + c, b + d);
    expect_both(both.times(s, t), a * s, b * t);
    expect_both(both.times(s.high(), t.high()), a * s.high(), b * t.high());
    expect_both(both.plus(c.x().high(), c.y().high(), d.x().high(), d.y().high()),
                a.plus(c.x().high(), c.y().high()), b.plus(d.x().high(), d.y().high()));
  }
}

TEST(DoubleDouble, OperationsAreRightToTheEpsilon) {
  Numbers numbers;
  for (int i = 0; i < 100000; ++i) {
    const DoubleDouble a = numbers.next(), b = numbers.next();
    const double c = b.high();
    const Exact x = exact(a), y = exact(b), z = c;
    const std::pair<DoubleDouble, Exact> found[] = {{a + b, x + y},
                                                    {a - b, x - y},
                                                    {a * b, x * y},
                                                    {a / b, x / y},
                                                    {a + c, x + z},
                                                    {a - c, x - z},
                                                    {c - a, z - x},
                                                    {a * c, x * z},
                                                    {a / c, x / z},
                                                    {c / a, z / x},
                                                    {sqrt(abs(a)), mp::sqrt(mp::abs(x))}};
    for (const auto& [ours, wanted] : found) {
      ASSERT_LE(relative_error(ours, wanted), kEpsilonOfTwo);
      expect_normalized(ours);
    }
  }
}

// What cancels is told to the epsilon of what is left, not of what was there.
TEST(DoubleDouble, WhatCancelsKeepsItsDigits) {
  Numbers numbers;
  for (int i = 0; i < 100000; ++i) {
    const DoubleDouble a = numbers.next();
    const DoubleDouble b = DoubleDouble::sum(a.high(), a.low() * 1.25);
    ASSERT_LE(relative_error(a - b, exact(a) - exact(b)), kEpsilonOfTwo);
    ASSERT_LE(relative_error(a - a.high(), Exact(a.low())), kEpsilonOfTwo);
  }
}

TEST(DoubleDouble, SumAndProductOfTwoDoublesAreExact) {
  Numbers numbers;
  for (int i = 0; i < 100000; ++i) {
    const double a = numbers.next().high(), b = numbers.next().high();
    ASSERT_EQ(exact(DoubleDouble::sum(a, b)), Exact(a) + Exact(b));
    ASSERT_EQ(exact(DoubleDouble::product(a, b)), Exact(a) * Exact(b));
  }
}

// Whichever the processor has: Dekker's operations, or one that is fused.
TEST(DoubleDouble, ProductsHaveTheSameBitsOnEveryProcessor) {
  std::mt19937_64 random(20261125);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  std::uniform_int_distribution<int> size(-450, 450);
  for (int k = 0; k < 100000; ++k) {
    const double a = std::ldexp(part(random), size(random)), b = std::ldexp(part(random), size(random));
    const error_free::Result plain = error_free::Plain::product(a, b), dekker = error_free::product(a, b);
    if (std::abs(a * b) < 0x1p-960) continue;
    EXPECT_EQ(plain.high, dekker.high) << a << ' ' << b;
    EXPECT_EQ(plain.low, dekker.low) << a << ' ' << b;
  }
}

TEST(DoubleDouble, OrderIsThatOfTheNumbers) {
  Numbers numbers;
  for (int i = 0; i < 100000; ++i) {
    const DoubleDouble a = numbers.next(), b = i % 2 ? numbers.next() : a + a * 0x1p-104;
    ASSERT_EQ(a < b, exact(a) < exact(b));
    ASSERT_EQ(a <= b, exact(a) <= exact(b));
    ASSERT_EQ(a > b, exact(a) > exact(b));
    ASSERT_EQ(a == b, exact(a) == exact(b));
  }
}

// Beyond the range of a product's error the answer is that of doubles, never NaN where they have none.
TEST(DoubleDouble, FarNumbersAreAsGoodAsDoubles) {
  const double sizes[] = {0.0, 4.9e-324, 1e-308, 1e-200, 1.0, 1e200, 1e300, 1.7e308, kInfinity};
  const auto expect_near = [](const DoubleDouble& found, double wanted) {
    if (std::isnan(wanted)) {
      EXPECT_TRUE(isnan(found));
    } else if (std::isinf(wanted)) {
      EXPECT_EQ(found, DoubleDouble(wanted));
    } else {
      EXPECT_NEAR(found.high(), wanted, std::max(1e-15 * std::abs(wanted), 1e-307));
      EXPECT_FALSE(std::isnan(found.low()));
    }
  };
  for (const double a : sizes)
    for (const double b : sizes)
      for (const double sign : {1.0, -1.0}) {
        const DoubleDouble x = a, y = sign * b;
        expect_near(x + y, a + sign * b);
        expect_near(x * y, a * (sign * b));
        expect_near(x / y, a / (sign * b));
        expect_near(x * (sign * b), a * (sign * b));
        expect_near(x / (sign * b), a / (sign * b));
        expect_near(sqrt(x), std::sqrt(a));
      }
  EXPECT_TRUE(isnan(sqrt(DoubleDouble(-1.0))));
  EXPECT_FALSE(isfinite(DoubleDouble(kInfinity)));
}

}  // namespace
}  // namespace brink::double_double_test
