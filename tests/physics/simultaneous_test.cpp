/// Contacts of one instant taken together: orders `lcp` and `reflections`, by whichever policy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "brink/core/base/random.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/worlds.h"

namespace brink::simultaneous_test {
namespace {

using testing::Events;

struct Outcome {
  std::vector<BodyState> states;
  RunSummary summary;
  Events events;
};

class Together : public ::testing::TestWithParam<std::string> {
 protected:
  static Outcome run(const World& world, const char* order, double until) {
    SolverOptions options;
    options.policy = GetParam();
    options.order = order;
    Simulator simulator(world, options);
    Outcome outcome;
    outcome.summary = simulator.run(testing::until(until), &outcome.events);
    outcome.states = simulator.states();
    EXPECT_EQ(outcome.summary.termination, Termination::reached_end) << outcome.summary.why;
    return outcome;
  }
};

/// n equal discs of radius 1/2 in a row along x, all but the first touching; it comes with speed 1 from 1/4
/// away.
World cradle(int n, double restitution) {
  World world;
  world.materials[0].restitution = restitution;
  const Shape disc = make_disc(0.5);
  for (int i = 0; i < n; ++i)
    testing::add(world, testing::body(disc, {i - (i == 0 ? 0.25 : 0.0), 0.0}, {i == 0 ? 1.0 : 0.0, 0.0}));
  return world;
}

void expect_row(const Outcome& outcome, double first, double middle, double last, double precision) {
  const int n = static_cast<int>(outcome.states.size());
  for (int i = 0; i < n; ++i) {
    const Twist& t = outcome.states[i].twist;
    EXPECT_NEAR(t.velocity.x(), i == 0 ? first : (i == n - 1 ? last : middle), precision) << "disc " << i;
    EXPECT_NEAR(t.velocity.y(), 0.0, precision) << "disc " << i;
    EXPECT_NEAR(t.omega, 0.0, precision) << "disc " << i;
  }
}

// Newton's law at all contacts: the first rebounds from the rest at its speed of approach, the rest stay
// together; momentum v0 + (n-1) u = 1 and u - v0 = 1 give v0 = 2/n - 1, u = 2/n.
TEST_P(Together, LcpCradleSpreadsOut) {
  expect_row(run(cradle(3, 1.0), "lcp", 1.0), -1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 1e-14);
  const Outcome five = run(cradle(5, 1.0), "lcp", 1.0);
  expect_row(five, -0.6, 0.4, 0.4, 1e-14);
  EXPECT_EQ(five.events.collisions().size(), 4U);  // one event for each contact that pushed
  for (const Event& e : five.events.collisions())
    EXPECT_EQ(e.contact.time, five.events.events[0].contact.time);
}

TEST_P(Together, InelasticCradleMovesAsOne) {
  for (const char* order : {"lcp", "reflections"})
    for (const int n : {2, 3, 5})
      expect_row(run(cradle(n, 0.0), order, 1.0), 1.0 / n, 1.0 / n, 1.0 / n, 1e-14);
}

// Reflections break away: the velocity is handed on within the instant, and the last leaves alone.
TEST_P(Together, ReflectedCradleLetsTheLastGo) {
  for (const int n : {2, 3, 5, 10}) expect_row(run(cradle(n, 1.0), "reflections", 1.0), 0.0, 0.0, 1.0, 1e-14);
}

// Disc v = (1, 0) on two touching ones at +-30 degrees, together: v0 = (-1/5, 0), the two leave at 2 sqrt3
// / 5.
TEST_P(Together, DiscOnTwoIsSymmetric) {
  World world;
  const Shape disc = make_disc(0.5);
  const double c = std::cos(M_PI / 6.0), s = std::sin(M_PI / 6.0);
  testing::add(world, testing::body(disc, {-0.5, 0.0}, {1.0, 0.0}));
  testing::add(world, testing::body(disc, {c, s}, {0.0, 0.0}));
  testing::add(world, testing::body(disc, {c, -s}, {0.0, 0.0}));
  for (const char* order : {"lcp", "reflections"}) {
    const Outcome outcome = run(world, order, 2.0);
    EXPECT_NEAR(outcome.states[0].twist.velocity.x(), -0.2, 1e-14) << order;
    EXPECT_NEAR(outcome.states[0].twist.velocity.y(), 0.0, 1e-14) << order;
    for (const int k : {1, 2})
      EXPECT_NEAR(outcome.states[k].twist.velocity.norm(), 2.0 * std::sqrt(3.0) / 5.0, 1e-14) << order;
    EXPECT_EQ(outcome.events.collisions().size(), 2U) << order;
  }
}

// A polygon's contact is met up to 1e-13 of its size above the floor: so far the figures are good, 1e-12.
// A box that falls flat meets the floor with both corners. Together they throw it back as it came, without a
// spin (one at a time, the first would set it turning). From height h at g it lands after sqrt(2 h / g) = 1 s
// with v = 1 m/s.
TEST_P(Together, FlatBoxReboundsWithoutASpin) {
  World world;
  world.gravity = {0.0, -1.0};
  testing::add(world, testing::body(make_box(2.0, 1.0), {0.3, 1.0}, {0.0, 0.0}));
  testing::add(world, testing::site(make_segment({-5.0, 0.0}, {5.0, 0.0})));
  for (const char* order : {"lcp", "reflections"}) {
    const Outcome outcome = run(world, order, 1.5);
    EXPECT_EQ(outcome.events.collisions().size(), 2U) << order;
    EXPECT_NEAR(outcome.states[0].twist.velocity.y(), 0.5, 1e-12) << order;
    EXPECT_NEAR(outcome.states[0].twist.omega, 0.0, 1e-13) << order;
    EXPECT_NEAR(outcome.states[0].pose.position.y(), 0.5 + 0.5 - 0.5 * 0.25, 1e-12) << order;
  }
}

/// A cue disc from the left on a touching triangle of discs in the middle of a box.
World rack(double restitution, double friction) {
  World world;
  world.materials[0].restitution = restitution;
  world.materials[0].friction = friction;
  const Shape disc = make_disc(0.1);
  testing::add(world, testing::body(disc, {-1.5, 0.01}, {5.0, 0.0}));
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j <= i; ++j)
      testing::add(world, testing::body(disc, {0.2 * i * std::sqrt(0.75), 0.2 * (j - 0.5 * i)}, {0.0, 0.0}));
  for (const auto& [a, b] :
       {std::pair<Vec2, Vec2>{{-2, -1}, {2, -1}}, {{2, -1}, {2, 1}}, {{2, 1}, {-2, 1}}, {{-2, 1}, {-2, -1}}})
    testing::add(world, testing::site(make_segment(a, b)));
  return world;
}

// Groups of ten and more, then single pairs: elastic energy stays to rounding whatever the order, and
// with friction and losses it only goes.
TEST_P(Together, BreakKeepsEnergyOrLosesIt) {
  for (const char* order : {"lcp", "reflections"}) {
    const Outcome elastic = run(rack(1.0, 0.0), order, 3.0);
    EXPECT_GT(elastic.summary.collisions, 30U) << order;
    EXPECT_NEAR(elastic.summary.energy_final / elastic.summary.energy_initial, 1.0, 1e-14) << order;
    EXPECT_LE(elastic.summary.max_overlap, 1e-14) << order;
    const Outcome lossy = run(rack(0.8, 0.2), order, 3.0);
    EXPECT_LT(lossy.summary.energy_final, lossy.summary.energy_initial) << order;
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, Together, ::testing::ValuesIn(exact_policies()));

// Twenty touching discs, the left half running into the right one at 2 m/s, e = 0.7: one at a time they
// collide within the instant until nothing is left of their speeds (inelastic collapse; McNamara & Young
// 1992). The kernel counts, says `group`, and takes what is left together; momentum is 0 and stays so.
TEST(Collapse, RowThatCollidesWithoutEndIsTakenTogetherAndReported) {
  World world;
  world.materials[0].restitution = 0.7;
  for (int i = 0; i < 20; ++i)
    testing::add(world, testing::body(make_disc(0.5), {1.0 * i, 0.0}, {i < 10 ? 1.0 : -1.0, 0.0}));
  for (const std::string& policy : exact_policies()) {
    SolverOptions options;
    options.policy = policy;
    Simulator simulator(world, options);
    Events events;
    const RunSummary summary = simulator.run(testing::until(1.0), &events);
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    const auto groups = std::count_if(events.events.begin(), events.events.end(),
                                      [](const Event& e) { return e.kind == EventKind::group; });
    EXPECT_EQ(groups, 1) << policy;
    EXPECT_GT(summary.collisions, 6000U) << policy;
    EXPECT_LT(summary.energy_final, 1e-3 * summary.energy_initial) << policy;
    EXPECT_NEAR(summary.momentum.x(), 0.0, 1e-13) << policy;
    EXPECT_LE(summary.max_overlap, 1e-12) << policy;
  }
}

// What the group is does not depend on who found it: all exact policies give the same bits.
TEST(TogetherPolicies, GiveTheSameEvents) {
  for (const char* order : {"lcp", "reflections"})
    for (const double friction : {0.0, 0.3}) {
      std::vector<std::uint64_t> hashes;
      for (const std::string& policy : exact_policies()) {
        SolverOptions options;
        options.policy = policy;
        options.order = order;
        Simulator simulator(rack(0.95, friction), options);
        hashes.push_back(simulator.run(testing::until(2.0)).state_hash);
      }
      for (const std::uint64_t hash : hashes)
        EXPECT_EQ(hash, hashes[0]) << order << ", friction " << friction;
    }
}

/// Triangles and boxes on a grid in a closed room, and nothing that would bring two contacts to one instant.
World room(Random& random) {
  World world;
  world.materials[0].restitution = random.uniform(0.4, 1.0);
  world.materials[0].friction = random.uniform(0.0, 1.0);
  world.materials[0].tangential_restitution = random.uniform(-0.5, 0.5);
  testing::add(world, testing::site(make_chain({{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, true)));
  for (int k = 0; k < 4; ++k) {
    const double size = random.uniform(0.4, 0.9);
    const Shape shape =
        k % 2 == 0 ? make_box(size, 0.6 * size) : make_polygon({{0, 0}, {size, 0}, {0, size}});
    testing::add(world,
                 testing::body(shape, Vec2(k % 2 - 0.5, k / 2 - 0.5) * 1.7,
                               {random.uniform(-3, 3), random.uniform(-3, 3)}, random.uniform(0.1, 3.0),
                               random.uniform(-3, 3), random.uniform(-4, 4)));
  }
  return world;
}

// Where contacts come one by one, there is no order.
TEST(TogetherOrAlone, WithOneContactAnInstantIsTheSameUnderEveryOrder) {
  Random random(31);
  int collisions = 0;
  for (int k = 0; k < 20; ++k) {
    const World world = room(random);
    std::vector<RunSummary> ran;
    std::vector<std::vector<BodyState>> ended;
    for (const char* order : {"index", "lcp", "reflections"}) {
      SolverOptions options;
      options.order = order;
      Simulator simulator(world, options);
      if (!simulator.start_fault().empty()) break;
      ran.push_back(simulator.run(testing::until(0.7)));
      ended.push_back(simulator.states());
    }
    for (std::size_t i = 1; i < ran.size(); ++i) {
      EXPECT_EQ(ran[i].collisions, ran[0].collisions) << k;
      for (std::size_t b = 0; b < world.bodies.size(); ++b)
        EXPECT_LT((ended[i][b].pose.position - ended[0][b].pose.position).norm(), 1e-9) << k;
      collisions += static_cast<int>(ran[i].collisions);
    }
  }
  EXPECT_GT(collisions, 100);
}

// The friction of a corner that is hit beside the centre of mass pushes it together again, if that comes after the normal impulse.
TEST(TogetherOrAlone, WhatIsPulledTogetherWithoutARebound) {
  Random random(32);
  for (int k = 0; k < 60; ++k) {
    World world;
    world.materials[0].restitution = 0.0;
    world.materials[0].friction = random.uniform(0.2, 1.0);
    for (const double x : {-2.0, 2.0})
      testing::add(world, testing::body(make_box(random.uniform(0.3, 0.8), random.uniform(0.3, 0.8)),
                                        {x + random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)},
                                        {random.uniform(-1, 1), random.uniform(-2, 2)}, random.uniform(1, 4),
                                        random.uniform(-3, 3), random.uniform(-4, 4)));
    AttractForce pull;
    pull.bodies = {0, 1};
    pull.strength = 40.0;
    pull.power = 0.0;
    world.forces.emplace_back(pull);
    for (const char* order : {"lcp", "reflections"}) {
      SolverOptions options;
      options.order = order;
      const RunSummary summary = Simulator(world, options).run(testing::until(1.5));
      EXPECT_EQ(summary.termination, Termination::reached_end) << k << ", " << order << ": " << summary.why;
    }
  }
}

// The order takes impulses; the mirror response resolves one contact alone.
TEST(TogetherOptions, WithTheMirrorResponseIsABadInputThatSaysSo) {
  SolverOptions options;
  options.order = "lcp";
  options.response = "reflection";
  std::string error;
  EXPECT_FALSE(options.is_valid(&error));
  EXPECT_NE(error.find("index, closing_speed, depth, random"), std::string::npos) << error;
  options.response = "impulse";
  options.detector = "depth";
  EXPECT_FALSE(options.is_valid(&error));
}

}  // namespace
}  // namespace brink::simultaneous_test
