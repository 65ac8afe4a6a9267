#include "brink/core/shapes/biarc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "brink/core/base/random.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/shapes.h"

namespace brink::biarc_test {
namespace {

double distance_to(const std::vector<Site>& sites, const Vec2& q) {
  double least = 1e300;
  for (const Site& s : sites) least = std::min(least, nearest_on(s, q).distance);
  return least;
}

double dense_deviation(const SmoothCurve& curve, const std::vector<Site>& sites, int n = 20000) {
  const auto ts = curve.breaks();
  double worst = 0;
  for (int k = 0; k <= n; ++k)
    worst = std::max(worst, distance_to(sites, curve.point(std::lerp(ts.front(), ts.back(), double(k) / n))));
  return worst;
}

void expect_joined(const std::vector<Site>& sites, const Vec2& start, const Vec2& end) {
  ASSERT_FALSE(sites.empty());
  EXPECT_EQ(sites.front().a, start);
  EXPECT_EQ(sites.back().b, end);
  for (std::size_t k = 0; k + 1 < sites.size(); ++k) EXPECT_EQ(sites[k].b, sites[k + 1].a);
}

TEST(Biarc, RandomCubicsStayWithinToleranceAndTheBoundHolds) {
  // the curve sampled at 20001 parameters, an independent and denser check than the fitter's own
  Random random(9);
  double worst_ratio = 0;
  for (int k = 0; k < 60; ++k) {
    std::array<Vec2, 4> control;
    for (Vec2& p : control) p = Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    const CubicBezier curve(control);
    for (double tolerance : {1e-2, 1e-4, 1e-6}) {
      std::vector<Site> sites;
      const double bound = fit_arcs(curve, control[0], control[3], tolerance, 0, sites);
      expect_joined(sites, control[0], control[3]);
      const double dense = dense_deviation(curve, sites, 2000);
      EXPECT_LE(bound, tolerance) << "seed 9, case " << k;
      EXPECT_LE(dense, bound + 1e-13) << "seed 9, case " << k;
      worst_ratio = std::max(worst_ratio, dense / tolerance);
    }
  }
  std::cout << "largest deviation / tolerance over random cubics: " << worst_ratio << "\n";
}

// A tolerance of the size of the curve: arcs tighter than it, and few places that are looked at.
TEST(Biarc, BoundHoldsWhereTheToleranceIsCoarse) {
  Random random(10);
  for (int k = 0; k < 3000; ++k) {
    std::array<Vec2, 4> control;
    for (Vec2& p : control) p = Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
    // every third nearly has a cusp, every third nearly comes back
    if (k % 3 == 1) control[3] = control[0] + 0.05 * control[3];
    if (k % 3 == 2) control[2] = control[0] + 0.02 * control[2], control[1] = control[3] + 0.02 * control[1];
    const double tolerance = std::pow(10.0, random.uniform(-2.5, 0.0));
    const CubicBezier curve(control);
    std::vector<Site> sites;
    const double bound = fit_arcs(curve, control[0], control[3], tolerance, 0, sites);
    EXPECT_LE(bound, tolerance) << "case " << k << " of seed 10";
    if (sites.empty()) continue;
    EXPECT_LE(dense_deviation(curve, sites, 1000), bound * (1 + 1e-9)) << "case " << k << " of seed 10";
  }
}

TEST(Biarc, ArcsStayOnTheCurveToo) {
  // the other half of the Hausdorff distance: points of the arcs against a fine polyline of the curve
  const std::array<Vec2, 4> control{Vec2(0, 0), Vec2(2, 3), Vec2(-1, 3), Vec2(1, 0)};
  const CubicBezier curve(control);
  std::vector<Site> sites, polyline;
  fit_arcs(curve, control[0], control[3], 1e-4, 0, sites);
  const int n = 4000;
  for (int k = 0; k < n; ++k)
    polyline.push_back(segment_site(curve.point(k / double(n)), curve.point((k + 1) / double(n)), 0));
  double worst = 0;
  for (const Site& s : sites)
    for (int k = 0; k <= 20; ++k) worst = std::max(worst, distance_to(polyline, point_along(s, k / 20.0)));
  EXPECT_LE(worst, 1.001e-4);
}

TEST(Biarc, NumberOfArcsGrowsWithTheCubeRootOfTheTolerance) {
  // biarcs are third order: a thousandth of the tolerance takes about ten times the arcs
  const std::array<Vec2, 4> control{Vec2(0, 0), Vec2(1, 2), Vec2(3, 2), Vec2(4, -1)};
  const CubicBezier curve(control);
  std::vector<Site> coarse, fine;
  fit_arcs(curve, control[0], control[3], 1e-5, 0, coarse);
  fit_arcs(curve, control[0], control[3], 1e-8, 0, fine);
  EXPECT_LT(fine.size(), 16 * coarse.size());
  EXPECT_GT(fine.size(), 5 * coarse.size());
}

TEST(Biarc, JointsAreSmooth) {
  const std::array<Vec2, 4> control{Vec2(0, 0), Vec2(1, 2), Vec2(3, 2), Vec2(4, -1)};
  std::vector<Site> sites;
  fit_arcs(CubicBezier(control), control[0], control[3], 1e-4, 0, sites);
  for (std::size_t k = 0; k + 1 < sites.size(); ++k)
    EXPECT_LT((direction_at_end(sites[k]) - direction_at_start(sites[k + 1])).norm(), 1e-7);
}

TEST(Biarc, StraightCubicIsSegments) {
  const std::array<Vec2, 4> control{Vec2(0, 0), Vec2(1, 1), Vec2(2, 2), Vec2(3, 3)};
  std::vector<Site> sites;
  const double bound = fit_arcs(CubicBezier(control), control[0], control[3], 1e-6, 0, sites);
  EXPECT_LE(sites.size(), 2u);
  for (const Site& s : sites) EXPECT_EQ(s.kind, SiteKind::segment);
  EXPECT_LT(bound, 1e-6);
}

TEST(Biarc, DegenerateCubicsEndAndStayWithinTolerance) {
  // a cusp, a line that doubles back, coincident controls at one end, at both ends, a loop
  const std::array<std::array<Vec2, 4>, 6> cases{{
      {Vec2(0, 0), Vec2(1, 1), Vec2(0, 1), Vec2(1, 0)},
      {Vec2(0, 0), Vec2(3, 0), Vec2(-2, 0), Vec2(1, 0)},
      {Vec2(0, 0), Vec2(0, 0), Vec2(1, 1), Vec2(2, 0)},
      {Vec2(0, 0), Vec2(0, 0), Vec2(2, 1), Vec2(2, 1)},
      {Vec2(0, 0), Vec2(3, 2), Vec2(-2, 2), Vec2(1, 0)},
      {Vec2(0, 0), Vec2(2, 2), Vec2(2, 2), Vec2(0, 0)},
  }};
  for (const auto& control : cases) {
    const CubicBezier curve(control);
    std::vector<Site> sites;
    const double bound = fit_arcs(curve, control[0], control[3], 1e-5, 0, sites);
    expect_joined(sites, control[0], control[3]);
    EXPECT_LE(bound, 1e-5);
    EXPECT_LE(dense_deviation(curve, sites), bound + 1e-14);
    EXPECT_LT(sites.size(), 400u);
  }
}

TEST(Biarc, EllipsesStayWithinTolerance) {
  for (double ratio : {0.9, 0.3, 0.01}) {
    const EllipticalArc curve({1, 2}, Vec2(1, 0.5), ratio * Vec2(-0.5, 1), 0.2, 5.9);
    std::vector<Site> sites;
    const Vec2 start = curve.point(0.2), end = curve.point(5.9);
    const double bound = fit_arcs(curve, start, end, 1e-6, 0, sites);
    expect_joined(sites, start, end);
    EXPECT_LE(bound, 1e-6);
    EXPECT_LE(dense_deviation(curve, sites), bound + 1e-14);
  }
}

TEST(Biarc, BezierShapeKeepsItsDeviation) {
  const Shape shape = make_bezier({Vec2(0, 0), Vec2(1, 2), Vec2(3, 2), Vec2(4, -1)}, 1e-4, 0.1);
  EXPECT_GT(shape.outline.curve_deviation, 0);
  EXPECT_LE(shape.outline.curve_deviation, 1e-4);
}

}  // namespace
}  // namespace brink::biarc_test
