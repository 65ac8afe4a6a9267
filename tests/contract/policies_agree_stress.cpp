// Gases of 1e5 collisions and more, event by event under every exact policy; by hand.
#include <gtest/gtest.h>

#include "tests/support/gases.h"
#include "tests/support/same_events.h"

namespace brink::policies_agree_stress {
namespace {

constexpr std::uint64_t kCollisions = 100000;

TEST(PoliciesOnLongRuns, DiscsInABoxGiveTheSameEvents) {
  EXPECT_GE(
      testing::expect_same_events(testing::boxed(testing::lattice_gas(100, make_disc(0.5), 0.5)), {}, 270.0),
      kCollisions);
}

TEST(PoliciesOnLongRuns, PeriodicDiscsGiveTheSameEvents) {
  EXPECT_GE(testing::expect_same_events(testing::lattice_gas(100, make_disc(0.5), 0.5), {}, 285.0),
            kCollisions);
}

TEST(PoliciesOnLongRuns, SpinningBoxesGiveTheSameEvents) {
  EXPECT_GE(testing::expect_same_events(
                testing::boxed(testing::lattice_gas(49, make_box(1.0, 0.6), 0.4, 1.0)), {}, 1000.0),
            kCollisions);
}

}  // namespace
}  // namespace brink::policies_agree_stress
