// The hull of an outline: convex, and nothing of the outline lies beyond it.
#include "brink/core/shapes/hull.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "brink/core/shapes/shapes.h"
#include "tests/support/seeded_random.h"

namespace brink::hull_test {
namespace {

std::vector<Vec2> points_of(const Site& site) {
  std::vector<Vec2> points;
  for (int i = 0; i <= 50; ++i) {
    const double part = i / 50.0;
    if (site.kind == SiteKind::arc) {
      const Vec2 from = site.a - site.center;
      const double c = std::cos(part * site.sweep), s = std::sin(part * site.sweep);
      points.push_back(site.center + Vec2(c * from.x() - s * from.y(), s * from.x() + c * from.y()));
    } else {
      points.push_back(site.kind == SiteKind::point ? site.a : Vec2(site.a + part * (site.b - site.a)));
    }
  }
  return points;
}

void expect_holds(const Outline& outline) {
  const Hull& hull = outline.hull;
  const double rounding = 1e-14 * (1.0 + hull.reach);
  const std::size_t n = hull.corners.size();
  ASSERT_GT(n, 0U);
  ASSERT_EQ(hull.normals.size(), n > 1 ? n : 0U);
  for (std::size_t k = 0; k < hull.normals.size(); ++k) {
    EXPECT_NEAR(hull.normals[k].norm(), 1.0, 1e-15);
    for (const Vec2& p : hull.corners) EXPECT_LE(hull.normals[k].dot(p - hull.corners[k]), rounding);
    for (const Site& site : outline.sites) {
      EXPECT_LE(site.radius, hull.thickness);
      for (const Vec2& p : points_of(site)) EXPECT_LE(hull.normals[k].dot(p - hull.corners[k]), rounding);
    }
  }
  for (const Vec2& p : hull.corners) EXPECT_LE(p.norm(), hull.reach);
}

TEST(Hull, OfAPolygonItIsThePolygon) {
  const Hull hull = make_box(3.0, 2.0, 0.1).outline.hull;
  EXPECT_EQ(hull.corners.size(), 4U);
  EXPECT_EQ(hull.thickness, 0.1);
  EXPECT_DOUBLE_EQ(hull.reach, std::hypot(1.5, 1.0));
  // counter-clockwise from the lowest of the leftmost
  EXPECT_EQ(hull.corners[0], Vec2(-1.5, -1.0));
  EXPECT_EQ(hull.corners[1], Vec2(1.5, -1.0));
  EXPECT_EQ(hull.normals[0], Vec2(0.0, -1.0));
}

TEST(Hull, OfAStarItHasTheTipsAlone) {
  std::vector<Vec2> star;
  for (int i = 0; i < 10; ++i) {
    const double r = i % 2 ? 0.4 : 1.0, angle = 0.2 * std::numbers::pi * i;
    star.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  EXPECT_EQ(make_polygon(star).outline.hull.corners.size(), 5U);
}

TEST(Hull, OfADiscItIsAPointOfASegmentBothSides) {
  const Hull disc = make_disc(0.5).outline.hull;
  EXPECT_EQ(disc.corners, std::vector<Vec2>{Vec2::Zero()});
  EXPECT_TRUE(disc.normals.empty());
  EXPECT_EQ(disc.thickness, 0.5);
  const Hull bar = make_segment({-1.0, 0.0}, {1.0, 0.0}, 0.1).outline.hull;
  ASSERT_EQ(bar.normals.size(), 2U);
  EXPECT_EQ(bar.normals[0], -bar.normals[1]);
}

TEST(Hull, OfAContainerThereIsNone) { EXPECT_TRUE(make_disc_container(1.0).outline.hull.corners.empty()); }

// Points in lines, in heaps and far away.
TEST(Hull, HoldsWhateverChainIsGiven) {
  SeededRandom r(20261126);
  for (int i = 0; i < 500; ++i) {
    std::vector<Vec2> chain;
    const Vec2 base = (r.below(2) ? 0.0 : 100.0) * Vec2(r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0));
    const bool grid = r.below(2) != 0;
    for (std::uint64_t k = 2 + r.below(20); k > 0; --k) {
      Vec2 p = base + Vec2(r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0));
      if (grid) p = base + Vec2(static_cast<double>(r.below(3)), static_cast<double>(r.below(3)));
      if (chain.empty() || chain.back() != p) chain.push_back(p);
    }
    if (chain.size() < 2) continue;
    expect_holds(make_chain(chain, false, r.uniform(0.0, 0.1)).outline);
  }
}

TEST(Hull, HoldsArcs) {
  SeededRandom r(3);
  for (int i = 0; i < 200; ++i) {
    const double from = r.uniform(-7.0, 7.0);
    expect_holds(
        make_arc({r.uniform(-1.0, 1.0), 0.0}, r.uniform(0.1, 2.0), from, from + r.uniform(0.1, 6.2)).outline);
  }
  expect_holds(make_path("M -1 -1 A 1.2 1.2 0 0 1 1 -1 L 1 1 A 2 2 0 0 0 -1 1 Z", 0.2, 1e-6).outline);
}

TEST(ConvexHull, GoesRoundItsCornersOnce) {
  const std::vector<Vec2> square = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};
  EXPECT_EQ(convex_hull({{2.0, 2.0}, {1.0, 0.0}, {0.0, 0.0}, {2.0, 0.0}, {0.0, 2.0}, {1.0, 1.0}, {2.0, 2.0}}),
            square);
  const std::vector<Vec2> ends = {{-1.0, -2.0}, {2.0, 4.0}};
  EXPECT_EQ(convex_hull({{0.0, 0.0}, {2.0, 4.0}, {-1.0, -2.0}, {1.0, 2.0}, {2.0, 4.0}}), ends);
  EXPECT_EQ(convex_hull({{3.0, 1.0}, {3.0, 1.0}}).size(), 1U);
}

}  // namespace
}  // namespace brink::hull_test
