// Contacts that last, against known answers: bounces have a limit, what lies lies, and wakes when it is hit or
// left.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/support/outside/frame_watch.h"
#include "tests/support/settling.h"

namespace brink::lasting_contacts_test {
namespace {

using testing::add;
using testing::add_floor;
using testing::all_at_rest;
using testing::at_rest;
using testing::body;
using testing::go_on;
using testing::heavy_world;
using testing::kEarth;
using testing::lasting;
using testing::same_place;
using testing::site;

// ---- a ball

World dropped_ball(double restitution) {
  World world = heavy_world(restitution, 0.0);
  add_floor(world);
  add(world, body(make_disc(0.5), {0.0, 1.5}, {0.0, 0.0}));
  return world;
}

/// sqrt(2h/g) (1 + e) / (1 - e), h = 1 m.
double limit_of(double e) { return std::sqrt(2.0 / kEarth) * (1.0 + e) / (1.0 - e); }

class BallThatBounces : public ::testing::TestWithParam<double> {};

// The geometric series has a limit, and from there on nothing moves: not by a bit.
TEST_P(BallThatBounces, LiesOnTheFloorAfterTheLimit) {
  const double e = GetParam(), limit = limit_of(e);
  Simulator simulator(dropped_ball(e), lasting());
  EXPECT_EQ(go_on(simulator, 0.999 * limit), "");
  EXPECT_FALSE(at_rest(simulator.state(0)));
  EXPECT_EQ(go_on(simulator, limit), "");
  const BodyState lies = simulator.state(0);
  EXPECT_NEAR(lies.pose.position.y(), 0.5, 1e-13);
  EXPECT_TRUE(at_rest(lies));
  EXPECT_EQ(go_on(simulator, limit + 10.0), "");
  EXPECT_TRUE(same_place(simulator.state(0), lies));
}

// The limit is told where it lies, though the ball has been caught a little before.
TEST_P(BallThatBounces, TellsTheLimitOfItsBounces) {
  const double e = GetParam(), limit = limit_of(e);
  Simulator simulator(dropped_ball(e), lasting());
  testing::Events events;
  EXPECT_EQ(simulator.run(testing::until(limit + 0.1), &events).termination, Termination::reached_end);
  const auto zeno = std::find_if(events.events.begin(), events.events.end(),
                                 [](const Event& told) { return told.kind == EventKind::zeno; });
  ASSERT_TRUE(zeno != events.events.end());
  std::printf("e = %.2f: %zu bounces, limit %.12f s, told %.1e s beside it\n", e, events.collisions().size(),
              limit, zeno->contact.time - limit);
  EXPECT_NEAR(zeno->contact.time, limit, 1e-12 * std::max(1.0, limit));
}

// At 0.99 there are 1156 bounces in 90 s: what a rounding of the clock takes from one comes back with all others.
INSTANTIATE_TEST_SUITE_P(Restitutions, BallThatBounces, ::testing::Values(0.5, 0.9, 0.99));

// ---- a stack

/// Boxes of side 1, a hair above each other.
World stack(int boxes, double hair) {
  World world = heavy_world(0.0, 0.5);
  add_floor(world);
  for (int k = 0; k < boxes; ++k)
    add(world, body(make_box(1.0, 1.0), {0.0, 0.5 + k + (k + 1) * hair}, {0.0, 0.0}));
  return world;
}

TEST(Stack, SetDownLiesForAHundredSecondsAtNoCost) {
  const World world = stack(10, 1e-4);
  Simulator simulator(world, lasting());
  EXPECT_EQ(go_on(simulator, 2.0), "");
  ASSERT_TRUE(all_at_rest(simulator));
  const std::vector<BodyState> lies = simulator.states();
  const RunSummary before = simulator.run(testing::until(3.0)), after = simulator.run(testing::until(103.0));
  for (int k = 0; k < 10; ++k) {
    EXPECT_TRUE(same_place(simulator.state(k), lies[k])) << k;
    EXPECT_NEAR(lies[k].pose.position.y(), k + 0.5, 1e-9) << k;
    // not 0: each box is set down on one of its corners first, and then on both
    EXPECT_NEAR(lies[k].pose.position.x(), 0.0, 1e-8) << k;
  }
  std::printf("in 100 s: %d collisions, %d searches, %d passes, %d horizons\n",
              static_cast<int>(after.collisions - before.collisions),
              static_cast<int>(after.work.pair_searches - before.work.pair_searches),
              static_cast<int>(after.work.passes - before.work.passes),
              static_cast<int>(after.work.horizons - before.work.horizons));
  EXPECT_EQ(after.collisions, before.collisions);
  EXPECT_EQ(after.work.component_resets, before.work.component_resets);
  EXPECT_LE(after.work.pair_searches, before.work.pair_searches + 10);
}

TEST(Stack, HitByABallWakes) {
  World world = stack(3, 1e-4);
  // meets the upper box at its middle after 1.45 s
  add(world, body(make_disc(0.25), {-8.0, 2.5}, {5.0, 0.5 * kEarth * 7.25 / 5.0}));
  Simulator simulator(world, lasting());
  EXPECT_EQ(go_on(simulator, 1.4), "");
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(at_rest(simulator.state(k))) << k;
  EXPECT_EQ(go_on(simulator, 1.5), "");
  EXPECT_GT(simulator.state(2).twist.velocity.x(), 0.1);
  EXPECT_GT(simulator.state(2).pose.position.x(), 0.001);
  EXPECT_EQ(go_on(simulator, 6.0), "");
}

// ---- supports that leave

/// A box on a table that moves as told from t = 1 s on.
World on_a_table(const char* x, const char* y, const Shape& shape) {
  World world = heavy_world(0.0, 0.0);
  FixedSite table = site(make_box(4.0, 0.5), {0.0, -0.25});
  FormulaMotion motion;
  motion.x.emplace(x, std::vector<std::string>{"t"});
  motion.y.emplace(y, std::vector<std::string>{"t"});
  table.motion = motion;
  add(world, table);
  add(world, body(shape, {1.0, 0.5001}, {0.0, 0.0}));
  return world;
}

TEST(Support, ThatFallsFasterThanItsLoadLetsItFly) {
  Simulator simulator(on_a_table("0", "-10*max(0,t-1)^2", make_box(1.0, 1.0)), lasting());
  ASSERT_EQ(go_on(simulator, 1.0), "");
  const double y = simulator.state(0).pose.position.y();
  EXPECT_NEAR(y, 0.5, 1e-6);
  EXPECT_EQ(go_on(simulator, 2.0), "");
  std::printf("falls %.6f m in a second, a free body %.6f m\n", y - simulator.state(0).pose.position.y(),
              0.5 * kEarth);
  const double step = 0.05 * std::sqrt(std::sqrt(2.0) / kEarth);  // late by so much at most
  EXPECT_NEAR(y - simulator.state(0).pose.position.y(), 0.5 * kEarth, kEarth * step);
  EXPECT_NEAR(simulator.state(0).pose.angle, 0.0, 1e-9);
}

TEST(Support, DrawnAwaySidewaysLetsADiscFall) {
  Simulator simulator(on_a_table("-2*max(0,t-1)", "0", make_disc(0.5)), lasting());
  EXPECT_EQ(go_on(simulator, 1.4), "");
  EXPECT_NEAR(simulator.state(0).pose.position.y(), 0.5, 1e-6);  // the edge comes by after 1.5 s
  EXPECT_EQ(go_on(simulator, 2.5), "");
  EXPECT_LT(simulator.state(0).pose.position.y(), -2.0);
}

// ---- a pile

TEST(Pile, OfThirtyDiscsInABinComesToRest) {
  World world = heavy_world(0.2, 0.5);
  add(world, site(make_segment({-1.0, 0.0}, {1.0, 0.0})));
  for (const double x : {-1.0, 1.0}) add(world, site(make_segment({x, 0.0}, {x, 6.0})));
  for (int k = 0; k < 30; ++k)
    add(world, body(make_disc(0.12 + 0.002 * (k % 7)),
                    {-0.75 + 0.37 * (k % 5) + 0.01 * (k % 3), 0.3 + 0.35 * (k / 5)}, {0.0, 0.0}));
  outside::FrameWatch watch(world, 20.0, 1e-9);
  Simulator simulator(world, lasting());
  RunOptions options = testing::until(0.0);
  options.frame_interval = 0.02;
  double from = 0.0;
  for (double t = 0.25; t <= 20.0 && from == 0.0; t += 0.25) {
    options.until = t;
    const RunSummary summary = simulator.run(options, &watch);
    ASSERT_EQ(summary.termination, Termination::reached_end) << summary.why;
    if (all_at_rest(simulator)) from = t;
  }
  std::printf("at rest by %.2f s, deepest %.1e m, gained %.1e at %.3f s\n", from,
              static_cast<double>(watch.deepest), static_cast<double>(watch.gained), watch.when);
  EXPECT_TRUE(watch.sound()) << watch.report();
  EXPECT_LE(watch.gained, 1e-10);
  ASSERT_GT(from, 0.0) << "moves at 20 s";
  const std::vector<BodyState> lies = simulator.states();
  EXPECT_EQ(go_on(simulator, from + 100.0), "");
  for (int k = 0; k < 30; ++k) EXPECT_TRUE(same_place(simulator.state(k), lies[k])) << k;
}

}  // namespace
}  // namespace brink::lasting_contacts_test
