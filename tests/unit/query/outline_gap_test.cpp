/// Gaps of two outlines against known distances, and against pairs of pieces that share no code.
#include "brink/core/query/outline_gap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "brink/core/query/closest_point.h"
#include "brink/core/query/gap_bound.h"
#include "tests/unit/query/query_shapes.h"

namespace brink::outline_gap_test {
namespace {

constexpr double pi = std::numbers::pi;

TEST(OutlineGap, DiscsApartAreTheirCentresLessTheirRadii) {
  const OutlineGap g =
      outline_gap(make_disc(1.0).outline, {{3, 4}, 2.0}, make_disc(0.5).outline, {{0, 0}, 1.0});
  EXPECT_NEAR(g.gap, 3.5, 1e-15);
  EXPECT_LE((g.normal - Vec2(0.6, 0.8)).norm(), 1e-15);
  EXPECT_LE((g.point_a - Vec2(2.4, 3.2)).norm(), 1e-15);
  EXPECT_LE((g.point_b - Vec2(0.3, 0.4)).norm(), 1e-15);
}

// A corner of the turned box points at the face: sqrt(2) below its centre.
TEST(OutlineGap, ACornerAboveAFaceIsItsHeight) {
  const Outline box = make_box(2.0, 2.0).outline, floor = make_box(10.0, 2.0).outline;
  for (const double height : {3.0, 2.2}) {
    const OutlineGap g = outline_gap(box, {{0.5, height}, pi / 4}, floor, {});
    EXPECT_NEAR(g.gap, height - 1.0 - std::sqrt(2.0), 1e-14);  // the second is in the floor
    EXPECT_LE((g.normal - Vec2(0, 1)).norm(), 1e-15);
    EXPECT_LE((g.point_b - Vec2(0.5, 1.0)).norm(), 1e-14);
    EXPECT_TRUE(g.sample_on_a);
    const OutlineGap other_way = outline_gap(floor, {}, box, {{0.5, height}, pi / 4});
    EXPECT_NEAR(other_way.gap, g.gap, 1e-14);
    EXPECT_LE((other_way.normal + g.normal).norm(), 1e-14);
    EXPECT_FALSE(other_way.sample_on_a);
  }
}

// The round side of a half disc, 0.25 above a wire: only its arc sees the wire's middle.
TEST(OutlineGap, AnArcIsMetInItsSector) {
  const Outline bow = make_arc({0, 0}, 1.0, -2.5, -0.5, 0.1).outline;
  const OutlineGap g = outline_gap(bow, {{0.3, 1.35}, 0.0}, make_segment({-5, 0}, {5, 0}).outline, {});
  EXPECT_NEAR(g.gap, 0.25, 1e-15);
  EXPECT_LE((g.point_a - Vec2(0.3, 0.25)).norm(), 1e-15);
  EXPECT_GE(g.sample, 0);
}

// A solid half disc that bulges down through a floor, by a rounding and by more: how far its lowest point is above it.
TEST(OutlineGap, ABulgeIsAsDeepAsItHasSunk) {
  const Outline half = make_path("M -1 0 A 1 1 0 0 0 1 0 Z", 1.0, 1e-4).outline;
  const Outline floor = make_box(20.0, 4.0).outline;
  const double low = half.bounds.low.y();
  for (const double height : {0.5, 1e-6, 1e-12, 0.0, -1e-15, -1e-12, -1e-9, -1e-6, -1e-3, -0.02})
    for (const double x : {0.0, 0.3, -2.7}) {
      const Pose pose{{x, 2.0 - low + height}, 0.0};
      EXPECT_NEAR(outline_gap(half, pose, floor, {}).gap, height, 2e-15) << height;
      EXPECT_NEAR(outline_gap(floor, {}, half, pose).gap, height, 2e-15) << height;
    }
}

// The hollow side of a solid's arc is no bulge: what lies in the bowl touches nothing.
// One lies in the hollow of the other and touches it from within: its circle is nearer the greater one's centre by a rounding,
// or farther.
TEST(OutlineGap, NestedArcsThatTouchAreToldToRoundings) {
  Random random(406);
  for (int k = 0; k < 500; ++k) {
    const double greater = random.uniform(0.2, 2.0), lesser = greater * random.uniform(0.2, 0.95);
    const double toward = random.uniform(-3.0, 3.0), angle = random.uniform(-9.0, 9.0);
    const Outline bowl = make_arc({0, 0}, greater, toward - 0.7, toward + 0.6).outline,
                  arc = make_arc({0, 0}, lesser, toward - 0.5, toward + 0.8).outline;
    for (const double gap :
         {1e-3, 1e-9, 1e-13, 3e-16, 2e-16, 1e-16, 0.0, -1e-16, -2e-16, -3e-16, -1e-13, -1e-9}) {
      const Vec2 shift = (greater - lesser - gap) * Vec2(std::cos(toward), std::sin(toward));
      EXPECT_NEAR(
          outline_gap(arc, {Frame({Vec2::Zero(), angle}).to_world(shift), angle}, bowl, {{0, 0}, angle}).gap,
          gap, 8e-15)
          << k;
    }
  }
}

TEST(OutlineGap, WhatIsInTheHollowOfASolidIsNotInIt) {
  const Outline bowl = make_path("M -2 0 L -1 0 A 1 1 0 0 0 1 0 L 2 0 L 2 2 L -2 2 Z", 1.0, 1e-4).outline;
  const Outline ball = make_disc(0.25).outline;
  const OutlineGap g = outline_gap(ball, {{0.0, 0.0}, 0.0}, bowl, {});
  EXPECT_GE(g.gap, 0.0);
}

// No vertex of either is in the other: a plus of two boxes; two wires; a bow through a wire.
TEST(OutlineGap, WhatCrossesWithoutAVertexInsideIsAnOverlap) {
  const Outline bar = make_box(4.0, 1.0).outline, wire = make_segment({-1, 0}, {1, 0}).outline;
  // of four crossings the deepest: the upright's upper end, at 2.1, over the side at 0.5
  EXPECT_NEAR(outline_gap(bar, {}, bar, {{0.2, 0.1}, pi / 2}).gap, -1.6, 1e-14);
  EXPECT_NEAR(outline_gap(wire, {}, wire, {{0.25, 0.0}, pi / 2}).gap, -0.75, 1e-14);
  const Outline bow = make_arc({0, 0}, 1.0, pi / 4, 3 * pi / 4).outline;
  EXPECT_LT(outline_gap(bow, {{0, -0.9}, 0.0}, wire, {}).gap, -0.05);
  EXPECT_LT(outline_gap(bow, {}, bow, {{0.5, 0.0}, 0.0}).gap, -0.05);
}

// An end that lies on the wire is not the whole: the arc rises over it, comes back and goes on below. It would have to go down
// by its rise or up by what is below, whichever is less; and so for every angle at which the pair stands.
TEST(OutlineGap, AnArcWithAnEndOnAWireReachesAsFarThroughAsItBulges) {
  const Outline wire = make_segment({-1, 0}, {1, 0}).outline;
  const double height = std::sin(pi / 3);
  for (const double to : {40.0, 50.0, 58.0, 60.0}) {
    const double angle = to * pi / 180;
    // from (-.5, 0), rising by .134 over the wire, which it meets again at 60 degrees
    const Outline bow = make_arc({0, -height}, 1.0, angle, 2 * pi / 3).outline;
    const double depth = std::min(1.0 - height, height - std::sin(angle));
    for (const double turn : {0.0, 1.0, 2.5, -0.7}) {
      const Pose pose{{0.3, 0.2}, turn};
      EXPECT_NEAR(outline_gap(bow, pose, wire, pose).gap, -depth, 1e-14) << to << " " << turn;
      EXPECT_NEAR(outline_gap(wire, pose, bow, pose).gap, -depth, 1e-14) << to << " " << turn;
    }
  }
  // two arcs that share a lens, an end of the one upon the other: least is what the other's end stands over it
  const Outline cup = make_arc({0, height}, 1.0, -130 * pi / 180, -50 * pi / 180).outline;
  const Outline bow = make_arc({0, -height}, 1.0, 40 * pi / 180, 120 * pi / 180).outline;
  const Vec2 end = Vec2(0, height) + Vec2(std::cos(-50 * pi / 180), std::sin(-50 * pi / 180));
  const double over = (end - Vec2(0, -height)).norm() - 1.0;
  EXPECT_NEAR(outline_gap(bow, {}, cup, {}).gap, -over, 1e-14);
}

TEST(OutlineGap, EdgesThatCoincideShareAnInside) {
  const Outline box = make_box(1.0, 1.0).outline;
  EXPECT_LT(outline_gap(box, {}, box, {}).gap, -0.1);
  EXPECT_LT(outline_gap(box, {}, box, {{0.5, 0.0}, 0.0}).gap, -0.05);
  EXPECT_EQ(outline_gap(box, {}, box, {{1.0, 0.0}, 0.0}).gap, 0.0);  // neighbours
}

TEST(OutlineGap, ABodyInAContainerIsApartFromItsWall) {
  const Outline room = make_disc_container(3.0).outline, ball = make_disc(0.5).outline;
  EXPECT_NEAR(outline_gap(ball, {{2, 0}, 0.0}, room, {}).gap, 0.5, 1e-15);
  EXPECT_NEAR(outline_gap(ball, {{2.75, 0}, 0.0}, room, {}).gap, -0.25, 1e-15);
  EXPECT_NEAR(outline_gap(ball, {{9, 0}, 0.0}, room, {}).gap, -6.5, 1e-15);  // in the rock
}

// 1e9 m out the poses have 1e-7 m; what is between them is told to a rounding of their sizes all the same.
TEST(OutlineGap, FarAwayNothingIsLost) {
  const Outline box = make_box(2.0, 2.0).outline;
  const Vec2 far(1073741824.0, -536870912.0);
  EXPECT_NEAR(outline_gap(box, {far, 0.0}, box, {far + Vec2(3.25, 0), 0.0}).gap, 1.25, 1e-15);
}

TEST(OutlineGap, AgreesWithPairsOfPiecesThatShareNoCode) {
  constexpr std::uint64_t seed = 404;
  Random random(seed);
  const std::vector<NamedOutline> outlines = query_outlines();
  int apart = 0, overlapping = 0, parted = 0;
  for (const NamedOutline& a : outlines)
    for (const NamedOutline& b : outlines)
      for (int k = 0; k < 30; ++k) {
        if (a.outline.container && b.outline.container) continue;
        SCOPED_TRACE(a.name + " and " + b.name + ", case " + std::to_string(k) + ", seed " +
                     std::to_string(seed));
        const Pose pose_a{anywhere(random, 2.5), random.uniform(-9, 9)},
            pose_b{anywhere(random, 2.5), random.uniform(-9, 9)};
        const OutlineGap g = outline_gap(a.outline, pose_a, b.outline, pose_b);
        const double reference = static_cast<double>(
            outside::gap(outside::shape_of(a.outline), {outside::vec(pose_a.position), pose_a.angle},
                         outside::shape_of(b.outline), {outside::vec(pose_b.position), pose_b.angle}));
        const double noise = 2e-14 + looseness(a.outline) + looseness(b.outline);
        EXPECT_LE((g.point_b + g.gap * g.normal - g.point_a).norm(), noise);
        if (std::abs(reference) <= noise) continue;
        ASSERT_EQ(g.gap > 0.0, reference > 0.0) << g.gap << " is not " << reference;
        if (reference > 0.0) {
          EXPECT_NEAR(g.gap, reference, noise);
        } else {
          EXPECT_FALSE(surely_apart(a.outline, pose_a, b.outline, pose_b, 0.0));
        }
        for (const double enough : {-1.0, 0.0, 0.1, 1e9}) {
          const double bound = gap_at_least(a.outline, pose_a, b.outline, pose_b, enough);
          EXPECT_LE(bound, reference + noise) << "enough: " << enough;
          parted += enough == 0.0 && bound > 0.0;
        }
        ++(reference > 0.0 ? apart : overlapping);
      }
  EXPECT_GT(apart, 1000);
  EXPECT_GT(overlapping, 1000);
  EXPECT_GT(parted, 3 * apart / 4);
}

// Samples and pairs of sites that cannot be the nearest are not looked at: what is told is the least of all that are.
TEST(OutlineGap, IsTheLeastOfAllSamples) {
  Random random(405);
  std::vector<Vec2> teeth;
  for (int k = 0; k < 60; ++k)
    teeth.push_back((k % 2 == 0 ? 1.0 : 0.8) * Vec2(std::cos(M_PI * k / 30), std::sin(M_PI * k / 30)));
  const Outline gear = make_polygon(teeth).outline, thick = make_polygon(teeth, 0.05).outline,
                wire = make_chain(teeth, true).outline, box = make_box(0.5, 0.2).outline;
  int apart = 0, within = 0;
  for (const Outline* a : {&gear, &thick, &wire, &box})
    for (const Outline* b : {&gear, &thick, &wire, &box})
      for (int k = 0; k < 200; ++k) {
        const Pose at_a{anywhere(random, 1.5), random.uniform(-9, 9)},
            at_b{anywhere(random, 1.5), random.uniform(-9, 9)};
        double least = std::numeric_limits<double>::infinity();
        const auto look = [&](const Outline& samples, const Pose& at, const Outline& sites,
                              const Pose& of_sites) {
          for (const Sample& s : samples.samples)
            least = std::min(least, closest_point(sites, of_sites, Frame(at).to_world(s.p)).gap - s.radius);
        };
        look(*a, at_a, *b, at_b);
        look(*b, at_b, *a, at_a);
        const double gap = outline_gap(*a, at_a, *b, at_b).gap;
        // sites that cross, and common edges, may be deeper than all samples
        EXPECT_LE(gap, least + 1e-14);
        if (gap > 0.0) {
          EXPECT_NEAR(gap, least, 1e-14);
        }
        ++(gap > 0.0 ? apart : within);
      }
  EXPECT_GT(apart, 500);
  EXPECT_GT(within, 500);
}

}  // namespace
}  // namespace brink::outline_gap_test
