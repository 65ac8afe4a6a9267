/// Closest points against known places, and against distances that share no code.
#include "brink/core/query/closest_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "brink/core/base/error.h"
#include "brink/core/query/cast_ray.h"
#include "tests/unit/query/query_shapes.h"

namespace brink::closest_point_test {
namespace {

constexpr double pi = std::numbers::pi;

void expect_near(const Vec2& p, const Vec2& q, double tolerance) {
  EXPECT_LE((p - q).norm(), tolerance) << p.transpose() << " is not " << q.transpose();
}

// A unit disc about (3, 4) seen from the origin: 5 - 1 away, along (3, 4) / 5.
TEST(ClosestPoint, OfADiscLiesOnItsRim) {
  const SurfacePoint p = closest_point(make_disc(1.0).outline, {{3, 4}, 0.4}, {0, 0});
  EXPECT_NEAR(p.gap, 4.0, 1e-15);
  expect_near(p.point, {2.4, 3.2}, 1e-15);
  expect_near(p.normal, {-0.6, -0.8}, 1e-15);
  EXPECT_EQ(p.site, 0);
}

// A box of 2 x 2 turned by a quarter, rounded by 0.5: its right face is at x = 1.5.
TEST(ClosestPoint, OfARoundedBoxIncludesTheRadius) {
  const Outline box = make_box(2.0, 2.0, 0.5).outline;
  const SurfacePoint face = closest_point(box, {{10, 0}, pi / 2}, {12, 0.3});
  EXPECT_NEAR(face.gap, 0.5, 1e-14);
  expect_near(face.point, {11.5, 0.3}, 1e-14);
  expect_near(face.normal, {1, 0}, 1e-15);
  const SurfacePoint corner = closest_point(box, {{10, 0}, pi / 2}, {14, 5});  // 3 and 4 beyond the corner
  EXPECT_NEAR(corner.gap, 4.5, 1e-14);
  expect_near(corner.point, {11.3, 1.4}, 1e-14);
}

TEST(ClosestPoint, InsideTheGapIsNegativeAndTheNormalPointsOut) {
  const SurfacePoint p = closest_point(make_box(2.0, 4.0).outline, {}, {0.9, 0.2});
  EXPECT_NEAR(p.gap, -0.1, 1e-15);
  expect_near(p.point, {1.0, 0.2}, 1e-15);
  expect_near(p.normal, {1, 0}, 0.0);
  const SurfacePoint wall = closest_point(make_disc_container(2.0).outline, {}, {0, 2.5});
  EXPECT_NEAR(wall.gap, -0.5, 1e-15);
  expect_near(wall.normal, {0, -1}, 1e-15);  // into the free room
}

TEST(ClosestPoint, AWireIsSeenFromEitherSide) {
  const Outline wire = make_segment({-1, 0}, {1, 0}).outline;
  for (const double side : {1.0, -1.0}) {
    const SurfacePoint p = closest_point(wire, {}, {0.5, 0.25 * side});
    EXPECT_EQ(p.gap, 0.25);
    expect_near(p.normal, {0, side}, 0.0);
  }
}

// Two sides of a wall that is 1e-9 thick are told apart, and far away as well as the pose allows.
TEST(ClosestPoint, TheSideOfAThinWallIsRight) {
  const Outline wall = make_box(2.0, 1e-9).outline;
  for (const double side : {1.0, -1.0}) {
    const SurfacePoint p = closest_point(wall, {{1e6, 0}, 0.0}, {1e6 + 0.3, side * 1e-8});
    EXPECT_NEAR(p.gap, 9.5e-9, 1e-22);
    expect_near(p.normal, {0, side}, 0.0);
  }
}

TEST(ClosestPoint, AgreesWithDistancesThatShareNoCode) {
  constexpr std::uint64_t seed = 31;
  Random random(seed);
  for (const NamedOutline& o : query_outlines())
    for (int k = 0; k < 300; ++k) {
      SCOPED_TRACE(o.name + ", case " + std::to_string(k) + ", seed " + std::to_string(seed));
      const Pose pose{anywhere(random, k % 3 == 0 ? 1e6 : 2.0), random.uniform(-9, 9)};
      const Vec2 q = pose.position + anywhere(random, 2.5);
      const SurfacePoint p = closest_point(o.outline, pose, q);
      const OutsideView view(o.outline, pose);
      const double noise = looseness(o.outline) + 4e-16 * (10.0 + pose.position.norm());
      EXPECT_NEAR(p.gap, static_cast<double>(view.gap(outside::vec(q))), noise);
      EXPECT_NEAR(p.normal.norm(), 1.0, 1e-15);
      expect_near(q - p.gap * p.normal, p.point, 2 * noise);
      if (p.gap > 0.0) {
        EXPECT_NEAR(static_cast<double>(view.to_pieces(outside::vec(p.point))), 0.0, 2 * noise);
      }
    }
}

TEST(ClosestPoint, APlaceThatIsNotFiniteIsRefused) {
  EXPECT_THROW(closest_point(make_disc(1.0).outline, {}, {NAN, 0}), BadInput);
}

// From 1e16 sizes on, all sites are equally near, by rounding.
TEST(ClosestPoint, TheSideOfFarPlacesIsTheOutlinesOwn) {
  Random random(32);
  for (const NamedOutline& o : query_outlines())
    for (double away = 10.0; away < 1e149; away *= 30.0) {
      SCOPED_TRACE(o.name + ", seed 32, " + std::to_string(away));
      const double angle = random.below(2) == 0 ? kQuarterTurn * random.below(4) : random.uniform(-pi, pi);
      const Vec2 q = away * Vec2(std::cos(angle), std::sin(angle));
      const SurfacePoint p = closest_point(o.outline, {}, q);
      const double size = o.outline.bounding_radius, outward = o.outline.container ? -1.0 : 1.0;
      if (away < 10.0 * size) continue;
      EXPECT_NEAR(p.gap * outward, away, 2.0 * size + 1e-15 * away);
      EXPECT_GT(p.normal.dot(q) * outward, 0.0);
    }
}

TEST(ClosestPoint, APlaceTooFarToHaveADistanceIsRefusedAndOneLessFarIsNot) {
  for (const NamedOutline& o : query_outlines()) {
    SCOPED_TRACE(o.name);
    const Vec2 far(1e149, 1e149), too_far(1e200, 0);
    EXPECT_NEAR(std::abs(closest_point(o.outline, {}, far).gap) / far.norm(), 1.0, 1e-14);
    EXPECT_EQ(closest_point(o.outline, {}, far).gap < 0.0, o.outline.container);
    EXPECT_THROW(closest_point(o.outline, {}, too_far), BadInput);
    EXPECT_THROW(cast_ray(o.outline, {}, {too_far, {-1, 0}}), BadInput);
  }
}

}  // namespace
}  // namespace brink::closest_point_test
