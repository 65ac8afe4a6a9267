// Which series of bounces come to an end.
#include <gtest/gtest.h>

#include <cmath>

#include "brink/scheduler/resolve/zeno.h"
#include "tests/support/seeded_random.h"

namespace brink::zeno_test {
namespace {

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

// On an arc of 20 m a gap is rounded to 2e-14 m: a flight of that height ends anywhere.
TEST(ZenoWatch, NoFlightOfASeriesIsAsLowAsItsRounding) {
  const double rounding = 2e-14, g = 10.0, limit = 1.0;
  for (const double e : {0.03, 0.1, 0.2, 0.5, 0.9}) {
    ZenoWatch watch(4e-10);
    double v = 0.02 * (1.0 - e), t = limit - 2.0 * e * v / g / (1.0 - e), rise = 1.0;
    std::optional<ZenoEnding> ending;
    for (int i = 0; i < 1000 && !ending; ++i) {
      ending = watch.collided(feature(0, 0), t, v, BounceLoss::some, 2.0 * v / g, false, {}, rounding);
      rise = 0.5 * v * v / g;
      EXPECT_GT(rise, 4.0 * rounding) << e;
      t += 2.0 * e * v / g;
      v *= e;
    }
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

// A light body between two heavy ones that close in on it: each way is shorter than the last, and as fast. Nothing there comes to rest.
TEST(ZenoWatch, WhatIsClosedInOnIsNoSeries) {
  ZenoWatch watch(1e-10);
  double v = 19.0, t = 0.0, flight = 1e-13;
  for (int i = 0; i < 40; ++i) {
    ASSERT_FALSE(watch.collided(feature(i % 2, 0), t, v, BounceLoss::some, flight)) << i;
    v *= 1.0 - 1e-6;
    t += flight *= 0.8;
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
  SeededRandom r(9);
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
}  // namespace brink::zeno_test
