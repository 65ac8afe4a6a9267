// What holds of every policy in the list.
#include "brink/scheduler/policies/policy.h"

#include <gtest/gtest.h>

#include <string>

#include "brink/scheduler/kernel/stage_clock.h"
#include "tests/support/gases.h"
#include "tests/support/same_events.h"

namespace brink::policies_test {
namespace {

/// Boxes, whose searches have no closed form.
World gas() { return testing::boxed(testing::lattice_gas(36, make_box(0.9, 0.7), 0.3)); }

// One search of many is timed and counts for all.
TEST(Policies, TimeTheirSearches) {
  for (const std::string& policy : exact_policies()) {
    const RunSummary s = testing::run_under(gas(), {}, policy, 3.0).summary;
    EXPECT_GT(s.collisions, 100U) << policy;
    EXPECT_GT(s.work.pair_searches, 100U) << policy;
    EXPECT_GT(s.work.seconds_search, 0.0) << policy;
    // one search of several is timed and counts for all, which on a busy machine may come to more than there was
    EXPECT_LT(s.work.seconds_search, StageTimer::Sampled::kEvery * s.wall_seconds) << policy;
  }
}

// Who keeps all pairs at once is refused where these do not fit into memory; body_clocks never asks for them.
TEST(Policies, TooManyPairsAreRefusedWhereTheyAreKept) {
  World world;
  for (int k = 0; k < 5000; ++k)
    testing::add(world, testing::body(make_disc(0.1), {1.0 * (k % 100), 1.0 * (k / 100)}, {0.0, 0.0}));
  SolverOptions options;
  options.broad_phase = false;
  for (const std::string& policy : exact_policies()) {
    options.policy = policy;
    if (policy == "body_clocks") {
      EXPECT_NO_THROW(Simulator(world, options));
      continue;
    }
    try {
      Simulator(world, options);
      ADD_FAILURE() << policy;
    } catch (const BadInput& e) {
      EXPECT_NE(std::string(e.what()).find("5000 bodies and 0 sites make 1.25e+07 pairs"), std::string::npos)
          << e.what();
    }
  }
}

TEST(Policies, AreMadeByTheirNames) {
  for (const auto& p : policies()) {
    EXPECT_NE(make_policy(p.name), nullptr) << p.name;
    EXPECT_FALSE(p.summary.empty()) << p.name;
  }
  EXPECT_THROW(make_policy("nobody"), BadInput);
}

}  // namespace
}  // namespace brink::policies_test
