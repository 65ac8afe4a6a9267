// Intervals that hold one crossing of a gap, for gaps whose crossings are known.
#include "brink/scheduler/first_contact/falling_gap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "tests/support/seeded_random.h"

namespace brink::falling_gap_test {
namespace {

using detail::FallingGap;

constexpr double kLast = std::numeric_limits<double>::infinity();

TEST(FallingGap, AStraightOneIsHeldWithinRoundings) {
  const double t = 3.0, rounding = 1e-15;
  const auto gap = [&](double at) { return 1e-11 - 2.0 * (at - t); };
  const FallingGap falling(t, 1e-11, 2.0, 0.0, rounding);
  const std::optional<double> low = falling.clear_end(gap, 0.0);
  ASSERT_TRUE(low);
  EXPECT_GT(gap(*low), rounding);
  const FallingGap::Beyond beyond = falling.beyond_end(gap, *low, kLast);
  EXPECT_TRUE(beyond.surely);
  EXPECT_LT(gap(beyond.end), -rounding);
  EXPECT_LT(beyond.end - *low, 64.0 * falling.moment());
}

TEST(FallingGap, WhatNeverWasClearHasNoLowerEnd) {
  const auto gap = [](double at) { return -1e-12 - (at - 1.0); };
  const FallingGap falling(1.0, -1e-12, 1.0, 0.0, 1e-15);
  EXPECT_FALSE(falling.clear_end(gap, 1.0));
  // it was, a little before
  const std::optional<double> low = falling.clear_end(gap, 0.5);
  ASSERT_TRUE(low);
  EXPECT_GT(gap(*low), 0.0);
}

TEST(FallingGap, ProbesStayWithinTheMotion) {
  double latest = 0.0;
  const auto gap = [&](double at) {
    latest = std::max(latest, at);
    return 1e-11 - (at - 1.0);
  };
  const FallingGap falling(1.0, 1e-11, 1.0, 0.0, 1e-15);
  const double last = 1.0 + 5e-12;
  const FallingGap::Beyond beyond = falling.beyond_end(gap, 1.0, last);
  EXPECT_EQ(beyond.end, 1.0);
  EXPECT_FALSE(beyond.surely);
  EXPECT_LE(latest, last);
}

// now - v s + c s^2 / 2: parabolas that bend to either side by no more than what is told, from above the surface and from
// below. The interval holds the first crossing and not the second; if none is found, it dips by less than a few roundings.
TEST(FallingGap, OfParabolasTheFirstCrossingAloneIsHeld) {
  SeededRandom r(20261126);
  int held = 0, passed = 0;
  for (int i = 0; i < 20000; ++i) {
    const double t = std::exp(r.uniform(-3.0, 8.0)), rounding = std::exp(r.uniform(-35.0, -30.0));
    const double now =
        r.uniform(-4.0, 1.0) < 0.0 ? r.uniform(-1.0, 1.0) * 4.0 * rounding : r.uniform(0.0, 1e-10);
    const double v = std::exp(r.uniform(-4.0, 4.0));
    // bent so that it turns before, about or after it is gone
    const double c = (r.below(2) ? 1.0 : -1.0) * v * v / (1e-10 * std::exp(r.uniform(-1.0, 8.0)));
    const auto gap = [&](double at) { return now - v * (at - t) + 0.5 * c * (at - t) * (at - t); };
    const FallingGap falling(t, now, v, std::abs(c) * r.uniform(1.0, 2.0), rounding);
    const std::optional<double> low = falling.clear_end(gap, t - 1024.0 * falling.moment());
    if (!low) continue;
    EXPECT_TRUE(gap(*low) > rounding || *low == t) << i;
    const FallingGap::Beyond beyond = falling.beyond_end(gap, *low, kLast);
    const double root = v * v - 2.0 * c * now;  // > 0: it crosses
    const double depth = c > 0.0 ? 0.5 * v * v / c - now : kLast;
    if (!beyond.surely) {
      EXPECT_LT(depth, 64.0 * (rounding + v * ulp(t))) << i << ": a dip that was not found";
      ++passed;
      continue;
    }
    ASSERT_GT(root, 0.0) << i;
    EXPECT_LT(gap(beyond.end), -rounding) << i;
    EXPECT_GT(beyond.end, *low) << i;
    // the crossing that begins below lies before t, the one that begins above behind it
    const double first = t + 2.0 * now / (v + std::sqrt(root)), slack = 8.0 * ulp(t) + 2.0 * rounding / v;
    EXPECT_GE(first, *low - slack) << i;
    EXPECT_LE(first, beyond.end + slack) << i;
    const double second = c > 0.0 ? t + (v + std::sqrt(root)) / c : kLast;
    EXPECT_LT(beyond.end, second + slack) << i;
    ++held;
  }
  EXPECT_GT(held, 10000);
  EXPECT_GT(passed, 10);
}

// A parabola that dips below the surface and rises out of it, and falls again soon after, as beside another surface: where
// the upper end is beyond that, it is told that the gap may have risen, so that the first dip is looked for.
TEST(FallingGap, WhatMayHaveRisenBeforeIsTold) {
  SeededRandom r(20261127);
  int doubtful = 0;
  for (int i = 0; i < 20000; ++i) {
    const double t = r.uniform(0.0, 100.0), now = std::exp(r.uniform(-27.0, -22.0)),
                 v = std::exp(r.uniform(-13.0, 0.0)), rounding = 1e-16;
    const double c = r.uniform(0.05, 0.499) * v * v / now, root = std::sqrt(v * v - 2.0 * c * now);
    const double first = t + (v - root) / c, second = t + (v + root) / c;
    if (second - first < 1024.0 * ulp(t)) continue;  // told from none by no clock
    const double again = second + r.uniform(0.01, 2.0) * (second - t);
    const auto gap = [&](double at) {
      return at > again ? again - at : now - v * (at - t) + 0.5 * c * (at - t) * (at - t);
    };
    const FallingGap falling(t, now, v, c * r.uniform(1.0, 3.0), rounding);
    const double end = falling.beyond_end(gap, t, kLast).end;
    if (end < again) continue;
    EXPECT_TRUE(falling.may_rise_first(end, 0.0)) << i;
    ++doubtful;
  }
  EXPECT_GT(doubtful, 100);
}

// What is computed of a slow gap is wrong by up to its rounding, now to this side and now to that: it seems to go through
// zero thousands of times. From wherever it is looked at on the way, the crossing is told at the same double.
TEST(FallingGap, OneCrossingIsToldThoughRoundingsMakeMany) {
  SeededRandom r(20261128);
  constexpr double rounding = 1e-14;
  for (int i = 0; i < 300; ++i) {
    const double meets = r.uniform(0.001, 1.0), v = std::exp(r.uniform(-14.0, -8.0));
    const double c = r.uniform(-0.1, 0.1) * v * v / 1e-12,
                 steps = std::exp(r.uniform(0.0, 5.0)) * v / rounding;
    // places of which a coordinate moves by whole steps: off by a sawtooth of nearly all of the rounding
    const auto off = [&](double t) {
      return 0.99 * rounding * (2.0 * (t * steps - std::floor(t * steps)) - 1.0);
    };
    const auto gap = [&](double t) {
      const double s = t - meets;
      return -v * s + 0.5 * c * s * s + off(t);
    };
    double told = 0.0;
    for (int j = 0; j < 20; ++j) {
      const double t = meets - std::exp(r.uniform(-4.0, 4.0)) * rounding / v;
      const FallingGap falling(t, gap(t), v - c * (t - meets), std::abs(c), rounding);
      const std::optional<double> low = falling.clear_end(gap, 0.0);
      ASSERT_TRUE(low) << i;
      const FallingGap::Beyond beyond = falling.beyond_end(gap, *low, kLast);
      ASSERT_TRUE(beyond.surely) << i;
      const double here = last_clear_time(gap, *low, beyond.end);
      if (j == 0) told = here;
      EXPECT_EQ(here, told) << i << " looked at " << (meets - t) * v / rounding << " roundings before";
    }
  }
}

}  // namespace
}  // namespace brink::falling_gap_test
