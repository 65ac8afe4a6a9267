// Who can meet whom: by bounds, and by looking at all.
#include "brink/scheduler/kernel/near_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::near_pairs_test {
namespace {

using namespace testing;

TEST(NearPairs, ThoseWhoseBoundsMeetInTheTimeAsked) {
  KernelParts parts(two_discs(), {});
  EXPECT_TRUE(parts.near.all(0.0, 0.9).empty());
  EXPECT_EQ(parts.near.all(0.0, 1.1), std::vector<PairKey>{kDiscs});
  EXPECT_EQ(parts.near.of(1, 0.0, 1.1, false), std::vector<PairKey>{kDiscs});
}

// A container far from the place that it turns about: the whole arm counts.
TEST(NearPairs, APassSeesAContainerThatTurnsAboutAFarPlace) {
  World world;
  testing::add(world, testing::body(make_disc(0.2), {11.0, 1.0}, {0.0, 0.0}));
  FixedSite room = testing::site(make_disc(1.0));
  room.outline =
      std::make_shared<Outline>(as_container(transformed(make_box(2, 2).outline, {{11.0, 1.0}, 0.0})));
  room.motion = ConstantMotion{{{0.0, 0.0}, 0.2}};
  testing::add(world, room);
  SolverOptions options;
  options.detector = "pass";
  KernelParts parts(world, options);
  // its lower side rises at 2.2 m/s
  EXPECT_EQ(parts.near.of(0, 0.0, 0.4, false).size(), 1U);
}

TEST(NearPairs, EveryPairWithoutTheBroadPhase) {
  SolverOptions options;
  options.broad_phase = false;
  KernelParts parts(two_discs(), options);
  EXPECT_EQ(parts.near.all(0.0, 0.1).size(), 3U);
}

// A body that has changed has other bounds; while motions are ahead of what is certain, its former ones too.
TEST(NearPairs, AChangedBodyHasNewBounds) {
  KernelParts parts(two_discs(), {});
  parts.near.all(0.0, 1.5);
  BodyTrack& b = parts.trajectories.body(0);
  b.motion = Motion::ballistic(0.0, {{{0.0, 0.0}, 0.0}, {{-2.0, 0.0}, 0.0}}, {});
  ++b.version;
  EXPECT_EQ(parts.near.of(1, 0.0, 1.5, true), std::vector<PairKey>{kDiscs});
  ++b.version;
  EXPECT_TRUE(parts.near.of(1, 0.0, 1.5, false).empty());
}

TEST(NearPairs, AtATimeThoseThatOverlapThen) {
  KernelParts parts(two_discs(), {});
  int met = 0;
  parts.near.each_at(1.5, [&](const PairKey& pair) {
    EXPECT_EQ(pair, kDiscs);
    return ++met, true;
  });
  EXPECT_EQ(met, 1);
}

}  // namespace
}  // namespace brink::near_pairs_test
