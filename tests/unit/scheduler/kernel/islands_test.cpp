// Islands: begun, captured, woken, saved.
#include "brink/scheduler/kernel/islands.h"

#include <gtest/gtest.h>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::islands_test {
namespace {

using namespace testing;

/// Contacts of body 0 with the floor that touch now.
std::vector<std::pair<PairKey, FeatureContact>> touching(KernelParts& parts) {
  std::vector<std::pair<PairKey, FeatureContact>> all;
  for (const FeatureContact& c :
       parts.search.touching(kOnFloor, parts.search.limits().tolerance, parts.run.time()))
    all.emplace_back(kOnFloor, c);
  return all;
}

TEST(Islands, WhatLiesFromTheStartIsAtRest) {
  KernelParts parts(on_floor(make_box(1.0, 1.0)), {});
  parts.islands.allow({});
  EXPECT_TRUE(parts.islands.allowed());
  std::vector<int> changed;
  ASSERT_TRUE(parts.islands.begin(touching(parts), changed));
  EXPECT_EQ(changed, std::vector<int>{0});
  ASSERT_EQ(parts.islands.all().size(), 1U);
  EXPECT_TRUE(parts.islands.all().at(0).rests);
  EXPECT_TRUE(parts.islands.is_member(0));
  EXPECT_TRUE(parts.trajectories.is_held(0));
  EXPECT_EQ(parts.islands.next_step(), kForever);
  EXPECT_EQ(parts.islands.step_end(0), kForever);
  EXPECT_EQ(parts.islands.tally().slept, 1U);
  EXPECT_EQ(parts.trajectories.body(0).motion.state(100.0).pose.position, Vec2(0.0, 0.5));
}

TEST(Islands, ADisturbedOneWakesAndStepsOnFromStepToStep) {
  KernelParts parts(on_floor(make_box(1.0, 1.0)), {});
  parts.islands.allow({});
  std::vector<int> changed;
  ASSERT_TRUE(parts.islands.begin(touching(parts), changed));
  ExtendedState pushed = parts.trajectories.state_now(0);
  pushed.twist.velocity.x() = 1;
  const Restart restart{0, pushed};
  parts.trajectories.restart({&restart, 1}, changed);
  ASSERT_TRUE(parts.islands.disturbed(0, changed));
  EXPECT_EQ(parts.islands.tally().woken, 1U);
  EXPECT_FALSE(parts.islands.all().at(0).rests);
  EXPECT_EQ(parts.islands.next_island(), 0);
  // it slides to rest in 1 / 5 s and 1 / 10 m
  double last = 0.0;
  for (int n = 0; n < 1000 && parts.islands.next_step() < kForever; ++n) {
    EXPECT_GT(parts.islands.next_step(), last);
    last = parts.islands.next_step();
    parts.run.set_time(last);
    ASSERT_TRUE(parts.islands.step(changed));
  }
  EXPECT_TRUE(parts.islands.all().at(0).rests);
  EXPECT_NEAR(last, 0.2, 1e-6);
  EXPECT_NEAR(parts.trajectories.body(0).motion.state(last).pose.position.x(), 0.1, 1e-6);
}

// Bounces of a disc have come to their end now: it lasts from here on, and lies still.
TEST(Islands, ACapturedDiscLies) {
  KernelParts parts(on_floor(make_disc(0.5)), {});
  parts.islands.allow({});
  const auto contacts = touching(parts);
  ASSERT_EQ(contacts.size(), 1U);
  std::vector<int> changed;
  ASSERT_TRUE(parts.islands.capture(kOnFloor, contacts[0].second, 0.0, changed));
  EXPECT_EQ(parts.islands.tally().captured, 1U);
  EXPECT_TRUE(parts.islands.all().at(0).rests);
  // the limit lies ahead: there the island has its next step, if only to tell it
  KernelParts ahead(on_floor(make_disc(0.5)), {});
  ahead.islands.allow({});
  ASSERT_TRUE(ahead.islands.capture(kOnFloor, contacts[0].second, 0.25, changed));
  EXPECT_EQ(ahead.islands.next_step(), 0.25);
  ahead.run.set_time(0.25);
  ASSERT_TRUE(ahead.islands.step(changed));
  EXPECT_EQ(ahead.islands.next_step(), kForever);
}

TEST(Islands, AreThoseThatWereSaved) {
  const World world = on_floor(make_box(1.0, 1.0), 0.5, {1.0, 0.0});
  KernelParts parts(world, {}), again(world, {});
  parts.islands.allow({});
  std::vector<int> changed;
  ASSERT_TRUE(parts.islands.begin(touching(parts), changed));
  ASSERT_LT(parts.islands.next_step(), kForever);
  again.trajectories.restore(parts.trajectories.saved(), 0.0);
  again.islands.restore(parts.islands.saved());
  EXPECT_EQ(again.islands.next_step(), parts.islands.next_step());
  EXPECT_EQ(again.islands.tally().captured, parts.islands.tally().captured);
  ASSERT_EQ(again.islands.all().size(), 1U);
  const Island &a = again.islands.all().at(0), &b = parts.islands.all().at(0);
  EXPECT_EQ(a.members, b.members);
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t k = 0; k < a.contacts.size(); ++k)
    EXPECT_EQ(a.contacts[k].normal_force, b.contacts[k].normal_force);
}

}  // namespace
}  // namespace brink::islands_test
