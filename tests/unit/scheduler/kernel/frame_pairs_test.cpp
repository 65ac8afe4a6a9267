// Which pairs are seen at frames: everyone who overlaps, and few of those who do not.
#include "brink/scheduler/kernel/frame_pairs.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/seeded_random.h"
#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::frame_pairs_test {
namespace {

using namespace testing;

/// Bodies that fly through each other, as nobody resolves anything, and a wall and a container.
World flying(Random& random, int bodies, double speed, double spin) {
  World world;
  for (int k = 0; k < bodies; ++k) {
    const double angle = random.uniform(0.0, 2.0 * M_PI);
    const Shape shape = k % 3 == 0   ? make_disc(0.5)
                        : k % 3 == 1 ? make_box(1.6, 0.3)
                                     : make_polygon({{0, 0}, {1, 0.2}, {2, 0}, {1.2, 0.6}, {1, 1.5}});
    add(world, body(shape, {random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0)},
                    speed * Vec2(std::cos(angle), std::sin(angle)), 1.0, angle, random.uniform(-spin, spin)));
  }
  add(world, site(make_segment({-7.0, 1.0}, {7.0, -1.0}, 0.0)));
  return world;
}

struct Tally {
  long all = 0, overlapping = 0, looked = 0;
};

/// Frames at times. Everyone in another must have been seen, as it is, and each once, in order.
Tally see(const World& world, const std::vector<double>& times) {
  KernelParts parts(world, {});
  FramePairs pairs(world, parts.trajectories, parts.search, parts.near, parts.run);
  Tally tally;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double t = times[k];
    std::set<PairKey> looked;
    pairs.each(t, [&](const PairKey& pair, double at_least, double at_most) {
      EXPECT_LE(at_least, parts.search.gap(pair, t)) << "frame " << k;
      EXPECT_TRUE(looked.empty() || *looked.rbegin() < pair) << "frame " << k;
      looked.insert(pair);
      return std::optional(parts.search.gap(pair, t, at_most));
    });
    tally.looked += static_cast<long>(looked.size());
    for (int a = 0; a < parts.trajectories.body_count(); ++a)
      for (int b = a + 1; b < parts.trajectories.owner_count(); ++b) {
        const PairKey pair = *parts.search.pair_of(a, b, {});
        ++tally.all;
        if (parts.search.gap(pair, t) >= 0.0) continue;
        ++tally.overlapping;
        EXPECT_TRUE(looked.count(pair)) << a << " in " << b << " at frame " << k;
      }
  }
  return tally;
}

std::vector<double> even(int frames, double interval) {
  std::vector<double> times;
  for (int k = 0; k < frames; ++k) times.push_back(k * interval);
  return times;
}

TEST(FramePairs, EveryoneWhoOverlapsIsSeen) {
  SeededRandom random(20261125);
  long overlapping = 0;
  for (int k = 0; k < 20; ++k) {
    const double speed = std::pow(10.0, random.uniform(-2.0, 2.0)),
                 spin = std::pow(10.0, random.uniform(-2.0, 2.0));
    const Tally tally = see(flying(random, 12, speed, spin), even(150, 0.02 * std::min(1.0, 3.0 / speed)));
    overlapping += tally.overlapping;
  }
  EXPECT_GT(overlapping, 2000);
}

// From frame to frame bodies go a hundredth of the world, or farther than any list of near pairs would hold for.
TEST(FramePairs, EveryoneWhoOverlapsIsSeenWhereSomeFramesAreFarApart) {
  SeededRandom random(20261127);
  Tally all;
  for (int k = 0; k < 60; ++k) {
    const World world = flying(random, 12, 1.0, random.uniform(0.0, 1.0));
    std::vector<double> times{0.0};
    while (times.size() < 20) {
      const bool far = random.uniform(0.0, 1.0) < 0.5;
      times.push_back(times.back() + random.uniform(0.5, 1.0) * (far ? 1.0 : 0.01));
    }
    const Tally tally = see(world, times);
    all.all += tally.all;
    all.overlapping += tally.overlapping;
    all.looked += tally.looked;
  }
  EXPECT_GT(all.overlapping, 1000);
  EXPECT_LT(all.looked, all.all / 4);
}

TEST(FramePairs, WhoIsFarFromAllIsSeldomSeen) {
  SeededRandom random(20261126);
  World world;
  for (int k = 0; k < 30; ++k)
    add(world, body(make_box(1.0, 0.4), {2.0 * (k % 6), 2.0 * (k / 6)}, {random.uniform(-0.1, 0.1), 0.0}));
  const Tally tally = see(world, even(200, 1.0 / 60.0));
  EXPECT_EQ(tally.overlapping, 0);
  EXPECT_LT(tally.looked, tally.all / 100);
}

TEST(FramePairs, TwoThatStandAreSeenOnceAndAgainWhenAllIsForgotten) {
  World world;
  add(world, body(make_box(1.0, 1.0), {0.0, 0.0}, {0.0, 0.0}));
  add(world, body(make_box(1.0, 1.0), {0.9, 0.0}, {0.0, 0.0}));
  KernelParts parts(world, {});
  FramePairs pairs(world, parts.trajectories, parts.search, parts.near, parts.run);
  int looks = 0;
  const auto frame = [&](double t) {
    pairs.each(t, [&](const PairKey& pair, double, double) {
      ++looks;
      return std::optional(parts.search.gap(pair, t));
    });
  };
  for (const double t : {0.0, 1.0, 2.0}) frame(t);
  EXPECT_EQ(looks, 1);
  pairs.clear();
  frame(3.0);
  EXPECT_EQ(looks, 2);
}

}  // namespace
}  // namespace brink::frame_pairs_test
