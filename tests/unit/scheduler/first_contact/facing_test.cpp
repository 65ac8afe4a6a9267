// The line between a point and a convex polygon: a step that is safe for it is safe for the polygon.
#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/first_contact/site_step.h"
#include "tests/support/seeded_random.h"

namespace brink::facing_test {
namespace {

/// Of 3 to 9 corners on an ellipse, anywhere.
Outline random_convex(Random& random) {
  const int count = 3 + static_cast<int>(7.0 * random.uniform());
  const double width = random.uniform(0.05, 2.0), height = random.uniform(0.05, 2.0);
  std::vector<Vec2> corners;
  for (int k = 0; k < count; ++k) {
    const double angle = 6.283185307179586 * (k + 0.8 * random.uniform()) / count;
    corners.emplace_back(width * std::cos(angle), height * std::sin(angle));
  }
  return make_polygon(corners).outline;
}

TEST(FacingConvex, IsNeverFartherThanThePolygonWhereverThePointGoes) {
  SeededRandom random(20261122);
  int outside = 0, exact = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Outline outline = random_convex(random);
    ASSERT_EQ(outline.facets.size(), outline.sites.size());
    const Vec2 q(random.uniform(-4, 4), random.uniform(-4, 4)),
        rate(random.uniform(-1, 1), random.uniform(-1, 1));
    const double gap = gap_by_brute_force(outline, q);
    if (gap <= 1e-6) continue;
    ++outside;
    const Facing line = facing_convex(outline, q, rate);
    EXPECT_GT(line.gap, 0.0);
    EXPECT_LE(line.gap, gap + 1e-14);
    exact += line.gap >= gap - 1e-14;
    for (const double h : {0.1, 1.0, 5.0}) {
      const double then = gap_by_brute_force(outline, q + h * rate);
      // beyond the line is outside the polygon, and as far from it at least
      if (line.gap + h * line.rate > 0.0) {
        EXPECT_GE(then, line.gap + h * line.rate - 1e-13);
      }
    }
  }
  EXPECT_GT(outside, 10000);
  EXPECT_GT(exact, 9 * outside / 10);  // it is the distance itself nearly everywhere
}

// Right beside a long site, and where its frame's origin is: the foot is rounded as the site's ends are, which are far.
TEST(DistanceRate, OfWhatSlidesAlongASiteIsNone) {
  SeededRandom random(991002714);
  for (int trial = 0; trial < 20000; ++trial) {
    const double length = std::pow(10.0, random.uniform(-2.0, 6.0)), angle = random.uniform(-4.0, 4.0);
    const double at = random.below(2) ? 1e-9 * random.uniform(-1.0, 1.0) : length * random.uniform(-0.9, 0.9);
    const Vec2 along(std::cos(angle), std::sin(angle)), out = perp(along);
    const Outline wall = make_segment(-length * along, length * along).outline;
    const double gap = std::pow(10.0, random.uniform(-12.0, 0.0)), falls = random.uniform(-1.0, 1.0);
    const Vec2 q = at * along + gap * out, rate = 10.0 * along + falls * out;
    const Nearest nearest = nearest_on(wall.sites[0], q);
    if (nearest.foot != Foot::interior || gap < 1e-14 * length)
      continue;  // else on which side it is, is rounding
    EXPECT_NEAR(distance_rate(wall.sites[0], nearest, q, rate), falls, 1e-13) << "trial " << trial;
  }
}

}  // namespace
}  // namespace brink::facing_test
