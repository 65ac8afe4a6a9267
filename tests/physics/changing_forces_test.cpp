// Forces that change with place, velocity or time while contacts last: closed forms of blocks on ice, pushes shorter than a
// step, and energy that springs must not make, of few bodies (by modes) and of more than modes take (by steps).
#include <gtest/gtest.h>

#include <fmt/core.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/log.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/worlds.h"

namespace brink::changing_forces_test {
namespace {

/// A floor without restitution, blocks on it side by side, and more.
std::string blocks(int count, double friction, double duration) {
  std::string text = fmt::format(
      "[world]\nduration = {}\ngravity = [0, -9.81]\n[materials.default]\nrestitution = 0\nfriction = {}\n"
      "[[sites]]\nname = 'floor'\nsegment = [[-20, 0], [20, 0]]\n",
      duration, friction);
  for (int k = 0; k < count; ++k)
    text += fmt::format(
        "[[bodies]]\nname = 'b{}'\nbox = {{ width = 0.4, height = 0.2 }}\nposition = [{}, 0.1]\nmass = 1\n",
        k, 0.1 + 0.5 * k);
  return text;
}

/// Springs of that stiffness without length, from each block to where it stands less 0.1 m, and to its neighbour as it stands.
std::string springs(int count, double stiffness) {
  std::string text;
  for (int k = 0; k < count; ++k) {
    text += fmt::format("[[forces]]\nkind = 'spring'\nbody = 'b{}'\nanchor = [{}, 0.1]\nstiffness = {}\n", k,
                        0.5 * k, stiffness);
    if (k > 0)
      text += fmt::format(
          "[[forces]]\nkind = 'spring'\nbodies = ['b{}', 'b{}']\nrest_length = 0.5\nstiffness = {}\n", k - 1,
          k, stiffness);
  }
  return text;
}

std::string formula(const std::string& axis, const std::string& f) {
  return fmt::format("[[forces]]\nkind = 'formula'\n{} = '{}'\n", axis, f);
}

/// To its end in so many parts, under that policy.
struct Ran {
  BodyState first;  ///< of the first body
  std::vector<double> energies;
  std::uint64_t hash = 0;
};
Ran run(const std::string& text, const std::string& policy = "body_clocks", int parts = 1) {
  const Scene scene = parse_scene(text, "blocks", {"solver.policy=" + policy});
  Simulator simulator(scene.world, scene.solver);
  Ran ran;
  for (int k = 1; k <= parts; ++k) {
    const RunSummary summary = simulator.run(testing::until(scene.duration * k / parts));
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    if (k == 1) ran.energies.push_back(summary.energy_initial);
    ran.energies.push_back(summary.energy_final);
    ran.hash = summary.state_hash;
  }
  ran.first = simulator.state(0);
  return ran;
}

TEST(ChangingForces, BlockOnIceSwingsOnItsSpring) {
  const std::string text = blocks(1, 0.0, 10.0) + springs(1, 100.0);
  const Ran once = run(text);
  EXPECT_NEAR(once.first.pose.position.x(), 0.1 * std::cos(100.0), 1e-7);
  EXPECT_NEAR(once.first.twist.velocity.x(), -std::sin(100.0), 1e-6);
  EXPECT_NEAR(once.energies.back() / once.energies.front(), 1.0, 1e-7);
  for (const std::string& policy : exact_policies()) {
    EXPECT_EQ(run(text, policy, 7).hash, once.hash) << policy;
  }
}

TEST(ChangingForces, StiffSpringAndStiffDragOnIce) {
  const Ran spring = run(blocks(1, 0.0, 1.0) + springs(1, 1e6));
  EXPECT_NEAR(spring.energies.back() / spring.energies.front(), 1.0, 1e-6);
  const std::string moving = "velocity = [1, 0]\n[[forces]]\nkind = 'drag'\nlinear = 1e4\n";
  const Ran drag = run(blocks(1, 0.0, 1.0) + moving);
  EXPECT_NEAR(drag.first.pose.position.x(), 0.1 + 1e-4, 1e-9);  // v m / c
  EXPECT_NEAR(drag.first.twist.velocity.x(), 0.0, 1e-9);
}

TEST(ChangingForces, QuickForceIsNotSampledWhereItLooksConstant) {
  const Ran ran = run(blocks(1, 0.0, 2.0) + formula("fx", "200*sin(500*t)"));
  EXPECT_NEAR(ran.first.twist.velocity.x(), 0.4 * (1.0 - std::cos(1000.0)), 1e-6);
  EXPECT_NEAR(ran.first.pose.position.x(), 0.1 + 0.8 - 200.0 / 250000.0 * std::sin(1000.0), 1e-6);
}

// Ten thousand times as short as what a step of the block at rest would last, upwards: what it does while the floor holds the
// block, and from then on, by steps of a nanosecond.
TEST(ChangingForces, ShortPushLiftsARestingBlock) {
  for (const double width : {1e-4, 1e-3, 1e-2}) {
    const double peak = 0.5 / width;
    const std::string push = fmt::format("{}*exp(-((t-1.5)/{})^2)", peak, width);
    const Ran ran = run(blocks(1, 0.5, 1.5 + 6.0 * width) + formula("fy", push));
    double y = 0.0, v = 0.0;
    constexpr int kSteps = 1000000;
    const double h = 12.0 * width / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const double t = (-6.0 * width + (k + 0.5) * h) / width;
      v = std::max(v + h * (peak * std::exp(-t * t) - 9.81), y > 0.0 ? -1e300 : 0.0);
      y += h * v;
    }
    EXPECT_NEAR(ran.first.pose.position.y(), 0.1 + y, 1e-3 * y) << width;
    EXPECT_NEAR(ran.first.twist.velocity.y(), v, 1e-4 * v) << width;
  }
}

TEST(ChangingForces, HalfADozenBlocksSwingByModes) {
  const Ran ran = run(blocks(6, 0.0, 2.0) + springs(6, 100.0));
  EXPECT_NEAR(ran.first.pose.position.x(), 0.1 * std::cos(20.0),
              1e-6);  // all alike: those between them say nothing
  EXPECT_NEAR(ran.energies.back() / ran.energies.front(), 1.0, 1e-7);
}

// More than modes take: to first order, and what springs give back is never more than they took. Within a step the twists are
// those of its end: what is told there may be above, by a step's work.
TEST(ChangingForces, StepsOfManyWinNoEnergy) {
  for (const double stiffness : {10.0, 1e3, 1e5}) {
    const Ran ran = run(blocks(20, 0.0, 2.0) + springs(20, stiffness), "body_clocks", 40);
    const double of_gravity = 20 * 9.81 * 0.1, of_springs = ran.energies.front() - of_gravity;
    EXPECT_NEAR(of_springs, 20 * 0.5 * stiffness * 0.01, 1e-9 * stiffness);
    for (const double energy : ran.energies)
      EXPECT_LE(energy, ran.energies.front() + 0.02 * of_springs) << stiffness;
    EXPECT_LT(ran.energies.back(), ran.energies.front()) << stiffness;
  }
}

TEST(ChangingForces, StepsOfManyUnderDragComeToAStop) {
  std::string text = blocks(20, 0.0, 0.5) + springs(20, 10.0) + "[[forces]]\nkind = 'drag'\nlinear = 1e3\n";
  const Ran ran = run(text, "body_clocks", 10);
  for (std::size_t k = 1; k < ran.energies.size(); ++k)
    EXPECT_LE(ran.energies[k], ran.energies[k - 1] + 1e-12);
  // 10 N/m against 1000 kg/s: the first comes back by 0.1 (1 - exp(-k t / c)), all alike
  EXPECT_NEAR(ran.first.pose.position.x(), 0.1 * std::exp(-0.005), 1e-5);
}

/// Ends the process as soon as something has been said.
struct SaidSink final : spdlog::sinks::base_sink<spdlog::details::null_mutex> {
  void sink_it_(const spdlog::details::log_msg&) override { std::_Exit(0); }
  void flush_() override {}
};

/// Runs a disc under the force, until something is said or, for a minute at most, to the end, and ends the process.
[[noreturn]] void run_and_exit(const std::string& force) {
  const Scene scene = parse_scene(
      "[world]\nduration = 1.0\n[[bodies]]\nname = 'ball'\ndisc = { radius = 0.5 }\nvelocity = [1, 0]\n"
      "[[forces]]\nkind = 'formula'\nfx = '" +
          force + "'\n",
      "pace");
  log().sinks().push_back(std::make_shared<SaidSink>());
  RunOptions options = testing::until(scene.duration);
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  options.progress = [end](double, std::uint64_t) { return std::chrono::steady_clock::now() < end; };
  Simulator(scene.world, scene.solver).run(options);
  std::_Exit(0);
}

// Dry friction as a formula: it jumps where the disc stands still, and is followed in steps of 1e-11 s for ever.
TEST(ChangingForcesDeathTest, AForceThatJumpsIsWarnedOf) {
  EXPECT_EXIT(
      run_and_exit("vx > 0 ? -3*m : 3*m"), ::testing::ExitedWithCode(0),
      "^warning: the motion of 'ball' is followed in steps of .*e-11 s at t = 0.33333.* its force jumps");
  EXPECT_EXIT(run_and_exit("-1e6*m*x"), ::testing::ExitedWithCode(0), "^$");
}

}  // namespace
}  // namespace brink::changing_forces_test
