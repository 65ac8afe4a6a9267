// The classic detector: what particles see, and how bodies go on from it.
#include "brink/scheduler/classic/depth_detector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "brink/core/shapes/distance.h"
#include "brink/scheduler/classic/depth_normal.h"
#include "tests/support/worlds.h"

namespace brink::depth_detector_test {
namespace {

using brink::testing::add;
using brink::testing::body;
using brink::testing::Events;
using brink::testing::site;
using brink::testing::until;

Sampling sampled(Sampling::Kind kind, double spacing) {
  Sampling s;
  s.kind = kind;
  s.spacing = spacing;
  return s;
}

SolverOptions depth_options(const std::string& policy = "global_backup") {
  SolverOptions options;
  options.detector = "depth";
  options.policy = policy;
  options.step = 0.01;
  return options;
}

std::vector<OwnerMoment> at_start(const World& world) {
  std::vector<OwnerMoment> owners;
  for (const Body& b : world.bodies) owners.push_back({b.initial, b.initial});
  for (const FixedSite& s : world.sites) owners.push_back({{s.pose, {}}, {s.pose, {}}});
  return owners;
}

/// Two unit squares that overlap by 0.2 in x, the left one moving to the right.
World two_squares() {
  World world;
  for (const double x : {0.0, 0.8}) {
    Body b = body(make_box(1, 1), {x, 0.0}, {x == 0.0 ? 1.0 : 0.0, 0.0});
    b.sampling = sampled(Sampling::Kind::volume, 0.05);
    add(world, b);
  }
  return world;
}

// The overlap is a rectangle of 0.2 x 1 m; the particles on the leading sides lie 0.2 m deep.
TEST(DepthDetector, VolumeParticlesTellDepthAndAreaOfAnOverlap) {
  const World world = two_squares();
  DepthDetector detector(world, depth_options(), nullptr);
  const DepthSight& sight = detector.look(at_start(world), 1.0);
  ASSERT_EQ(sight.overlaps.size(), 1U);
  EXPECT_NEAR(sight.overlaps[0].area, 0.2, 0.051);         // one lattice line of 0.05 x 1 more or less
  EXPECT_GT(sight.overlaps[0].depth, 0.19);                // boundary particles lie 0.2 deep
  EXPECT_LT(sight.overlaps[0].depth, 0.2 + 1.0 / 64);      // a pixel's worth
  EXPECT_NEAR(sight.overlaps[0].normal.x(), -1.0, 1e-12);  // into the left one
}

TEST(DepthDetector, EveryContactOfAMomentIsStoredWithSiteAndNormal) {
  World world;
  Body b = body(make_box(1, 1), {0.0, 0.5}, {0.0, -1.0});
  b.sampling = sampled(Sampling::Kind::boundary, 0.5);
  add(world, b);
  add(world, site(make_segment({-5, 0}, {5, 0})));
  DepthDetector detector(world, depth_options(), nullptr);
  const DepthSight& sight = detector.look(at_start(world), 0.1);
  ASSERT_EQ(sight.contacts.size(), 3U);  // three particles on the lower edge
  for (const DepthContact& c : sight.contacts) {
    EXPECT_EQ(c.pair, (PairKey{0, -1, 0}));
    EXPECT_EQ(c.contact.site, 0);
    EXPECT_NEAR(c.contact.point.y(), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(c.contact.normal.y()), 1.0, 1e-12);
    EXPECT_LT(std::abs(c.contact.gap), detector.tolerance(0));
  }
}

// Normals of arcs come from the picture: within a few hundredths of the true direction, on both sides of a
// solid's edge.
TEST(DepthDetector, CurvesHaveNormalsByDifferencesOfDepthOnBothSides) {
  double worst = 0.0;
  int seen = 0;
  for (const double depth : {-0.03, 0.0})
    for (int k = 0; k < 20; ++k) {
      const double angle = 0.1 + 0.314 * k;
      const Vec2 out(std::cos(angle), std::sin(angle));
      World world;
      add(world, body(make_box(0.4, 0.4), (1.0 + depth) * out, -out, 1.0, angle));
      world.bodies[0].sampling.kind = Sampling::Kind::file;
      world.bodies[0].sampling.points = {Vec2(0.0, 0.0)};
      add(world, site(make_path("M1 0 A1 1 0 0 1 -1 0 A1 1 0 0 1 1 0 Z", 1.0, 1e-6)));
      DepthDetector detector(world, depth_options(), nullptr);
      for (const DepthContact& c : detector.look(at_start(world), 0.1).contacts) {
        ++seen;
        worst = std::max(worst, std::acos(std::min(1.0, c.contact.normal.dot(out))));
      }
    }
  EXPECT_EQ(seen, 40);
  EXPECT_LT(worst, 0.02);  // [rad]; the curvature over a pixel (0.4 sqrt(2) / 64) is 0.009
}

// A wire has no inside. Going through, the normal points back to where the particle came from; having
// bounced, it points to the side on which the particle is, however it moves.
TEST(DepthNormal, WiresFlipForWhatGoesThroughAlone) {
  Site wire;
  wire.kind = SiteKind::segment;
  wire.a = {-1, 0};
  wire.b = {1, 0};
  const auto none = [] { return Vec2(0, 0); };
  const auto normal = [&](double y, double before, double speed) {
    return normal_of(wire, {{0.0, y}, {0.0, before}, {0.0, speed}}, none);
  };
  EXPECT_EQ(normal(0.01, 0.02, -1.0).normal, Vec2(0, 1));   // coming from above
  EXPECT_EQ(normal(-0.01, 0.01, -1.0).normal, Vec2(0, 1));  // gone through: back up
  EXPECT_TRUE(normal(-0.01, 0.01, -1.0).crossed);
  EXPECT_EQ(normal(0.01, 0.005, 1.0).normal, Vec2(0, 1));  // leaving upward, never through
  EXPECT_FALSE(normal(0.01, 0.005, 1.0).crossed);
}

// The same for an arc that is a wire: whichever side the particle came from, the normal points back there,
// and on its own side the picture's slope is taken.
TEST(DepthNormal, ArcsThatAreWiresFlipForWhatGoesThroughAlone) {
  const Outline outline = make_arc({0, 0}, 1.0, 0.0, std::numbers::pi).outline;
  const auto normal = [&](double y, double before, double speed) {
    const auto slope = [&] { return Vec2(0.02, y > 1.0 ? 0.9 : -0.9); };  // of the distance, askew
    const Vec2 now(0.0, y);
    const Site& site = *std::min_element(outline.sites.begin(), outline.sites.end(), [&](auto& a, auto& b) {
      return nearest_on(a, now).distance < nearest_on(b, now).distance;
    });
    return normal_of(site, {now, {0.0, before}, {0.0, speed}}, slope);
  };
  EXPECT_LT((normal(1.01, 1.02, -1.0).normal - Vec2(0.02, 0.9).normalized()).norm(), 1e-12);  // from outside
  EXPECT_LT((normal(0.99, 0.98, 1.0).normal - Vec2(0.02, -0.9).normalized()).norm(), 1e-12);  // from inside
  EXPECT_GT(normal(0.99, 1.01, -1.0).normal.y(), 0.99);  // gone in: back out
  EXPECT_TRUE(normal(0.99, 1.01, -1.0).crossed);
  EXPECT_LT(normal(1.01, 0.99, 1.0).normal.y(), -0.99);  // gone out: back in
  EXPECT_TRUE(normal(1.01, 0.99, 1.0).crossed);
  EXPECT_FALSE(normal(0.99, 0.995, -1.0).crossed);  // leaving inward, never through
}

// A solid's normal points out of it whichever side the particle is on, however it moves: a particle that has
// gone in is shown the way out.
TEST(DepthNormal, SolidsPointOutwardFromBothSides) {
  const Outline box = make_box(2.0, 2.0).outline;
  const auto none = [] { return Vec2(0, 0); };
  for (const Vec2& out : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)})
    for (const double distance : {0.99, 1.01})
      for (const double speed : {-1.0, 1.0}) {
        const Vec2 now = distance * out + 0.3 * Vec2(-out.y(), out.x());
        const Site& site = *std::min_element(box.sites.begin(), box.sites.end(), [&](auto& a, auto& b) {
          return nearest_on(a, now).distance < nearest_on(b, now).distance;
        });
        const DepthNormal found = normal_of(site, {now, now - 0.1 * speed * out, speed * out}, none);
        EXPECT_LT((found.normal - out).norm(), 1e-12) << distance << ' ' << speed;
        EXPECT_FALSE(found.crossed);
      }
}

double first_hit(const World& world, const SolverOptions& options, double end) {
  Simulator simulator(world, options);
  Events events;
  EXPECT_EQ(simulator.run(until(end), &events).termination, Termination::reached_end);
  const auto hits = events.collisions();
  return hits.empty() ? -1.0 : hits.front().contact.time;
}

// A disc falls 1 m: sqrt(2/g) = 0.451523641 s. The picture sees it early by at most the tolerance plus half a
// pixel's diagonal, at 4.43 m/s; never late by more than half a diagonal.
TEST(ClassicBackup, FindsTheFirstTouchWithinAPixelForEveryIntegratorAndOption) {
  World world;
  world.gravity = {0.0, -9.81};
  add(world, body(make_disc(0.5), {0.0, 1.5}, {0.0, 0.0}));
  add(world, site(make_segment({-5, 0}, {5, 0})));
  const double truth = std::sqrt(2.0 / 9.81), diagonal = std::sqrt(2.0) / 64;
  const auto check = [&](SolverOptions options, double integration = 0.0) {
    const double t = first_hit(world, options, 0.6);
    EXPECT_GT(t, truth - diagonal / 4.42 - integration);
    EXPECT_LT(t, truth + 0.5 * diagonal / 4.42 + integration);
  };
  for (const char* integrator : {"auto", "rk4", "erk", "adams", "bdf"}) {
    SolverOptions options = depth_options();
    options.integrator = integrator;
    check(options);
  }
  for (const char* first_order : {"euler", "semi_implicit_euler"}) {
    SolverOptions options = depth_options();
    options.integrator = first_order;
    check(options, 0.01);  // a step
  }
  for (const char* readback : {"full", "window", "pixel"})
    for (const char* passes : {"each", "two_layers"})
      for (const bool truncated : {true, false}) {
        SolverOptions options = depth_options();
        options.field.readback = readback;
        options.field.passes = passes;
        options.field.truncated = truncated;
        check(options);
      }
}

// A disc at 4.4 m/s that falls onto a block is found at the end of the step in which it touches: late by a
// step (and a pixel) at most, early by the tolerance; integrators of first order add a step's error of their
// own.
TEST(ClassicFixedStep, FindsTheFirstTouchWithinAStepForEveryIntegrator) {
  World world;
  world.gravity = {0.0, -9.81};
  add(world, body(make_disc(0.5), {0.0, 1.5}, {0.0, 0.0}));
  add(world, site(make_box(4, 1), {0.0, -0.5}));
  const double truth = std::sqrt(2.0 / 9.81), diagonal = std::sqrt(2.0) / 64;
  for (const char* integrator : {"auto", "euler", "semi_implicit_euler", "rk4", "erk", "adams", "bdf"}) {
    SolverOptions options = depth_options("fixed_step");
    options.integrator = integrator;
    const double own = std::string(integrator).ends_with("euler") ? options.step : 0.0;
    const double t = first_hit(world, options, 0.6);
    EXPECT_GT(t, truth - diagonal / 4.42 - own) << integrator;
    EXPECT_LT(t, truth + options.step + diagonal / 4.42 + own) << integrator;
  }
}

// The wire is 0.02 m away when the step begins and 0.02 m behind when it ends, within the tolerance (half a
// diagonal of pixels of 1/32 m): the particle has come out on the wrong side, and is thrown back.
TEST(ClassicFixedStep, WhatWentThroughAWireIsThrownBack) {
  World world;
  add(world, body(make_box(1, 1), {0.52, 0.0}, {-4.0, 0.0}));
  add(world, site(make_segment({0, -2}, {0, 2})));
  SolverOptions options = depth_options("fixed_step");
  options.field.resolution = 32;
  Simulator simulator(world, options);
  simulator.run(until(0.01));
  EXPECT_NEAR(simulator.state(0).twist.velocity.x(), 4.0, 1e-9);
  EXPECT_GT(simulator.state(0).pose.position.x(), 0.5 - 1e-6);  // pushed out by its depth
}

// The mirror rebound without slip or spin of a disc on a floor turns its normal velocity round and keeps the
// rest; with spin 0 a box that lands on a corner does not begin to turn, by the impulse law it does.
TEST(ClassicBackup, ReflectionMirrorsWithSlipAndSpinOfTheSite) {
  const auto after = [](const char* response, double slip, double spin) {
    World world;
    Material rough;
    rough.name = "rough";
    rough.slip = slip;
    rough.spin = spin;
    world.materials.push_back(rough);
    Body b = body(make_box(0.4, 0.2), {0.0, 0.3}, {1.0, -2.0}, 1.0, 0.3);
    b.sampling = sampled(Sampling::Kind::boundary, 0.05);
    add(world, b);
    FixedSite floor = site(make_segment({-5, 0}, {5, 0}));
    floor.material = static_cast<int>(world.materials.size()) - 1;
    add(world, floor);
    SolverOptions options = depth_options();
    options.response = response;
    options.max_collisions = 1;
    Simulator simulator(world, options);
    simulator.run(until(0.5));
    return simulator.state(0).twist;
  };
  const Twist impulse = after("impulse", 1.0, 1.0), mirrored = after("reflection", 1.0, 1.0);
  // elastic and frictionless: both laws are the same there, factor 2 and division by the inertia included
  EXPECT_NEAR(mirrored.velocity.y(), impulse.velocity.y(), 1e-12);
  EXPECT_NEAR(mirrored.omega, impulse.omega, 1e-12);
  EXPECT_GT(std::abs(mirrored.omega), 1.0);
  EXPECT_NEAR(after("reflection", 1.0, 0.5).omega, 0.5 * mirrored.omega, 1e-12);
  EXPECT_EQ(after("reflection", 1.0, 0.0).omega, 0.0);
  EXPECT_EQ(mirrored.velocity.x(), 1.0);
  EXPECT_LT(after("reflection", 0.5, 1.0).velocity.x(), 1.0);
}

// Without friction or loss a box in a box keeps its energy in every rebound, however early it is found.
TEST(ClassicBackup, ElasticReboundsKeepEnergy) {
  World world;
  Body b = body(make_box(0.6, 0.4), {0.2, 0.1}, {1.0, 0.7}, 1.0, 0.3, 2.0);
  b.sampling = sampled(Sampling::Kind::boundary, 0.05);
  add(world, b);
  add(world, site(make_chain({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, true)));
  Simulator simulator(world, depth_options());
  const RunSummary summary = simulator.run(until(5.0));
  EXPECT_EQ(summary.termination, Termination::reached_end);
  EXPECT_GT(summary.collisions, 8U);
  EXPECT_NEAR(summary.energy_final / summary.energy_initial, 1.0, 1e-12);
  EXPECT_LT(simulator.state(0).pose.position.cwiseAbs().maxCoeff(), 1.0);  // nothing has gone through
}

TEST(ClassicFixedStep, PushesApartByTheDepthOfTheDeepestParticle) {
  World world;
  Body b = body(make_box(1, 1), {0.0, 0.53}, {0.0, -6.0});
  b.sampling = sampled(Sampling::Kind::boundary, 0.1);
  add(world, b);
  add(world, site(make_box(10, 2), {0.0, -1.0}));
  SolverOptions options = depth_options("fixed_step");
  Simulator simulator(world, options);
  simulator.run(until(0.01));  // one step takes it 0.03 m into the floor
  EXPECT_NEAR(simulator.state(0).pose.position.y(), 0.5, 1.0 / 64);
  EXPECT_NEAR(simulator.state(0).twist.velocity.y(), 6.0, 1e-9);
}

// Boxes of 1 and 3 kg run 0.08 m into each other in one step: they share the way apart by their inverse
// masses, and their velocities are those of an elastic collision in one dimension.
TEST(ClassicFixedStep, BodiesWithVolumeParticlesSharePushingByInverseMass) {
  World world;
  for (const double mass : {1.0, 3.0}) {
    const double side = mass == 1.0 ? -1.0 : 1.0;
    Body b = body(make_box(1, 1), {side * 0.5, 0.0}, {-side * 4.0, 0.0}, mass);
    b.sampling = sampled(Sampling::Kind::volume, 0.1);
    add(world, b);
  }
  Simulator simulator(world, depth_options("fixed_step"));
  simulator.run(until(0.01));
  const BodyState light = simulator.state(0), heavy = simulator.state(1);
  const double moved_light = -0.46 - light.pose.position.x(), moved_heavy = heavy.pose.position.x() - 0.46;
  EXPECT_NEAR(moved_light + moved_heavy, 0.08, 1.0 / 64);
  EXPECT_NEAR(moved_light, 3.0 * moved_heavy, 1e-9);
  EXPECT_NEAR(light.twist.velocity.x(), -8.0, 1e-9);  // (m - M) / (m + M) 4 - 2 M / (m + M) 4
  EXPECT_NEAR(heavy.twist.velocity.x(), 0.0, 1e-9);
}

// A resting box is bounced and pushed for ever; it neither sinks in nor stops the run.
TEST(Classic, BodiesAtRestNeitherSinkNorStopTheRun) {
  for (const char* policy : {"global_backup", "fixed_step"}) {
    World world;
    world.gravity = {0.0, -9.81};
    world.materials[0].restitution = 0.2;
    Body b = body(make_box(1, 1), {0.0, 0.6}, {0.0, 0.0});
    b.sampling = sampled(Sampling::Kind::boundary, 0.25);
    add(world, b);
    add(world, site(make_box(10, 2), {0.0, -1.0}));
    Simulator simulator(world, depth_options(policy));
    const RunSummary summary = simulator.run(until(1.5));
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    EXPECT_NEAR(simulator.state(0).pose.position.y(), 0.5, 0.05) << policy;
    EXPECT_LT(summary.max_overlap, 0.05) << policy;
  }
}

}  // namespace
}  // namespace brink::depth_detector_test
