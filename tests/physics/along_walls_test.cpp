// Round outlines of arcs (a circle, a ring, one that is flattened) that hit an upright wall without a rebound, and fall along it,
// touching, as they turn: what pulls along the wall does not bring them nearer. A circle of arcs goes as the disc does. And boxes that
// lie flat on a wall in any direction, along which they are pulled: they fall as if it were not there. The same bits
// under every policy, each stopped. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for scenes that
// fail.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/seeded_worlds.h"

namespace brink::along_walls_test {
namespace {

enum class Round { disc, circle, ring, flattened };

std::string shape_of(Round round, double radius) {
  const std::string circle = "M -1 0 A 1 1 0 1 0 1 0 A 1 1 0 1 0 -1 0 Z";
  switch (round) {
    case Round::disc:
      return fmt::format("disc = {{ radius = {:.17g} }}", radius);
    case Round::circle:
      return fmt::format("path = {{ d = '{}', scale = {:.17g} }}", circle, radius);
    case Round::ring:
      return fmt::format(
          "path = {{ d = '{} M -0.7 0 A 0.7 0.7 0 1 1 0.7 0 A 0.7 0.7 0 1 1 -0.7 0 Z', scale = {:.17g} }}",
          circle, radius);
    default:
      return fmt::format(
          "path = {{ d = 'M -1 0 C -1 -0.8 1 -0.8 1 0 C 1 0.8 -1 0.8 -1 0 Z', scale = {:.17g} }}", radius);
  }
}

std::string scene_of(std::uint64_t seed, Round round) {
  Random random(seed);
  const double radius = random.uniform(0.05, 0.3),
               friction = random.below(3) == 0 ? 0.0 : random.uniform(0.1, 1.0);
  std::string text = fmt::format(
      "[world]\nduration = 1.5\ngravity = [0, -9.81]\n[materials.default]\nrestitution = 0\nfriction = "
      "{:.17g}\n",
      friction);
  switch (random.below(3)) {
    case 0:
      text += "[[sites]]\nsegment = [[1, -40], [1, 10]]\n";
      break;
    case 1:
      text += "[[sites]]\nbox = { width = 0.5, height = 60 }\nposition = [1.25, 0]\n";
      break;
    default:
      text += "[[sites]]\npolyline = [[1, -40], [1, -1.5], [1, 10], [2, 12]]\n";
  }
  return text + fmt::format(
                    "[[bodies]]\n{}\ndensity = 2\nposition = [0, 0]\nvelocity = [{:.17g}, {:.17g}]\nangle = "
                    "{:.17g}\nangular_velocity = {:.17g}\n",
                    shape_of(round, radius), random.uniform(1.0, 3.0), random.uniform(-2.0, 2.0),
                    random.uniform(-3.0, 3.0), random.uniform(-9.0, 9.0));
}

/// A box flat on a wall, from where both are put, or put on it by the program; thrown and pulled along it.
struct Flat {
  std::string scene;
  Vec2 along = Vec2::Zero();
  double way = 0.0;  ///< how far along the wall it is after a second [m]
};

Flat flat_of(std::uint64_t seed) {
  Random random(seed);
  const double angle = random.below(2) == 0 ? 1.5707963267948966 * static_cast<double>(random.below(4))
                                            : random.uniform(0.0, 6.28);
  const Vec2 along(std::cos(angle), std::sin(angle)), up(-along.y(), along.x());
  const double restitution = random.below(3) == 0 ? 0.0 : random.uniform(0.0, 1.0),
               friction = random.below(2) == 0 ? 0.0 : random.uniform(0.1, 1.0);
  const double width = random.uniform(0.1, 1.0), height = random.uniform(0.1, 1.0),
               speed = random.uniform(-3.0, 3.0), pull = random.uniform(1.0, 10.0),
               from = random.below(2) == 0 ? 0.0 : random.uniform(0.0, 100.0);
  Flat flat;
  flat.along = along;
  flat.way = from + speed + 0.5 * pull;
  const bool put = random.below(3) == 0;
  const Vec2 at = (from * along) + (0.5 * height + (put ? 0.01 : 0.0)) * up;
  const auto pair = [](const Vec2& v) { return fmt::format("[{:.17g}, {:.17g}]", v.x(), v.y()); };
  flat.scene = fmt::format(
      "[world]\nduration = 1\ngravity = {}\n[materials.default]\nrestitution = {:.17g}\nfriction = "
      "{:.17g}\n[[sites]]\nname = 'wall'\n",
      pair(pull * along), restitution, friction);
  const int kind = static_cast<int>(random.below(3));
  const Vec2 below = kind == 1 ? Vec2(-0.05 * up) : Vec2::Zero(), middle = from * along;
  if (kind == 2)
    flat.scene += fmt::format("box = {{ width = 400, height = 1 }}\nposition = {}\nangle = {:.17g}\n",
                              pair(middle - 0.5 * up), angle);
  else
    flat.scene += fmt::format("segment = [{}, {}]\nradius = {}\n", pair(middle - 200.0 * along + below),
                              pair(middle + 200.0 * along + below), kind == 1 ? 0.05 : 0.0);
  flat.scene += fmt::format(
      "[[bodies]]\nbox = {{ width = {:.17g}, height = {:.17g} }}\nposition = {}\nangle = {:.17g}\nvelocity = "
      "{}\n",
      width, height, pair(at), angle, pair(speed * along));
  if (put) flat.scene += fmt::format("touching = ['wall']\ntouching_direction = {}\n", pair(-up));
  return flat;
}

/// Of the only body at the end of the run, which nobody is in.
BodyState end_of(const std::string& text) {
  const Scene scene = parse_scene(text, "wall");
  outside::FrameWatch watch(scene.world, scene.duration, 1e-9);
  RunOptions options = testing::until(scene.duration);
  options.frame_interval = 0.01;
  Simulator simulator(scene.world, scene.solver);
  const RunSummary summary = simulator.run(options, &watch);
  EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
  EXPECT_TRUE(watch.sound()) << watch.report();
  EXPECT_LE(watch.gained, 1e-10L);
  return simulator.state(0);
}

TEST(AlongWalls, ACircleOfArcsFallsAsADiscDoes) {
  const auto arcs = [](std::uint64_t seed) { return scene_of(seed, Round::circle); };
  testing::for_each_world(40, arcs, [&](std::uint64_t seed) {
    const BodyState disc = end_of(scene_of(seed, Round::disc)), circle = end_of(arcs(seed));
    // At a wire the joint of two arcs counts half a touching distance early, as a sharp corner does: each that passes is an impact of
    // some 1e-6 m/s, with its friction.
    const bool wire = arcs(seed).find("box") == std::string::npos;
    const double near = wire ? 2e-5 : 1e-9;
    EXPECT_NEAR((circle.pose.position - disc.pose.position).norm(), 0.0, near);
    EXPECT_NEAR((circle.twist.velocity - disc.twist.velocity).norm(), 0.0, near);
    EXPECT_NEAR(circle.twist.omega, disc.twist.omega, 10.0 * near);
    testing::expect_same_bits(arcs(seed), seed);
  });
}

TEST(AlongWalls, WhatIsRoundComesToItsEnd) {
  for (const Round round : {Round::ring, Round::flattened}) {
    const auto scene = [round](std::uint64_t seed) { return scene_of(seed, round); };
    testing::for_each_world(20, scene, [&](std::uint64_t seed) {
      end_of(scene(seed));
      testing::expect_same_bits(scene(seed), seed);
    });
  }
}

// Nothing presses the box to the wall, but for roundings of directions: its contacts neither push nor open, or steps by modes end at
// once, and one of first order takes their place (0.001 m off after a second).
TEST(AlongWalls, BoxesThatLieFlatFallAsIfNoWallWereThere) {
  const auto scene = [](std::uint64_t seed) { return flat_of(seed).scene; };
  testing::for_each_world(60, scene, [&](std::uint64_t seed) {
    const Flat flat = flat_of(seed);
    const BodyState box = end_of(flat.scene);
    EXPECT_NEAR(flat.along.dot(box.pose.position), flat.way, 1e-9);
    EXPECT_NEAR(box.twist.omega, 0.0, 1e-9);
    if (seed % 6 == 0) testing::expect_same_bits(flat.scene, seed);
  });
}

}  // namespace
}  // namespace brink::along_walls_test
