// The policies that take bodies back: what they waste is counted, and is bounded, and changes no event.
#include <gtest/gtest.h>

#include "tests/support/gases.h"
#include "tests/support/same_events.h"

namespace brink::backup_policies_test {
namespace {

using testing::expect_same_events;
using testing::run_under;

World small_gas() { return testing::boxed(testing::lattice_gas(49, make_disc(0.5), 0.5)); }

/// Four bodies on springs, in pairs, thrown at one another in a box: motions that integrators make.
World coupled_pairs() {
  World world;
  const Vec2 corners[] = {{-4.0, -4.0}, {4.0, -4.0}, {4.0, 4.0}, {-4.0, 4.0}};
  for (int k = 0; k < 4; ++k) {
    testing::add(world, testing::body(make_disc(0.5), 0.5 * corners[k], -0.25 * corners[(k + 1) % 4]));
    testing::add(world, testing::site(make_segment(corners[k], corners[(k + 1) % 4])));
  }
  for (const int k : {0, 2}) {
    SpringForce spring;
    spring.body_a = k;
    spring.body_b = k + 1;
    spring.stiffness = 3.0;
    spring.rest_length = 3.0;
    world.forces.push_back(spring);
  }
  return world;
}

TEST(Timewarp, GasHasTheSameEventsAsUnderGlobalBackup) {
  EXPECT_GT(expect_same_events(small_gas(), {}, 10.0), 500U);
}

// A late contact must have come at least once in so many collisions of a dense gas, and what it undid is
// counted; nobody is backed up, as nobody is taken past what may be a contact.
TEST(Timewarp, LateContactsAreRolledBackAndCounted) {
  const RunSummary run = run_under(small_gas(), {}, "timewarp", 10.0).summary;
  EXPECT_GT(run.work.rollbacks, 0U);
  EXPECT_GT(run.work.body_seconds_thrown_away, 0.0);
  EXPECT_GT(run.work.states_kept, 0U);
  EXPECT_EQ(run.work.backups, 0U);
}

// The trace tells of every body that is rolled back, and how far: as the counters do.
TEST(Timewarp, TraceShowsWhatWasRolledBack) {
  struct RollBacks : TraceSink {
    void mark(const TraceMark& m) override {
      if (m.kind != TraceKind::roll_back) return;
      ++count;
      seconds += m.from - m.to;
    }
    std::uint64_t count = 0;
    double seconds = 0.0;
  } seen;
  SolverOptions options;
  options.policy = "timewarp";
  Simulator simulator(small_gas(), options);
  RunOptions run = testing::until(10.0);
  run.trace = &seen;
  const RunSummary summary = simulator.run(run);
  EXPECT_GT(seen.count, 0U);
  EXPECT_EQ(seen.count, summary.work.rollbacks);
  EXPECT_NEAR(seen.seconds, summary.work.body_seconds_thrown_away, 1e-9 * seen.seconds);
}

// With room for no former state nobody can run ahead, so that nothing is ever rolled back.
TEST(Timewarp, KeepsNoMoreStatesThanItMay) {
  for (const std::uint64_t most : {0, 3, 8}) {
    SolverOptions options;
    options.kept_states = most;
    const auto run = run_under(small_gas(), options, "timewarp", 5.0);
    EXPECT_LE(run.summary.work.states_kept, most);
    if (most == 0) {
      EXPECT_EQ(run.summary.work.rollbacks, 0U);
    }
    EXPECT_EQ(run.summary.state_hash, run_under(small_gas(), {}, "body_clocks", 5.0).summary.state_hash);
  }
}

// Rolling a driven body back starts its integrator again where it was started before.
TEST(Timewarp, BodiesOnSpringsHaveTheSameEvents) {
  EXPECT_GT(expect_same_events(coupled_pairs(), {}, 20.0), 10U);
}

// Two clusters far from each other are two islands: a contact backs up one of them alone.
TEST(IslandBackup, BacksUpOnlyTheIslandOfTheContact) {
  World world = testing::lattice_gas(16, make_disc(0.5), 0.5);
  world.periods = {};
  const std::size_t half = world.bodies.size();
  for (std::size_t k = 0; k < half; ++k) {
    Body far = world.bodies[k];
    far.name += "'";
    far.initial.pose.position.x() += 1000.0;
    world.bodies.push_back(far);
  }
  const auto global = run_under(world, {}, "global_backup", 2.0).summary;
  const auto island = run_under(world, {}, "island_backup", 2.0).summary;
  EXPECT_GT(global.collisions, 10U);
  EXPECT_EQ(island.state_hash, global.state_hash);
  EXPECT_LE(2 * island.work.backups, global.work.backups);
  EXPECT_LT(island.work.body_seconds_thrown_away, global.work.body_seconds_thrown_away);
}

}  // namespace
}  // namespace brink::backup_policies_test
