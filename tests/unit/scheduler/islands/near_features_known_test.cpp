// Features that once went wrong: normals that lost digits, corners on corners, joints, hollows.
#include <gtest/gtest.h>

#include <cmath>

#include <algorithm>

#include "tests/unit/scheduler/islands/outlines_near.h"

namespace brink::near_features_known_test {
namespace {

// A normal from the difference of two points that are a gap apart has a rounding of the place in it, over the gap.
TEST(NearFeatures, NormalsKeepTheirDigitsHoweverSmallTheGap) {
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-11})
    for (const NearFeature& f :
         between(make_box(2, 1).outline, {{0.3, 0.5 + gap}, 0}, wire({-5, 0}, {5, 0}), {}, 0.1))
      EXPECT_NEAR((f.normal - Vec2(0, 1)).norm(), 0.0, 1e-13) << gap;
}

// Corner on corner, each touches the upper face of the one below; the sides are no obstacles.
TEST(NearFeatures, EqualBoxesOnOneAnotherTouchUpwards) {
  const Outline box = make_box(0.4, 0.2).outline;
  for (const double gap : {1e-3, 1e-9, 1e-16, 0.0, -1e-16}) {
    int up = 0;
    for (const NearFeature& f : between(box, {{0, 0.2 + gap}, 0}, box, {}, 1e-2)) {
      EXPECT_NEAR(f.normal.x(), 0.0, 1e-12) << gap << ", site " << f.site << ", gap " << f.gap;
      up += f.normal.y() > 0.5;
    }
    EXPECT_GE(up, 2) << gap;
  }
}

// What slides over a joint of two straight pieces meets no end of a piece, neither before nor after it.
TEST(NearFeatures, JointOfTwoStraightPiecesIsNoObstacle) {
  const Outline floor = make_chain({{-1, 0}, {0, 0}, {1, 0}}).outline;
  for (const double x : {-0.05, 0.05})
    for (const NearFeature& f : between(make_point({0, 0}).outline, {{x, 1e-9}, 0}, floor, {}, 0.1))
      EXPECT_NEAR(f.normal.x(), 0.0, 1e-6) << "at " << x << ", site " << f.site << ", gap " << f.gap;
}

/// True if sample and site are among the features.
bool lists(const std::vector<NearFeature>& found, int sample, int site) {
  return std::any_of(found.begin(), found.end(), [&](const NearFeature& f) {
    return f.sample_on_a && f.sample == sample && f.site == site;
  });
}

// Still over the floor, it comes to a wall that rises from the floor's end: whatever its slope.
TEST(NearFeatures, WallThatRisesFromAJointIsAhead) {
  for (const Vec2& top : {Vec2(1, 1), Vec2(2, 0.1), Vec2(0, 1)}) {
    const Outline ground = make_polygon({{-2, -1}, {3, -1}, {3, 2}, top, {0, 0}, {-2, 0}}).outline;
    int wall = -1;
    for (std::size_t j = 0; j < ground.sites.size(); ++j)
      if (ground.sites[j].b == Vec2(0, 0) || ground.sites[j].a == Vec2(0, 0))
        if (ground.sites[j].a == top || ground.sites[j].b == top) wall = static_cast<int>(j);
    ASSERT_GE(wall, 0);
    for (const double height : {1e-9, 1e-3})
      EXPECT_TRUE(
          lists(between(make_disc(0.02).outline, {{-0.05, 0.02 + height}, 0}, ground, {}, 0.1), 0, wall))
          << top.transpose() << " at " << height;
  }
}

// Into the corner of a room, exactly, a little short of it, or a rounding beyond: floor and wall both.
TEST(NearFeatures, CornerInAHollowCornerTouchesBothSides) {
  const Outline room = as_container(make_box(2.0, 2.0).outline);
  const Outline box = make_box(0.4, 0.2).outline;
  for (const double beside : {-1e-12, 0.0, 1e-13, 1e-11}) {
    const auto found = between(box, {{1 - 0.2 + beside, -1 + 0.1}, 0}, room, {}, 1e-9);
    bool floor = false, wall = false;
    for (const NearFeature& f : found) {
      if (!f.sample_on_a || (box.samples[f.sample].p - Vec2(0.2, -0.1)).norm() > 1e-9) continue;
      floor = floor || f.normal.y() > 0.999;
      wall = wall || f.normal.x() < -0.999;
    }
    EXPECT_TRUE(floor && wall) << beside << ": floor " << floor << ", wall " << wall;
  }
}

// An arc's own sample speaks for its outer side alone: what is in its hollow is as far away as it is.
TEST(NearFeatures, BoxInTheHollowOfAnArcIsApart) {
  const Outline arc = make_arc({0, 0}, 1.0, 4.0, 5.4).outline;
  const auto found = between(make_box(0.2, 0.2).outline, {{0, -0.85}, 0}, arc, {}, 0.2);
  ASSERT_FALSE(found.empty());
  for (const NearFeature& f : found)
    EXPECT_GT(f.gap, 0.04) << "sample " << f.sample << (f.sample_on_a ? " of the box" : " of the arc");
}

// A sample that is near a face's end and goes down beside the next face has not gone through the first.
TEST(NearFeatures, GapGoesOnWhereTheSampleLeavesTheSideOfItsSite) {
  const Outline box = make_box(2, 1).outline, point = make_point({0, 0}).outline;
  const auto at = [](double y) { return ExtendedState(BodyState{{{-1.1, y}, 0}, {}}); };
  for (const NearFeature& f : near_features(point, at(0.52), box, BodyState{}, 0.2))
    for (const double y : {0.48, 0.4, 0.2})
      EXPECT_GE(gap_of(f, point, at(y), box, BodyState{}), 0.1 - 1e-12) << "site " << f.site << ", at " << y;
}

}  // namespace
}  // namespace brink::near_features_known_test
