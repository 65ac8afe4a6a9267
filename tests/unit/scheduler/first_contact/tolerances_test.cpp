// The margins of the search for first contact.
#include "brink/scheduler/first_contact/tolerances.h"

#include <gtest/gtest.h>

#include "brink/scheduler/first_contact/safe_step.h"
#include "tests/support/seeded_random.h"

namespace brink::tolerances_test {
namespace {

constexpr double kStep = 1e-14;

// The lowest and highest of gap + rate s - acceleration s^2 / 2 until it comes back down to `level`.
double highest(double gap, double rate, double acceleration) {
  return rate > 0.0 ? gap + rate * rate / (2.0 * acceleration) : gap;
}

TEST(StartSink, PairsApartMeetAtTheirNominalLevel) {
  EXPECT_EQ(start_sink(kStep, -1.0, 1e-15, 10.0, kStep), 0.0);
  EXPECT_EQ(start_sink(kStep, 0.0, 1e-15, 10.0, kStep), 0.0);
}

TEST(StartSink, ARebounceThatRisesMeetsAtItsNominalLevelEvenFromARoundingBelow) {
  EXPECT_EQ(start_sink(-1e-17, 1.0, 1e-15, 10.0, kStep), 0.0);
  EXPECT_EQ(start_sink(-1e-17, 1e-12, 1e-15, 0.0, kStep), 0.0);  // nothing draws it back
}

TEST(StartSink, WhatIsPressedMeetsAStepBelowItsStart) {
  EXPECT_EQ(start_sink(-1e-17, 0.0, 1e-15, 10.0, kStep), -1e-17 - kStep);
  EXPECT_EQ(start_sink(1e-17, -1e-16, 1e-15, 10.0, kStep), 1e-17 - kStep);
}

TEST(StartSink, ALowElasticFlightDoesNotSinkAnyDeeper) {
  // it has fallen one step, and rebounds as high: from -step back to 0
  const double a = 10.0, rate = std::sqrt(2.0 * a * kStep);
  EXPECT_EQ(start_sink(-kStep, rate, 1e-15, a, kStep), -kStep);
}

// A contact is a crossing from above: whatever the start, the gap is above its level by half a step at some
// time before it meets it, so that roundings below a quarter of a step do not matter.
TEST(StartSink, EveryLevelIsCrossedFromAbove) {
  SeededRandom random(5);
  for (int i = 0; i < 100000; ++i) {
    const double gap = random.uniform(-3.0, 3.0) * kStep, a = std::exp(random.uniform(-20.0, 20.0));
    const double rate = random.uniform(-1.0, 4.0) * std::sqrt(a * kStep), noise = 1e-3 * std::sqrt(a * kStep);
    const double level = start_sink(gap, rate, noise, a, kStep);
    EXPECT_LE(level, 0.0);
    EXPECT_GE(level, std::min(gap, 0.0) - 1.0000001 * kStep);
    EXPECT_GE(highest(gap, rate > noise ? rate : 0.0, a) - level, 0.49 * kStep)
        << "gap " << gap << " rate " << rate << " acceleration " << a;
  }
}

// What is pressed onto a wire meets it, is pushed out, sinks and meets it again: whatever roundings make of each gap, the
// next contact is crossed from above by more than one of them, nobody comes to the wire itself, and a push does not lead
// past another wire that was met at its level.
TEST(ThinLevel, WhatIsPressedOnAWireCrossesItsLevelFromClearAboveForEver) {
  SeededRandom random(8);
  for (int i = 0; i < 1000; ++i) {
    const double rounding = std::exp(random.uniform(-45.0, -25.0)), tolerance = 1e-3,
                 touch = rounding * std::exp(random.uniform(-3.0, 6.0));
    const double nominal = nominal_level(touch, tolerance, rounding, true), step = sink_step(touch, rounding);
    const auto seen = [&](double gap) { return gap + random.uniform(-1.0, 1.0) * rounding; };
    double level = nominal;
    for (int bounce = 0; bounce < 100; ++bounce) {
      const double met = seen(level);  // where it is when its gap is seen to be the level
      EXPECT_GT(met, 3.99 * rounding);
      const double push = push_of(nominal - level, nominal, tolerance, random.uniform(0.0, 1.0));
      const double start = seen(met + push);
      level = level_of(nominal, start_sink(start - nominal, 0.0, 1e-30, 10.0, step));
      EXPECT_GE(start - level, 0.99 * rounding) << "bounce " << bounce << " touch " << touch / rounding;
      EXPECT_GT(met - push, 0.99 * rounding);
    }
  }
}

// gap(s) = above + rate s - curvature s^2 / 2 is the lowest that the bounds allow.
TEST(BandStep, NeverLeadsOntoTheLevel) {
  SeededRandom random(6);
  const double band = 1e-10, allowed = 1e-15;
  for (int i = 0; i < 100000; ++i) {
    const double above = std::exp(random.uniform(-36.0, -23.1)),
                 curvature = std::exp(random.uniform(-5.0, 5.0));
    const double rate = random.uniform(-3.0, 3.0) * std::sqrt(curvature * band) * random.uniform(0.0, 1.0);
    const double h = band_step(above, rate, curvature, band, allowed);
    ASSERT_GT(h, 0.0);
    const double there = above + h * (rate - 0.5 * curvature * h);
    const double rounding = 1e-14 * (above + h * std::abs(rate) + curvature * h * h);
    EXPECT_GE(there, std::min(0.5 * above, above - allowed) - rounding);
    if (rate <= 0.0) continue;
    // it rises: all the way back into the middle of the band from outside, to its highest, or beyond that
    const double highest = above + rate * rate / (2.0 * curvature);
    if (highest > band) {
      EXPECT_NEAR(there, 0.5 * band, 1e-6 * band + rounding);
    } else {
      EXPECT_GE(h, rate / curvature * (1.0 - 1e-12));
    }
  }
}

// A pressed pair that drifts apart by next to nothing is not looked at for ever.
TEST(BandStep, AGapThatHardlyRisesIsSteppedByWhatThereIsOfIt) {
  EXPECT_GT(band_step(1e-14, 1e-15, 1.0, 1e-10, 1e-15), 1e-8);
}

TEST(BandStep, WithNothingToBendItAGapThatRisesIsSafeForEver) {
  EXPECT_TRUE(std::isinf(band_step(1e-13, 1e-9, 0.0, 1e-10, 1e-15)));
}

// Against the same sum in extended precision.
TEST(PlaceRounding, BoundsTheErrorOfAParabola) {
  SeededRandom random(7);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::exp(random.uniform(-10.0, 25.0));
    BodyState start;
    start.pose.position = {random.uniform(-size, size), random.uniform(-size, size)};
    start.twist.velocity = {random.uniform(-size, size), random.uniform(-1.0, 1.0)};
    const Motion motion =
        Motion::ballistic(random.uniform(0.0, 10.0), start, {{0.0, random.uniform(-9.0, 0.0)}, 0.0});
    const double t = motion.begin() + random.uniform(0.0, 20.0);
    const Vec2 place = motion.pose(t).position;
    const RealVec exact = motion.extended_state(t).position;
    const double error = static_cast<double>((place.cast<Real>() - exact).lpNorm<1>());
    EXPECT_LE(error, MotionRounding(motion).place(t, place));
  }
}

TEST(TimeUntilWithin, IsExactForDiscsAsFarAwayAsABillionSizes) {
  EXPECT_DOUBLE_EQ(time_until_within({-1e9, 0.0}, {1e9, 0.0}, 2.0), 1.0 - 2e-9);
  EXPECT_TRUE(std::isinf(time_until_within({-1e9, 2.1}, {1e9, 0.0}, 2.0)));
  EXPECT_NEAR(time_until_within({-1e9, 1.9}, {1e9, 0.0}, 2.0), 1.0, 1e-8);
  EXPECT_TRUE(std::isinf(time_until_within({1.0, 0.0}, {1.0, 0.0}, 0.5)));
}

}  // namespace
}  // namespace brink::tolerances_test
