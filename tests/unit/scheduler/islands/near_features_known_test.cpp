// Features that once went wrong: normals that lost digits, corners on corners, joints, hollows.
#include <gtest/gtest.h>

#include <cmath>

#include <algorithm>

#include "brink/core/base/random.h"
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

// A corner of wire in the hollow corner of another, its side flush upon the one piece: the hollow meets it from below alone.
TEST(NearFeatures, CornerOfWireInAHollowOfWireIsAboveIt) {
  const Outline hollow = make_chain({{-2.0, 1.5}, {0.0, 0.0}, {2.0, 1.0}}, false).outline;
  const Outline triangle = make_chain({{0.0, 0.0}, {0.4, 0.2}, {0.1, 0.4}}, true).outline;
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const Vec2 off(random.uniform(-1e-12, 1e-12), random.uniform(0.0, 1e-12));
    for (const NearFeature& f : between(triangle, {off, random.uniform(-1e-13, 1e-13)}, hollow, {}, 1e-9))
      EXPECT_GT(f.normal.y(), 0.0) << "sample " << f.sample << (f.sample_on_a ? "" : " of the hollow")
                                   << ", site " << f.site << ", gap " << f.gap << ", off by "
                                   << off.transpose();
  }
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

// Two acute corners beside each other, each at its outline's origin: `right` stands to the right of `left`, and both have a
// bottom that falls to its corner.
struct TwoCorners {
  Outline left = make_polygon({{0, 0}, {0, 1}, {-1, 1}, {-1, 0.2}}).outline;
  Outline right = make_polygon({{0, 0}, {1, 0.2}, {1, 1}, {0.1, 1}}).outline;

  // The least gap of corner on corner, seen with the right one's corner at `first`, after it has gone to `then`.
  double least(const Vec2& first, const Vec2& then, double reach) const {
    const auto at = [](const Vec2& p) { return ExtendedState(BodyState{{p, 0}, {}}); };
    double least = 1.0;
    for (const NearFeature& f : near_features(right, at(first), left, BodyState{}, reach))
      if ((f.sample_on_a ? right : left).samples[f.sample].p.isZero(0.0))
        least = std::min(least, gap_of(f, right, at(then), left, BodyState{}));
    return least;
  }
};

// It slides down along the upright side and on: the other corner was behind the line of the side that it comes to stand
// beside. In a drum such a gap was told to be missed, and the step was made to bring the corners onto each other.
TEST(NearFeatures, CornerThatSlidesPastACornerHasGoneThroughNothing) {
  const TwoCorners corners;
  for (const double beside : {1e-7, 1e-5, 1e-4})
    for (const double lower : {1e-4, 1e-3, 4e-3}) {
      const double least = corners.least({beside, 2e-3}, {beside, -lower}, 0.01);
      EXPECT_GT(least, 0.9 * beside) << beside << ", lower by " << lower;
      EXPECT_LT(least, std::hypot(beside, lower) + 1e-15) << beside << ", lower by " << lower;
    }
}

// Neither corner is in the other solid, but their sides cross beside both: no sample tells it.
TEST(NearFeatures, CornersThatHavePassedThroughEachOtherAreNotApart) {
  const TwoCorners corners;
  for (const double deep : {1e-9, 1e-7, 1e-5, 1e-3}) {
    EXPECT_NEAR(corners.least({1e-4, 2e-3}, {-deep, 0.0}, 0.01), -deep, 1e-2 * deep);
    EXPECT_NEAR(corners.least({1e-4, 2e-3}, {deep, 0.0}, 0.01), deep, 1e-2 * deep);
  }
}

// A triangle's lowest corner comes along the floor to that of a box that stands on it: neither corner is ever in the other body. On
// which side of the box's lower face roundings put the one must not make a way below the box.
TEST(NearFeatures, CornerThatComesAlongAFloorDoesNotGoBelowWhatStandsThere) {
  const Outline box = make_box(0.3, 0.3).outline,
                triangle = make_polygon({{0, 0}, {0.3, 0.17}, {0, 0.3}}).outline;
  const auto lowest = std::min_element(triangle.samples.begin(), triangle.samples.end(),
                                       [](const Sample& a, const Sample& b) { return a.p.y() < b.p.y(); });
  for (int k = 0; k < 200; ++k) {
    const double turn = 0.0314 * k;  // each turn rounds otherwise
    const Frame turned({Vec2::Zero(), turn});
    const auto at = [&](double gap) {
      const Vec2 place = turned.to_world(Vec2(0.15 + gap, -0.15) - lowest->p);
      return ExtendedState(BodyState{{place, turn}, {}});
    };
    const ExtendedState stands(BodyState{{Vec2::Zero(), turn}, {}});
    double least = 1.0;
    for (const NearFeature& f : near_features(triangle, at(1e-3), box, stands, 0.01))
      least = std::min(least, gap_of(f, triangle, at(-1e-3), box, stands));
    EXPECT_NEAR(least, -1e-3, 1e-9) << "turned by " << turn;
  }
}

// A box's corner that has sunk into a pentagon's side by about as much as still tells a direction: whether it does is said once,
// or the normal is turned that was the side's own.
TEST(NearFeatures, NormalOfWhatHasSunkByARoundingLeadsOut) {
  const Outline box = make_box(0.249, 0.164).outline,
                pentagon =
                    make_polygon({{0.3, 0.15}, {0.2, 0.3}, {0.02, 0.24}, {0.02, 0.06}, {0.2, 0.0}}).outline;
  const double size = box.bounding_radius + pentagon.bounding_radius;
  const Vec2 corner(0.1245, 0.082);
  Random random(1);
  for (int k = 0; k < 20000; ++k) {
    const Site& side = pentagon.sites[static_cast<std::size_t>(k) % 5];
    const Vec2 along = (side.b - side.a).normalized(), out(along.y(), -along.x());
    const Pose stands{Vec2::Zero(), random.uniform(0.0, 6.28)};
    const Frame frame(stands);
    // the corner leads straight into the side
    const Vec2 way = frame.direction_to_world(-out);
    const double turn = std::atan2(way.y(), way.x()) - std::atan2(corner.y(), corner.x());
    const double deep = 1e-12 * size * (1.0 + random.uniform(-1e-3, 1e-3));
    const Vec2 at = side.a + random.uniform(0.2, 0.8) * (side.b - side.a) - deep * out;
    const Pose sunk{frame.to_world(at) - Frame({Vec2::Zero(), turn}).to_world(corner), turn};
    for (const NearFeature& f : between(box, sunk, pentagon, stands, 1e-6))
      ASSERT_LT(f.normal.dot(way), -0.9) << k << ": gap " << f.gap;
  }
}

// Corners upon each other: of the side that was chosen there each step keeps what the step before has kept. Where a gap was told
// along the way, and the next list began with another, a groove let a triangle's corner in by the difference, and on.
TEST(NearFeatures, GapUponACornerIsAsTheNextListHasIt) {
  constexpr double kNear = 1e-10,
                   kTurn = 0.7;  // well within what counts as upon the corner; of the points about it
  const TwoCorners corners;
  const auto about = [](int k) { return Vec2(kNear * std::cos(kTurn * k), kNear * std::sin(kTurn * k)); };
  const auto at = [](const Vec2& p) { return ExtendedState(BodyState{{p, 0}, {}}); };
  int compared = 0, behind = 0;
  for (int first = 0; first < 9; ++first)
    for (int then = 0; then < 9; ++then)
      for (const NearFeature& f :
           near_features(corners.right, at(about(first)), corners.left, BodyState{}, 0.01))
        for (const NearFeature& g :
             near_features(corners.right, at(about(then)), corners.left, BodyState{}, 0.01)) {
          const bool same = f.sample == g.sample && f.site == g.site && f.sample_on_a == g.sample_on_a;
          if (!same || !f.upon_corner || g.at_end) continue;
          ++compared;
          behind += g.gap < 0.0;
          EXPECT_NEAR(gap_of(f, corners.right, at(about(then)), corners.left, BodyState{}), g.gap,
                      1e-3 * kNear)
              << first << ", " << then << ", site " << f.site;
        }
  EXPECT_GT(compared, 10);
  EXPECT_GT(behind, 10);
}

}  // namespace
}  // namespace brink::near_features_known_test
