// Safe steps, canonical times, quadratics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/closed_forms.h"
#include "brink/scheduler/first_contact/safe_step.h"
#include "tests/support/seeded_random.h"

namespace brink::safe_step_test {
namespace {

// The step is the first zero of f + f' h - c h^2 / 2, so the bound is 0 there and above 0 before.
TEST(SafeStep, EndsWhereTheLowerBoundReachesZero) {
  SeededRandom r(3);
  for (int i = 0; i < 100000; ++i) {
    const double f = r.uniform(0.0, 2.0), df = r.uniform(-3.0, 3.0), c = r.uniform(0.0, 5.0) * (i % 5 != 0);
    const double h = safe_step(f, df, c);
    if (std::isinf(h)) {
      ASSERT_TRUE(c == 0.0 && df >= 0.0);
      continue;
    }
    const auto bound = [&](double x) { return f + df * x - 0.5 * c * x * x; };
    ASSERT_NEAR(bound(h), 0.0, 1e-13 * (1.0 + std::abs(df) * h + c * h * h));
    for (const double part : {0.25, 0.5, 0.75}) ASSERT_GE(bound(part * h), -1e-14);
  }
}

TEST(CanonicalTime, CoarsestDyadicLiesBetweenAndHasTheFewestBits) {
  EXPECT_EQ(coarsest_between(0.3, 0.8), 0.5);
  EXPECT_EQ(coarsest_between(0.5, 0.8), 0.75);
  EXPECT_EQ(coarsest_between(2.9, 9.0), 8.0);
  const double next = std::nextafter(1.5, 2.0);
  EXPECT_EQ(coarsest_between(1.5, next), 1.5);  // nothing between: the low end
}

// The root of a falling function found from a thousand brackets is one and the same double.
TEST(CanonicalTime, LastClearTimeDoesNotDependOnTheBracket) {
  SeededRandom r(4);
  for (int k = 0; k < 200; ++k) {
    const double root = r.uniform(0.0, 100.0), slope = r.uniform(0.1, 50.0);
    const auto gap = [&](double t) { return (root - t) * slope; };
    const double first = last_clear_time(gap, 0.0, 200.0);
    EXPECT_GT(gap(first), 0.0);
    EXPECT_LE(gap(std::nextafter(first, 1e9)), 0.0);
    for (int i = 0; i < 50; ++i) {
      const double width = std::pow(10.0, r.uniform(-9.0, 1.0));
      EXPECT_EQ(last_clear_time(gap, std::max(0.0, root - width * (r.uniform() + 1e-3)),
                                root + width * (r.uniform() + 1e-3)),
                first);
      EXPECT_EQ(last_clear_time_by_threes(gap, std::max(0.0, root - width * (r.uniform() + 1e-3)),
                                          root + width * (r.uniform() + 1e-3)),
                first);
    }
  }
}

// Where roundings make a gap fall and rise, too: the same probes are believed.
TEST(CanonicalTime, ProbesByThreesAreBelievedAsOneByOne) {
  SeededRandom r(5);
  for (int k = 0; k < 2000; ++k) {
    const double low = r.uniform(0.0, 100.0);
    double high = low;
    for (std::uint64_t n = 1 + r.below(40); n > 0; --n) high = next_after(high);
    std::map<double, double> gaps{{low, 1.0}, {high, -1.0}};
    const auto gap = [&](double t) { return gaps.try_emplace(t, r.uniform(-1.0, 1.0)).first->second; };
    const double by_threes = last_clear_time_by_threes(gap, low, high);
    EXPECT_EQ(last_clear_time(gap, low, high), by_threes);
  }
}

TEST(FallingRoot, IsTheUniqueFallThroughZero) {
  EXPECT_DOUBLE_EQ(falling_root({1.0, 0.0, -2.0}), 1.0);  // 1 - s^2
  EXPECT_DOUBLE_EQ(falling_root({0.0, 3.0, -2.0}), 3.0);  // 3 s - s^2: the later root
  EXPECT_DOUBLE_EQ(falling_root({2.0, -3.0, 2.0}), 1.0);  // (s-1)(s-2): the earlier
  EXPECT_DOUBLE_EQ(falling_root({2.0, -4.0, 0.0}), 0.5);
  EXPECT_TRUE(std::isinf(falling_root({2.0, 1.0, 0.0})));
  EXPECT_TRUE(std::isinf(falling_root({1.0, -1.0, 4.0})));            // turns above zero
  EXPECT_NEAR(falling_root({1e-20, 1.0, -9.81}), 2.0 / 9.81, 1e-16);  // no cancellation
}

}  // namespace
}  // namespace brink::safe_step_test
