// How surfaces of sites that move come towards a place that stays: lines and circles by their own formulas.
#include "brink/scheduler/islands/driven_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/shapes/shapes.h"

namespace brink::driven_surface_test {
namespace {

/// A contact at that place, seen from the site's owner, which stands at angle 0.
NearFeature contact(const Vec2& point, const Vec2& normal, double gap, int site) {
  NearFeature f;
  f.point = point;
  f.normal = normal;
  f.gap = gap;
  f.site = site;
  f.sample = 0;
  return f;
}

Outline owner(SiteKind kind) {
  Outline o;
  Site s;
  s.kind = kind;
  s.a = {1.0, 0.0};
  s.b = kind == SiteKind::arc ? Vec2(0.0, 1.0) : Vec2(3.0, 0.0);
  s.center = {0.0, 0.0};
  s.arc_radius = 1.0;
  s.sweep = kQuarterTurn;
  o.sites = {s};
  return o;
}

TEST(DrivenSurface, ALineThatTurnsAboutAPlaceOnItComesAsFarAsItsSine) {
  const NearFeature f = contact({2.0, 0.0}, {0.0, 1.0}, 0.1, 0);
  for (const double turn : {1e-6, 0.01, -0.3})
    EXPECT_NEAR(advance_of_surface(f, owner(SiteKind::segment), 0.0, Frame({{0.0, 0.0}, turn})),
                2.0 * std::sin(turn), 1e-15);
  // along itself it does not come
  EXPECT_EQ(advance_of_surface(f, owner(SiteKind::segment), 0.0, Frame({{0.7, 0.0}, 0.0})), 0.0);
  EXPECT_NEAR(advance_of_surface(f, owner(SiteKind::segment), 0.0, Frame({{0.7, 0.2}, 0.0})), 0.2, 1e-15);
}

TEST(DrivenSurface, ACircleThatTurnsAboutItsCentreComesNoNearer) {
  const Vec2 out(std::sqrt(0.5), std::sqrt(0.5));
  const Outline circle = owner(SiteKind::arc);
  // from outside, and in its hollow
  for (const double side : {1.0, -1.0}) {
    const NearFeature f = contact(out, side * out, 0.1, 0);
    EXPECT_NEAR(advance_of_surface(f, circle, 0.0, Frame({{0.0, 0.0}, 0.4})), 0.0, 1e-15);
    // the centre by .2 along the way out: nearer from outside, farther in the hollow
    EXPECT_NEAR(advance_of_surface(f, circle, 0.0, Frame({0.2 * out, 0.0})), side * 0.2, 1e-15);
    // across: a hollow rises beside the place, a circle falls off
    const double distance = 1.0 + side * 0.1;
    EXPECT_NEAR(advance_of_surface(f, circle, 0.0, Frame({0.2 * perp(out), 0.0})),
                side * (distance - std::hypot(distance, 0.2)), 1e-15);
  }
}

}  // namespace
}  // namespace brink::driven_surface_test
