#include "brink/core/shapes/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <numbers>
#include <string>

#include "brink/core/base/random.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/polygon.h"
#include "brink/core/shapes/shapes.h"

namespace brink::distance_test {
namespace {

constexpr double pi = std::numbers::pi;

double gap(const Shape& shape, double x, double y) { return gap_by_brute_force(shape.outline, Vec2(x, y)); }

TEST(Distance, SegmentAnswersEndsAndInterior) {
  const Site s = segment_site({0, 0}, {2, 0}, 0);
  EXPECT_EQ(nearest_on(s, {-3, 4}).distance, 5);
  EXPECT_EQ(nearest_on(s, {-3, 4}).foot, Foot::start);
  EXPECT_EQ(nearest_on(s, {5, -4}).distance, 5);
  EXPECT_EQ(nearest_on(s, {5, -4}).foot, Foot::end);
  EXPECT_EQ(nearest_on(s, {1, -4}).distance, 4);
  EXPECT_EQ(nearest_on(s, {1, -4}).foot, Foot::interior);
}

TEST(Distance, ArcAnswersBothSidesEndsAndCentre) {
  std::vector<Site> sites;
  add_arc(sites, {1, 0}, {0, 1}, {0, 0}, 1, pi / 2, 0);
  ASSERT_EQ(sites.size(), 1u);
  const Site& s = sites[0];
  const double diagonal = std::sqrt(0.5);
  EXPECT_NEAR(nearest_on(s, Vec2(3 * diagonal, 3 * diagonal)).distance, 2, 1e-15);
  EXPECT_NEAR(nearest_on(s, Vec2(0.5 * diagonal, 0.5 * diagonal)).distance, 0.5, 1e-15);
  EXPECT_EQ(nearest_on(s, Vec2(1, -2)).distance, 2);
  EXPECT_EQ(nearest_on(s, Vec2(-3, 1)).distance, 3);
  EXPECT_EQ(nearest_on(s, Vec2(0, 0)).distance, 1);
  EXPECT_EQ(nearest_on(s, Vec2(-0.1, -0.2)).foot, Foot::start) << "behind the centre the nearer end counts";
}

TEST(Distance, ArcsMatchDenseSampling) {
  // brute force over 20001 points of the arc is off by at most the sagitta and spacing, below R sweep / 20000
  Random random(11);
  for (int k = 0; k < 200; ++k) {
    const Vec2 c(random.uniform(-1, 1), random.uniform(-1, 1));
    const double r = random.uniform(0.1, 3), from = random.uniform(0, 7),
                 sweep = random.uniform(-pi / 2, pi / 2);
    std::vector<Site> sites;
    add_arc(sites, c + r * unit_at(from), c + r * unit_at(from + sweep), c, r, sweep, 0);
    const Vec2 q(random.uniform(-4, 4), random.uniform(-4, 4));
    double least = 1e9;
    for (int j = 0; j <= 20000; ++j) least = std::min(least, (point_along(sites[0], j / 20000.0) - q).norm());
    EXPECT_NEAR(nearest_on(sites[0], q).distance, least, r * 1e-4) << "seed 11, case " << k;
  }
}

TEST(Distance, NeedleTipIsOutsideOnAllSides) {
  // a needle 10 long and 1e-6 thick; just beyond and beside the tip every direction is outside
  const Shape needle = make_polygon({{0, 0}, {10, -5e-7}, {10, 5e-7}});
  for (int k = 0; k < 360; ++k) {
    const Vec2 q = 1e-3 * unit_at(k * pi / 180);
    const bool inside = q.x() > 0 && std::abs(q.y()) < q.x() * 5e-8;
    EXPECT_EQ(gap(needle, q.x(), q.y()) < 0, inside) << "degree " << k;
  }
  EXPECT_LT(gap(needle, 5, 0), 0);
  EXPECT_GT(gap(needle, 10.001, 0), 0);
}

TEST(Distance, ReflexCornerIsInsideWhereTheVertexIsNearest) {
  const Shape ell = make_polygon({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  EXPECT_NEAR(gap(ell, 0.9, 0.9), -std::sqrt(0.02), 1e-15) << "nearest is the reflex vertex (1, 1)";
  EXPECT_NEAR(gap(ell, 1.5, 1.5), 0.5, 1e-15);
  EXPECT_NEAR(gap(ell, 0.5, 0.25), -0.25, 1e-15);
}

TEST(Distance, HoleIsFree) {
  const Shape ring = make_path("M-2-2H2V2H-2ZM-1-1V1H1V-1Z", 1, 1e-6);
  EXPECT_NEAR(gap(ring, 0, 0), 1, 1e-15);
  EXPECT_NEAR(gap(ring, 1.5, 0.2), -0.5, 1e-15);
  EXPECT_NEAR(gap(ring, 3, 0), 1, 1e-15);
  EXPECT_NEAR(gap(ring, 1.1, 1.1), -std::sqrt(0.02), 1e-15) << "the hole's corner, seen from the solid";
}

TEST(Distance, ContainerIsSolidOutside) {
  const Shape disc = make_disc_container(2);
  EXPECT_EQ(gap(disc, 0, 0), 2);
  EXPECT_NEAR(gap(disc, 1.5, 0), 0.5, 1e-15);
  EXPECT_NEAR(gap(disc, 3, 4), -3, 1e-14);
  const Shape stadium = make_capsule_container(2, 1.5);
  EXPECT_NEAR(gap(stadium, 0.5, 0.25), 1.25, 1e-15);
  EXPECT_NEAR(gap(stadium, 2.2, 0), 0.3, 1e-15);
  EXPECT_NEAR(gap(stadium, 1.3, 0.4), 1.0, 1e-15);
  EXPECT_NEAR(gap(stadium, 0, -2), -0.5, 1e-15);
  EXPECT_NEAR(gap(stadium, -5, 3), -3.5, 1e-14);
  const Outline box = as_container(make_box(4, 2).outline);
  EXPECT_EQ(gap_by_brute_force(box, Vec2(0, 0)), 1);
  EXPECT_EQ(gap_by_brute_force(box, Vec2(3, 0)), -1);
  EXPECT_NEAR(gap_by_brute_force(box, Vec2(3, 2)), -std::sqrt(2), 1e-15)
      << "past the corner: deep in the solid";
}

TEST(Distance, RoundContainerTakesThicknessInward) {
  const Outline box = as_container(make_box(4, 2, 0.25).outline);
  EXPECT_EQ(gap_by_brute_force(box, Vec2(0, 0)), 0.75);
}

TEST(Distance, WireArcIsFeltFromBothSides) {
  const Shape arc = make_arc({0, 0}, 1, 0, pi, 0.1);
  EXPECT_NEAR(gap(arc, 0, 1.5), 0.4, 1e-15);
  EXPECT_NEAR(gap(arc, 0, 0.5), 0.4, 1e-15);
  EXPECT_NEAR(gap(arc, 0, 1), -0.1, 1e-15);
}

TEST(Distance, CuspsOfArcsHaveTheRightSide) {
  // two circles tangent at the origin, radii 1 and 2, bound a needle whose tip has no angle: the normals
  // cancel there. By construction: inside is between the circles, left of x = 1.2. The container of it has
  // the slot instead.
  const Shape needle = make_path("M0 0A1 1 0 0 0 1-1L1.2-.4A2 2 0 0 1 0 0Z", 1, 1e-6);
  const Outline slot = as_container(needle.outline);
  Random random(6);
  int nearest_is_tip = 0;
  for (int k = 0; k < 20000; ++k) {
    const double size = std::pow(10.0, -random.uniform(0.5, 6));
    const Vec2 q = size * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    const bool inside = q.x() > 0 && (q - Vec2(0, 1)).norm() > 1 && (q - Vec2(0, 2)).norm() < 2;
    const double gap_of_needle = gap_by_brute_force(needle.outline, q);
    if (std::abs(gap_of_needle) < 1e-15) continue;
    ASSERT_EQ(gap_of_needle < 0, inside) << "seed 6 at " << q.transpose();
    ASSERT_EQ(gap_by_brute_force(slot, q) < 0, !inside) << "seed 6 at " << q.transpose();
    nearest_is_tip += gap_of_needle == q.norm();
  }
  EXPECT_GT(nearest_is_tip, 5000) << "the tip itself was put to the test";
}

/// A closed path of arcs through random points on a circle, bulging in and out.
std::string random_arc_path(Random& random, int n) {
  std::string d;
  Vec2 first(0, 0), last(0, 0);
  for (int k = 0; k <= n; ++k) {
    const Vec2 p = k == n ? first : Vec2(random.uniform(0.7, 1.3) * unit_at(2 * pi * k / n));
    const std::string to = std::to_string(p.x()) + " " + std::to_string(p.y());
    const std::string r = std::to_string((p - last).norm() * random.uniform(0.6, 3));
    d += k == 0 ? "M" + to : "A" + r + " " + r + (random.below(2) ? " 0 0 0 " : " 0 0 1 ") + to;
    last = p;
    if (k == 0) first = p;
  }
  return d + "Z";
}

std::vector<Vec2> polyline_of(const Outline& outline, int pieces) {
  std::vector<Vec2> points;
  for (const Site& s : outline.sites)
    for (int k = 0; k < pieces; ++k) points.push_back(point_along(s, k / double(pieces)));
  return points;
}

TEST(Distance, RandomArcLoopsHaveTheSignOfAFinePolygon) {
  // 200 chords an arc of less than a quarter of radius below 5 are within 5 (pi/800)^2 / 2 < 4e-5 of it
  Random random(12);
  int loops = 0, wrong = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Shape shape;
    try {
      shape = make_path(random_arc_path(random, 3 + static_cast<int>(random.below(8))), 1, 1e-6);
    } catch (const std::exception&) {
      continue;  // bulges that cross each other are refused
    }
    ++loops;
    const std::vector<Vec2> polygon = polyline_of(shape.outline, 200);
    for (int k = 0; k < 200; ++k) {
      const Vec2 q(random.uniform(-2, 2), random.uniform(-2, 2));
      const double g = gap_by_brute_force(shape.outline, q);
      if (std::abs(g) > 4e-5) wrong += (g < 0) != polygon_contains(polygon, q);
    }
  }
  EXPECT_GT(loops, 150);
  EXPECT_EQ(wrong, 0) << "seed 12";
}

TEST(Distance, NormalPointsOutFromEverySide) {
  const Shape box = make_box(2, 2);
  int site = -1;
  const Vec2 inside(0.9, 0.1), outside(1.5, 0.1), corner(2, 2);
  for (const Vec2& q : {inside, outside}) {
    gap_by_brute_force(box.outline, q, &site);
    const Site& s = box.outline.sites[site];
    EXPECT_EQ(normal_at(s, nearest_on(s, q), q), Vec2(1, 0));
  }
  gap_by_brute_force(box.outline, corner, &site);
  const Site& s = box.outline.sites[site];
  EXPECT_NEAR((normal_at(s, nearest_on(s, corner), corner) - Vec2(1, 1).normalized()).norm(), 0, 1e-15);
}

/// A random simple polygon: vertices at sorted random angles with random radii (star-shaped), some very deep.
std::vector<Vec2> random_polygon(Random& random) {
  const int n = 3 + static_cast<int>(random.below(30));
  std::vector<double> angles(n);
  for (double& a : angles) a = random.uniform(0, 2 * pi);
  std::sort(angles.begin(), angles.end());
  std::vector<Vec2> vertices;
  for (double a : angles) vertices.push_back(std::pow(10.0, random.uniform(-2, 0)) * unit_at(a));
  return vertices;
}

TEST(Distance, RandomPolygonsHaveTheSignOfTheEvenOddRuleAndAreLipschitz) {
  Random random(2024);
  long points = 0, signs_wrong = 0, steep = 0;
  for (int p = 0; p < 400; ++p) {
    const std::vector<Vec2> vertices = random_polygon(random);
    Shape shape;
    try {
      shape = make_polygon(vertices);
    } catch (const std::exception&) {
      continue;  // the few whose angles leave a gap of half a turn may cross themselves at the origin
    }
    Vec2 last(0, 0);
    double last_gap = gap_by_brute_force(shape.outline, last);
    for (int k = 0; k < 500; ++k) {
      // far, near, and within 1e-9 of vertices, where the sign is hardest
      const Vec2 anywhere(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
      const Vec2 near =
          vertices[random.below(vertices.size())] + std::pow(10.0, -random.uniform(0, 9)) * anywhere;
      const Vec2 q = k % 2 ? anywhere : near;
      const double g = gap_by_brute_force(shape.outline, q);
      if (std::abs(g) > 1e-14) signs_wrong += (g < 0) != polygon_contains(vertices, q);
      steep += std::abs(g - last_gap) > (q - last).norm() + 1e-14;
      last = q;
      last_gap = g;
      ++points;
    }
  }
  EXPECT_GE(points, 100000);
  EXPECT_EQ(signs_wrong, 0) << "of " << points << ", seed 2024";
  EXPECT_EQ(steep, 0) << "of " << points << ", seed 2024";
  std::cout << "points tested: " << points << "\n";
}

}  // namespace
}  // namespace brink::distance_test
