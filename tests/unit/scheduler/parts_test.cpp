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
ZenoWatch::Feature feature(int site, int sample) {
  FeatureContact contact;
  contact.site = site;
  contact.sample = sample;
  return {{0, -1, 0}, contact};
}

TEST(ZenoWatch, NamesTheLimitOfAGeometricSeriesOfLowBounces) {
  for (const double e : {0.01, 0.1, 0.6, 0.99}) {
    ZenoWatch watch(1e-10);
    const double g = 10.0, limit = 1.0;
    double v = std::min(1e-3, 0.1 * (1.0 - e));  // impact speed; flights last 2 e v / g
    double t = limit - 2.0 * e * v / g / (1.0 - e);
    std::optional<ZenoEnding> ending;
    for (int i = 0; i < 10000 && !ending; ++i) {
      ending = watch.collided(feature(0, 0), t, v, BounceLoss::some, 2.0 * v / g);
      t += 2.0 * e * v / g;
      v *= e;
    }
    if (e < 0.1) continue;  // all within one instant before the tenth
    ASSERT_TRUE(ending) << e;
    EXPECT_NEAR(ending->limit_time, limit, 1e-12) << e;
  }
}

TEST(ZenoWatch, SmallButElasticBouncesAboveTheToleranceGoOn) {
  ZenoWatch watch(1e-10);
  for (int i = 0; i < 1000; ++i)
    EXPECT_FALSE(watch.collided(feature(0, 0), 1e-3 * i, 1e-3, BounceLoss::some));
}

// A disc in a slot with 4e-11 m of play, from wall to wall: each flight is lower than the tolerance. Without
// a loss they stay alike; with one they grow. Neither comes to rest in a finite time.
TEST(ZenoWatch, RattlingIsNoSeries) {
  for (const double e : {1.0, 0.999, 0.5}) {
    ZenoWatch watch(1e-10);
    double v = 1.0, t = 0.0, flight = 0.0;
    for (int i = 0; i < 40; ++i) {
      const auto loss = e < 1.0 ? BounceLoss::some : BounceLoss::none;
      ASSERT_FALSE(watch.collided(feature(i % 2, 0), t, v, loss, flight)) << "e " << e << ", hit " << i;
      v *= e;
      t += flight = 4e-11 / v;
    }
  }
}

// Flights of one pair, by ten features in turn: each feature has had one.
TEST(ZenoWatch, CountsByFeature) {
  ZenoWatch watch(1e-10);
  for (int i = 0; i < 10; ++i)
    EXPECT_FALSE(watch.collided(feature(0, i), 1e-6 * i, 1e-6, BounceLoss::all, 1e-6));
}

// Restitution 0 under gravity: it sinks by a touch and is stopped, again and again in like times. That is a
// contact that lasts, wherever on the site it is.
TEST(ZenoWatch, PressedFeaturesEndAfterTenLikeFlights) {
  ZenoWatch watch(1e-10);
  const double depth = 1e-13, g = 10.0, flight = std::sqrt(2.0 * depth / g);
  std::optional<ZenoEnding> ending;
  int hits = 0;
  for (; hits < 100 && !ending; ++hits)
    ending = watch.collided(feature(0, 0), flight * hits, g * flight, BounceLoss::all, flight);
  ASSERT_TRUE(ending);
  EXPECT_EQ(hits, 11);
  EXPECT_DOUBLE_EQ(ending->limit_time, 10.0 * flight);
}

// Bounces under changing loads, each flight 0.5 to 1.2 times as long as the last: it shrinks all the same.
TEST(ZenoWatch, UnsteadySeriesEnds) {
  Random r(9);
  ZenoWatch watch(1e-10);
  double t = 0.0, flight = 1e-5;
  std::optional<ZenoEnding> ending;
  int hits = 0;
  for (; hits < 200 && !ending; ++hits) {
    ending = watch.collided(feature(0, 0), t, flight, BounceLoss::some, 0.5 * flight);
    t += flight *= r.uniform(0.5, 1.2);
  }
  EXPECT_TRUE(ending);
}

}  // namespace
}  // namespace brink
