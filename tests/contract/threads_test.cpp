// Any number of threads gives the same events, frames, states and counts of work, to the bit: threads find ahead what one
// of them would have found, and change nothing. Stopped and gone on with by another number, too.
#include <gtest/gtest.h>

#include <map>

#include "brink/core/base/error.h"
#include "tests/support/gases.h"
#include "tests/support/lasting_worlds.h"
#include "tests/support/same_events.h"

namespace brink::threads_test {
namespace {

using testing::boxed;
using testing::lattice_gas;

/// Counts of work; of seconds none.
std::map<std::string, double> counts(const WorkCounters& work) {
  std::map<std::string, double> all;
  WorkCounters::for_each(work, [&](const std::string& name, auto value, auto) {
    if (name.rfind("seconds_", 0) != 0) all[name] = static_cast<double>(value);
  });
  return all;
}

testing::Ran run(const World& world, const SolverOptions& solver, RunOptions options, int threads) {
  options.threads = threads;
  Simulator simulator(world, solver);
  testing::Ran ran;
  ran.summary = simulator.run(options, &ran.events);
  return ran;
}

void expect_same(const testing::Ran& one, const testing::Ran& more, const std::string& where) {
  EXPECT_EQ(more.summary.termination_text(), one.summary.termination_text()) << where;
  EXPECT_EQ(more.summary.why, one.summary.why) << where;
  EXPECT_EQ(more.summary.state_hash, one.summary.state_hash) << where;
  EXPECT_EQ(more.events.frame_times, one.events.frame_times) << where;
  EXPECT_EQ(counts(more.summary.work), counts(one.summary.work)) << where;
  const auto &a = one.events.events, &b = more.events.events;
  ASSERT_EQ(a.size(), b.size()) << where;
  for (std::size_t i = 0; i < a.size(); ++i)
    ASSERT_TRUE(testing::same(a[i], b[i])) << where << ", event " << i << ": " << testing::text(b[i]);
}

/// With 2 and 4 threads, and in parts, each by another number of threads and from a snapshot; returns the collisions.
std::uint64_t expect_same_for_any_number(const World& world, const SolverOptions& solver, double end) {
  RunOptions options = testing::until(end);
  options.frame_interval = end / 7.0;
  const testing::Ran one = run(world, solver, options, 1);
  for (const int threads : {2, 4})
    expect_same(one, run(world, solver, options, threads), std::to_string(threads));
  if (one.summary.termination != Termination::reached_end) return one.summary.collisions;
  std::vector<std::byte> snapshot;
  std::uint64_t hash = 0;
  for (int part = 1; part <= 5; ++part) {
    Simulator simulator(world, solver);
    if (!snapshot.empty()) simulator.restore(snapshot);
    options.until = part == 5 ? end : end * part / 5.0;
    options.threads = 1 + part % 3;
    hash = simulator.run(options).state_hash;
    snapshot = simulator.snapshot();
  }
  EXPECT_EQ(hash, one.summary.state_hash) << "in parts";
  return one.summary.collisions;
}

std::uint64_t expect_same_for_any_number(const World& world, double end) {
  return expect_same_for_any_number(world, SolverOptions(), end);
}

/// A zigzag of wire.
Shape wire() { return make_chain({{-0.5, -0.2}, {-0.1, 0.3}, {0.2, -0.3}, {0.5, 0.2}}, false, 0.0); }

/// Neighbours in a row joined two and two, or all of a row in one chain.
World on_springs(World world, bool chains) {
  const int n = static_cast<int>(world.bodies.size()), side = static_cast<int>(std::ceil(std::sqrt(n)));
  for (int k = 0; k + 1 < n; k += chains ? 1 : 2) {
    if (k % side + 1 == side) continue;
    SpringForce spring;
    spring.body_a = k;
    spring.body_b = k + 1;
    spring.stiffness = 2.0;
    spring.damping = k % 3 == 0 ? 0.1 : 0.0;
    spring.rest_length =
        (world.bodies[k].initial.pose.position - world.bodies[k + 1].initial.pose.position).norm();
    world.forces.emplace_back(spring);
  }
  return world;
}

TEST(Threads, GivesTheSameBitsForStars) {
  EXPECT_GT(expect_same_for_any_number(boxed(lattice_gas(300, testing::star(7, 0.5, 0.7), 0.4, 1.0)), 1.5),
            300U);
  EXPECT_GT(expect_same_for_any_number(lattice_gas(100, testing::star(5, 0.5, 0.5), 0.3, 2.0), 2.0), 50U);
}

TEST(Threads, GivesTheSameBitsForBoxes) {
  EXPECT_GT(expect_same_for_any_number(boxed(lattice_gas(400, make_box(1.0, 0.6), 0.4, 1.0)), 2.0), 300U);
}

TEST(Threads, GivesTheSameBitsForDiscs) {
  const World world = boxed(lattice_gas(500, make_disc(0.5), 0.5));
  EXPECT_GT(expect_same_for_any_number(world, 2.0), 500U);
  SolverOptions general;
  general.closed_forms = false;
  EXPECT_GT(expect_same_for_any_number(world, general, 1.0), 200U);
  // nobody looks on: the quick way
  RunOptions options = testing::until(4.0);
  std::uint64_t hashes[2];
  for (const int more : {0, 1}) {
    Simulator simulator(world, SolverOptions());
    options.threads = 1 + more;
    const RunSummary summary = simulator.run(options);
    EXPECT_GT(summary.work.collisions_quick, 500U);
    hashes[more] = summary.state_hash;
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Threads, GivesTheSameBitsForWires) {
  EXPECT_GT(expect_same_for_any_number(boxed(lattice_gas(150, wire(), 0.3, 1.0)), 1.0), 20U);
}

TEST(Threads, GivesTheSameBitsOnSprings) {
  EXPECT_GT(expect_same_for_any_number(on_springs(boxed(lattice_gas(100, make_disc(0.5), 0.3)), false), 1.5),
            30U);
  EXPECT_GT(
      expect_same_for_any_number(on_springs(boxed(lattice_gas(64, make_box(0.8, 0.5), 0.3, 1.0)), true), 1.0),
      15U);
  SolverOptions solver;
  for (const char* integrator : {"rk4", "adams"}) {
    solver.integrator = integrator;
    EXPECT_GT(expect_same_for_any_number(on_springs(boxed(lattice_gas(36, make_disc(0.5), 0.3)), false),
                                         solver, 1.0),
              5U);
  }
}

TEST(Threads, GivesTheSameBitsUnderEveryPolicyAndOrder) {
  const World world = on_springs(boxed(lattice_gas(49, testing::star(5, 0.5, 0.6), 0.35, 1.0)), false);
  SolverOptions solver;
  for (const std::string& policy : exact_policies()) {
    solver.policy = policy;
    expect_same_for_any_number(world, solver, 0.5);
  }
  solver.policy = "body_clocks";
  for (const Choice& order : orders()) {
    solver.order = order.name;
    expect_same_for_any_number(world, solver, 0.5);
  }
}

// Islands form and are let go, sites move, forces pull: components fall asleep, and wake.
TEST(Threads, GivesTheSameBitsWhereContactsLast) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const testing::LastingWorld made = testing::LastingWorldMaker(seed).make();
    SolverOptions solver;
    solver.order = made.order;
    solver.island_tolerance = made.island_tolerance;
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_same_for_any_number(made.world, solver, 0.5 * made.duration);
  }
}

// A motion that fails ends the run where it would: a force that is no number from some time on.
TEST(Threads, FailAsOneDoes) {
  World world = on_springs(boxed(lattice_gas(36, make_disc(0.5), 0.3)), false);
  FormulaForce force;
  force.bodies = {7};
  force.fx = Formula("sqrt(0.8 - t)", force_formula_variables());
  world.forces.emplace_back(force);
  const RunOptions options = testing::until(3.0);
  const testing::Ran one = run(world, SolverOptions(), options, 1);
  EXPECT_EQ(one.summary.termination, Termination::failed);
  for (const int threads : {2, 4})
    expect_same(one, run(world, SolverOptions(), options, threads), std::to_string(threads));
}

// From within, as a signal does: at the next chance; and gone on with by one thread.
TEST(Threads, StopWhenAsked) {
  const World world = on_springs(boxed(lattice_gas(100, make_disc(0.5), 0.3)), false);
  RunOptions options = testing::until(1.0);
  Simulator undisturbed(world, SolverOptions());
  undisturbed.run(options);
  Simulator simulator(world, SolverOptions());
  options.threads = 3;
  options.progress = [](double t, std::uint64_t) { return t < 0.4; };
  EXPECT_EQ(simulator.run(options).termination, Termination::stopped);
  EXPECT_LT(simulator.time(), 1.0);
  options.threads = 1;
  options.progress = {};
  simulator.run(options);
  EXPECT_EQ(simulator.state_hash(), undisturbed.state_hash());
}

TEST(Threads, AreAtLeastOne) {
  Simulator simulator(boxed(lattice_gas(4, make_disc(0.5), 0.3)), SolverOptions());
  RunOptions options = testing::until(1.0);
  for (const int threads : {0, -1, 65}) {
    options.threads = threads;
    EXPECT_THROW(simulator.run(options), BadInput);
  }
}

}  // namespace
}  // namespace brink::threads_test
