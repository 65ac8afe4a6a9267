#pragma once
/// Random worlds by their seeds: which of them a test looks at, once more under another policy, and kept where they fail.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/policies/policy.h"
#include "tests/support/worlds.h"

namespace brink::testing {

/// A number that the user gave (BRINK_SEED, BRINK_WORLDS), or else another.
inline std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

/// Writes a scene that failed to the folder `BRINK_KEEP`, if that is set.
inline void keep(const std::string& name, const std::string& text) {
  const char* folder = std::getenv("BRINK_KEEP");
  if (!folder) return;
  std::filesystem::create_directories(folder);
  std::ofstream(std::filesystem::path(folder) / name) << text;
}

/// Calls check(seed) for the seeds from 1 on, or those that BRINK_SEED and BRINK_WORLDS name, and keeps scene_of(seed) where
/// an expectation fails in it.
template <typename SceneOf, typename Check>
void for_each_world(std::uint64_t worlds, SceneOf scene_of, Check check) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1);
  for (std::uint64_t seed = first; seed < first + from_environment("BRINK_WORLDS", worlds); ++seed) {
    SCOPED_TRACE(fmt::format("BRINK_SEED={} BRINK_WORLDS=1", seed));
    const auto failures = [] {
      return ::testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
    };
    const int before = failures();
    check(seed);
    if (failures() > before) keep(fmt::format("seed_{}.toml", seed), scene_of(seed));
  }
}

/// Expects that a scene ends with the same bits under every exact policy, each stopped at a random time and gone on with by
/// another simulator. Returns how it ends.
inline RunSummary expect_same_bits(const std::string& text, std::uint64_t seed) {
  const Scene scene = parse_scene(text, fmt::format("seed_{}", seed));
  const RunSummary told = Simulator(scene.world, scene.solver).run(until(scene.duration));
  Random random(seed);
  for (const std::string& policy : exact_policies()) {
    SolverOptions solver = scene.solver;
    solver.policy = policy;
    const double stop = random.uniform(0.0, scene.duration);
    Simulator stopped(scene.world, solver), goes_on(scene.world, solver);
    if (stopped.run(until(stop)).termination == Termination::reached_end) goes_on.restore(stopped.snapshot());
    const RunSummary s = goes_on.run(until(scene.duration));
    EXPECT_EQ(s.why, told.why) << policy << ", stopped at " << stop;
    EXPECT_EQ(s.collisions, told.collisions) << policy << ", stopped at " << stop;
    EXPECT_EQ(s.state_hash, told.state_hash) << policy << ", stopped at " << stop;
  }
  return told;
}

/// The same world under the exact policy that the seed names, stopped after every part of the way: "" if it ends as `first`
/// did, bit for bit, else under which policy it does not.
inline std::string stopped_under_another_policy(const World& world, SolverOptions solver, RunOptions options,
                                                int parts, std::uint64_t seed, const RunSummary& first) {
  solver.policy = exact_policies()[seed % exact_policies().size()];
  Simulator other(world, solver);
  const double end = options.until;
  RunSummary last;
  for (int part = 1; part <= parts && (part == 1 || last.termination == Termination::reached_end); ++part) {
    options.until = part == parts ? end : end * part / parts;  // the last to the bit
    last = other.run(options);
  }
  const bool same = last.state_hash == first.state_hash && last.termination == first.termination;
  return same ? "" : "other bits under " + solver.policy;
}

}  // namespace brink::testing
