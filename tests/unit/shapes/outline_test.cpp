#include "brink/core/shapes/outline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "brink/core/base/error.h"
#include "brink/core/base/random.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/shapes.h"

namespace brink::outline_test {
namespace {

using ::testing::HasSubstr;
constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class Make>
std::string fault(Make make) {
  try {
    make();
  } catch (const BadInput& e) {
    return e.what();
  }
  return "no fault";
}

TEST(Outline, DiscIsOneSampleWithItsRadius) {
  const Outline disc = make_disc(0.5).outline;
  EXPECT_TRUE(disc.is_point());
  EXPECT_FALSE(disc.solid);
  ASSERT_EQ(disc.samples.size(), 1u);
  EXPECT_EQ(disc.samples[0].radius, 0.5);
  EXPECT_EQ(disc.bounding_radius, 0.5);
  EXPECT_EQ(disc.bounds.low, Vec2(-0.5, -0.5));
}

TEST(Outline, CapsuleIsTwoSamples) {
  const Outline capsule = make_capsule(2, 0.25).outline;
  ASSERT_EQ(capsule.samples.size(), 2u);
  EXPECT_EQ(capsule.samples[0].p, Vec2(-1, 0));
  EXPECT_EQ(capsule.samples[1].p, Vec2(1, 0));
  EXPECT_EQ(capsule.bounding_radius, 1.25);
}

TEST(Outline, BoxHasFourSamplesAndOutwardPseudoNormals) {
  const Outline box = make_box(2, 4, 0.5).outline;
  ASSERT_EQ(box.samples.size(), 4u);
  for (const Sample& s : box.samples) EXPECT_EQ(s.radius, 0.5);
  for (const Site& s : box.sites) EXPECT_GT(s.pseudo_a.dot(s.a), 0);
  EXPECT_EQ(box.bounds.high, Vec2(1.5, 2.5));
  EXPECT_EQ(box.bounding_radius, std::sqrt(5) + 0.5);
}

TEST(Outline, ConvexPolygonsAloneHaveFacets) {
  const Outline box = make_box(4, 2, 0.1).outline;
  ASSERT_EQ(box.facets.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(box.facets[k].norm(), 1.0, 1e-15);
    EXPECT_GT(box.facets[k].dot(0.5 * (box.sites[k].a + box.sites[k].b)), 0.9);  // outward
    EXPECT_NEAR(box.facets[k].dot(box.sites[k].b - box.sites[k].a), 0.0, 1e-15);
  }
  EXPECT_EQ(make_polygon({{0, 0}, {1, 0}, {0.5, 1}}).outline.facets.size(), 3u);
  const auto facets_of = [](const Outline& outline) { return outline.facets.size(); };
  EXPECT_EQ(facets_of(make_polygon({{0, 0}, {2, 0}, {2, 2}, {1, 0.5}}).outline), 0u);  // a notch
  EXPECT_EQ(facets_of(as_container(make_box(4, 2).outline)), 0u);
  EXPECT_EQ(facets_of(make_disc(1).outline), 0u);
  EXPECT_EQ(facets_of(make_chain({{0, 0}, {1, 0}, {1, 1}}, true).outline), 0u);  // a wire
}

TEST(Outline, ArcSamplesStandForTheConvexSide) {
  // a wire arc and the outer arcs of a solid count; the inner side of a hole or container has its convex side
  // in the solid
  const Outline wire = make_arc({1, 0}, 2, 0, pi, 0.1).outline;
  int arcs = 0;
  for (const Sample& s : wire.samples)
    if (s.arc_site >= 0) {
      ++arcs;
      EXPECT_EQ(s.p, Vec2(1, 0));
      EXPECT_EQ(s.radius, 2.1);
    }
  EXPECT_EQ(arcs, 2);
  EXPECT_EQ(wire.samples.size(), 5u);
  EXPECT_EQ(make_path("M-1 0A1 1 0 0 1 1 0A1 1 0 0 1-1 0Z", 1, 1e-6).outline.samples.size(), 8u);
  EXPECT_EQ(make_disc_container(2).outline.samples.size(), 4u);
}

TEST(Outline, BoundsOfArcsAreExact) {
  // from 45 to 135 degrees on a circle of radius 1 about (0, 1): the top is the only axis point
  const Outline arc = make_arc({0, 1}, 1, pi / 4, 3 * pi / 4).outline;
  EXPECT_EQ(arc.bounds.high.y(), 2);
  EXPECT_NEAR(arc.bounds.high.x(), std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(arc.bounds.low.y(), 1 + std::sqrt(0.5), 1e-15);
  EXPECT_EQ(arc.bounding_radius, 2);
}

TEST(Outline, BoundsHoldRandomArcsAndTouchThem) {
  // every sampled point is within; the farthest of 2001 samples is within R (step/2)^2 / 2 of the bound
  Random random(8);
  for (int k = 0; k < 300; ++k) {
    const Vec2 c(random.uniform(-1, 1), random.uniform(-1, 1));
    const double r = random.uniform(0.1, 2), from = random.uniform(-7, 7), sweep = random.uniform(0.1, 6);
    const Outline arc = make_arc(c, r, from, from + sweep).outline;
    double farthest = 0;
    Box box;
    for (int j = 0; j <= 2000; ++j) {
      const Vec2 p = c + r * unit_at(from + sweep * j / 2000);
      farthest = std::max(farthest, p.norm());
      box.add(p);
      ASSERT_TRUE(arc.bounds.grown(1e-14).contains(p)) << "seed 8, case " << k;
    }
    EXPECT_LE(farthest, arc.bounding_radius + 1e-14);
    EXPECT_GE(farthest, arc.bounding_radius - 1e-5);
    EXPECT_LT((box.high - arc.bounds.high).norm() + (box.low - arc.bounds.low).norm(), 1e-5);
  }
}

TEST(Outline, TransformedMovesTheDistanceWithIt) {
  const Outline shape = make_path("M0 0H3A1 1 0 0 1 3 2H0Z", 1, 1e-6).outline;
  Pose pose;
  pose.position = Vec2(3, -2);
  pose.angle = 0.7;
  const Outline moved = transformed(shape, pose);
  const Frame frame(pose);
  Random random(4);
  for (int k = 0; k < 2000; ++k) {
    const Vec2 q(random.uniform(-2, 6), random.uniform(-4, 4));
    EXPECT_NEAR(gap_by_brute_force(moved, frame.to_world(q)), gap_by_brute_force(shape, q), 1e-14)
        << "seed 4";
  }
}

TEST(Outline, ContainerTwiceOrOfAWireIsRefused) {
  EXPECT_THROW(as_container(make_disc(1).outline), BadInput);
  EXPECT_THROW(as_container(make_chain({{0, 0}, {1, 0}, {1, 1}}, true).outline), BadInput);
  EXPECT_THROW(as_container(make_disc_container(1).outline), BadInput);
}

TEST(Outline, BadSitesAreNamed) {
  Outline gap_in_loop;
  gap_in_loop.sites = {segment_site({0, 0}, {1, 0}, 0), segment_site({1, 1e-9}, {2, 0}, 0)};
  gap_in_loop.loops = {{0, 2, false}};
  EXPECT_THAT(fault([&] { finish_outline(gap_in_loop); }), HasSubstr("site 0 ends at (1, 0)"));
  Outline long_arc;
  Site arc;
  arc.kind = SiteKind::arc;
  arc.a = Vec2(1, 0);
  arc.b = Vec2(-1, 0);
  arc.arc_radius = 1;
  arc.sweep = pi;
  long_arc.sites = {arc};
  long_arc.loops = {{0, 1, false}};
  EXPECT_THAT(fault([&] { finish_outline(long_arc); }), HasSubstr("at most a quarter turn"));
  Outline empty;
  EXPECT_THROW(finish_outline(empty), BadInput);
}

TEST(Shapes, BadNumbersAreNamed) {
  EXPECT_THAT(fault([] { make_disc(-1); }), HasSubstr("radius is -1; it must be > 0"));
  EXPECT_THAT(fault([] { make_disc(nan); }), HasSubstr("radius is nan"));
  EXPECT_THAT(fault([] { make_box(0, 1); }), HasSubstr("width is 0"));
  EXPECT_THAT(fault([] { make_box(1, 1, -0.5); }), HasSubstr("radius is -0.5; it must be >= 0"));
  EXPECT_THAT(fault([] { make_capsule(1, 0); }), HasSubstr("radius is 0"));
  EXPECT_THAT(fault([] { make_segment({1, 2}, {1, 2}); }), HasSubstr("both ends are (1, 2)"));
  EXPECT_THAT(fault([] { make_arc({0, 0}, 1, 1, 1); }), HasSubstr("angles must be finite and differ"));
  EXPECT_THAT(fault([] {
                make_arc({-1e15, 1}, 1, 0, 2);
              }),
              HasSubstr("about (-1e+15, 1) its places are rounded by 0.222"));
  EXPECT_THAT(fault([] { make_chain({{0, 0}}); }), HasSubstr("at least 2"));
  EXPECT_THAT(fault([] {
                make_bezier({Vec2(1, 1), Vec2(1, 1), Vec2(1, 1), Vec2(1, 1)}, 1e-3);
              }),
              HasSubstr("differ"));
}

TEST(Shapes, BadPolygonsAreNamed) {
  EXPECT_THAT(fault([] { make_polygon({{0, 0}, {1, 0}}); }), HasSubstr("at least 3"));
  EXPECT_THAT(fault([] { make_polygon({{0, 0}, {1, 0}, {1, nan}}); }), HasSubstr("vertex 2 is (1, nan)"));
  EXPECT_THAT(fault([] { make_polygon({{0, 0}, {1, 0}, {2, 0}}); }), HasSubstr("area is 0"));
  EXPECT_THAT(fault([] { make_polygon({{0, 0}, {2, 2}, {2, 0}, {0, 3}}); }), HasSubstr("sides 0 and 2"));
  EXPECT_THAT(fault([] {
                make_polygon({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}});
              }),
              HasSubstr("cross or touch"));
  EXPECT_THAT(fault([] {
                make_polygon({{0, 0}, {4, 0}, {6, 0}, {4, 0}, {4, 4}});
              }),
              HasSubstr("cross or touch"))
      << "a spike of no width";
  EXPECT_THAT(fault([] { make_polygons({}); }), HasSubstr("empty"));
  EXPECT_THAT(fault([] {
                make_polygons({{{0, 0}, {1, 0}, {0, 1}}, {{0, 0}, {1, 0}}});
              }),
              HasSubstr("polygons[1]"));
}

TEST(Shapes, SizesWithoutAMeasureAreRefused) {
  // r^4 overflows or underflows: there is no inertia to compute with
  EXPECT_THAT(fault([] { make_disc(1e100); }), HasSubstr("too far"));
  EXPECT_THAT(fault([] { make_disc(1e-100); }), HasSubstr("both must be > 0"));
  EXPECT_EQ(fault([] { make_point({1, 2}); }), "no fault");
  EXPECT_THAT(fault([] { make_disc_container(1e100); }), HasSubstr("too far"));
  EXPECT_THAT(fault([] { make_disc_container(1e-100); }), HasSubstr("both must be > 0"));
}

TEST(Shapes, RepeatedVerticesMerge) {
  EXPECT_EQ(make_polygon({{0, 0}, {0, 0}, {1, 0}, {1, 1}, {1, 1}, {0, 0}}).outline.sites.size(), 3u);
}

TEST(Shapes, ThinSawIsAccepted) {
  // a thousand teeth a hundred times taller than wide: close neighbours, no touch
  std::vector<Vec2> saw{{1, -1}, {0, -1}};
  for (int k = 0; k < 1000; ++k) {
    saw.emplace_back(k / 1000.0, 0);
    saw.emplace_back((k + 0.5) / 1000.0, 0.1);
  }
  saw.emplace_back(1, 0);
  const Shape shape = make_polygon(saw);
  EXPECT_NEAR(shape.measure.size, 1 + 1000 * 0.001 * 0.1 / 2, 1e-12);
}

// Whatever the sweep, no piece turns by more than an arc site may.
TEST(Shapes, ArcsOfAHairMoreThanQuarterTurnsAreSplit) {
  for (const double quarters : {1.0, 2.0, 3.0})
    for (double more = 1e-16; more < 1e-6; more *= 3.0) {
      const double sweep = quarters * kQuarterTurn * (1 + more);
      const Shape arc = make_arc({0, 0}, 1, 0, sweep);
      EXPECT_NEAR(arc.measure.size, sweep, 1e-14) << more;
      EXPECT_EQ(arc.outline.sites.size(), quarters + (more > 1e-12 ? 1 : 0)) << more;
    }
}

TEST(Shapes, ArcGivenBackwardsGoesTheLongWayRound) {
  double sweep = 0;
  for (const Site& s : make_arc({0, 0}, 1, pi / 2, 0).outline.sites) sweep += s.sweep;
  EXPECT_NEAR(sweep, 3 * pi / 2, 1e-15);
}

}  // namespace
}  // namespace brink::outline_test
