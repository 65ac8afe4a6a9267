#include "brink/scheduler/islands/near_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "tests/support/seeded_random.h"
#include "tests/unit/query/query_shapes.h"
#include "tests/unit/scheduler/islands/facing_points.h"
#include "tests/unit/scheduler/islands/outlines_near.h"

namespace brink::near_features_test {
namespace {

// ---- known answers

TEST(NearFeatures, BoxOnAFloorTouchesWithItsTwoLowerCorners) {
  const auto found = between(make_box(2, 1).outline, {{0.3, 0.51}, 0}, wire({-5, 0}, {5, 0}), {}, 0.1);
  ASSERT_EQ(found.size(), 2U);
  for (const NearFeature& f : found) {
    EXPECT_TRUE(f.sample_on_a);
    EXPECT_NEAR(f.gap, 0.01, 1e-15);
    EXPECT_NEAR((f.normal - Vec2(0, 1)).norm(), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(f.point.x() - 0.3), 1.0, 1e-15);
    EXPECT_TRUE(f.thin);
  }
}

// The tip of a needle in the hollow of a roof of wire, beside its ridge, and on top of it: what goes out through the
// ridge from below has crossed it, though it is abreast of neither side; what goes over it from above has not.
TEST(NearFeatures, ATipThatLeavesAHollowThroughAJointOfWiresHasCrossed) {
  const Outline roof = make_chain({{-2, -1}, {0, 0}, {2, -1}}, false).outline, needle = wire({0, -1}, {0, 0});
  const Vec2 down_right = Vec2(2, -1).normalized(), up = perp(down_right);
  const auto at = [&](const Vec2& tip, double turned) { return BodyState{{tip, turned}, {}}; };
  const auto least_after = [&](const Vec2& before, const Vec2& after, double turned) {
    double least = 1.0;
    for (const NearFeature& f : near_features(needle, at(before, turned), roof, BodyState{}, 0.2))
      if (f.thin && f.sample_on_a && needle.samples[f.sample].p.isZero(0.0))
        least = std::min(least, gap_of(f, needle, at(after, turned), roof, BodyState{}));
    return least;
  };
  const Vec2 below = 0.05 * down_right - 1e-12 * up, above = 0.05 * down_right + 1e-12 * up;
  for (const double beyond : {1e-6, 1e-3}) {
    EXPECT_NEAR(least_after(below, Vec2(0.0, beyond), 0.0), -beyond, 1e-12);
    EXPECT_NEAR(least_after(below, Vec2(-0.1 * beyond, beyond), 0.0), -beyond, 0.01 * beyond);
    EXPECT_GT(least_after(above, Vec2(0.0, beyond), 3.141592653589793), 0.0);
    EXPECT_GT(least_after(above, Vec2(-0.1 * beyond, beyond), 3.141592653589793), 0.0);
  }
}

/// The least gap, with a body moved by `way`, of all features with b that are seen up to `reach` from where it was [m].
double least_gap_after(const Outline& body, const Vec2& at, const Vec2& way, const Outline& other,
                       double reach) {
  double least = 1.0;
  for (const NearFeature& f : near_features(body, BodyState{{at, 0.0}, {}}, other, BodyState{}, reach))
    least = std::min(least, gap_of(f, body, BodyState{{at + way, 0.0}, {}}, other, BodyState{}));
  return least;
}

// Two tables that stand on pointed feet and slide into each other, foot to foot: wherever roundings put the one foot above or
// below the other, and though neither comes to be in the other's solid, they are in each other.
TEST(NearFeatures, FeetThatMeetTipToTipAreInEachOther) {
  const Outline slim = make_polygon({{-1, 0}, {-0.5, 0.6}, {0, 0}, {-0.5, 1.5}}).outline,
                flat = make_polygon({{0, 0}, {0.5, 0.1}, {1, 0}, {0.5, 0.5}}).outline,
                wedge = make_polygon({{0, 0}, {1, 0}, {0.5, 0.5}}).outline;
  for (const Outline& other : {flat, wedge})
    for (const double up : {-1e-12, -1e-16, 0.0, 1e-16, 1e-12})
      for (const double beyond : {1e-6, 1e-3, 1e-2})
        EXPECT_LT(least_gap_after(slim, {-0.01, up}, {0.01 + beyond, 0}, other, 0.1), -0.1 * beyond) << up;
}

// A box that comes over the edge of a table as high as its bottom, or lower by a rounding, lies on it.
TEST(NearFeatures, ABoxThatComesOverAnEdgeIsNotThroughIt) {
  const Outline box = make_box(1, 1).outline,
                table = make_polygon({{0.5, 0}, {3, 0}, {2, -1}, {1.5, -1}}).outline;  // overhanging, acute
  for (const double up : {0.0, 1e-16, 1e-12})
    for (const double beyond : {1e-6, 1e-3, 1e-2})
      EXPECT_GT(least_gap_after(box, {-0.01, 0.5 + up}, {0.01 + beyond, 0}, table, 0.1), -2e-12) << up;
}

// The end of a wire in the notch of a star, sunk into its two sides by less than the contact tolerance, and not by as much.
TEST(NearFeatures, WhatHasSunkInANotchTouchesBothItsSides) {
  const Outline star = make_polygon({{4, 0}, {1, 1}, {0, 4}, {-1, 1}, {-4, 0}, {-1, -1}, {0, -4}, {1, -1}})
                           .outline,
                rod = wire({0, 0}, {0, 1});
  const Vec2 notch(-1, 1), out = notch.normalized(), along = perp(out);
  for (const double away : {-1e-10, -2e-11, 0.0, 2e-11})
    for (const double beside : {-1e-10, -2e-11, 0.0, 2e-11, 1e-10}) {
      int sides = 0;
      const BodyState at{{notch + away * out + beside * along, 0.785}, {}};
      for (const NearFeature& f : near_features(rod, at, star, BodyState{}, 0.01, 1e-10))
        sides += f.sample_on_a && rod.samples[f.sample].p.isZero(0.0) &&
                 (star.sites[f.site].a == notch || star.sites[f.site].b == notch);
      EXPECT_EQ(sides, 2) << away << " " << beside;
    }
}

// A box against a wall of wire that ends on the floor, right at its corner, wherever roundings put the one beside the other:
// all of the wall holds its side, and the wall's end is on the box's side, not on its bottom.
TEST(NearFeatures, AWireThatEndsAtACornerIsBesideIt) {
  const Outline box = make_box(2, 1).outline, wall = make_segment({4, 0}, {4, 6}).outline;
  for (const double off : {-3e-13, 0.0, 3e-13})
    for (const double up : {-3e-13, 0.0, 3e-13}) {
      int corners = 0, ends = 0;
      for (const NearFeature& f : between(box, {{3.0 + off, 0.5 + up}, 0}, wall, {}, 0.01)) {
        // how far beyond the end it is may count, too
        EXPECT_NEAR((f.normal - Vec2(-1, 0)).norm(), 0.0, 1e-9) << off << ' ' << up;
        EXPECT_NEAR(f.gap, -off, 4e-13) << off << ' ' << up;
        ++(f.sample_on_a ? corners : ends);
      }
      EXPECT_EQ(corners, 2) << off << ' ' << up;
      EXPECT_EQ(ends, 1) << off << ' ' << up;
    }
}

TEST(NearFeatures, DiscInAGrooveTouchesBothSides) {
  const Outline groove = make_polygon({{-2, -2}, {2, -2}, {2, 1}, {0, -1}, {-2, 1}}).outline;
  const double r = 0.5, slack = 0.01;
  const auto found =
      between(make_disc(r).outline, {{0, -1 + (r + slack) * std::sqrt(2.0)}, 0}, groove, {}, 0.1);
  ASSERT_EQ(found.size(), 2U);
  for (const NearFeature& f : found) EXPECT_NEAR(f.gap, slack, 1e-15);
  EXPECT_NEAR(found[0].normal.dot(found[1].normal), 0.0, 1e-15);
}

// Beyond the tip of a wedge nothing but the tip is near: its sides are seen from behind, or from their ends.
TEST(NearFeatures, WhatIsBehindATipIsNone) {
  const Outline wedge = make_polygon({{0, 0}, {-1, -3}, {1, -3}}).outline;
  for (const double gap : {1e-12, 1e-6, 0.01}) {
    const auto found = between(make_point({0, 0}).outline, {{0.2 * gap, gap}, 0}, wedge, {}, 0.5);
    ASSERT_FALSE(found.empty()) << gap;
    for (const NearFeature& f : found) {
      EXPECT_NEAR(f.gap, gap * std::hypot(0.2, 1.0), 1e-15) << "site " << f.site;
      EXPECT_NEAR(f.point.norm(), 0.0, 1e-15) << "site " << f.site;
    }
  }
}

// A half disc on its round side, sunk by what steps leave of a contact.
TEST(NearFeatures, RoundSideThatHasSunkALittleIsStillSeen) {
  const Outline half = make_path("M-1 0 A1 1 0 0 0 1 0 Z", 1.0, 1e-6).outline;
  const Vec2 low = half.bounds.low;
  ASSERT_GT(-low.y(), half.bounds.high.y());  // the round side is below
  for (const double sunk : {0.0, 1e-13, 1e-11, 1e-9}) {
    const auto found = between(half, {{0, -low.y() - sunk}, 0}, wire({-5, 0}, {5, 0}), {}, 0.1);
    const bool seen = std::any_of(found.begin(), found.end(),
                                  [&](const NearFeature& f) { return std::abs(f.gap + sunk) < 1e-14; });
    EXPECT_TRUE(seen) << sunk;
  }
}

// A sample that roundings have put into a solid is met by the side that it crossed, from inside.
TEST(NearFeatures, SampleInsideByARoundingIsSeenFromTheSideThatItCrossed) {
  const auto found =
      between(make_point({0, 0}).outline, {{0.2, 0.5 - 1e-14}, 0}, make_box(2, 1).outline, {}, 0.1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].gap, -1e-14, 1e-16);
  EXPECT_NEAR((found[0].normal - Vec2(0, 1)).norm(), 0.0, 1e-12);
}

TEST(NearFeatures, DiscInABowlTouchesItOnceWhereItIsDeepest) {
  const Outline bowl = make_disc_container(2.0).outline;
  for (const double angle : {0.3, 2.0, 4.0, 5.5}) {
    const Vec2 out(std::cos(angle), std::sin(angle));
    const auto found = between(make_disc(0.5).outline, {1.49 * out, 0}, bowl, {}, 0.1);
    ASSERT_FALSE(found.empty()) << angle;
    const auto nearest = std::min_element(found.begin(), found.end(),
                                          [](const auto& f, const auto& g) { return f.gap < g.gap; });
    EXPECT_NEAR(nearest->gap, 0.01, 1e-14) << angle;
    EXPECT_NEAR((nearest->normal + out).norm(), 0.0, 1e-14) << angle;
    EXPECT_EQ(std::count_if(found.begin(), found.end(), [](const auto& f) { return f.gap < 0.0101; }), 1);
  }
}

TEST(NearFeatures, BoxInTheCornerOfARoomTouchesBothWalls) {
  const Outline room = as_container(make_box(4, 4).outline);
  const auto found = between(make_box(1, 1).outline, {{1.49, -1.48}, 0}, room, {}, 0.1);
  int right = 0, below = 0;
  for (const NearFeature& f : found) {
    right += f.normal.x() < -0.99 && std::abs(f.gap - 0.01) < 1e-14;
    below += f.normal.y() > 0.99 && std::abs(f.gap - 0.02) < 1e-14;
    EXPECT_GE(f.gap, 0.01 - 1e-14);
  }
  EXPECT_EQ(right, 2);
  EXPECT_EQ(below, 2);
}

// A point upon one piece of a hump is behind the tangent at its end, and meets the next piece only once it has come there: that is listed
// with the gap of its circle or line. Not what lies round a corner of more than 60 degrees.
TEST(NearFeatures, WhatComesOverAHumpMayMeetTheNextPiece) {
  const Outline tip = make_polygon({{0, 0}, {0.1, 0.3}, {-0.1, 0.3}}).outline;
  const auto over_hump = [&](const Outline& hump, const Vec2& at) {
    std::vector<NearFeature> found = between(tip, {at, 0}, hump, {}, 0.3);
    std::erase_if(found, [](const NearFeature& f) { return !f.over_hump; });
    return found;
  };
  // a quarter of a circle of 1 goes on smoothly into one of 1.25 at the top (the way of a path leads down with y)
  const Outline egg =
      make_path("M 1 0 A 1 1 0 0 0 0 -1 A 1.25 1.25 0 0 0 -1.25 0.25 L 1 0.25 Z", 1.0, 1e-3).outline;
  const auto ahead = over_hump(egg, {0.02, std::sqrt(1 - 0.02 * 0.02) + 1e-5});
  ASSERT_EQ(ahead.size(), 1U);
  const Site& next = egg.sites[ahead[0].site];
  EXPECT_NEAR(next.arc_radius, 1.25, 1e-12);
  EXPECT_TRUE(ahead[0].goes_on && ahead[0].at_end);
  const Vec2 from_centre = Vec2(0.02, std::sqrt(1 - 0.02 * 0.02) + 1e-5) - next.center;
  EXPECT_NEAR(ahead[0].gap, from_centre.norm() - 1.25, 1e-12);
  EXPECT_NEAR((ahead[0].normal - from_centre.normalized()).norm(), 0.0, 1e-12);
  // until it is there its gap is that of the end
  EXPECT_GT(
      gap_of(ahead[0], tip, ExtendedState(BodyState{{{0.02, std::sqrt(1 - 0.02 * 0.02) + 1e-5}, 0}, {}}), egg,
             ExtendedState(BodyState{})),
      0.01);
  // upon a side of an octagon the two beside it, upon one of a box none
  std::vector<Vec2> corners;
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.25 * M_PI * (k + 0.5);
    corners.emplace_back(std::cos(angle), std::sin(angle));
  }
  const double flat = std::cos(M_PI / 8);
  EXPECT_EQ(over_hump(make_polygon(corners).outline, {0.3, flat + 1e-5}).size(), 1U);
  EXPECT_TRUE(over_hump(make_box(2, 2).outline, {0.9, 1 + 1e-5}).empty());
}

// ---- against brute force

std::vector<NamedOutline> outlines() {
  std::vector<NamedOutline> all;
  for (NamedOutline& n : query_outlines())  // but those too thin, flat or fat to be walked along
    if (n.name != "thin wall" && n.name != "flat arc" && n.name != "very thick arc") all.push_back(n);
  return all;
}

struct Placed {
  Pose a, b;
  double gap = 0.0;
};

/// Two outlines a little apart, as extended precision sees them.
std::optional<Placed> place(const Outline& a, const Outline& b, Random& random) {
  const outside::Shape of_a = outside::shape_of(a), of_b = outside::shape_of(b);
  for (int tries = 0; tries < 200; ++tries) {
    Placed p;
    p.b = {anywhere(random, 3.0), random.uniform(-3.0, 3.0)};
    p.a = {p.b.position + anywhere(random, 2.5), random.uniform(-3.0, 3.0)};
    p.gap = static_cast<double>(outside::gap(of_a, {outside::vec(p.a.position), p.a.angle}, of_b,
                                             {outside::vec(p.b.position), p.b.angle}));
    if (p.gap > 1e-3 && p.gap < 0.3) return p;
  }
  return std::nullopt;
}

/// The site of a feature as it stands in the world, in extended precision.
outside::Piece site_of(const NearFeature& f, const Outline& a, const Outline& b, const Placed& p) {
  const Pose& at = f.sample_on_a ? p.b : p.a;
  return moved(outside::shape_of(f.sample_on_a ? b : a).pieces[f.site], outside::Turn(at.angle),
               outside::vec(at.position));
}

/// Arcs that are hollow somewhere: see BoxInTheHollowOfAnArcIsApart.
bool has_hollows(const std::string& name) { return name == "curve" || name == "egg"; }

// None is nearer than the outlines are, one is as near; each begins on the surface of its site.
TEST(NearFeatures, OfOutlinesOfAllKindsAreAsNearAsThese) {
  SeededRandom random(1);
  const std::vector<NamedOutline> all = outlines();
  int features = 0;
  for (const auto& [name_a, a] : all)
    for (const auto& [name_b, b] : all)
      for (int k = 0; k < 6; ++k) {
        const auto p = a.container ? std::nullopt : place(a, b, random);
        if (!p || has_hollows(name_a) || has_hollows(name_b)) continue;
        double least = std::numeric_limits<double>::infinity();
        for (const NearFeature& f : between(a, p->a, b, p->b, 0.4)) {
          // see WhatComesOverAHumpMayMeetTheNextPiece
          if (f.over_hump) continue;
          ++features;
          least = std::min(least, f.gap);
          EXPECT_NEAR(f.normal.norm(), 1.0, 1e-14) << name_a << " and " << name_b;
          const outside::Piece piece = site_of(f, a, b, *p);
          const outside::Vec there = outside::vec(p->b.position) + outside::vec(f.point);
          // over a smooth joint it begins on the tangent there
          if (f.over_joint) continue;
          EXPECT_LE(std::abs(outside::to_core(there, piece) - piece.thickness), 1e-12)
              << name_a << " and " << name_b;
        }
        EXPECT_NEAR(least, p->gap, 1e-12) << name_a << " and " << name_b << ", place " << k;
      }
  std::printf("%d features\n", features);
  EXPECT_GT(features, 2000);
}

// Whatever two points face each other, neither of which can go nearer, are a feature.
TEST(NearFeatures, AreAllThatFaceEachOther) {
  SeededRandom random(2);
  const std::vector<NamedOutline> all = outlines();
  constexpr double kReach = 0.4;
  int met = 0;
  for (const auto& [name_a, a] : all)
    for (const auto& [name_b, b] : all) {
      if (a.container) continue;
      const auto p = place(a, b, random);
      if (!p) continue;
      const auto found = between(a, p->a, b, p->b, kReach);
      for (const FacingPoints& facing : facing_points(a, p->a, b, p->b)) {
        if (facing.gap > 0.9 * kReach) continue;
        ++met;
        const bool told = std::any_of(found.begin(), found.end(), [&](const NearFeature& f) {
          return std::abs(f.gap - facing.gap) < 1e-6 && (f.normal - facing.normal).norm() < 1e-2;
        });
        EXPECT_TRUE(told) << name_a << " and " << name_b << ": gap " << facing.gap << " along "
                          << facing.normal.transpose() << ", at " << facing.on_a.transpose();
      }
    }
  std::printf("%d pairs of points that face each other\n", met);
  EXPECT_GT(met, 300);
}

bool is_the_same(const NearFeature& f, const NearFeature& g) {
  return std::tie(f.sample_on_a, f.sample, f.site, f.gap, f.at_end, f.beside_arc, f.over_joint,
                  f.no_way_by) == std::tie(g.sample_on_a, g.sample, g.site, g.gap, g.at_end, g.beside_arc,
                                           g.over_joint, g.no_way_by) &&
         f.point == g.point && f.normal == g.normal;
}

/// A gear, and a ring that has room for it.
std::vector<Vec2> teeth(int count, double inner, double outer) {
  std::vector<Vec2> corners;
  for (int k = 0; k < 4 * count; ++k) {
    const double angle = 2.0 * M_PI *
                         (k + (k % 4 == 1 || k % 4 == 2 ? 0.0
                               : k % 4 == 0             ? -0.1
                                                        : 0.1)) /
                         (4 * count),
                 radius = k % 4 == 1 || k % 4 == 2 ? outer : inner;
    corners.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

// What is far off is left out before it is looked at: of a list that goes far those that are as near are all the same, to the bit.
TEST(NearFeatures, OfAShortListAreThoseOfALongOneThatAreAsNear) {
  SeededRandom random(4);
  std::vector<NamedOutline> all = outlines();
  all.push_back({"gear", make_polygon(teeth(9, 0.8, 1.0)).outline});
  all.push_back({"ring", as_container(make_polygon(teeth(24, 2.6, 2.3)).outline)});
  int near = 0, far = 0;
  for (const auto& [name_a, a] : all)
    for (const auto& [name_b, b] : all)
      for (int k = 0; k < 12; ++k) {
        if (a.container) continue;
        // apart, and a little in each other
        const Pose at_b{anywhere(random, 3.0), random.uniform(-3.0, 3.0)},
            at_a{at_b.position + anywhere(random, 2.0), random.uniform(-3.0, 3.0)};
        const double reach = std::pow(10.0, random.uniform(-9.0, -0.5));
        // which arcs may come to lie in each other is a matter of the reach itself
        const auto is_far = [&](const NearFeature& f) {
          const bool in_arc = f.beside_arc && (f.sample_on_a ? b : a).sites[f.site].kind == SiteKind::arc;
          return f.gap > reach || f.goes_on || in_arc;
        };
        std::vector<NearFeature> short_list = between(a, at_a, b, at_b, reach),
                                 long_list = between(a, at_a, b, at_b, 1e3);
        far += static_cast<int>(long_list.size());
        std::erase_if(short_list, is_far);
        std::erase_if(long_list, is_far);
        near += static_cast<int>(short_list.size());
        EXPECT_TRUE(
            std::equal(short_list.begin(), short_list.end(), long_list.begin(), long_list.end(), is_the_same))
            << name_a << " and " << name_b << ", place " << k << ", reach " << reach << ": "
            << short_list.size() << " of " << long_list.size();
      }
  std::printf("%d of %d features\n", near, far);
  EXPECT_GT(near, 1000);
  EXPECT_GT(far, 10 * near);
}

// ---- elsewhere

/// Where site and sample are of kinds whose distance is convex, anything but an arc's hollow; and the sample is
/// beside a solid's site, not beyond its end (see GapGoesOnWhereTheSampleLeavesTheSideOfItsSite).
bool is_convex(const NearFeature& f, const Outline& a, const Outline& b, const Placed& p) {
  const Outline &of_site = f.sample_on_a ? b : a, &of_sample = f.sample_on_a ? a : b;
  const outside::Piece site = site_of(f, a, b, p);
  const outside::Vec there = outside::vec(p.b.position) + outside::vec(f.point);
  const bool at_end = std::min(norm(there - site.a), norm(there - site.b)) <= site.thickness + 1e-12L;
  return site.kind != outside::Piece::Kind::arc && of_sample.samples[f.sample].arc_site < 0 &&
         !(of_site.solid && at_end);
}

// A gap moved by nothing is itself; along a way on which nothing turns it lies above its tangent.
TEST(NearFeatures, GapsAlongAStraightWayLieAboveTheirTangents) {
  SeededRandom random(3);
  const std::vector<NamedOutline> all = outlines();
  int looks = 0;
  for (int round = 0; round < 10; ++round)
    for (const auto& [name_a, a] : all)
      for (const auto& [name_b, b] : all) {
        if (a.container) continue;
        const auto p = place(a, b, random);
        if (!p) continue;
        const Vec2 way = anywhere(random, 1.0).normalized();
        for (const NearFeature& f : between(a, p->a, b, p->b, 0.4)) {
          const ExtendedState at_b(BodyState{p->b, {}});
          const auto gap = [&](double along) {
            return gap_of(f, a, ExtendedState(BodyState{p->a, {}}).shifted(along * way), b, at_b);
          };
          // over a smooth joint it is that above the tangent, or the circle, until the sample is abreast of the site
          if (f.over_joint || f.over_hump) continue;
          EXPECT_NEAR(gap(0.0), f.gap, 1e-14) << name_a << " and " << name_b;
          if (!is_convex(f, a, b, *p)) continue;
          for (const double along : {1e-3, 0.01, 0.1}) {
            if (along > p->gap) continue;  // the two may overlap, there or elsewhere
            ++looks;
            EXPECT_GE(gap(along), f.gap + along * f.normal.dot(way) - 1e-13)
                << name_a << " and " << name_b << ", sample " << f.sample
                << (f.sample_on_a ? " of a" : " of b") << ", site " << f.site << ", gap " << f.gap
                << ", moved by " << along;
          }
        }
      }
  EXPECT_GT(looks, 5000);
}

}  // namespace
}  // namespace brink::near_features_test
