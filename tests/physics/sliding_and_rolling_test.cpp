// Bodies that slide, stick and roll on what holds them, against closed forms. Steps of islands are of order 1:
// their length goes with the root of the body's size, on which nothing of these answers depends.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/settling.h"

namespace brink::sliding_and_rolling_test {
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

// ---- a block on an incline

constexpr double kSteep = 0.4;  // [rad]

/// A block of length `size`, a rounding above a wire through the origin.
World block_on_an_incline(double size, double friction) {
  World world = heavy_world(0.0, friction);
  add(world, site(make_segment({-50.0, 0.0}, {50.0, 0.0}), Vec2::Zero(), kSteep));
  const Vec2 out(-std::sin(kSteep), std::cos(kSteep));
  add(world, body(make_box(size, 0.5 * size), (0.25 * size + 1e-9 * size) * out, {0.0, 0.0}, 1.0, kSteep));
  return world;
}

/// How far it is down the incline [m].
double way(const BodyState& s) { return -s.pose.position.dot(Vec2(std::cos(kSteep), std::sin(kSteep))); }

TEST(BlockOnAnIncline, SticksWhereFrictionHoldsIt) {
  for (const double friction : {1.001 * std::tan(kSteep), 2.0}) {
    Simulator simulator(block_on_an_incline(0.2, friction), lasting());
    EXPECT_EQ(go_on(simulator, 1.0), "");
    const BodyState lies = simulator.state(0);
    EXPECT_TRUE(at_rest(lies)) << friction;
    EXPECT_NEAR(way(lies), 0.0, 1e-8) << friction;
    EXPECT_EQ(go_on(simulator, 100.0), "");
    EXPECT_TRUE(same_place(simulator.state(0), lies)) << friction;
  }
}

/// What moves, moves at the level of velocities.
SolverOptions by_steps() {
  SolverOptions options = lasting();
  options.modes_contacts = 0;
  return options;
}

/// What its way in a second misses of a/2, a = g (sin - mu cos) [m].
double error_of_way(double size, double friction, const SolverOptions& options) {
  Simulator simulator(block_on_an_incline(size, friction), options);
  EXPECT_EQ(go_on(simulator, 1.0), "") << size;
  const double a = kEarth * (std::sin(kSteep) - friction * std::cos(kSteep));
  return way(simulator.state(0)) - 0.5 * a;
}

// A step is off by half of what its change of velocity moves: h^2 a / 2, so errors go with the root of what is allowed.
TEST(BlockOnAnIncline, SlidesAsExactlyAsIslandToleranceAsks) {
  const double friction = 0.2, a = kEarth * (std::sin(kSteep) - friction * std::cos(kSteep));
  std::vector<double> errors;
  for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
    SolverOptions options = by_steps();
    options.island_tolerance = tolerance;
    Simulator simulator(block_on_an_incline(0.2, friction), options);
    EXPECT_EQ(go_on(simulator, 1.0), "");
    errors.push_back(std::abs(way(simulator.state(0)) - 0.5 * a));
    std::printf("island_tolerance %.0e: off by %.2e m\n", tolerance, errors.back());
  }
  EXPECT_LT(errors[0], 0.01);
  for (const int k : {1, 2}) EXPECT_NEAR(errors[k - 1] / errors[k], 10.0, 4.0);
}

TEST(BlockOnAnIncline, SlidesOnWhereNoStepIsExactEnough) {
  SolverOptions options = by_steps();
  options.island_tolerance = 1e-300;
  Simulator simulator(block_on_an_incline(0.2, 0.2), options);
  EXPECT_EQ(go_on(simulator, 0.01), "");
  EXPECT_GT(way(simulator.state(0)), 0.0);
}

TEST(BlockOnAnIncline, SlidesWithTheAccelerationThatFrictionLeaves) {
  for (const double size : {3.2, 0.8, 0.2}) {
    for (const double friction : {0.0, 0.2})
      EXPECT_NEAR(error_of_way(size, friction, lasting()), 0.0, 1e-8) << friction << ", size " << size;
    // where friction all but holds it, the friction of its first bounces does for a moment
    EXPECT_NEAR(error_of_way(size, 0.999 * std::tan(kSteep), lasting()), 0.0, 1e-5) << "size " << size;
  }
}

TEST(BlockOnAnIncline, SlidesByStepsWithTheAccelerationThatFrictionLeavesToOrderOne) {
  for (const double friction : {0.0, 0.2, 0.999 * std::tan(kSteep)}) {
    double coarser = 0.0;
    for (const double size : {3.2, 0.8, 0.2}) {
      const double error = std::abs(error_of_way(size, friction, by_steps()));
      std::printf("friction %.4f, size %.1f: error %.3e m, ratio %.2f\n", friction, size, error,
                  coarser / error);
      EXPECT_GE(coarser / error, coarser > 0.0 ? 1.7 : 0.0) << friction << ", size " << size;
      coarser = error;
    }
    EXPECT_LE(coarser, 0.05);
  }
}

// ---- many that slide

constexpr int kSlabs = 10;
/// The longest step of such slabs, a twentieth of sqrt(size / g) [s], and how far off they come by that, being of first
/// order: half a step at 2 m/s, and a fifth more [m].
const double kLongest = 0.05 * std::sqrt(2.0 * std::hypot(1.0, 0.05) / kEarth), kFirstOrder = 1.2 * kLongest;

/// Flat slabs on one another, thrown along a floor at 2 m/s; friction .3 at the floor, .9 between slabs, and that of the
/// slippery one below the uppermost. Of a contact it is the smaller of the two.
World thrown_slabs(double below_uppermost) {
  World world = heavy_world(0.0, 0.9);
  world.friction_rule = Combine::min;
  for (const double friction : {0.3, below_uppermost}) {
    Material material;
    material.name = friction == 0.3 ? "floor" : "uppermost";
    material.restitution = 0.0;
    material.friction = friction;
    world.materials.push_back(material);
  }
  add_floor(world);
  world.sites[0].material = 1;
  for (int k = 0; k < kSlabs; ++k) {
    add(world, body(make_box(2.0, 0.1), {-20.0, 0.05 + 0.1 * k}, {2.0, 0.0}));
    world.bodies.back().material = k == kSlabs - 1 ? 2 : 0;
  }
  return world;
}

// An island of more than eight members, so friction comes of sweeps: v^2 / 2 mu g, nobody moves beside another, then rest.
TEST(ManySlabs, SlideAsOneAndStopWhereFrictionHasTakenTheirSpeed) {
  Simulator simulator(thrown_slabs(0.9), lasting());
  EXPECT_EQ(go_on(simulator, 2.0), "");
  EXPECT_TRUE(all_at_rest(simulator));
  const std::vector<BodyState> end = simulator.states();
  const double way = end[0].pose.position.x() + 20.0, expected = 4.0 / (2.0 * 0.3 * kEarth);
  std::printf("slid by %.5f m, expected %.5f m\n", way, expected);
  EXPECT_NEAR(way, expected, kFirstOrder);
  for (const BodyState& s : end) EXPECT_NEAR(s.pose.position.x() - end[0].pose.position.x(), 0.0, 1e-9);
}

// The uppermost is slowed by .05 g, and pulls the nine below it on by as much of its weight.
TEST(ManySlabs, ASlipperyOneGoesOnUponTheOthers) {
  Simulator simulator(thrown_slabs(0.05), lasting());
  EXPECT_EQ(go_on(simulator, 0.5), "");
  const std::vector<BodyState> then = simulator.states();
  const double slowed = kEarth * (0.3 * kSlabs - 0.05) / (kSlabs - 1);
  const double slow[] = {slowed, 0.05 * kEarth};
  for (const int k : {0, 1}) {
    const BodyState& s = then[k * (kSlabs - 1)];
    EXPECT_NEAR(s.pose.position.x() + 20.0, 1.0 - 0.125 * slow[k], kFirstOrder) << k;
    // a step has the twist of its end
    EXPECT_NEAR(s.twist.velocity.x(), 2.0 - 0.5 * slow[k], slow[k] * kLongest) << k;
  }
  for (int k = 1; k < kSlabs - 1; ++k)
    EXPECT_NEAR(then[k].pose.position.x(), then[0].pose.position.x(), 1e-9) << k;
}

// ---- wheels

// Nothing stops it, so it may not be taken to lie.
TEST(Wheel, RollsOnAFloorAndNeverLies) {
  World world = heavy_world(0.0, 0.5);
  add_floor(world);
  const double v = 0.7, r = 0.5;
  add(world, body(make_disc(r), {-50.0, r + 1e-12}, {v, 0.0}, 1.0, 0.0, -v / r));
  Simulator simulator(world, lasting());
  for (const double t : {1.0, 10.0, 100.0}) {
    EXPECT_EQ(go_on(simulator, t), "");
    const BodyState s = simulator.state(0);
    std::printf("after %.0f s: speed off by %.1e, place by %.1e m\n", t, s.twist.velocity.x() - v,
                s.pose.position.x() + 50.0 - v * t);
    EXPECT_NEAR(s.twist.velocity.x(), v, 1e-12) << t;
    EXPECT_NEAR(s.pose.position.x(), -50.0 + v * t, 1e-10) << t;
    EXPECT_NEAR(s.pose.position.y(), r, 1e-10) << t;
  }
}

// The torque of a rolling resistance b is b m g; at no slip (I + m R^2) alpha = -b m g, I = m R^2 / 2.
TEST(Wheel, WithRollingResistanceStopsWhereItsWorkIsDone) {
  const double v = 0.7, r = 0.5, b = 0.01, deceleration = 2.0 / 3.0 * b * kEarth / r;
  World world = heavy_world(0.0, 0.5);
  world.materials[0].rolling_resistance = b;
  add_floor(world);
  add(world, body(make_disc(r), {0.0, r + 1e-12}, {v, 0.0}, 1.0, 0.0, -v / r));
  Simulator simulator(world, lasting());
  EXPECT_EQ(go_on(simulator, 2.0), "");
  EXPECT_NEAR(simulator.state(0).twist.velocity.x(), v - 2.0 * deceleration,
              0.016 * deceleration);  // a step of it
  EXPECT_EQ(go_on(simulator, v / deceleration + 1.0), "");
  const BodyState lies = simulator.state(0);
  std::printf("stops after %.6f m, %.6f by its work\n", lies.pose.position.x(), 0.5 * v * v / deceleration);
  EXPECT_TRUE(at_rest(lies));
  EXPECT_NEAR(lies.pose.position.x(), 0.5 * v * v / deceleration, 0.02 * v);  // a step at most
  EXPECT_EQ(go_on(simulator, 1000.0), "");
  EXPECT_TRUE(same_place(simulator.state(0), lies));
}

// On a slope its weight turns it about the foot with m g R sin, against at most b m g cos.
TEST(Wheel, WithRollingResistanceStandsOnASlopeUpToItsAngle) {
  for (const double steeper : {0.999, 1.001}) {
    const double r = 0.25, b = 0.02, angle = steeper * std::atan(b / r);
    World world = heavy_world(0.0, 0.5);
    world.materials[0].rolling_resistance = b;
    add(world, site(make_segment({-50.0, 0.0}, {50.0, 0.0}), Vec2::Zero(), angle));
    const Vec2 out(-std::sin(angle), std::cos(angle));
    add(world, body(make_disc(r), (r + 1e-12) * out, {0.0, 0.0}));
    Simulator simulator(world, lasting());
    EXPECT_EQ(go_on(simulator, 10.0), "");
    const double rolled = simulator.state(0).pose.position.dot(Vec2(-std::cos(angle), -std::sin(angle)));
    // 2/3 g (sin - b/R cos)
    const double free = 2.0 / 3.0 * kEarth * (std::sin(angle) - b / r * std::cos(angle)) * 0.5 * 100.0;
    std::printf("%.4f of the angle: rolled %.6f m, %.6f in closed form\n", steeper, rolled,
                std::max(free, 0.0));
    EXPECT_EQ(at_rest(simulator.state(0)), steeper < 1.0);
    EXPECT_NEAR(rolled, std::max(free, 0.0), 1e-2 * std::abs(free) + 1e-9);
  }
}

TEST(Wheel, SlowerThanTheRestSpeedLies) {
  World world = heavy_world(0.0, 0.5);
  add_floor(world);
  const double v = 1e-3, r = 0.5;
  add(world, body(make_disc(r), {0.0, r + 1e-12}, {v, 0.0}, 2.0, 0.0, -v / r));
  for (const double rest_speed : {0.0, 1.9e-3, 2.1e-3}) {  // its fastest point goes at 2 v
    SolverOptions options = lasting();
    options.rest_speed = rest_speed;
    Simulator simulator(world, options);
    const RunSummary summary = simulator.run(testing::until(1.0));
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    const bool lies = rest_speed > 2.0 * v;
    EXPECT_EQ(at_rest(simulator.state(0)), lies) << rest_speed;
    EXPECT_NEAR(summary.rest_energy, lies ? 0.75 * world.bodies[0].mass * v * v : 0.0, 1e-15) << rest_speed;
    EXPECT_EQ(summary.energy_taken, summary.rest_energy) << rest_speed;  // no group took any
  }
}

// Angular momentum about a point of the floor is kept, whatever friction does: 2/3 of the speed is left.
TEST(Wheel, ThatSlidesAtFirstRollsWithTwoThirdsOfItsSpeed) {
  World world = heavy_world(0.0, 0.3);
  add_floor(world);
  const double v = 3.0, r = 0.2, begins = v / (3.0 * 0.3 * kEarth);
  add(world, body(make_disc(r), {0.0, r + 1e-12}, {v, 0.0}));
  Simulator simulator(world, lasting());
  EXPECT_EQ(go_on(simulator, 2.0 * begins), "");
  const BodyState s = simulator.state(0);
  const double x = 5.0 * v * v / (18.0 * 0.3 * kEarth) + begins * 2.0 * v / 3.0;
  std::printf("speed off by %.1e, slip %.1e m/s, place by %.1e m\n", s.twist.velocity.x() - 2.0 * v / 3.0,
              s.twist.velocity.x() + r * s.twist.omega, s.pose.position.x() - x);
  EXPECT_NEAR(s.twist.velocity.x(), 2.0 * v / 3.0, 1e-9);
  EXPECT_NEAR(s.twist.velocity.x(), -r * s.twist.omega, 1e-9);
  EXPECT_NEAR(s.pose.position.x(), x, 0.02);
}

TEST(Wheel, InAGrooveComesToLie) {
  World world = heavy_world(0.0, 0.5);
  add(world, site(make_polygon({{-4, -2}, {4, -2}, {4, 1.5}, {0, -1}, {-4, 1.5}})));
  add(world, body(make_disc(0.4), {0.8, 0.3}, {0.0, 0.0}));
  Simulator simulator(world, lasting());
  EXPECT_EQ(go_on(simulator, 20.0), "");
  const BodyState lies = simulator.state(0);
  EXPECT_TRUE(at_rest(lies)) << lies.twist.velocity.transpose() << ", " << lies.twist.omega;
  EXPECT_NEAR(lies.pose.position.x(), 0.0, 1e-6);
  EXPECT_EQ(go_on(simulator, 100.0), "");
  EXPECT_TRUE(same_place(simulator.state(0), lies));
}

// ---- a conveyor

// The top of a wheel that turns under a block: it drags the block with mu g until both go alike.
TEST(Conveyor, DragsABlockUntilBothGoAlike) {
  const double radius = 1000.0, speed = 1.0, friction = 0.2, alike = speed / (friction * kEarth);
  World world = heavy_world(0.0, friction);
  FixedSite wheel = site(make_disc(radius), {0.0, -radius});
  wheel.motion = ConstantMotion{{Vec2::Zero(), -speed / radius}};
  add(world, wheel);
  Body block = body(make_box(0.2, 0.2), {0.0, 0.1 + 1e-9}, {0.0, 0.0});
  block.lock_angle = true;
  add(world, block);
  Simulator simulator(world, lasting());
  EXPECT_EQ(go_on(simulator, 0.5 * alike), "");
  std::printf("dragged to %.6f of %.6f m/s, ", simulator.state(0).twist.velocity.x(), 0.5 * speed);
  EXPECT_NEAR(simulator.state(0).twist.velocity.x(), 0.5 * speed, 0.02);
  EXPECT_EQ(go_on(simulator, 3.0 * alike), "");
  std::printf("then %.9f of %.9f m/s\n", simulator.state(0).twist.velocity.x(), speed);
  EXPECT_NEAR(simulator.state(0).twist.velocity.x(), speed, 1e-3);
}

}  // namespace
}  // namespace brink::sliding_and_rolling_test
