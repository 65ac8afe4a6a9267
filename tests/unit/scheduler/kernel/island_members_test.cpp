// Members of an island, what pulls at them and what is near them.
#include "brink/scheduler/kernel/island_members.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::island_members_test {
namespace {

using namespace testing;

TEST(IslandMembers, ABoxOnTheFloorTouchesByItsTwoLowerCorners) {
  KernelParts parts(on_floor(make_box(1.0, 1.0)), {});
  EXPECT_EQ(hold(parts, {0}), std::vector<int>{0});
  IslandMembers members = members_of(parts, {0});
  EXPECT_EQ(members.acceleration(0).linear, Vec2(0.0, -10.0));
  EXPECT_EQ(members.pull(), 10.0);
  EXPECT_EQ(members.heaviest(), 1.0);
  const std::vector<HeldContact> contacts = members.contacts(1e-3);
  ASSERT_EQ(contacts.size(), 2U);
  for (const HeldContact& c : contacts) {
    EXPECT_EQ(c.pair, kOnFloor);
    EXPECT_NEAR(c.feature.gap, 0.0, 1e-15);
    EXPECT_NEAR(static_cast<double>(members.arm(c).y()), -0.5, 1e-15);
    EXPECT_NEAR(std::abs(static_cast<double>(members.arm(c).x())), 0.5, 1e-15);
    EXPECT_EQ(members.closing_speed(c), 0.0);
    EXPECT_NEAR(members.gap(c, 0.25, {Vec3(3.0, 2.0, 0.0)}), 0.5, 1e-15);
    EXPECT_FALSE(members.on_moving_site(c));
  }
}

TEST(IslandMembers, AnotherTwistClosesFaster) {
  KernelParts parts(on_floor(make_disc(0.5)), {});
  hold(parts, {0});
  IslandMembers members = members_of(parts, {0});
  const std::vector<HeldContact> contacts = members.contacts(1e-3);
  ASSERT_EQ(contacts.size(), 1U);
  ExtendedTwist falls;
  falls.velocity = RealVec(Real(0.0), Real(-3.0));
  EXPECT_EQ(members.closing_speed(contacts[0], falls, ExtendedTwist()), 3.0);
  EXPECT_EQ(members.closing_speed(contacts[0]), 0.0);
  members.set_twist(0, falls);
  members.find_speeds();
  EXPECT_EQ(members.closing_speed(contacts[0]), 3.0);
  EXPECT_EQ(members.speed(), 3.0);
}

// As far as it flies and falls in the step, at the least.
TEST(IslandMembers, ComeNoFartherThanTheirReach) {
  KernelParts parts(on_floor(make_disc(0.5), 0.0, {4.0, 0.0}, 3.0), {});
  hold(parts, {0});
  IslandMembers members = members_of(parts, {0});
  members.look_ahead(0.1, 1.0);
  EXPECT_GE(members.reach_of(0), std::hypot(0.4, 0.05));
  EXPECT_LE(members.reach_of(0), 1.0);
  const Box box = members.box(0);
  EXPECT_TRUE(box.contains({0.4, 2.95}));
}

TEST(IslandMembers, AreNamedByTheirPlaceAndSeeEachOther) {
  World world = on_floor(make_disc(0.5));
  add(world, body(make_disc(0.25), {9.0, 0.25}, {0.0, 0.0}));
  add(world, body(make_disc(0.5), {1.0, 0.5}, {0.0, 0.0}));
  KernelParts parts(world, {});
  hold(parts, {0, 2});
  const IslandMembers members = members_of(parts, {2, 0});
  EXPECT_EQ(members.bodies(), (std::vector<int>{0, 2}));
  EXPECT_EQ(members.place_of(2), 1);
  EXPECT_TRUE(members.has(2));
  EXPECT_FALSE(members.has(1));
  EXPECT_EQ(members.coupled_to(1), std::vector<int>{1});
  int between = 0, with_floor = 0;
  for (const HeldContact& c : members.contacts(1e-3)) (c.pair.with_site() ? with_floor : between) += 1;
  EXPECT_EQ(with_floor, 2);
  EXPECT_GE(between, 1);
}

}  // namespace
}  // namespace brink::island_members_test
