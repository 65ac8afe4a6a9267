/// Rays against known places, and against sphere tracing that shares no code.
#include "brink/core/query/cast_ray.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "brink/core/base/error.h"
#include "brink/core/shapes/curve_site.h"
#include "tests/unit/query/query_shapes.h"

namespace brink::cast_ray_test {
namespace {

constexpr double pi = std::numbers::pi;

Ray along_x(double x, double y) { return {{x, y}, {1, 0}}; }

void expect_hit(const std::optional<RayHit>& hit, double distance, const Vec2& normal) {
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, distance, 1e-14);
  EXPECT_LE((hit->normal - normal).norm(), 1e-14) << hit->normal.transpose();
  EXPECT_FALSE(hit->starts_inside);
}

// A disc of radius 5 about (10, 0), met 3 above its middle: at x = 10 - 4.
TEST(CastRay, ADiscIsMetOnItsRim) {
  const Outline disc = make_disc(5.0).outline;
  expect_hit(cast_ray(disc, {{10, 0}, 0.0}, along_x(0, 3)), 6.0, {-0.8, 0.6});
  expect_hit(cast_ray(disc, {{10, 0}, 0.0}, along_x(0, 5)), 10.0, {0, 1});  // grazes
  EXPECT_FALSE(cast_ray(disc, {{10, 0}, 0.0}, along_x(0, 5.001)));
  EXPECT_FALSE(cast_ray(disc, {{10, 0}, 0.0}, along_x(20, 3)));  // behind
}

TEST(CastRay, EndsAtItsLength) {
  Ray ray = along_x(0, 0);
  ray.length = 6.0;
  EXPECT_TRUE(cast_ray(make_disc(1.0).outline, {{7, 0}, 0.0}, ray));
  ray.length = std::nextafter(6.0, 0.0);
  EXPECT_FALSE(cast_ray(make_disc(1.0).outline, {{7, 0}, 0.0}, ray));
}

// A capsule of radius 1 along y: its side at 1, and above its end (0, 2) a quarter of a disc.
TEST(CastRay, ACapsuleIsItsSidesAndItsEnds) {
  const Outline capsule = make_capsule(4.0, 1.0).outline;
  const Pose upright{{0, 0}, pi / 2};
  expect_hit(cast_ray(capsule, upright, along_x(-5, 1.5)), 4.0, {-1, 0});
  expect_hit(cast_ray(capsule, upright, along_x(-5, 2.6)), 4.2, {-0.8, 0.6});
  expect_hit(cast_ray(capsule, upright, {{0, 9}, {0, -1}}), 6.0, {0, 1});
  EXPECT_FALSE(cast_ray(capsule, upright, along_x(-5, 3.1)));
}

// Half a circle of radius 3, open to the left, thickness 1: from the left it is met inside, at x = 2; from the
// right at 4; its ends are discs.
TEST(CastRay, AThickArcIsMetOnBothSidesAndAtItsEnds) {
  const Outline arc = make_arc({0, 0}, 3.0, -pi / 2, pi / 2, 1.0).outline;
  expect_hit(cast_ray(arc, {}, along_x(-9, 0)), 11.0, {-1, 0});
  expect_hit(cast_ray(arc, {}, {{9, 0}, {-1, 0}}), 5.0, {1, 0});
  expect_hit(cast_ray(arc, {}, along_x(-9, 3)), 8.0, {-1, 0});
}

TEST(CastRay, WiresAreMetFromEitherSide) {
  const Outline wire = make_segment({0, -1}, {0, 1}).outline;
  expect_hit(cast_ray(wire, {}, along_x(-2, 0.5)), 2.0, {-1, 0});
  expect_hit(cast_ray(wire, {}, {{2, 0.5}, {-1, 0}}), 2.0, {1, 0});
  const Outline bow = make_arc({0, 0}, 1.0, -1.0, 1.0).outline;
  expect_hit(cast_ray(bow, {}, along_x(-2, 0)), 3.0, {-1, 0});
  expect_hit(cast_ray(bow, {}, {{2, 0}, {-1, 0}}), 1.0, {1, 0});
  expect_hit(cast_ray(make_segment({2, 0}, {3, 0}).outline, {}, along_x(0, 0)), 2.0, {0, -1});  // along it
}

TEST(CastRay, FromInsideAContainerItsWallIsMet) {
  expect_hit(cast_ray(make_disc_container(2.0).outline, {{5, 5}, 1.0}, along_x(5, 5)), 2.0, {-1, 0});
  const Outline room = as_container(make_box(4.0, 2.0).outline);
  expect_hit(cast_ray(room, {}, {{0, 0}, {0.6, 0.8}}), 1.25, {0, -1});
}

TEST(CastRay, AnOriginInsideIsSaid) {
  const std::optional<RayHit> hit = cast_ray(make_box(2.0, 2.0).outline, {}, along_x(0.7, 0));
  ASSERT_TRUE(hit);
  EXPECT_TRUE(hit->starts_inside);
  EXPECT_EQ(hit->distance, 0.0);
  EXPECT_EQ(hit->point, Vec2(0.7, 0));
  EXPECT_LE((hit->normal - Vec2(1, 0)).norm(), 1e-15);
  const std::optional<RayHit> wall = cast_ray(make_disc_container(1.0).outline, {}, along_x(1.5, 0));
  ASSERT_TRUE(wall);
  EXPECT_TRUE(wall->starts_inside);
  const std::optional<RayHit> touching = cast_ray(make_box(2.0, 2.0).outline, {}, along_x(-1.0, 0));
  ASSERT_TRUE(touching);
  EXPECT_EQ(touching->distance, 0.0);
  EXPECT_FALSE(touching->starts_inside);
}

// Aimed at every vertex: what is closed has no slit where two sites meet.
TEST(CastRay, NothingSlipsThroughWhereSitesMeet) {
  constexpr std::uint64_t seed = 5;
  Random random(seed);
  for (const NamedOutline& o : query_outlines()) {
    if (!o.outline.solid || o.outline.container) continue;
    for (int k = 0; k < 2000; ++k) {
      const Site& site = o.outline.sites[random.below(o.outline.sites.size())];
      const Pose pose{anywhere(random, 3.0), random.uniform(-4, 4)};
      const double heading = random.uniform(0, 2 * pi);
      Ray ray;
      ray.origin = pose.position + 10.0 * Vec2(std::cos(heading), std::sin(heading));
      ray.direction = (Frame(pose).to_world(site.a) - ray.origin).normalized();
      const double beyond = (Frame(pose).to_world(site.a) - ray.origin).norm();
      const OutsideView view(o.outline, pose);
      const Vec2 behind = ray.origin + (beyond + 1e-3) * ray.direction;
      if (!view.within(outside::vec(behind))) continue;  // only grazes that corner
      const std::optional<RayHit> hit = cast_ray(o.outline, pose, ray);
      ASSERT_TRUE(hit) << o.name << ", case " << k << ", seed " << seed;
      EXPECT_LE(hit->distance, beyond + 1e-9) << o.name << ", case " << k << ", seed " << seed;
    }
  }
}

/// Arcs that hand over to each other.
Outline wire_of_arcs(std::vector<Site> sites) {
  Outline outline;
  outline.loops = {{0, static_cast<int>(sites.size()), false}};
  outline.sites = std::move(sites);
  finish_outline(outline);
  return outline;
}

// Two eighths of circles that cross the x axis where they join, each on the side of its own centre.
TEST(CastRay, WhereTwoArcsJoinThereIsNoSlit) {
  const double root = std::sqrt(2.0);
  std::vector<Site> sites;
  add_arc(sites, {1.0 - root, 1.0}, {0.0, 0.0}, {1.0, 1.0}, root, pi / 4, 0.0);
  add_arc(sites, {0.0, 0.0}, {root - 1.0, -1.0}, {-1.0, -1.0}, root, -pi / 4, 0.0);
  const std::optional<RayHit> hit = cast_ray(wire_of_arcs(sites), {}, along_x(-5, 0));
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->distance, 5.0);
  EXPECT_LT(hit->normal.x(), 0.0);
}

// A circle of 1e8 m through the origin, of which the middle 2 m are there: the distance keeps its digits.
TEST(CastRay, AFlatArcIsMetToARoundingOfTheDistance) {
  const double r = 1e8, drop = 1.0 / (r + std::sqrt(r * r - 1.0));
  std::vector<Site> sites;
  add_arc(sites, {1.0, -drop}, {-1.0, -drop}, {0.0, -r}, r, 2.0 * std::asin(1.0 / r), 0.0);
  expect_hit(cast_ray(wire_of_arcs(sites), {}, {{0.0, 0.1}, {0, -1}}), 0.1, {0, 1});
  expect_hit(cast_ray(wire_of_arcs(sites), {}, {{0.0, -0.1}, {0, 1}}), 0.1, {0, -1});
}

// Over the tip of a diamond, from either side: what is behind the tip does not turn its inside to the ray.
TEST(CastRay, ACornerThatIsGrazedTurnsItsOutsideToTheRay) {
  const Outline diamond = make_polygon({{0.5, 0}, {0, 0.5}, {-0.5, 0}, {0, -0.5}}).outline;
  for (const double way : {1.0, -1.0}) {
    const std::optional<RayHit> hit = cast_ray(diamond, {}, {{-2.0 * way, 0.5}, {way, 0}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->distance, 2.0);
    EXPECT_GT(hit->normal.y(), 0.5);
    EXPECT_LT(hit->normal.x() * way, -0.5);
  }
}

/// Steps as far as nothing can be, until it is there: never beyond the first hit. Infinite: no hit.
outside::Real sphere_trace(const OutsideView& view, const Ray& ray, outside::Real near) {
  const outside::Vec origin = outside::vec(ray.origin), direction = outside::vec(ray.direction);
  outside::Real t = 0;
  for (int step = 0; step < 200000 && t <= 20.0; ++step) {
    const outside::Real gap = view.to_pieces(origin + direction * t);
    if (gap <= near) return t;
    t += gap;
  }
  return outside::kNever;
}

TEST(CastRay, AgreesWithSphereTracing) {
  constexpr std::uint64_t seed = 77;
  Random random(seed);
  int hits = 0;
  for (const NamedOutline& o : query_outlines())
    for (int k = 0; k < 400; ++k) {
      SCOPED_TRACE(o.name + ", case " + std::to_string(k) + ", seed " + std::to_string(seed));
      const bool far = k % 4 == 0;
      const Pose pose{anywhere(random, far ? 1e6 : 2.0), random.uniform(-9, 9)};
      const double heading = random.uniform(0, 2 * pi);
      Ray ray;
      ray.origin = pose.position + anywhere(random, 2.5);
      ray.direction = {std::cos(heading), std::sin(heading)};
      ray.length = 20.0;
      const OutsideView view(o.outline, pose);
      const std::optional<RayHit> hit = cast_ray(o.outline, pose, ray);
      if (view.gap(outside::vec(ray.origin)) <= 0) {
        ASSERT_TRUE(hit);
        EXPECT_TRUE(hit->starts_inside);
        continue;
      }
      const double noise = (far ? 1e-9 : 1e-13) + looseness(o.outline);
      const outside::Real reference = sphere_trace(view, ray, noise);
      ASSERT_EQ(hit.has_value(), reference <= 20.0);
      if (!hit) continue;
      ++hits;
      EXPECT_FALSE(hit->starts_inside);
      const double sine = -hit->normal.dot(ray.direction);
      EXPECT_GE(sine, 0.0);
      EXPECT_NEAR(hit->distance, static_cast<double>(reference), 4 * noise / std::max(sine, 1e-3));
      const outside::Real at = view.to_pieces(outside::vec(hit->point));
      EXPECT_LE(std::abs(static_cast<double>(at)), 4 * noise);
    }
  EXPECT_GT(hits, 1000);
}

TEST(CastRay, WhatIsNoRayIsRefused) {
  const Outline disc = make_disc(1.0).outline;
  EXPECT_THROW(cast_ray(disc, {}, {{NAN, 0}, {1, 0}}), BadInput);
  EXPECT_THROW(cast_ray(disc, {}, {{5, 0}, {1, 1}}), BadInput);
  EXPECT_THROW(cast_ray(disc, {}, {{5, 0}, {0, 0}}), BadInput);
  EXPECT_THROW(cast_ray(disc, {}, {{5, 0}, {1, 0}, -1.0}), BadInput);
}

}  // namespace
}  // namespace brink::cast_ray_test
