/// The scheduler's small parts: safe steps, canonical times, quadratics, the agenda, the broad phase, the
/// Zeno watch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "brink/core/base/random.h"
#include "brink/scheduler/agenda.h"
#include "brink/scheduler/broad_phase.h"
#include "brink/scheduler/canonical_time.h"
#include "brink/scheduler/closed_forms.h"
#include "brink/scheduler/safe_step.h"
#include "brink/scheduler/zeno.h"

namespace brink {
namespace {

// The step is the first zero of f + f' h - c h^2 / 2, so the bound is 0 there and above 0 before.
TEST(SafeStep, EndsWhereTheLowerBoundReachesZero) {
  Random r(3);
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
  Random r(4);
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
    }
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

TEST(Agenda, PopsInTheTotalOrder) {
  Random r(5);
  Agenda agenda;
  std::vector<Certificate> all;
  for (int i = 0; i < 2000; ++i) {
    Certificate c;
    c.time = static_cast<double>(r.below(50));
    c.pair = {static_cast<int>(r.below(9)), r.below(2) ? static_cast<int>(10 + r.below(9)) : -1, -1};
    if (c.pair.other_body < 0) c.pair.other_site = static_cast<int>(r.below(5));
    c.contact.site = static_cast<int>(r.below(4));
    c.contact.sample = static_cast<int>(r.below(4));
    agenda.insert(c);
    all.push_back(c);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.order() < b.order(); });
  for (const Certificate& expected : all) EXPECT_EQ(agenda.pop().order(), expected.order());
  EXPECT_TRUE(agenda.empty());
}

// The grid names just the pairs that brute force names, each once, large and endless boxes among them.
TEST(BroadPhase, GridFindsThePairsOfBruteForce) {
  Random r(6);
  for (int round = 0; round < 100; ++round) {
    std::vector<Box> boxes;
    const int n = 2 + static_cast<int>(r.below(120));
    for (int i = 0; i < n; ++i) {
      const Vec2 low(r.uniform(-10, 10), r.uniform(-10, 10));
      const double size = i % 17 == 0 ? 15.0 : i % 5 == 0 ? 0.0 : 1.0;
      boxes.push_back({low, low + size * Vec2(r.uniform(), r.uniform())});
    }
    if (round % 3 == 0) boxes.push_back({Vec2::Constant(-INFINITY), Vec2::Constant(INFINITY)});
    std::vector<std::pair<int, int>> expected;
    for (int i = 0; i < static_cast<int>(boxes.size()); ++i)
      for (int j = i + 1; j < static_cast<int>(boxes.size()); ++j)
        if (boxes[i].overlaps(boxes[j])) expected.emplace_back(i, j);
    ASSERT_EQ(overlapping_pairs(boxes), expected) << "round " << round << " of seed 6";
  }
}

// Intervals of a bouncing ball shrink by e: the limit is the sum of their geometric series.
TEST(ZenoWatch, NamesTheLimitOfAGeometricSeriesOfLowBounces) {
  ZenoWatch watch(1e-10);
  const PairKey pair{0, -1, 0};
  const double e = 0.6, g = 10.0, limit = 1.0;
  double v = 1e-3;  // impact speed; flights last 2 e v / g
  double t = limit - 2.0 * e * v / g / (1.0 - e);
  std::optional<ZenoEnding> ending;
  for (int i = 0; i < 100 && !ending; ++i) {
    ending = watch.collided(pair, t, v);
    t += 2.0 * e * v / g;
    v *= e;
  }
  ASSERT_TRUE(ending);
  EXPECT_NEAR(ending->limit_time, limit, 1e-12);
}

TEST(ZenoWatch, SmallButElasticBouncesAboveTheToleranceGoOn) {
  ZenoWatch watch(1e-10);
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(watch.collided({0, -1, 0}, 1e-3 * i, 1e-3));
}

}  // namespace
}  // namespace brink
