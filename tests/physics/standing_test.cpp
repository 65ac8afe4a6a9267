// Scenes that start touching and stand: what statics says stands does so from the start, to the bit, under every
// policy; what it says falls does not.
#include <gtest/gtest.h>

#include <cmath>

#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink::standing_test {
namespace {

Scene on_floor(const std::string& bodies, double friction, const std::string& gravity = "[0, -9.81]") {
  return parse_scene(
      "[world]\ngravity = " + gravity + "\n[solver]\npersistent = true\n[materials.default]\n" +
          "restitution = 0.3\nfriction = " + std::to_string(friction) +
          "\n[[sites]]\nname = \"floor\"\nbox = { width = 100, height = 1 }\nposition = [0, -0.5]\n" + bodies,
      "test");
}

struct Ran {
  RunSummary summary;
  std::vector<BodyState> states;
};

Ran run(const Scene& scene, const std::string& policy, double until) {
  SolverOptions options = scene.solver;
  options.policy = policy;
  Simulator simulator(scene.world, options);
  RunOptions to;
  to.until = until;
  to.checkpoint_seconds = -1.0;
  Ran ran{simulator.run(to), {}};
  ran.states = simulator.states();
  return ran;
}

const std::string kBox =
    "[[bodies]]\nbox = { width = 0.8, height = 0.3 }\nposition = [0, 1]\ntouching = \"floor\"\n";
const std::string kDisc = "[[bodies]]\ndisc = { radius = 0.3 }\nposition = [0, 1]\ntouching = \"floor\"\n";

// A stack stands whatever its height. In a pyramid of bricks every brick lies on two, in a wall as well. Discs
// in a triangular heap press outwards with 1/3 of what lies on them at 60 degrees: friction 0.6 holds them.
TEST(Standing, WhatStandsKeepsEveryBit) {
  for (const std::string& bodies : {kBox + "stack = 50\n", kBox + "pyramid = 10\n", kBox + "wall = [6, 7]\n",
                                    kDisc + "pyramid = 6\n", kDisc}) {
    const Scene scene = on_floor(bodies, 0.6);
    for (const std::string& policy : exact_policies()) {
      SCOPED_TRACE(bodies + policy);
      const Ran ran = run(scene, policy, 100.0);
      EXPECT_EQ(ran.summary.termination_text(), "reached_end");
      EXPECT_EQ(ran.summary.resting, scene.world.bodies.size());
      EXPECT_EQ(ran.summary.collisions, 0U);
      EXPECT_EQ(ran.summary.island_steps, 0U);
      for (std::size_t k = 0; k < ran.states.size(); ++k) {
        const Pose &is = ran.states[k].pose, &was = scene.world.bodies[k].initial.pose;
        EXPECT_TRUE(is.position == was.position && is.angle == was.angle) << "body " << k;
      }
    }
  }
}

// Without friction the heap of discs runs apart.
TEST(Standing, AHeapOfSmoothDiscsRunsApart) {
  const Ran ran = run(on_floor(kDisc + "pyramid = 3\n", 0.0), "body_clocks", 1.0);
  EXPECT_EQ(ran.summary.termination_text(), "reached_end");
  EXPECT_LT(ran.states[0].pose.position.x(), -0.6 - 0.1);
  EXPECT_GT(ran.states[2].pose.position.x(), 0.6 + 0.1);
}

// Gravity tilted by 20 degrees makes the floor a slope: tan 20 = 0.364. Put down square to the floor, a block
// stays with more friction than that; with less it slides with g (sin - mu cos).
TEST(Standing, ABlockOnASlopeSticksOrSlidesFromTheStart) {
  const double s = 9.81 * std::sin(20.0 * M_PI / 180.0), c = 9.81 * std::cos(20.0 * M_PI / 180.0);
  const std::string tilted = "[" + std::to_string(s) + ", " + std::to_string(-c) + "]";
  const std::string block = kBox + "touching_direction = [0, -1]\n";
  for (const std::string& policy : exact_policies()) {
    SCOPED_TRACE(policy);
    const Scene rough = on_floor(block, 0.37, tilted), smooth = on_floor(block, 0.35, tilted);
    const Ran stays = run(rough, policy, 50.0), slides = run(smooth, policy, 2.0);
    EXPECT_EQ(stays.summary.resting, 1U);
    EXPECT_EQ(stays.states[0].pose.position, rough.world.bodies[0].initial.pose.position);
    EXPECT_EQ(slides.summary.resting, 0U);
    const Vec2 gravity = smooth.world.gravity;
    EXPECT_NEAR(slides.states[0].twist.velocity.x(), 2.0 * (gravity.x() + 0.35 * gravity.y()), 0.13 / 60.0);
    EXPECT_NEAR(slides.states[0].pose.position.y(), 0.15, 1e-10);
  }
}

// What starts touching and moves is no rest: a ball that rolls rolls on, v = omega R.
TEST(Standing, ABallThatRollsRollsOn) {
  const Scene scene = on_floor(kDisc + "velocity = [0.6, 0]\nangular_velocity = -2\n", 0.5);
  for (const std::string& policy : exact_policies()) {
    const Ran ran = run(scene, policy, 5.0);
    EXPECT_EQ(ran.summary.termination_text(), "reached_end");
    EXPECT_NEAR(ran.states[0].pose.position.x(), 3.0, 1e-9);
    EXPECT_NEAR(ran.states[0].pose.angle, -10.0, 1e-9);
  }
}

// Without gravity nothing presses: two discs that touch stay two discs that touch, and no island.
TEST(Standing, WhatNothingPressesIsNoIsland) {
  const Scene scene =
      on_floor("[[bodies]]\ndisc = { radius = 0.3 }\nposition = [0, 5]\nstack = 2\n", 0.5, "[0, 0]");
  const Ran ran = run(scene, "body_clocks", 1.0);
  EXPECT_EQ(ran.summary.contacts_lasting, 0U);
  EXPECT_EQ(ran.states[1].pose.position, scene.world.bodies[1].initial.pose.position);
}

}  // namespace
}  // namespace brink::standing_test
