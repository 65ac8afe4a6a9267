// What holds of every policy in the list.
#include "brink/scheduler/policies/policy.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/gases.h"
#include "tests/support/same_events.h"

namespace brink::policies_test {
namespace {

/// Boxes, whose searches have no closed form.
World gas() { return testing::boxed(testing::lattice_gas(36, make_box(0.9, 0.7), 0.3)); }

// One search in sixteen is timed and counts for all, so that there must be many.
TEST(Policies, TimeTheirSearches) {
  for (const std::string& policy : exact_policies()) {
    const RunSummary s = testing::run_under(gas(), {}, policy, 3.0).summary;
    EXPECT_GT(s.collisions, 100U) << policy;
    EXPECT_GT(s.work.pair_searches, 100U) << policy;
    EXPECT_GT(s.work.seconds_search, 0.0) << policy;
    EXPECT_LT(s.work.seconds_search, s.wall_seconds) << policy;
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
