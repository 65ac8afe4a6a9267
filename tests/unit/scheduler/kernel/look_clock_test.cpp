// When the watch looks beside frames: at all multiples in small worlds, at few of them in large ones, the same for a run
// that goes on.
#include <gtest/gtest.h>

#include <vector>

#include "brink/scheduler/kernel/look_clock.h"

namespace brink::look_clock_test {
namespace {

std::vector<double> looks(LookClock& clock, double until, double collisions_a_second) {
  std::vector<double> times;
  for (double t = 0.0; t <= until; t += 0.125)
    while (const auto due = clock.due(t, static_cast<std::uint64_t>(collisions_a_second * t)))
      times.push_back(*due);
  return times;
}

LookClock clock_of(int owners, double from = 0.0, double frame_interval = 0.0) {
  RunOptions options;
  options.until = 64.0;
  options.frame_interval = frame_interval;
  LookClock clock;
  clock.begin(options, owners, from);
  return clock;
}

TEST(LookClock, LooksEachTimeInASmallWorld) {
  LookClock clock = clock_of(10);
  const std::vector<double> times = looks(clock, 64.0, 0.0);
  ASSERT_EQ(times.size(), 64U);
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_EQ(times[k], static_cast<double>(k + 1));
}

// Owners that are looked at, over all looks, against those that collide.
TEST(LookClock, CostsLittleInALargeOne) {
  for (const int owners : {1000, 100000})
    for (const double rate : {0.0, 1e3, 1e6, 1e8}) {
      LookClock clock = clock_of(owners);
      const std::vector<double> times = looks(clock, 64.0, rate);
      const double most = 4096.0 + rate;
      EXPECT_LE(static_cast<double>(times.size()) * owners, 4.0 * most) << owners << " " << rate;
      if (most >= 128.0 * owners) {
        EXPECT_EQ(times.size(), 64U) << owners << " " << rate;
      }
    }
}

TEST(LookClock, GoesOnAtTheSameTimes) {
  for (const double stopped : {0.5, 16.0, 31.75, 63.0}) {
    LookClock whole = clock_of(1000), rest = clock_of(1000, stopped);
    std::vector<double> expected = looks(whole, 64.0, 1e4);
    std::erase_if(expected, [&](double t) { return t <= stopped; });
    EXPECT_EQ(looks(rest, 64.0, 1e4), expected) << stopped;
  }
}

TEST(LookClock, LeavesItToFramesThatComeAsOften) {
  LookClock often = clock_of(10, 0.0, 1.0), seldom = clock_of(10, 0.0, 1.5);
  EXPECT_TRUE(looks(often, 64.0, 0.0).empty());
  EXPECT_EQ(looks(seldom, 64.0, 0.0).size(), 64U);
}

// A run far beyond the duration that its interval is of: as many looks as it doubles times, and at once.
TEST(LookClock, LeavesOutManyAtOnce) {
  RunOptions options;
  options.look_interval = 1e-6;
  options.until = 1e9;
  for (const int owners : {1, 1000, 10000000}) {
    LookClock clock;
    clock.begin(options, owners, 0.0);
    double last = 0.0;
    int looks = 0;
    while (const auto due = clock.due(options.until, 0)) {
      EXPECT_GT(*due, last);
      last = *due;
      ++looks;
    }
    EXPECT_LE(looks, 4096.0 / owners * 64.0);
    EXPECT_TRUE(owners > 4096 || last > 0.1 * options.until);
  }
}

TEST(LookClock, TellsALookOnce) {
  LookClock clock = clock_of(10);
  EXPECT_EQ(clock.due(0.99, 0), std::nullopt);
  EXPECT_EQ(clock.due(2.5, 0), 1.0);
  EXPECT_EQ(clock.due(2.5, 0), 2.0);
  EXPECT_EQ(clock.due(2.5, 0), std::nullopt);
}

}  // namespace
}  // namespace brink::look_clock_test
