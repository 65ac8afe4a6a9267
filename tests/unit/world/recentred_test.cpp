/// Frames of sites that are written far from their origin.
#include "brink/core/world/recentred.h"

#include <gtest/gtest.h>

#include "brink/core/shapes/shapes.h"
#include "tests/support/seeded_random.h"

namespace brink::recentred_test {
namespace {

FixedSite wall(const Vec2& a, const Vec2& b, const Pose& pose = {}) {
  FixedSite site;
  site.outline = std::make_shared<const Outline>(make_segment(a, b).outline);
  site.pose = pose;
  return site;
}

// A wall of 3 cm that is 10 km away: in its new frame it is a few centimetres long and off, and at every end
// exactly where it was.
TEST(Recentred, FarWallKeepsItsPlaceExactly) {
  SeededRandom random(1);
  for (int k = 0; k < 1000; ++k) {
    const Vec2 a(random.uniform(-1e4, 1e4), random.uniform(-1e4, 1e4));
    const Vec2 b = a + Vec2(random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03));
    const FixedSite near = recentred(wall(a, b));
    const Site& s = near.outline->sites[0];
    EXPECT_LT(near.outline->bounding_radius, 0.2);
    EXPECT_EQ((s.a.cast<long double>() + near.pose.position.cast<long double>()), a.cast<long double>());
    EXPECT_EQ((s.b.cast<long double>() + near.pose.position.cast<long double>()), b.cast<long double>());
  }
}

// The ends of an arc that is written far away are rounded by more than an arc nearer by may be.
TEST(Recentred, AnArcWhoseEndsAreRoundedStaysWhereItIs) {
  for (const double far : {1e3, 1e6, 1e7, 1e8, 1e9}) {
    FixedSite site;
    site.outline =
        std::make_shared<const Outline>(make_arc({-far, 1.0}, 1.1547005383792515, 4.2, 9.3).outline);
    const FixedSite moved = recentred(site);
    for (std::size_t k = 0; k < site.outline->sites.size(); ++k)
      EXPECT_EQ(Vec2(moved.outline->sites[k].center + moved.pose.position), site.outline->sites[k].center)
          << far;
  }
}

TEST(Recentred, StaysWhereItIsNearOrTurnedOrWhereAPlaceWouldBeRounded) {
  const Vec2 a(1000.0, 0.0), b(1001.0, 0.5);
  EXPECT_EQ(recentred(wall({-1.0, 0.0}, {2.0, 0.5})).pose.position, Vec2(0.0, 0.0));
  EXPECT_EQ(recentred(wall(a, b, {{0.0, 0.0}, 0.1})).pose.position, Vec2(0.0, 0.0));
  EXPECT_EQ(recentred(wall(a, b, {{0.1, 0.0}, 0.0})).pose.position, Vec2(0.1, 0.0));
  FixedSite turns = wall(a, b);
  turns.motion = ConstantMotion{{{0.0, 0.0}, 1.0}};
  EXPECT_EQ(recentred(turns).pose.position, Vec2(0.0, 0.0));
  FixedSite slides = wall(a, b);
  slides.motion = ConstantMotion{{{1.0, 0.0}, 0.0}};
  EXPECT_GT(recentred(slides).pose.position.x(), 900.0);
}

}  // namespace
}  // namespace brink::recentred_test
