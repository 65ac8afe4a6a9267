#pragma once
/// Random worlds by their seeds: which of them a test looks at, once more under another policy, and kept where they fail.

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

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
