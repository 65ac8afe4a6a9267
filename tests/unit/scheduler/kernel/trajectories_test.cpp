// Motions: made in any instalments the same, started afresh, grouped while running.
#include "brink/scheduler/kernel/trajectories.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::trajectories_test {
namespace {

using namespace testing;

bool same_bits(const BodyState& a, const BodyState& b) {
  return a.pose.position == b.pose.position && a.pose.angle == b.pose.angle &&
         a.twist.velocity == b.twist.velocity && a.twist.omega == b.twist.omega;
}

TEST(Trajectories, InstalmentsMakeTheSameMotionAsOneGo) {
  KernelParts at_once(on_a_spring(), {}), by_parts(on_a_spring(), {});
  ASSERT_TRUE(at_once.trajectories.cover(30.0));
  double reached = 0.0;
  for (double t = 0.3; reached < 30.0; t = std::min(30.0, t * 1.3))
    while (reached < t) reached = by_parts.trajectories.follow(t);
  for (int k = 0; k < 3; ++k)
    EXPECT_TRUE(same_bits(at_once.trajectories.body(k).motion.state(29.5),
                          by_parts.trajectories.body(k).motion.state(29.5)));
  EXPECT_FALSE(at_once.trajectories.is_free(0));
  EXPECT_TRUE(at_once.trajectories.is_free(2));
}

// A motion of an island begins where its body is, or ends the run.
TEST(Trajectories, NobodyIsHeldElsewhereThanHeIs) {
  for (const double off : {0.0, 1e-12, 1e-8}) {
    KernelParts parts(on_a_spring(), {});
    std::vector<int> changed;
    std::vector<Restart> held;
    for (int k = 0; k < 3; ++k) held.push_back({k, parts.trajectories.state_now(k)});
    held[1].state.position.x() += off;
    parts.trajectories.hold(held, changed);
    ASSERT_EQ(parts.run.halt().has_value(), off > 1e-10) << off;
    if (!parts.run.halt()) continue;
    EXPECT_EQ(parts.run.halt()->termination, Termination::failed);
    EXPECT_NE(parts.run.halt()->why.find("jumps by 1e-08 m"), std::string::npos) << parts.run.halt()->why;
  }
}

TEST(Trajectories, ARestartChangesItsComponentAlone) {
  KernelParts parts(on_a_spring(), {});
  parts.trajectories.cover(2.0);
  parts.run.set_time(2.0);
  ExtendedState state(parts.trajectories.body(1).motion.state(2.0));
  state.twist.velocity.x() += 1;
  const Restart restart{1, state};
  std::vector<int> changed;
  parts.trajectories.restart({&restart, 1}, changed);
  EXPECT_EQ(changed, (std::vector<int>{0, 1}));
  EXPECT_EQ(parts.trajectories.body(0).version, 1U);
  EXPECT_EQ(parts.trajectories.body(1).version, 1U);
  EXPECT_EQ(parts.trajectories.body(2).version, 0U);
  EXPECT_EQ(parts.trajectories.body(1).motion.begin(), 2.0);
}

// Two discs that nothing couples are integrated together for a while, and then alone again: they fly as
// before, to the integrator's tolerance; the third keeps its motion.
TEST(Trajectories, BodiesAreJoinedAndSplitWhileRunning) {
  World world = two_discs();
  world.gravity = {0.0, -1.0};
  add(world, body(make_disc(0.5), {0.0, 9.0}, {1.0, 0.0}));
  KernelParts parts(world, {});
  const KernelParts alone(world, {});
  parts.run.set_time(0.25);
  std::vector<int> changed;
  ASSERT_TRUE(parts.trajectories.regroup({{0, 1}}, changed));
  EXPECT_EQ(changed, (std::vector<int>{0, 1}));
  EXPECT_FALSE(parts.trajectories.is_free(0));
  EXPECT_EQ(parts.trajectories.body(0).component, parts.trajectories.body(1).component);
  EXPECT_EQ(parts.trajectories.component_count(), 1U);
  EXPECT_GT(parts.trajectories.body(1).version, 0U);
  EXPECT_EQ(parts.trajectories.body(2).version, 0U);
  ASSERT_TRUE(parts.trajectories.cover(0.75));
  parts.run.set_time(0.75);
  ASSERT_TRUE(parts.trajectories.regroup({}, changed));
  EXPECT_EQ(changed, (std::vector<int>{0, 1}));
  EXPECT_TRUE(parts.trajectories.is_free(0) && parts.trajectories.is_free(1));
  EXPECT_EQ(parts.trajectories.component_count(), 0U);
  for (int k = 0; k < 3; ++k) {
    const BodyState now = parts.trajectories.body(k).motion.state(2.0);
    const BodyState then = alone.trajectories.body(k).motion.state(2.0);
    EXPECT_LT((now.pose.position - then.pose.position).norm(), 1e-9);
    EXPECT_LT((now.twist.velocity - then.twist.velocity).norm(), 1e-9);
  }
  EXPECT_TRUE(
      same_bits(parts.trajectories.body(2).motion.state(2.0), alone.trajectories.body(2).motion.state(2.0)));
}

TEST(Trajectories, WhatIsSavedIsMadeAgainBitForBit) {
  KernelParts parts(on_a_spring(), {}), again(on_a_spring(), {});
  parts.trajectories.cover(2.0);
  parts.run.set_time(2.0);
  ExtendedState state(parts.trajectories.body(0).motion.state(2.0));
  state.twist.omega = 3;
  const Restart restart{0, state};
  std::vector<int> changed;
  parts.trajectories.restart({&restart, 1}, changed);
  parts.trajectories.cover(7.0);
  again.trajectories.restore(parts.trajectories.saved(), 7.0);
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(same_bits(parts.trajectories.body(k).motion.state(7.0),
                          again.trajectories.body(k).motion.state(7.0)));
    EXPECT_EQ(parts.trajectories.body(k).version, again.trajectories.body(k).version);
  }
}

}  // namespace
}  // namespace brink::trajectories_test
