// Who joins an island before it steps: who comes to touch it within the step, and slowly.
#include "brink/scheduler/kernel/island_joining.h"

#include <gtest/gtest.h>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::island_joining_test {
namespace {

using namespace testing;

/// Who joins the disc on the floor in a step of 0.02 s, of one that is `gap` [m] above it and comes down with
/// `speed` [m/s]; `absorbed` [m/s]: what a step takes without a rebound.
std::vector<int> who_joins(double gap, double speed, double absorbed) {
  World world = on_floor(make_disc(0.5));
  add(world, body(make_disc(0.5), {0.0, 1.5 + gap}, {0.0, -speed}));
  add(world, body(make_disc(0.5), {9.0, 0.5}, {0.0, 0.0}));  // far away
  KernelParts parts(world, {});
  hold(parts, {0});
  IslandMembers members = members_of(parts, {0});
  members.look_ahead(0.02, 2.0);
  return joining(parts.world, parts.trajectories, parts.search, members, 0.0, 0.02,
                 [absorbed](const PairKey&) { return absorbed; }, {});
}

TEST(IslandJoining, WhoComesSlowlyAndInTimeJoins) {
  EXPECT_EQ(who_joins(1e-3, 0.1, 0.5), std::vector<int>{1});
}

TEST(IslandJoining, WhoComesFastIsAnImpact) { EXPECT_TRUE(who_joins(1e-3, 0.1, 0.05).empty()); }

// Both may be 0.02 s * (0.1 + 10 * 0.02) m/s nearer then.
TEST(IslandJoining, WhoDoesNotComeInTimeWaits) { EXPECT_TRUE(who_joins(0.05, 0.1, 0.5).empty()); }

}  // namespace
}  // namespace brink::island_joining_test
