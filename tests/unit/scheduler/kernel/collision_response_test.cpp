// What one collision does to motions.
#include "brink/scheduler/kernel/collision_response.h"

#include <gtest/gtest.h>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::collision_response_test {
namespace {

using namespace testing;

TEST(CollisionResponse, ElasticDiscsExchangeVelocities) {
  KernelParts parts(two_discs(), {});
  const Certificate c = meeting(parts);
  parts.run.set_time(c.time);
  std::vector<int> changed;
  const auto outcome = parts.response.collide(kDiscs, c.contact, changed);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(changed, (std::vector<int>{0, 1}));
  EXPECT_NEAR(outcome->impulse_n, 2.0, 1e-14);
  EXPECT_NEAR(parts.trajectories.body(0).motion.twist(2.0).velocity.x(), 0.0, 1e-14);
  EXPECT_NEAR(parts.trajectories.body(1).motion.twist(2.0).velocity.x(), 2.0, 1e-14);
  EXPECT_EQ(parts.trajectories.body(0).last_partner, 1);
}

TEST(CollisionResponse, LossIsThatOfThePairsMaterial) {
  for (const double e : {0.0, 0.5, 1.0}) {
    KernelParts parts(two_discs(e), {});
    EXPECT_EQ(parts.response.loss_of(kDiscs), e == 0.0   ? BounceLoss::all
                                              : e == 1.0 ? BounceLoss::none
                                                         : BounceLoss::some);
  }
  // friction takes from what slides on, and with it from the approach
  for (const double tangential : {0.0, 1.0}) {
    World rough = two_discs(1.0);
    rough.materials[0].friction = 0.25;
    rough.materials[0].tangential_restitution = tangential;
    KernelParts parts(rough, {});
    EXPECT_EQ(parts.response.loss_of(kDiscs), BounceLoss::some);
  }
}

// A wall that comes towards a body which is held: no finite impulse parts them.
TEST(CollisionResponse, WhatCannotMoveJams) {
  World world = two_discs();
  Body& held = world.bodies[1];
  held.lock_x = held.lock_y = held.lock_angle = true;
  world.sites[0].motion = ConstantMotion{{{-1.0, 0.0}, 0.0}};
  KernelParts parts(world, {});
  const auto c = parts.search.search(kWall, parts.trajectories.body(1), nullptr, 0.0, 10.0);
  ASSERT_TRUE(c);
  parts.run.set_time(c->time);
  std::vector<int> changed;
  EXPECT_FALSE(parts.response.collide(kWall, c->contact, changed));
  ASSERT_TRUE(parts.run.halt());
  EXPECT_NE(parts.run.halt()->why.find("'body1' on 'site0' at t = 1."), std::string::npos);
  EXPECT_NE(parts.run.halt()->why.find("neither side can move"), std::string::npos);
}

// A contact that a picture shows is taken as it is told, wherever the outlines are.
TEST(CollisionResponse, ASeenContactIsTakenAsItIs) {
  KernelParts parts(two_discs(), {});
  FeatureContact contact;
  contact.sample = contact.site = 0;
  contact.seen = true;
  contact.normal = {-0.6, -0.8};
  contact.point = {2.0, 0.0};
  contact.closing_speed = 1.2;
  std::vector<int> changed;
  const auto outcome = parts.response.collide(kDiscs, contact, changed);
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->delay, 0);
  const Vec2 given = parts.trajectories.body(1).motion.twist(0.0).velocity;
  EXPECT_NEAR(given.y() / given.x(), 0.8 / 0.6, 1e-12);
}

TEST(CollisionResponse, TimeSinceTheLastIsTold) {
  KernelParts parts(two_discs(), {});
  EXPECT_TRUE(std::isinf(parts.response.note_resolve(0, 1, 1.0)));
  parts.run.set_time(0.5);
  EXPECT_EQ(parts.response.note_resolve(0, 1, 1.0), 0.5);
  EXPECT_EQ(parts.trajectories.body(0).streak, 2U);
  parts.response.note_resolve(0, 2, 1.0);
  EXPECT_EQ(parts.trajectories.body(0).streak, 1U);
}

}  // namespace
}  // namespace brink::collision_response_test
