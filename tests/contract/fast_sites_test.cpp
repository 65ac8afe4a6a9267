// Sites that fly away faster than anything of the scene, or come as fast: the run ends, and soon.
#include <gtest/gtest.h>

#include <chrono>

#include "brink/scenes/scene/scene.h"
#include "tests/support/same_events.h"

namespace brink::fast_sites_test {
namespace {

/// A run that somebody waits for in vain is stopped.
RunSummary run(const std::string& motion, const std::string& policy) {
  const Scene scene = parse_scene(
      "[world]\nduration = 10\n[[bodies]]\ndisc.radius = 0.5\n"
      "[[sites]]\nsegment = [[100, -10], [100, 10]]\nmotion = { " +
          motion + " }\n",
      "fast.toml", {"solver.policy=" + policy});
  Simulator simulator(scene.world, scene.solver);
  RunOptions options = testing::until(scene.duration);
  const auto begin = std::chrono::steady_clock::now();
  options.progress = [begin](double, std::uint64_t) {
    return std::chrono::steady_clock::now() - begin < std::chrono::seconds(20);
  };
  return simulator.run(options);
}

class FastSites : public ::testing::TestWithParam<std::string> {};

TEST_P(FastSites, ThatFlyAwayAreNotLookedAtForEver) {
  for (const char* motion :
       {"velocity = [1e9, 0]", "velocity = [1e15, 0]", "x = \"1e12*t\"", "x = \"1e100*t\""}) {
    const RunSummary summary = run(motion, GetParam());
    EXPECT_EQ(summary.termination, Termination::reached_end) << motion << ": " << summary.why;
    EXPECT_EQ(summary.collisions, 0U) << motion;
  }
}

// It is at the disc near t = 1 s, and there for no time that a clock could tell.
TEST_P(FastSites, ThatComeAreToldToBeTooFast) {
  const RunSummary summary = run("x = \"-100 - 1e13*(t - 1)\"", GetParam());
  EXPECT_EQ(summary.termination, Termination::failed) << summary.why;
  EXPECT_NE(summary.why.find("too fast for the clock"), std::string::npos) << summary.why;
}

INSTANTIATE_TEST_SUITE_P(Policies, FastSites, ::testing::ValuesIn(exact_policies()),
                         [](const auto& policy) { return policy.param; });

}  // namespace
}  // namespace brink::fast_sites_test
