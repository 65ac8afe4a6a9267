// Periodic worlds: the same events from every exact policy, images where a larger world has bodies, gases and
// the Lorentz gas.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "brink/core/base/error.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/same_events.h"
#include "tests/support/seeded_random.h"
#include "tests/support/worlds.h"

namespace brink::periodic_test {
namespace {

using testing::add;
using testing::body;
using testing::Events;
using testing::site;
using testing::until;

struct Ran {
  Events events;
  RunSummary summary;
  std::vector<BodyState> states;
};

Ran run(const World& world, const std::string& policy, double end) {
  SolverOptions options;
  options.policy = policy;
  Simulator simulator(world, options);
  Ran r;
  RunOptions run_options = until(end);
  run_options.frame_interval = end / 5.0;
  r.summary = simulator.run(run_options, &r.events);
  EXPECT_EQ(r.summary.termination, Termination::reached_end) << r.summary.why;
  r.states = simulator.states();
  return r;
}

void expect_same(const Ran& a, const Ran& b) {
  const auto &x = a.events.events, &y = b.events.events;
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    ASSERT_EQ(x[k].contact.time, y[k].contact.time) << "event " << k;
    ASSERT_EQ(x[k].contact.point, y[k].contact.point) << "event " << k;
    ASSERT_EQ(x[k].contact.body, y[k].contact.body) << "event " << k;
    ASSERT_EQ(x[k].contact.other_body, y[k].contact.other_body) << "event " << k;
  }
  EXPECT_EQ(a.summary.state_hash, b.summary.state_hash);
}

class PeriodicWorld : public ::testing::Test {
 protected:
  /// `side` x `side` bodies of those shapes, in turn, on a lattice of the pitch, with random velocities whose
  /// mean is not 0: all drift through the cell.
  World gas(int side, double pitch, const std::vector<Shape>& shapes, double spin) const {
    World world;
    world.periods.size = {side * pitch, side * pitch};
    Random random = start_;
    for (int k = 0; k < side * side; ++k)
      add(world, body(shapes[k % shapes.size()], {pitch * (k % side), pitch * (k / side)},
                      {random.uniform(-1.0, 2.0), random.uniform(-1.0, 1.5)}, 1.0, 0.0,
                      random.uniform(-spin, spin)));
    return world;
  }

  const SeededRandom start_{11};
};

TEST_F(PeriodicWorld, ExactPoliciesGiveTheSameEvents) {
  World discs = gas(10, 1.0, {make_disc(0.4), make_disc(0.3), make_disc(0.1)}, 0.0);
  for (const std::string& policy : testing::other_exact_policies())
    expect_same(run(discs, "global_backup", 5.0), run(discs, policy, 5.0));

  World boxes = gas(6, 1.2, {make_box(0.8, 0.4), make_disc(0.3)}, 3.0);
  boxes.gravity = {0.0, -0.5};
  boxes.bodies[7].outline = testing::outline(make_disc(0.1));
  for (const std::string& policy : testing::other_exact_policies())
    expect_same(run(boxes, "global_backup", 3.0), run(boxes, policy, 3.0));
}

TEST_F(PeriodicWorld, SitesAndMovingSitesHaveImages) {
  World world = gas(4, 1.2, {make_disc(0.2)}, 0.0);
  add(world, site(make_disc(0.3), {0.6, 0.6}));
  add(world, site(make_segment({-0.5, 0.0}, {0.5, 0.0}), {0.0, 3.0}));  // over the edge of the cell
  FixedSite paddle = site(make_box(0.5, 0.1), {3.0, 3.0});
  paddle.motion = ConstantMotion{{{0.3, 0.0}, 1.0}};  // drifts out of the cell, and turns
  add(world, paddle);
  const Ran r = run(world, "global_backup", 6.0);
  EXPECT_GT(r.summary.work.collisions_body_site, 10U);
  expect_same(r, run(world, "body_clocks", 6.0));
}

TEST_F(PeriodicWorld, IntegratedMotionGivesTheSameEvents) {
  World world = gas(4, 1.2, {make_disc(0.3), make_box(0.5, 0.3)}, 1.0);
  world.forces.push_back(DragForce{{0, 1, 2, 3, 4, 5}, 0.1, 0.05, 0.0});
  SpringForce spring;
  spring.body_a = 8;
  spring.body_b = 9;
  spring.stiffness = 2.0;
  spring.rest_length = 1.2;
  world.forces.push_back(spring);
  const Ran r = run(world, "global_backup", 3.0);
  EXPECT_GT(r.summary.collisions, 30U);
  expect_same(r, run(world, "body_clocks", 3.0));
}

// A cell of 3 x 3 bodies, and the same as part of one of twice the size: every collision happens four times
// there, at the same time but for rounding, until chaos has made that large.
TEST_F(PeriodicWorld, ImagesAreWhatALargerCellHasAsBodies) {
  const World small = gas(3, 1.3, {make_disc(0.45)}, 0.0);
  World large;
  large.periods.size = 2.0 * small.periods.size;
  for (int k = 0; k < 4; ++k)
    for (Body b : small.bodies) {
      b.name.clear();
      b.initial.pose.position += Vec2(k % 2 * small.periods.size.x(), k / 2 * small.periods.size.y());
      add(large, b);
    }
  const auto few = run(small, "body_clocks", 3.0).events.collisions();
  const auto many = run(large, "body_clocks", 3.0).events.collisions();
  ASSERT_GT(few.size(), 20U);
  ASSERT_EQ(many.size(), 4 * few.size());
  for (std::size_t k = 0; k < many.size(); ++k)
    EXPECT_NEAR(many[k].contact.time, few[k / 4].contact.time, 1e-9);
}

TEST_F(PeriodicWorld, GasKeepsMomentumAndEnergyAndNeverOverlaps) {
  const World world = gas(20, 1.0, {make_disc(0.4)}, 0.0);
  SolverOptions options;
  options.max_collisions = 100000;
  Simulator simulator(world, options);
  const RunSummary s = simulator.run(until(1e9));
  Vec2 before = Vec2::Zero(), after = Vec2::Zero();
  const std::vector<BodyState> states = simulator.states();
  double speeds = 0.0;
  for (std::size_t k = 0; k < states.size(); ++k) {
    before += world.bodies[k].initial.twist.velocity;
    after += states[k].twist.velocity;
    speeds += states[k].twist.velocity.norm();
  }
  EXPECT_LE((after - before).norm(), 1e-13 * speeds);
  EXPECT_LE(std::abs(s.energy_final - s.energy_initial), 1e-13 * s.energy_initial);
  EXPECT_TRUE(simulator.start_fault().empty());
  EXPECT_LE(s.max_overlap, 1e-12 * 0.4);
}

// A point among discs of radius R, one in each unit cell: mean free path (1 - pi R^2) / (2 R), Santalo's
// formula.
class LorentzGas : public ::testing::TestWithParam<double> {};

TEST_P(LorentzGas, MeanFreePathIsSantalos) {
  const double radius = GetParam();
  World world;
  world.periods.size = {1.0, 1.0};
  add(world, body(make_point({0.0, 0.0}), {0.5, 0.5}, {std::cos(0.3), std::sin(0.3)}));
  world.bodies[0].mass = world.bodies[0].inertia = 1.0;
  add(world, site(make_disc(radius)));
  SolverOptions options;
  options.max_collisions = 200000;
  Simulator simulator(world, options);
  const RunSummary s = simulator.run(until(1e9));
  ASSERT_EQ(s.collisions, options.max_collisions) << s.why;
  const double path = simulator.time() / static_cast<double>(s.collisions);
  const double expected = (1.0 - std::numbers::pi * radius * radius) / (2.0 * radius);
  std::printf("R = %.1f: mean free path %.6f, expected %.6f\n", radius, path, expected);
  EXPECT_NEAR(path, expected, 0.01 * expected);  // free paths have long tails: a few standard errors
}

INSTANTIATE_TEST_SUITE_P(Radii, LorentzGas, ::testing::Values(0.1, 0.2, 0.3));

TEST_F(PeriodicWorld, RefusesWhatCannotRepeat) {
  World world = gas(2, 1.0, {make_disc(0.3)}, 0.0);
  world.periods.size = {1.0, 2.0};
  EXPECT_THROW(Simulator(world, {}), BadInput);  // a body wider than half a period
  world = gas(3, 1.0, {make_disc(0.3)}, 0.0);
  SolverOptions options;
  options.detector = "pass";
  EXPECT_THROW(Simulator(world, options), BadInput);
  add(world, site(make_disc_container(5.0)));
  EXPECT_THROW(Simulator(world, {}), BadInput);
  world = gas(3, 1.0, {make_disc(0.3)}, 0.0);
  world.periods.size.x() = std::nan("");
  EXPECT_THROW(Simulator(world, {}), BadInput);
}

}  // namespace
}  // namespace brink::periodic_test
