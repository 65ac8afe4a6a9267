// How an island goes on: impacts at once, then rest, or a step.
#include "brink/scheduler/kernel/island_motion.h"

#include <gtest/gtest.h>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::island_motion_test {
namespace {

using namespace testing;

/// The island of body 0.
struct Alone {
  explicit Alone(const World& world)
      : parts(world, {}),
        motion((hold(parts, {0}), members_of(parts, {0})), parts.search, parts.response, solver, tally,
               WarmContacts(), {}) {}
  int pass_on_impacts() {
    int told = 0;
    motion.pass_on_impacts([&](const HeldContact&, const RealVec&, double, const ImpulseResult&) { ++told; });
    return told;
  }

  KernelParts parts;
  ConeQp solver;
  IslandTally tally;
  IslandMotion motion;
};

double sum_of_forces(const Island& island) {
  double sum = 0.0;
  for (const HeldContact& c : island.contacts) sum += c.normal_force;
  return sum;
}

TEST(IslandMotion, WhatLiesAndIsHeldRests) {
  Alone box(on_floor(make_box(1.0, 1.0)));
  EXPECT_EQ(box.pass_on_impacts(), 0);
  ASSERT_TRUE(box.motion.rests(0.0));
  const IslandParts parts = box.motion.parting().parts(true);
  EXPECT_EQ(parts.together, std::vector<std::vector<int>>{{0}});
  EXPECT_TRUE(parts.free.empty());
  const Island island = box.motion.parting().island_of({0}, true, 0.0);
  EXPECT_TRUE(island.rests);
  EXPECT_NEAR(sum_of_forces(island), 10.0, 1e-9);
}

TEST(IslandMotion, WhatNothingHoldsDoesNotRestAndIsLetGo) {
  Alone box(on_floor(make_box(1.0, 1.0), 0.5, {0.0, 0.0}, 0.75));
  box.pass_on_impacts();
  EXPECT_FALSE(box.motion.rests(0.0));
  ASSERT_TRUE(box.motion.take(box.motion.longest(), 0.0));
  EXPECT_EQ(box.motion.parting().parts(false).free, std::vector<int>{0});
  EXPECT_NEAR(box.motion.after(0).rounded().twist.velocity.y(), -10.0 * box.motion.duration(), 1e-12);
}

// It loses mu g h = 5 h in a step of h.
TEST(IslandMotion, WhatSlidesIsSlowedByFriction) {
  Alone box(on_floor(make_box(1.0, 1.0), 0.5, {1.0, 0.0}));
  EXPECT_EQ(box.pass_on_impacts(), 0);
  EXPECT_FALSE(box.motion.rests(0.0));
  ASSERT_TRUE(box.motion.take(box.motion.longest(), 0.0));
  const double h = box.motion.duration();
  EXPECT_GT(h, 0.0);
  const BodyState after = box.motion.after(0).rounded();
  EXPECT_NEAR(after.twist.velocity.x(), 1.0 - 5.0 * h, 1e-5);
  EXPECT_NEAR(after.twist.velocity.y(), 0.0, 1e-5);
  EXPECT_NEAR(after.twist.omega, 0.0, 1e-5);
  EXPECT_EQ(box.motion.parting().parts(false).together, std::vector<std::vector<int>>{{0}});
  EXPECT_NEAR(sum_of_forces(box.motion.parting().island_of({0}, false, h)), 10.0, 1e-4);
}

// Restitution 0.5: down by 2 m/s, up by 1.
TEST(IslandMotion, ImpactsComeFirstByTheirOwnLaw) {
  Alone disc(on_floor(make_disc(0.5), 0.0, {0.0, -2.0}));
  EXPECT_EQ(disc.pass_on_impacts(), 1);
  EXPECT_NEAR(static_cast<double>(disc.motion.members().state(0).twist.velocity.y()), 1.0, 1e-15);
  EXPECT_FALSE(disc.motion.rests(0.0));
}

TEST(IslandMotion, WhereNothingMovesOrPullsAStepHasNoEnd) {
  World world = on_floor(make_disc(0.5));
  world.gravity = {0.0, 0.0};
  const Alone disc(world);
  EXPECT_EQ(disc.motion.longest(), kForever);
}

}  // namespace
}  // namespace brink::island_motion_test
