#include "brink/core/shapes/polygon_union.h"

// Boost's integer rescaling would round its reference areas to about 1e-7
#define BOOST_GEOMETRY_NO_ROBUSTNESS

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/geometry/algorithms/append.hpp>
#include <boost/geometry/algorithms/area.hpp>
#include <boost/geometry/algorithms/union.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <iostream>
#include <numbers>

#include "brink/core/base/random.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/polygon.h"
#include "brink/core/shapes/shapes.h"

namespace brink::polygon_union_test {
namespace {

using Polygon = std::vector<Vec2>;

double area_of(const std::vector<Polygon>& loops) {
  double area = 0;
  for (const Polygon& loop : loops) area += signed_area(loop);
  return area;
}

TEST(PolygonUnion, SharedEdgeVanishesAndVerticesKeepTheirBits) {
  const double third = 1.0 / 3;
  const auto loops =
      union_of_polygons({{{0, 0}, {1, 0}, {1, third}, {0, third}}, {{0, third}, {1, third}, {0.1, 0.7}}});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 5u);
  EXPECT_NE(std::find(loops[0].begin(), loops[0].end(), Vec2(1, third)), loops[0].end());
}

TEST(PolygonUnion, FrameOfTrapezoidsHasAnOuterLoopAndAHole) {
  const auto loops = union_of_polygons({{{0, 0}, {4, 0}, {3, 1}, {1, 1}},
                                        {{4, 0}, {4, 4}, {3, 3}, {3, 1}},
                                        {{4, 4}, {0, 4}, {1, 3}, {3, 3}},
                                        {{0, 4}, {0, 0}, {1, 1}, {1, 3}}});
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_EQ(std::max(signed_area(loops[0]), signed_area(loops[1])), 16);
  EXPECT_EQ(std::min(signed_area(loops[0]), signed_area(loops[1])), -4);
  EXPECT_EQ(loops[0].size() + loops[1].size(), 8u);
}

TEST(PolygonUnion, OverlappingSquaresCrossTwice) {
  const auto loops = union_of_polygons({{{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {{1, 1}, {3, 1}, {3, 3}, {1, 3}}});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 8u);
  EXPECT_EQ(area_of(loops), 7);
}

TEST(PolygonUnion, PartsApartStayApart) {
  const auto loops = union_of_polygons({{{0, 0}, {1, 0}, {0, 1}}, {{5, 5}, {6, 5}, {5, 6}}});
  EXPECT_EQ(loops.size(), 2u);
  EXPECT_EQ(area_of(loops), 1);
}

TEST(PolygonUnion, SwallowedAndRepeatedPartsVanish) {
  const Polygon big{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  const auto loops = union_of_polygons({{{1, 1}, {2, 1}, {2, 2}}, big, big});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 4u);
}

TEST(PolygonUnion, RowOfBricksLosesItsCollinearVertices) {
  std::vector<Polygon> bricks;
  for (int k = 0; k < 10; ++k) {
    const double x = k * 0.1, y = (k + 1) * 0.1;
    bricks.push_back({{x, 0}, {y, 0}, {y, 1}, {x, 1}});
  }
  const auto loops = union_of_polygons(bricks);
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 4u);
  EXPECT_NEAR(area_of(loops), 1, 1e-15);
}

TEST(PolygonUnion, EdgesThatDifferInTheLastDigitStillMerge) {
  const double a = 0.1 + 0.2, b = 0.3;  // one unit in the last place apart
  const auto loops = union_of_polygons({{{0, 0}, {a, 0}, {a, 1}, {0, 1}}, {{b, 0}, {1, 0}, {1, 1}, {b, 1}}});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 4u);
}

TEST(PolygonUnion, CornerTouchingPartsHaveTheRightSignAtTheTouch) {
  // chequerboard: two squares touch at (1, 1); each free quadrant there is outside
  const Shape touch = make_polygons({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{1, 1}, {2, 1}, {2, 2}, {1, 2}}});
  EXPECT_GT(gap_by_brute_force(touch.outline, {1.1, 0.9}), 0);
  EXPECT_GT(gap_by_brute_force(touch.outline, {0.9, 1.1}), 0);
  EXPECT_LT(gap_by_brute_force(touch.outline, {1.1, 1.1}), 0);
  EXPECT_EQ(touch.outline.loops.size(), 2u);
}

TEST(PolygonUnion, ReflexSolidAtATouchHasTheRightSignThere) {
  // (0, 0) is met by two narrow free wedges, to the right; left of it all is solid and the vertex is nearest
  const Shape shape = make_polygons({{{0, 0}, {-2, -2}, {2, -2}, {2, -0.5}},
                                     {{0, 0}, {2, 0.5}, {2, 2}, {-2, 2}, {-2, -2}},
                                     {{0, 0}, {2, -0.1}, {2, 0.1}}});
  EXPECT_LT(gap_by_brute_force(shape.outline, {-0.1, 0}), 0);
  EXPECT_LT(gap_by_brute_force(shape.outline, {-0.1, 0.03}), 0);
  EXPECT_LT(gap_by_brute_force(shape.outline, {-0.1, -0.03}), 0);
  EXPECT_NEAR(gap_by_brute_force(shape.outline, {-0.1, 0}), -0.1, 1e-15);
  EXPECT_LT(gap_by_brute_force(shape.outline, {1, 0}), 0) << "in the tongue";
  EXPECT_GT(gap_by_brute_force(shape.outline, {1, 0.15}), 0) << "in the upper wedge";
}

TEST(PolygonUnion, OverlapOfAHundredMillionthIsKept) {
  // far above the weld: a tooth that reaches 1e-8 into a block crosses it in two new vertices
  const auto loops = union_of_polygons(
      {{{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}, {{4.99999999, -1}, {8, -0.5}, {8, 0.5}, {4.99999999, 1}}});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 8u);
  EXPECT_NEAR(area_of(loops), 100 + 1.5 * 3, 1e-7);
}

namespace bg = boost::geometry;
using BoostPoint = bg::model::d2::point_xy<double>;
using BoostPolygon = bg::model::polygon<BoostPoint, false, false>;
using BoostMulti = bg::model::multi_polygon<BoostPolygon>;

double boost_area(const std::vector<Polygon>& polygons) {
  BoostMulti sum;
  for (const Polygon& polygon : polygons) {
    BoostPolygon p;
    for (const Vec2& v : polygon) bg::append(p, BoostPoint(v.x(), v.y()));
    BoostMulti next;
    bg::union_(sum, p, next);
    sum = next;
  }
  return bg::area(sum);
}

TEST(PolygonUnion, RandomSoupsAgreeWithBoostAndWithMembership) {
  // two independent references: Boost.Geometry's area, and "inside any of the polygons" at random points
  Random random(77);
  double largest = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Polygon> polygons;
    const int n = 2 + static_cast<int>(random.below(10));
    for (int k = 0; k < n; ++k) {
      const Vec2 c(random.uniform(0, 2), random.uniform(0, 2));
      const double start = random.uniform(0, 7);
      const int corners = 3 + static_cast<int>(random.below(6));
      Polygon polygon;
      for (int j = 0; j < corners; ++j)
        polygon.push_back(c + random.uniform(0.2, 0.8) * unit_at(start + j * 2 * std::numbers::pi / corners));
      polygons.push_back(polygon);
    }
    const auto loops = union_of_polygons(polygons);
    largest = std::max(largest, std::abs(area_of(loops) - boost_area(polygons)));
    for (int k = 0; k < 300; ++k) {
      const Vec2 q(random.uniform(-1, 3), random.uniform(-1, 3));
      bool expected = false, found = false;
      for (const Polygon& p : polygons) expected |= polygon_contains(p, q);
      for (const Polygon& loop : loops) found ^= polygon_contains(loop, q);
      ASSERT_EQ(found, expected) << "seed 77, trial " << trial << " at " << q.transpose();
    }
  }
  EXPECT_LT(largest, 1e-12) << "seed 77";
  std::cout << "largest area difference from Boost.Geometry: " << largest << "\n";
}

TEST(PolygonUnion, RandomGridTrianglesMeetInVerticesAndEdgesAndStillAgree) {
  // vertices on a 5 x 5 grid: shared edges, T junctions, touches and repeats by the dozen; membership decides
  Random random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    std::vector<Polygon> polygons;
    while (polygons.size() < 8) {
      Polygon t(3);
      for (Vec2& v : t) v = Vec2(double(random.below(5)) / 3, double(random.below(5)) / 3);
      const double area = signed_area(t);
      if (std::abs(area) < 1e-9) continue;
      if (area < 0) std::swap(t[1], t[2]);
      polygons.push_back(t);
    }
    const auto loops = union_of_polygons(polygons);
    const Shape shape = make_polygons(polygons);
    for (int k = 0; k < 100; ++k) {
      const Vec2 q(random.uniform(-0.2, 1.6), random.uniform(-0.2, 1.6));
      bool expected = false;
      for (const Polygon& p : polygons) expected |= polygon_contains(p, q);
      const double gap = gap_by_brute_force(shape.outline, q);
      if (std::abs(gap) < 1e-12) continue;
      ASSERT_EQ(gap < 0, expected) << "seed 5, trial " << trial << " at " << q.transpose();
    }
  }
}

}  // namespace
}  // namespace brink::polygon_union_test
