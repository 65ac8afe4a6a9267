// Of many at rest only those wake who are moved. Seen from outside: who is not moved stays where it is while others
// go on, bricks and floor carry the weight of all, and nothing depends on the policy, or on where a run was stopped.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "tests/support/seeded_worlds.h"

namespace brink::partial_rest_test {
namespace {

constexpr double kWidth = 0.4, kHeight = 0.2;
/// A run begins with steps in which all take part [s].
constexpr double kFirstSteps = 0.1;

std::string world(double duration, double restitution, double friction) {
  return fmt::format(
      "[world]\nduration = {}\ngravity = [0, -9.81]\n[materials.default]\nrestitution = {}\nfriction = {}\n"
      "[[sites]]\nname = 'ground'\npolyline = [[-20, 3], [-20, 0], [20, 0], [20, 3]]\n",
      duration, restitution, friction);
}

/// A wall of bricks in running bond, each row one brick shorter than the one below, which begins at x = 0; 100 kg/m^2.
std::string wall(int columns, int rows) {
  std::string text;
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < columns - row; ++k)
      text +=
          fmt::format("[[bodies]]\nbox = {{ width = {}, height = {} }}\ndensity = 100\nposition = [{}, {}]\n",
                      kWidth, kHeight, kWidth * (k + 0.5 + 0.5 * row), kHeight * (row + 0.5));
  return text;
}

int bricks(int columns, int rows) { return columns * rows - rows * (rows - 1) / 2; }

std::string ball(double radius, double density, const Vec2& place, const Vec2& velocity, double spin) {
  return fmt::format(
      "[[bodies]]\ndisc = {{ radius = {} }}\ndensity = {}\nposition = [{:.17g}, {:.17g}]\nvelocity = "
      "[{:.17g}, "
      "{:.17g}]\nangular_velocity = {:.17g}\n",
      radius, density, place.x(), place.y(), velocity.x(), velocity.y(), spin);
}

/// What is told of each wake and sleep, and how often who moved between two frames.
class Watch : public Recorder {
 public:
  void frame(double t, std::span<const BodyState> states) override {
    if (!last_.empty() && t > kFirstSteps)
      for (std::size_t k = 0; k < states.size(); ++k)
        if (states[k].pose.position != last_[k].pose.position || states[k].pose.angle != last_[k].pose.angle)
          ++moved[static_cast<int>(k)];
    last_.assign(states.begin(), states.end());
  }
  void contact_lasted(const LastedContact& c) override {
    if (c.to >= end) carried[c.other_site] += c.normal_force * c.normal.y();
  }

  double end = 0.0;               ///< of the run [s]
  std::map<int, int> moved;       ///< by body: between how many frames
  std::map<int, double> carried;  ///< by site, -1: bodies; the normal forces at the end, upwards [N]

 private:
  std::vector<BodyState> last_;
};

struct Seen {
  RunSummary summary;
  Watch watch;
  std::vector<BodyState> before, after;
};

Seen run(const Scene& scene) {
  Seen r;
  Simulator simulator(scene.world, scene.solver);
  r.before = simulator.states();
  r.watch.end = scene.duration;
  RunOptions options = testing::until(scene.duration);
  options.frame_interval = scene.duration / 64.0;
  r.summary = simulator.run(options, &r.watch);
  r.after = simulator.states();
  return r;
}

/// But for what the steps before it came to rest have moved it by, of the order of roundings.
bool is_near(const BodyState& a, const BodyState& b) {
  return (a.pose.position - b.pose.position).norm() <= 1e-12 &&
         std::abs(a.pose.angle - b.pose.angle) <= 1e-12;
}

void same_under_other_policies(const Scene& scene, const RunSummary& first) {
  for (std::uint64_t policy = 0; policy < exact_policies().size(); ++policy)
    EXPECT_EQ(testing::stopped_under_another_policy(scene.world, scene.solver, testing::until(scene.duration),
                                                    3, policy, first),
              "");
}

// A ball rolls along the top of a wall. The wall carries it, wherever it is, and no brick moves by a bit.
TEST(PartialRest, AWallStaysWhileABallRollsOverIt) {
  for (const double radius : {0.05, 0.15}) {
    const int columns = 12, rows = 3;
    const double top = kHeight * rows, speed = 0.7;
    const Scene scene =
        parse_scene(world(3.0, 0.0, 0.5) + wall(columns, rows) +
                        ball(radius, 20.0, {0.9, top + radius}, {speed, 0.0}, -speed / radius),
                    "wall");
    const Seen r = run(scene);
    ASSERT_EQ(r.summary.termination, Termination::reached_end) << r.summary.why;
    for (int k = 0; k < bricks(columns, rows); ++k) {
      EXPECT_TRUE(is_near(r.before[k], r.after[k])) << k;
      EXPECT_TRUE(r.after[k].twist.velocity.isZero(0.0)) << k;
    }
    EXPECT_EQ(r.watch.moved.size(), 1u);  // the ball alone
    const BodyState& rolls = r.after.back();
    EXPECT_NEAR(rolls.pose.position.x(), 0.9 + 3.0 * speed, 1e-6);
    EXPECT_NEAR(rolls.pose.position.y(), top + radius, 1e-9);
    EXPECT_EQ(r.summary.resting, static_cast<std::uint64_t>(bricks(columns, rows)));
    // the ground carries the bricks and the ball
    double weight = 0.0;
    for (const Body& b : scene.world.bodies) weight += 9.81 * b.mass;
    EXPECT_NEAR(r.watch.carried.at(0), weight, 1e-6 * weight);
    same_under_other_policies(scene, r.summary);
  }
}

// A ball falls onto one end of a long wall and stays there, or takes bricks off: those at the other end do not know of it.
TEST(PartialRest, WhoIsFarFromAnImpactDoesNotMove) {
  for (const double density : {5.0, 2000.0}) {
    const int columns = 40, rows = 3;
    const Scene scene = parse_scene(
        world(1.5, 0.0, 0.5) + wall(columns, rows) + ball(0.15, density, {0.3, 2.0}, {-0.5, -4.0}, 0.0),
        "wall");
    const Seen r = run(scene);
    ASSERT_EQ(r.summary.termination, Termination::reached_end) << r.summary.why;
    EXPECT_EQ(r.summary.energy_final <= r.summary.energy_initial, true);
    for (int k = 0; k < bricks(columns, rows); ++k) {
      if (r.before[k].pose.position.x() < 0.5 * columns * kWidth) continue;
      EXPECT_TRUE(is_near(r.before[k], r.after[k])) << k;
    }
    same_under_other_policies(scene, r.summary);
  }
}

// What stands on a brick that is pulled away falls; the rest of the wall stays.
TEST(PartialRest, WhatLosesItsSupportWakes) {
  // A beam lies across two heaps of ten; a ball knocks one end's post out.
  const int columns = 12, rows = 1;
  std::string text = world(2.0, 0.0, 0.3) + wall(columns, rows);
  const double top = kHeight * rows;
  // a post on the last brick, with a plate on top
  text += fmt::format(
      "[[bodies]]\nname = 'post'\nbox = {{ width = 0.1, height = 0.5 }}\ndensity = 100\nposition = [{}, "
      "{}]\n",
      4.6, top + 0.25);
  text += fmt::format(
      "[[bodies]]\nname = 'plate'\nbox = {{ width = 0.3, height = 0.1 }}\ndensity = 100\nposition = [{}, "
      "{}]\n",
      4.6, top + 0.55);
  text += ball(0.1, 800.0, {2.5, top + 0.35}, {9.0, 0.0}, 0.0);
  const Scene scene = parse_scene(text, "post");
  const Seen r = run(scene);
  ASSERT_EQ(r.summary.termination, Termination::reached_end) << r.summary.why;
  const std::size_t plate = r.after.size() - 2;
  EXPECT_LT(r.after[plate].pose.position.y(), top + 0.5);
  for (int k = 0; k < 9; ++k) EXPECT_TRUE(is_near(r.before[k], r.after[k])) << k;
  same_under_other_policies(scene, r.summary);
}

// Heaps that settle, with and without rebounds: they come to rest as a whole in the end, nobody is in another, no energy is won, and
// the bits are the same under every policy.
TEST(PartialRest, HeapsSettleAlikeUnderEveryPolicy) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 6);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed) {
    Random random(seed);
    const double restitution = seed % 3 == 2 ? 0.5 : 0.0;
    std::string text = world(2.5, restitution, random.uniform(0.1, 0.8));
    text += "[[sites]]\npolyline = [[-1.2, 6], [-1.2, 0], [1.2, 0], [1.2, 6]]\nradius = 0.05\n";
    const int count = 20 + static_cast<int>(random.below(30));
    for (int k = 0; k < count; ++k) {
      const std::string shape = random.below(3)
                                    ? fmt::format("disc = {{ radius = {} }}", random.uniform(0.06, 0.12))
                                    : fmt::format("box = {{ width = {}, height = {} }}",
                                                  random.uniform(0.1, 0.2), random.uniform(0.1, 0.2));
      text +=
          fmt::format("[[bodies]]\n{}\ndensity = 100\nposition = [{}, {}]\nangle = {}\nvelocity = [{}, {}]\n",
                      shape, 0.32 * (k % 6 - 2.5) + random.uniform(-0.02, 0.02), 0.3 + 0.32 * (k / 6),
                      random.uniform(0.0, 3.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 0.0));
    }
    const Scene scene = parse_scene(text, "heap");
    const Seen r = run(scene);
    SCOPED_TRACE(fmt::format("BRINK_SEED={}", seed));
    ASSERT_EQ(r.summary.termination, Termination::reached_end) << r.summary.why;
    EXPECT_LE(r.summary.energy_final, r.summary.energy_initial);
    EXPECT_LE(r.summary.max_overlap, 1e-9);
    same_under_other_policies(scene, r.summary);
  }
}

}  // namespace
}  // namespace brink::partial_rest_test
