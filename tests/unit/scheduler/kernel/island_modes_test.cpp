// A small island's step at the level of accelerations.
#include "brink/scheduler/kernel/island_modes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::island_modes_test {
namespace {

using namespace testing;

constexpr double kStep = 0.0078125;  // [s]

/// The step by modes of body 0, of kStep at most.
struct Stepped {
  /// `listed`: of the contacts nearby those that the step is told of.
  explicit Stepped(
      const World& world, const IslandModes::Limits& limits = {},
      const std::function<bool(const HeldContact&)>& listed = [](const HeldContact&) { return true; })
      : parts(world, {}),
        members((hold(parts, {0}), members_of(parts, {0}))),
        modes(members, parts.trajectories, parts.search, parts.response, limits, warm) {
    members.look_ahead(kStep, 2.0);
    std::vector<HeldContact> contacts = members.contacts(-1.0);
    std::erase_if(contacts, std::not_fn(listed));
    outcome = modes.take(0.0, kStep, contacts, false);
  }

  KernelParts parts;
  IslandMembers members;
  WarmContacts warm;
  IslandModes modes;
  IslandModes::Outcome outcome;
};

TEST(IslandModes, ASlidingBoxIsExact) {
  const Stepped box(on_floor(make_box(1.0, 1.0), 0.5, {1.0, 0.0}));
  ASSERT_EQ(box.outcome, IslandModes::Outcome::moved);
  EXPECT_EQ(box.modes.end(), kStep);
  const BodyState end = box.modes.motion(0).state(kStep);
  EXPECT_NEAR(end.twist.velocity.x(), 1.0 - 5.0 * kStep, 1e-10);
  EXPECT_NEAR(end.pose.position.x(), kStep - 2.5 * kStep * kStep, 1e-10);
  EXPECT_NEAR(end.pose.position.y(), 0.5, 1e-10);
  EXPECT_NEAR(end.pose.angle, 0.0, 1e-10);
  double force = 0.0;
  for (const HeldContact& c : box.modes.contacts()) force += c.normal_force;
  EXPECT_NEAR(force, 10.0, 1e-9);
  EXPECT_TRUE(box.modes.impacts().empty());
  for (const IslandModes::Change& c : box.modes.changes()) EXPECT_EQ(c.kind, EventKind::slip);
}

// v = omega R: friction has nothing to do.
TEST(IslandModes, ADiscThatRollsRollsOn) {
  World world = on_floor(make_disc(0.5), 0.5, {1.0, 0.0});
  world.bodies[0].initial.twist.omega = -2.0;
  const Stepped disc(world);
  ASSERT_EQ(disc.outcome, IslandModes::Outcome::moved);
  const BodyState end = disc.modes.motion(0).state(kStep);
  EXPECT_NEAR(end.twist.velocity.x(), 1.0, 1e-10);
  EXPECT_NEAR(end.twist.omega, -2.0, 1e-10);
  const auto contacts = disc.modes.contacts();
  EXPECT_TRUE(std::any_of(contacts.begin(), contacts.end(),
                          [](const HeldContact& c) { return c.motion == MotionMode::stick; }));
}

TEST(IslandModes, WhatMeetsFastIsToldAndStopped) {
  const Stepped disc(on_floor(make_disc(0.5), 0.0, {0.0, -0.5}));
  ASSERT_EQ(disc.outcome, IslandModes::Outcome::moved);
  ASSERT_EQ(disc.modes.impacts().size(), 1U);
  EXPECT_NEAR(disc.modes.impacts()[0].closing, 0.5, 1e-15);
  EXPECT_NEAR(disc.modes.impacts()[0].normal, 0.5, 1e-10);
  EXPECT_NEAR(disc.modes.motion(0).state(kStep).twist.velocity.y(), 0.0, 1e-10);
}

// A box slides by 7.8 mm, and a wall stands 2 mm ahead: told of it the step ends there; not told, whole outlines are looked at
// where it ends, and there is no step.
TEST(IslandModes, AFeatureThatNobodyListedIsSeenAtTheEnd) {
  World world = on_floor(make_box(1.0, 1.0), 0.0, {1.0, 0.0});
  add(world, site(make_segment({0.502, 0.25}, {0.502, 2.0}, 0.0)));
  const Stepped told(world);
  ASSERT_EQ(told.outcome, IslandModes::Outcome::moved);
  EXPECT_NEAR(told.modes.motion(0).pose(told.modes.end()).position.x(), 0.002, 1e-10);
  const Stepped untold(world, {}, [](const HeldContact& c) { return c.pair.other_site == 0; });
  EXPECT_EQ(untold.outcome, IslandModes::Outcome::none);
}

TEST(IslandModes, AreForFewContacts) {
  KernelParts parts(on_floor(make_box(1.0, 1.0)), {});
  hold(parts, {0});
  const IslandMembers members = members_of(parts, {0});
  const WarmContacts warm;
  const auto fit = [&](std::size_t contacts) {
    return IslandModes(members, parts.trajectories, parts.search, parts.response, {1e-10, contacts}, warm)
        .fit();
  };
  EXPECT_EQ(fit(16), IslandModes::Fit::suited);
  EXPECT_EQ(fit(1), IslandModes::Fit::too_large);
  EXPECT_EQ(fit(0), IslandModes::Fit::too_large);
}

}  // namespace
}  // namespace brink::island_modes_test
