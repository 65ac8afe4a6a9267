/// What elastic collisions keep, and what choices of the solver must not change.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <numbers>

#include "brink/core/base/random.h"
#include "brink/core/world/forces.h"
#include "tests/support/worlds.h"

namespace brink::conservation_test {
namespace {

using testing::Events;

constexpr double kCell = 1.0;

/// side x side bodies, one a cell of 1 m about the origin: discs and boxes by turns, or all discs. Random
/// speeds up to 1 m/s a coordinate, boxes spin; every size fits its cell whatever its angle.
World gas(int side, bool boxes, std::uint64_t seed) {
  World world;
  Random random(seed);
  const double corner = -0.5 * kCell * (side - 1);
  for (int k = 0; k < side * side; ++k) {
    const Vec2 at(corner + kCell * (k % side), corner + kCell * (k / side));
    const Vec2 v(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const bool box = boxes && (k + k / side) % 2 == 0;
    const Shape shape = box ? make_box(0.6, 0.4) : make_disc(random.uniform(0.2, 0.4));
    testing::add(world, testing::body(shape, at, v, random.uniform(0.5, 2.0), random.uniform(0.0, 6.0),
                                      box ? random.uniform(-3.0, 3.0) : 0.0));
  }
  return world;
}

void add_walls(World& world, double half) {
  const Vec2 corners[] = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  for (int k = 0; k < 4; ++k)
    testing::add(world, testing::site(make_segment(corners[k], corners[(k + 1) % 4])));
}

World gas_in_a_box(int side, std::uint64_t seed) {
  World world = gas(side, true, seed);
  add_walls(world, 0.5 * kCell * side);
  return world;
}

struct Outcome {
  RunSummary summary;
  std::vector<Event> hits;
};

Outcome outcome(const World& world, const SolverOptions& options, double end) {
  Simulator simulator(world, options);
  Events events;
  Outcome o;
  RunOptions run = testing::until(end);
  const auto begin = std::chrono::steady_clock::now();
  run.progress = [begin](double, std::uint64_t) {  // a run that hangs fails
    return std::chrono::steady_clock::now() - begin < std::chrono::seconds(30);
  };
  o.summary = simulator.run(run, &events);
  EXPECT_EQ(o.summary.termination, Termination::reached_end) << o.summary.why;
  o.hits = events.collisions();
  return o;
}

/// Equal bit for bit: who, when, where, and the impulse.
bool same(const Event& a, const Event& b) {
  return a.contact.time == b.contact.time && a.contact.body == b.contact.body &&
         a.contact.other_body == b.contact.other_body && a.contact.other_site == b.contact.other_site &&
         a.contact.site == b.contact.site && a.contact.sample == b.contact.sample &&
         a.contact.point == b.contact.point && a.contact.normal == b.contact.normal &&
         a.impulse_n == b.impulse_n && a.impulse_t == b.impulse_t;
}

void expect_same(const Outcome& a, const Outcome& b) {
  ASSERT_EQ(a.hits.size(), b.hits.size());
  for (std::size_t k = 0; k < a.hits.size(); ++k)
    ASSERT_TRUE(same(a.hits[k], b.hits[k]))
        << "event " << k << " at t = " << a.hits[k].contact.time << " and " << b.hits[k].contact.time;
  EXPECT_EQ(a.summary.state_hash, b.summary.state_hash);
}

double relative_drift(const RunSummary& s) { return std::abs(s.energy_final / s.energy_initial - 1.0); }

// Each collision rounds the energy a few times and their errors add up like a random walk or at worst in a
// row: 2000 collisions at some 1e-16 each stay below 1e-12.
TEST(ElasticGas, DiscsAndBoxesInABoxKeepTheirEnergy) {
  const Outcome o = outcome(gas_in_a_box(8, 11), {}, 20.0);
  printf("64 discs and boxes: %zu collisions, energy drift %.1e, deepest overlap %.1e m\n", o.hits.size(),
         relative_drift(o.summary), o.summary.max_overlap);
  EXPECT_GT(o.hits.size(), 1000U);
  EXPECT_LE(relative_drift(o.summary), 1e-12);
  EXPECT_LE(o.summary.max_overlap, 1e-12);
}

// Under uniform gravity kinetic and potential energy change into each other; their sum is kept.
TEST(ElasticGas, UnderGravityTheSumOfBothEnergiesIsKept) {
  World world = gas_in_a_box(5, 12);
  world.gravity = {0.0, -9.81};
  const Outcome o = outcome(world, {}, 5.0);
  const double scale = std::abs(o.summary.energy_initial);
  const double drift = std::abs(o.summary.energy_final - o.summary.energy_initial) / scale;
  printf("25 bodies under gravity: %zu collisions, energy drift %.1e\n", o.hits.size(), drift);
  EXPECT_GT(o.hits.size(), 200U);
  EXPECT_LE(drift, 1e-11);
}

// In free space nothing acts from outside: linear and angular momentum stay, bodies of unlike mass and spin
// alike.
TEST(ElasticGas, InFreeSpaceMomentumAndEnergyStay) {
  World world = gas(6, true, 13);
  for (Body& b : world.bodies)
    b.initial.twist.velocity -= 0.3 * b.initial.pose.position;  // they fall together
  const auto states = [&] {
    std::vector<BodyState> s;
    for (const Body& b : world.bodies) s.push_back(b.initial);
    return s;
  }();
  const Momentum before = total_momentum(world, states);
  const Outcome o = outcome(world, {}, 6.0);
  double sum = 0.0, turning = 0.0;  // of the absolute values, to judge roundings by
  for (const Body& b : world.bodies) {
    sum += b.mass * b.initial.twist.velocity.norm();
    turning += b.mass * b.initial.twist.velocity.norm() * (b.initial.pose.position.norm() + 6.0);
  }
  const double linear = (o.summary.momentum - before.linear).norm() / sum;
  const double angular = std::abs(o.summary.angular_momentum - before.angular) / turning;
  printf("36 bodies in free space: %zu collisions, momentum drift %.1e, angular %.1e, energy %.1e\n",
         o.hits.size(), linear, angular, relative_drift(o.summary));
  EXPECT_GT(o.hits.size(), 50U);
  EXPECT_LE(linear, 1e-14);
  EXPECT_LE(angular, 1e-13);
  EXPECT_LE(relative_drift(o.summary), 1e-13);
}

/// A choice that must not change what happens.
struct Choice {
  const char* name;
  std::function<void(SolverOptions&)> choose;
};
void PrintTo(const Choice& c, std::ostream* out) { *out << c.name; }

class SameEvents : public ::testing::TestWithParam<Choice> {};

// Candidates, moving bounds and quadratics only leave out work that could not have found a contact earlier.
TEST_P(SameEvents, DiscsAndBoxesMeetAtTheSameBits) {
  const World world = gas_in_a_box(5, 21);
  SolverOptions other;
  GetParam().choose(other);
  const Outcome plain = outcome(world, {}, 6.0);
  ASSERT_GT(plain.hits.size(), 100U);
  expect_same(plain, outcome(world, other, 6.0));
}

TEST_P(SameEvents, FallingDiscsMeetAtTheSameBits) {
  World world = gas(5, false, 22);
  add_walls(world, 2.5);
  world.gravity = {0.0, -9.81};
  SolverOptions other;
  GetParam().choose(other);
  const Outcome plain = outcome(world, {}, 3.0);
  ASSERT_GT(plain.hits.size(), 100U);
  expect_same(plain, outcome(world, other, 3.0));
}

INSTANTIATE_TEST_SUITE_P(
    WorkLeftOutOrNot, SameEvents,
    ::testing::Values(Choice{"detector_pass", [](SolverOptions& o) { o.detector = "pass"; }},
                      Choice{"no_closed_forms", [](SolverOptions& o) { o.closed_forms = false; }},
                      Choice{"fields_for_all", [](SolverOptions& o) { o.fields_for_small_shapes = true; }},
                      Choice{"no_broad_phase", [](SolverOptions& o) { o.broad_phase = false; }},
                      Choice{"a_field_each",
                             [](SolverOptions& o) {
                               o.fields_for_small_shapes = true;
                               o.share_fields = false;
                             }}),
    [](const auto& choice) { return std::string(choice.param.name); });

class Orders : public ::testing::TestWithParam<const char*> {};

// A rack of touching discs broken by a fast one: many contacts at one moment, taken in any order, one at a
// time. Each single collision keeps energy and momentum, so any order does.
TEST_P(Orders, BreakShotKeepsEnergyAndMomentum) {
  World world;
  const double radius = 0.25, pitch = 2.0 * radius;
  for (int row = 0; row < 5; ++row)
    for (int k = 0; k <= row; ++k)
      testing::add(world, testing::body(make_disc(radius),
                                        {pitch * row * std::numbers::sqrt3 / 2.0, pitch * (k - 0.5 * row)},
                                        {0.0, 0.0}));
  testing::add(world, testing::body(make_disc(radius), {-2.0, 0.0}, {5.0, 0.0}));
  SolverOptions options;
  options.order = GetParam();
  const Outcome o = outcome(world, options, 3.0);
  printf("%s: %zu collisions, energy drift %.1e\n", GetParam(), o.hits.size(), relative_drift(o.summary));
  EXPECT_GE(o.hits.size(), 14U);
  EXPECT_LE(relative_drift(o.summary), 1e-13);
  EXPECT_NEAR(o.summary.momentum.x(), 5.0, 1e-13);
  EXPECT_NEAR(o.summary.momentum.y(), 0.0, 1e-13);
}

TEST_P(Orders, GasKeepsItsEnergy) {
  SolverOptions options;
  options.order = GetParam();
  const Outcome o = outcome(gas_in_a_box(5, 23), options, 6.0);
  EXPECT_GT(o.hits.size(), 100U);
  EXPECT_LE(relative_drift(o.summary), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(OneAtATime, Orders, ::testing::Values("index", "closing_speed", "depth", "random"));

}  // namespace
}  // namespace brink::conservation_test
