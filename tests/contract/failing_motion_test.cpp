/// A motion that cannot go on: everything up to there happens, is recorded, and is the same under every
/// policy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/base/error.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/same_events.h"

namespace brink::failing_motion_test {
namespace {

using testing::add;
using testing::Events;
using ::testing::HasSubstr;

Formula of_time(const char* text) { return Formula(text, {"t"}); }
FormulaForce force_on(int body, const char* fx) {
  FormulaForce force;
  force.bodies = {body};
  force.fx = Formula(fx, force_formula_variables());
  return force;
}

/// Discs that meet each other and the walls of a box before and after 1.5 s.
World discs() {
  World world;
  for (int k = 0; k < 6; ++k)
    add(world, testing::body(make_disc(0.2), {0.7 * k - 1.8, 0.3 * (k % 3)}, {1.0 - 0.3 * k, 0.7 - 0.2 * k}));
  const Vec2 corners[] = {{-2.5, -1.0}, {2.5, -1.0}, {2.5, 1.5}, {-2.5, 1.5}};
  for (int k = 0; k < 4; ++k) add(world, testing::site(make_segment(corners[k], corners[(k + 1) % 4])));
  return world;
}

/// A body out of everyone's way whose force ends at 1.5 s.
World one_fails() {
  World world = discs();
  add(world, testing::body(make_disc(0.1), {9.0, 9.0}, {0.0, 0.0}));
  world.forces.push_back(force_on(6, "sqrt(1.5 - t)"));
  return world;
}

RunSummary run(const World& world, const SolverOptions& options, double end, Events* events = nullptr) {
  Simulator simulator(world, options);
  RunOptions run_options = testing::until(end);
  run_options.frame_interval = 0.05;
  return simulator.run(run_options, events);
}

TEST(FailingMotion, EverythingUpToTheFailureHappens) {
  Events events;
  const RunSummary summary = run(one_fails(), {}, 3.0, &events);
  EXPECT_EQ(summary.termination, Termination::failed);
  EXPECT_THAT(summary.why, HasSubstr("'body6'"));
  EXPECT_THAT(summary.why, HasSubstr("not finite"));
  EXPECT_NEAR(summary.end_time, 1.5, 1e-3);
  EXPECT_GT(summary.collisions, 3U);
  EXPECT_NEAR(events.frame_times.back(), 1.5, 1e-3);
  EXPECT_GE(events.frame_times.size(), 30U);
}

TEST(FailingMotion, EveryPolicyAgrees) {
  EXPECT_GT(testing::expect_same_events(one_fails(), {}, 3.0), 3U);
  World jump = discs();
  add(jump, testing::site(make_segment({-9.0, 9.0}, {-8.0, 9.0})));
  jump.sites.back().motion = FormulaMotion{std::nullopt, of_time("t < 0.7 ? 0 : 0.3"), std::nullopt};
  testing::expect_same_events(jump, {}, 3.0);
}

// The collision comes before the failure and starts the motion afresh: that one goes on.
TEST(FailingMotion, ACollisionBeforeMayAvertIt) {
  World world;
  add(world, testing::body(make_disc(0.1), {0.0, 0.0}, {1.0, 0.0}));
  add(world, testing::site(make_segment({1.0, -1.0}, {1.0, 1.0})));
  world.forces.push_back(force_on(0, "x > 1.5 ? sqrt(-1) : 0"));
  const RunSummary summary = run(world, {}, 3.0);
  EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
  EXPECT_EQ(testing::expect_same_events(world, {}, 3.0), 1U);
}

TEST(FailingMotion, RunAgainGivesTheSameAnswer) {
  for (const Choice& choice : policies()) {
    const std::string policy(choice.name);
    SolverOptions options;
    options.policy = policy;
    Simulator simulator(one_fails(), options);
    const RunSummary first = simulator.run(testing::until(3.0));
    const RunSummary again = simulator.run(testing::until(4.0));
    EXPECT_EQ(first.termination, Termination::failed) << policy;
    EXPECT_EQ(again.termination_text(), first.termination_text()) << policy;
    EXPECT_EQ(again.end_time, first.end_time) << policy;
    EXPECT_EQ(again.state_hash, first.state_hash) << policy;
  }
}

// x'' = 1000 x': its energy overflows at 0.355 s, its speed at 0.71 s.
TEST(FailingMotion, NothingThatIsNotFiniteIsRecorded) {
  World world;
  add(world, testing::body(make_disc(0.1), {0.0, 0.0}, {1.0, 0.0}));
  world.forces.push_back(force_on(0, "1000 * vx"));
  for (const std::string& policy : exact_policies())
    for (const char* integrator : {"erk", "adams", "bdf", "rk4"}) {
      SolverOptions options;
      options.policy = policy;
      options.integrator = integrator;
      Events events;
      const RunSummary summary = run(world, options, 0.36, &events);
      SCOPED_TRACE(std::string(policy) + ", " + integrator);
      EXPECT_EQ(summary.termination, Termination::failed);
      EXPECT_THAT(summary.why, HasSubstr("overflows"));
      EXPECT_TRUE(std::isfinite(summary.energy_final));
      EXPECT_TRUE(std::isfinite(events.last_frame[0].pose.position.x()));
      EXPECT_LT(events.frame_times.back(), 0.36);
    }
}

// 1e15 steps: the run goes on until it is told not to, and asks whether it should.
TEST(FailingMotion, EndlessIntegrationAsksWhetherToGoOn) {
  World world;
  add(world, testing::body(make_disc(0.1), {0.0, 0.0}, {1.0, 0.0}));
  DragForce drag;
  drag.bodies = {0};
  drag.linear = 1.0;
  world.forces.push_back(drag);
  for (const Choice& choice : policies()) {
    const std::string policy(choice.name);
    SolverOptions options;
    options.policy = policy;
    options.integrator = "rk4";
    options.step = 1e-3;
    Simulator simulator(world, options);
    RunOptions run_options = testing::until(1e12);
    int asked = 0;
    run_options.progress = [&](double, std::uint64_t) { return ++asked < 100; };
    const RunSummary summary = simulator.run(run_options);
    EXPECT_EQ(summary.termination, Termination::stopped) << policy;
    EXPECT_LT(summary.work.solver_steps, 5000000U) << policy;
  }
}

// In instalments and with the past forgotten, a long motion is what it was; frames are where they are due.
TEST(FailingMotion, ForgettingThePastChangesNothing) {
  World world;
  add(world, testing::body(make_disc(0.1), {1.0, 0.0}, {0.0, 0.5}));
  world.forces.push_back(AttractForce{{0}, {0.0, 0.0}, 1.0, 1.0});
  for (const std::string& policy : exact_policies()) {
    SolverOptions options;
    options.policy = policy;
    options.integrator = "rk4";
    options.step = 1e-3;
    Simulator simulator(world, options);
    RunOptions run_options = testing::until(300.0);
    run_options.frame_interval = 30.0;
    Events events;
    EXPECT_EQ(simulator.run(run_options, &events).termination, Termination::reached_end) << policy;
    EXPECT_EQ(events.frame_times.size(), 11U) << policy;
    EXPECT_NEAR(simulator.state(0).pose.position.x(), std::cos(300.0), 1e-8) << policy;
    EXPECT_NEAR(simulator.state(0).pose.position.y(), 0.5 * std::sin(300.0), 1e-8) << policy;
  }
}

// A push of 2 ms: its impulse is 0.3 N * 1 ms, wherever steps begin.
TEST(FailingMotion, AShortPushIsNotSteppedOver) {
  for (const char* integrator : {"erk", "adams", "bdf"})
    for (const double start : {0.0, 0.3, 0.55}) {
      World world;
      add(world, testing::body(make_disc(0.1), {0.0, 0.0}, {start, 0.0}));
      world.forces.push_back(force_on(0, "1e3 * max(0, 0.3 - abs(t - 0.7031) * 300)"));
      SolverOptions options;
      options.integrator = integrator;
      Simulator simulator(world, options);
      simulator.run(testing::until(2.0));
      EXPECT_NEAR(simulator.state(0).twist.velocity.x() - start, 0.3, 1e-6) << integrator;
    }
}

}  // namespace
}  // namespace brink::failing_motion_test
