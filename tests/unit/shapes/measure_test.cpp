#include "brink/core/shapes/measure.h"

#include <gtest/gtest.h>

#include <numbers>

#include "brink/core/base/random.h"
#include "brink/core/shapes/outline.h"

namespace brink::measure_test {
namespace {

constexpr double pi = std::numbers::pi;

void expect_measure(const Measure& m, double size, const Vec2& centroid, double second_moment) {
  EXPECT_NEAR(m.size, size, 1e-14 * size);
  EXPECT_NEAR((m.centroid - centroid).norm(), 0.0, 1e-14 * (1 + centroid.norm()));
  EXPECT_NEAR(m.second_moment, second_moment, 4e-14 * second_moment);
}

TEST(Measure, DiscHasPiRSquaredAndHalfOfThatTimesRSquared) {
  const double r = 0.7;
  expect_measure(make_disc(r).measure, pi * r * r, Vec2(0, 0), pi * r * r * r * r / 2);
  expect_measure(make_disc_container(r).measure, pi * r * r, Vec2(0, 0), pi * r * r * r * r / 2);
}

TEST(Measure, ACapsuleTurnedInsideOutHasThatOfItsFreeInside) {
  const Measure solid = make_capsule(2.0, 0.7).measure;
  expect_measure(make_capsule_container(2.0, 0.7).measure, solid.size, Vec2(0, 0), solid.second_moment);
}

TEST(Measure, BoxHasWidthTimesHeightAndATwelfthOfTheSquares) {
  expect_measure(make_box(3, 2).measure, 6, Vec2(0, 0), 6 * (9 + 4) / 12.0);
}

TEST(Measure, RightTriangleHasItsCentroidAtTheThird) {
  // legs 3 and 4: Ix + Iy about the centroid = (b h^3 + h b^3) / 36
  expect_measure(make_polygon({{0, 0}, {3, 0}, {0, 4}}).measure, 6, Vec2(1, 4.0 / 3),
                 (3 * 64 + 4 * 27) / 36.0);
}

TEST(Measure, ClockwisePolygonMeasuresTheSame) {
  expect_measure(make_polygon({{0, 0}, {0, 4}, {3, 0}}).measure, 6, Vec2(1, 4.0 / 3),
                 (3 * 64 + 4 * 27) / 36.0);
}

TEST(Measure, EllIsTheSumOfTwoRectangles) {
  // 2 x 1 at (1, .5) and 1 x 1 at (.5, 1.5): area 3, centroid ((2 + .5) / 3, (1 + 1.5) / 3), parallel axes
  const Vec2 c(2.5 / 3, 2.5 / 3);
  const double second =
      2 * 5 / 12.0 + 2 * (Vec2(1, .5) - c).squaredNorm() + 2 / 12.0 + (Vec2(.5, 1.5) - c).squaredNorm();
  expect_measure(make_polygon({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}).measure, 3, c, second);
}

TEST(Measure, WireRingHasItsLengthAndRSquared) {
  expect_measure(make_arc({1, 2}, 0.5, 0, 2 * pi).measure, pi, Vec2(1, 2), pi * 0.25);
}

TEST(Measure, HalfCircleWireHasItsCentroidAtTwoROverPi) {
  const double r = 2, length = pi * r;
  expect_measure(make_arc({0, 0}, r, 0, pi).measure, length, Vec2(0, 2 * r / pi),
                 length * r * r - length * (2 * r / pi) * (2 * r / pi));
}

TEST(Measure, ThinChainIsTheSumOfItsRods) {
  // two rods of length 2 at a right angle: each L^3 / 12, centroids sqrt(1/2) from the common one
  expect_measure(make_chain({{0, 2}, {0, 0}, {2, 0}}).measure, 4, Vec2(0.5, 0.5), 2 * (8 / 12.0) + 4 * 0.5);
}

TEST(Measure, ThickRingIsTheAnnulus) {
  const double outer = 1.25, inner = 0.75;
  expect_measure(make_arc({3, -1}, 1, 0.3, 0.3 + 2 * pi, 0.25).measure, pi * (outer * outer - inner * inner),
                 Vec2(3, -1), pi / 2 * (std::pow(outer, 4) - std::pow(inner, 4)));
}

TEST(Measure, CapsuleIsARectangleAndADisc) {
  const double l = 3, r = 0.5, area = 2 * r * l + pi * r * r;
  // rectangle l x 2r; two half discs: their polar moment about their own centre, shifted by way of their
  // centroids
  const double g = 4 * r / (3 * pi), half_disc = pi * r * r / 2;
  const double caps =
      2 * (pi * std::pow(r, 4) / 4 - half_disc * g * g + half_disc * (l / 2 + g) * (l / 2 + g));
  expect_measure(make_capsule(l, r).measure, area, Vec2(0, 0), 2 * r * l * (l * l + 4 * r * r) / 12 + caps);
}

TEST(Measure, RoundedBoxFollowsSteiner) {
  // area A + P r + pi r^2 (Steiner's formula for convex sets)
  const double r = 0.3;
  const Measure m = make_box(3, 2, r).measure;
  EXPECT_NEAR(m.size, 6 + 10 * r + pi * r * r, 1e-13);
  EXPECT_NEAR(m.centroid.norm(), 0, 1e-14);
}

TEST(Measure, RoundedEllLosesTheReflexCorner) {
  // Steiner with five convex quarter turns and one reflex corner, where two strips overlap in an r x r
  // square: A + P r + 5 pi r^2 / 4 - r^2
  const double r = 0.2;
  const Shape ell = make_polygon({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, r);
  EXPECT_NEAR(ell.measure.size, 3 + 8 * r + 1.25 * pi * r * r - r * r, 1e-13);
}

TEST(Measure, RadiusThatFillsANotchCountsItOnce) {
  // a U with a notch 1 wide and 2 deep, rounded by 1 > half the notch: hand count by Monte Carlo, 4 sigma
  const std::vector<Vec2> u{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  const Shape shape = make_polygon(u, 1.0);
  Random random(3);
  int inside = 0;
  const int n = 400000;
  for (int k = 0; k < n; ++k)
    inside += gap_by_brute_force(shape.outline, Vec2(random.uniform(-1, 4), random.uniform(-1, 4))) <= 0;
  const double share = shape.measure.size / 25;
  EXPECT_NEAR(double(inside) / n, share, 4 * std::sqrt(share * (1 - share) / n)) << "seed 3";
}

TEST(Measure, ThickBentChainCountsTheOverlapOnce) {
  // a right angle of two capsules: two strips, one full disc at the ends together, and at the bend a quarter
  // disc outside; the strips overlap in an r x r square inside
  const double r = 0.25;
  const Shape shape = make_chain({{0, 2}, {0, 0}, {2, 0}}, false, r);
  EXPECT_NEAR(shape.measure.size, 2 * 2 * 2 * r + pi * r * r + pi * r * r / 4 - r * r, 1e-13);
}

TEST(Measure, ChainThatRunsBackOverItselfIsOneCapsule) {
  const Shape there_and_back = make_chain({{-1, 0}, {1, 0}, {-1, 0}}, false, 0.5);
  EXPECT_NEAR(there_and_back.measure.size, make_capsule(2, 0.5).measure.size, 1e-12);
}

TEST(Measure, SquareFrameSubtractsItsHole) {
  const Shape frame = make_polygons({{{0, 0}, {4, 0}, {3, 1}, {1, 1}},
                                     {{4, 0}, {4, 4}, {3, 3}, {3, 1}},
                                     {{4, 4}, {0, 4}, {1, 3}, {3, 3}},
                                     {{0, 4}, {0, 0}, {1, 1}, {1, 3}}});
  expect_measure(frame.measure, 12, Vec2(2, 2), 16 * 32 / 12.0 - 4 * 8 / 12.0);
}

TEST(Measure, FarFromTheOriginKeepsItsDigits) {
  // about the centroid nothing depends on where the shape is; coordinates themselves round to 1e6 eps = 1e-10
  const Measure m = make_polygon({{1e6, 1e6}, {1e6 + 3, 1e6}, {1e6 + 3, 1e6 + 2}, {1e6, 1e6 + 2}}).measure;
  EXPECT_NEAR(m.size, 6, 1e-12);
  EXPECT_NEAR(m.second_moment, 6.5, 1e-9);
}

TEST(Measure, HalfDiscPathIsExact) {
  // M -r 0 A r r 0 0 1 r 0 Z on screen bulges upward: area pi r^2 / 2, centroid 4 r / (3 pi) up
  const double r = 2, g = 4 * r / (3 * pi), area = pi * r * r / 2;
  expect_measure(make_path("M-2 0A2 2 0 0 1 2 0Z", 1, 1e-6).measure, area, Vec2(0, g),
                 pi * std::pow(r, 4) / 4 - area * g * g);
}

TEST(Measure, CenteredShapeHasItsCentroidAtTheOrigin) {
  const Shape shape = centered(make_polygon({{0, 0}, {3, 0}, {0, 4}}));
  EXPECT_EQ(shape.measure.centroid, Vec2(0, 0));
  EXPECT_NEAR(measure_of(shape.outline).centroid.norm(), 0, 1e-15);
}

}  // namespace
}  // namespace brink::measure_test
