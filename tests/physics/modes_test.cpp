// Whole runs with few contacts that last, against closed forms, far below what steps of order 1 give.
#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <numbers>

#include "brink/scenes/scene/scene.h"
#include "tests/support/lasting_worlds.h"
#include "tests/support/settling.h"

namespace brink::modes_test {
namespace {

SolverOptions by_modes() {
  SolverOptions options = testing::lasting();
  options.modes_contacts = 16;
  return options;
}

using testing::add;
using testing::all_at_rest;
using testing::body;
using testing::go_on;
using testing::heavy_world;
using testing::kEarth;
using testing::site;

void add_ground(World& world) { add(world, site(make_box(40.0, 1.0), {0.0, -0.5})); }

std::vector<double> times_of(const testing::Events& events, EventKind kind) {
  std::vector<double> times;
  for (const Event& e : events.events)
    if (e.kind == kind) times.push_back(e.contact.time);
  return times;
}

TEST(Modes, SlidingBlockStopsWhereItMustAndIsAtRest) {
  const double mu = 0.3, v = 2.0;
  World world = heavy_world(0.0, mu);
  add_ground(world);
  add(world, body(make_box(1.0, 0.5), {0.0, 0.25}, {v, 0.0}));
  Simulator simulator(world, by_modes());
  testing::Events events;
  EXPECT_EQ(simulator.run(testing::until(3.0), &events).termination, Termination::reached_end);
  EXPECT_NEAR(simulator.state(0).pose.position.x(), v * v / (2 * mu * kEarth), 1e-9);
  EXPECT_TRUE(all_at_rest(simulator));
  const std::vector<double> sleeps = times_of(events, EventKind::sleep);
  ASSERT_EQ(sleeps.size(), 1U);
  EXPECT_NEAR(sleeps[0], v / (mu * kEarth), 1e-9);
}

// Eleven bodies on a shaker: impacts and lifts that follow each other within microseconds, without end. Each is a step by
// modes, which costs ten others; of 20 000 steps two thirds once were of these, in a quarter of the time asked for.
TEST(Modes, WhatBuzzesWithoutEndIsMostlyLeftToSteps) {
  const testing::LastingWorld made = testing::LastingWorldMaker(46).make();
  SolverOptions options = by_modes();
  options.island_tolerance = made.island_tolerance;
  Simulator simulator(made.world, options);
  const RunSummary summary = simulator.run(testing::until(2.5));
  EXPECT_EQ(summary.termination, Termination::reached_end);
  EXPECT_GT(summary.steps_by_modes, 0U);
  EXPECT_LT(4 * summary.steps_by_modes, summary.island_steps);
}

// Housner 1963: known impacts of a block that rocks on its corners without bounce or slip.
TEST(Modes, RockingBlockMeetsTheFloorWhenHousnerSays) {
  const double b = 0.1, h = 0.4, th = std::atan2(b, h) / 2;
  World world = heavy_world(0.0, 1.0);
  add_ground(world);
  const Vec2 corner(std::cos(th) * b - std::sin(th) * h, -std::sin(th) * b - std::cos(th) * h);
  Body block = body(make_box(2 * b, 2 * h), -corner, {0.0, 0.0});
  block.initial.pose.angle = -th;
  add(world, block);
  Simulator simulator(world, by_modes());
  testing::Events events;
  EXPECT_EQ(simulator.run(testing::until(2.0), &events).termination, Termination::reached_end);
  const std::vector<double> known{.312308575, .820592229, 1.251876744, 1.625866613, 1.954508336};
  const std::vector<double> lifts = times_of(events, EventKind::lift);  // of the corner that it leaves
  ASSERT_EQ(lifts.size(), known.size());
  for (std::size_t k = 0; k < known.size(); ++k) EXPECT_NEAR(lifts[k], known[k], 2e-9) << k;
}

// A disc that rolls in a bowl is a pendulum: (1 + 1/2)(R - r) phi'' = -g sin phi.
TEST(Modes, DiscRollsInABowlAsAPendulum) {
  const double R = 2, r = 0.25, phi = std::numbers::pi / 3, t = 5.0;
  World world = heavy_world(0.0, 1.0);
  FixedSite bowl = site(make_disc(R));
  bowl.outline = std::make_shared<const Outline>(make_disc_container(R).outline);
  add(world, bowl);
  add(world, body(make_disc(r), (R - r) * Vec2(std::sin(phi), -std::cos(phi)), {0.0, 0.0}));
  Simulator simulator(world, by_modes());
  EXPECT_EQ(go_on(simulator, t), "");
  const double k = std::sin(phi / 2), rate = std::sqrt(2.0 / 3 * kEarth / (R - r));
  const double known = 2 * std::asin(k * boost::math::jacobi_sn(k, boost::math::ellint_1(k) - rate * t));
  const Vec2 at = simulator.state(0).pose.position;
  std::printf("rolling in a bowl: angle off by %.1e\n", std::atan2(at.x(), -at.y()) - known);
  EXPECT_NEAR(std::atan2(at.x(), -at.y()), known, 1e-6);  // the first touch, some 1e-7 s late, is part of it
  EXPECT_NEAR(at.norm(), R - r, 1e-9);
}

// What sticks and what slides on an incline is told apart by 1e-4 of the friction, and slides with its acceleration.
TEST(Modes, BlockOnAnInclineSlidesBesideItsFrictionAngle) {
  const double angle = 20 * std::numbers::pi / 180, mu = 0.3639;
  World world = heavy_world(0.0, mu);
  FixedSite plane = site(make_box(40.0, 1.0), {0.5 * std::sin(angle), -0.5 * std::cos(angle)});
  plane.pose.angle = angle;
  add(world, plane);
  Body block = body(make_box(1.0, 0.5), 0.25 * Vec2(-std::sin(angle), std::cos(angle)), {0.0, 0.0});
  block.initial.pose.angle = angle;
  add(world, block);
  Simulator simulator(world, by_modes());
  EXPECT_EQ(go_on(simulator, 2.0), "");
  const Vec2 down(-std::cos(angle), -std::sin(angle));
  const double a = kEarth * (std::sin(angle) - mu * std::cos(angle));
  EXPECT_NEAR(simulator.state(0).pose.position.dot(down), 0.5 * a * 4, 1e-6);
}

// A disc on a slope that is shaken slips, and its slip grazes 0 between two looks of a step: it sticks for a ten-thousandth of a second.
TEST(Modes, ASlipThatGrazesZeroIsSeen) {
  const std::string text =
      "[world]\nduration = 2.0\ngravity = [0.0, -9.81]\n[output]\nframe_interval = "
      "0\n[materials.m]\nrestitution = 0\n"
      "friction = 0.05\n[[sites]]\nname = 'line'\nsegment = [[-30, -0.125], [30, -0.125]]\nradius = "
      "0.125\nposition = [3.67, "
      "-0.28]\nangle = -0.148\nmaterial = 'm'\nmotion = { x = \"0.0001*(sin(190.519*t + 6.214) - "
      "sin(6.214))\", angle = "
      "\"-0.002*t*t\" }\n[[bodies]]\nname = 'b'\ndisc = { radius = 0.131 }\nmass = 7.966\nmaterial = "
      "'m'\nposition = "
      "[2.804101459419633, -0.01845513306357724]\nvelocity = [-1.573393120892367, 0.237411071343476]\n";
  double angle[2];
  for (const bool fine : {false, true}) {
    Scene scene = parse_scene(text, "graze");
    scene.solver.tolerance = fine ? 1e-13 : 1e-10;
    Simulator simulator(scene.world, scene.solver);
    EXPECT_EQ(simulator.run(testing::until(scene.duration)).termination, Termination::reached_end);
    angle[fine] = simulator.state(0).pose.angle;
  }
  EXPECT_NEAR(angle[0], angle[1], 1e-8);
}

}  // namespace
}  // namespace brink::modes_test
