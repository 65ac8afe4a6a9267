/// Joints of fixed sites that go on straight into each other.
#include "brink/core/world/straight_joints.h"

#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "brink/core/shapes/shapes.h"

namespace brink::straight_joints_test {
namespace {

constexpr double kTolerance = 1e-10;

World world_of(const std::vector<std::pair<Shape, Pose>>& sites) {
  World world;
  for (const auto& [shape, pose] : sites) {
    FixedSite site;
    site.name = "site" + std::to_string(world.sites.size());
    site.outline = std::make_shared<const Outline>(shape.outline);
    site.pose = pose;
    world.sites.push_back(site);
  }
  return world;
}

/// Ends noted as straight, of all sides of an outline.
int straight_ends(const Outline& outline) {
  int count = 0;
  for (const Site& s : outline.sites) count += int{s.straight_a} + int{s.straight_b};
  return count;
}

int covered_sides(const Outline& outline) {
  int count = 0;
  for (const Site& s : outline.sites) count += int{s.covered};
  return count;
}

/// Corners that something can meet.
int corners(const Outline& outline) {
  int count = 0;
  for (const Sample& s : outline.samples) count += int{!s.hollow};
  return count;
}

TEST(StraightJoints, OfSegmentsThatGoOnAreNoted) {
  const auto joined = with_straight_joints(
      world_of({{make_segment({-1, 0}, {0, 0}), {}}, {make_segment({0, 0}, {2, 0}), {}}}), kTolerance);
  EXPECT_FALSE(joined[0]->sites[0].straight_a);
  EXPECT_TRUE(joined[0]->sites[0].straight_b);
  EXPECT_TRUE(joined[1]->sites[0].straight_a);
  EXPECT_FALSE(joined[1]->sites[0].straight_b);
  EXPECT_EQ(corners(*joined[0]), 1);
}

TEST(StraightJoints, WiresMayRunEitherWay) {
  const auto joined = with_straight_joints(
      world_of({{make_segment({-1, 0}, {0, 0}), {}}, {make_segment({2, 0}, {0, 0}), {}}}), kTolerance);
  EXPECT_TRUE(joined[0]->sites[0].straight_b);
  EXPECT_TRUE(joined[1]->sites[0].straight_b);
}

TEST(StraightJoints, TurnedAndPlacedAreTheSame) {
  const Pose pose{{300.0, -500.0}, 0.7};
  const auto joined = with_straight_joints(
      world_of({{make_segment({-1, 0}, {0, 0}), pose}, {make_segment({0, 0}, {2, 0}), pose}}), kTolerance);
  EXPECT_EQ(straight_ends(*joined[0]), 1);
  EXPECT_EQ(straight_ends(*joined[1]), 1);
}

TEST(StraightJoints, WhatBendsPartsOrDiffersInThicknessIsNoJoint) {
  const std::vector<Shape> others{make_segment({0, 0}, {2, 1e-6}), make_segment({1e-8, 0}, {2, 0}),
                                  make_segment({0, 1e-8}, {2, 1e-8}), make_segment({0, 0}, {2, 0}, 0.1),
                                  make_segment({0, 0}, {-2, 0})};
  for (std::size_t k = 0; k < others.size(); ++k) {
    const World world = world_of({{make_segment({-1, 0}, {0, 0}), {}}, {others[k], {}}});
    const auto joined = with_straight_joints(world, kTolerance);
    EXPECT_EQ(straight_ends(*joined[0]), 0) << k;
    EXPECT_EQ(joined[1], world.sites[1].outline) << k << ": it keeps its outline";
  }
}

TEST(StraightJoints, MovingSitesHaveNone) {
  World world = world_of({{make_segment({-1, 0}, {0, 0}), {}}, {make_segment({0, 0}, {2, 0}), {}}});
  world.sites[1].motion = ConstantMotion{};
  EXPECT_EQ(straight_ends(*with_straight_joints(world, kTolerance)[0]), 0);
}

TEST(StraightJoints, BlocksSideBySideCoverEachOther) {
  const auto joined = with_straight_joints(
      world_of({{make_box(1, 1), {{0.5, 0.5}, 0.0}}, {make_box(1, 1), {{1.5, 0.5}, std::numbers::pi}}}),
      kTolerance);
  for (const auto& block : joined) {
    EXPECT_EQ(covered_sides(*block), 1);
    EXPECT_EQ(straight_ends(*block), 2);
    EXPECT_EQ(corners(*block), 2);
  }
}

// A wall of bricks: the long one's top is covered by two halves, theirs by it in part alone.
TEST(StraightJoints, SeveralCoverOneSideButOneWithoutAllOfItNone) {
  const auto joined = with_straight_joints(world_of({{make_box(2, 1), {{0.0, 0.5}, 0.0}},
                                                     {make_box(2, 1), {{-1.0, 1.5}, 0.0}},
                                                     {make_box(2, 1), {{1.0, 1.5}, 0.0}}}),
                                           kTolerance);
  EXPECT_EQ(covered_sides(*joined[0]), 1);
  EXPECT_EQ(covered_sides(*joined[1]), 1) << "by its neighbour alone";
  EXPECT_EQ(covered_sides(*joined[2]), 1);
}

TEST(StraightJoints, AtTheEdgeOfAPeriodicPlaneTheLastMeetsTheFirst) {
  World world = world_of({{make_segment({0, 1}, {4, 1}), {}}, {make_segment({4, 1}, {10, 1}), {}}});
  world.periods.size = {10.0, 0.0};
  const auto joined = with_straight_joints(world, kTolerance);
  EXPECT_EQ(straight_ends(*joined[0]), 2);
  EXPECT_EQ(straight_ends(*joined[1]), 2);
  EXPECT_EQ(corners(*joined[0]) + corners(*joined[1]), 0);
}

// Of one outline, where more than two meet, there is a corner all the same.
TEST(StraightJoints, WhereAThirdOneEndsIsACorner) {
  const Outline straight = make_chain({{0, 0}, {1, 0}, {2, 0}}, false).outline;
  EXPECT_EQ(straight_ends(straight), 2);
  EXPECT_EQ(corners(straight), 2);
  const Outline back = make_chain({{0, 0}, {1, 0}, {2, 0}, {1, 1}, {1, 0}}, false).outline;
  EXPECT_EQ(straight_ends(back), 0);
}

}  // namespace
}  // namespace brink::straight_joints_test
