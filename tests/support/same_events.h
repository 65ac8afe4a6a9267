#pragma once
/// One world under every exact policy, compared event by event.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <string>

#include "brink/scheduler/policies/policy.h"
#include "tests/support/worlds.h"

namespace brink::testing {

/// Every exact policy but global_backup, with which they are compared.
inline std::vector<std::string> other_exact_policies() {
  std::vector<std::string> names = exact_policies();
  std::erase(names, "global_backup");
  return names;
}

inline std::string text(const Event& e) {
  return std::string(to_string(e.kind)) + " at " + std::to_string(e.contact.time) + " of " +
         std::to_string(e.contact.body) + " on body " + std::to_string(e.contact.other_body) + " / site " +
         std::to_string(e.contact.other_site);
}

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline bool same(const Event& a, const Event& b) {
  const Contact &x = a.contact, &y = b.contact;
  return a.kind == b.kind && a.seq == b.seq && same_bits(x.time, y.time) &&
         same_bits(x.time_low, y.time_low) && x.body == y.body && x.other_body == y.other_body &&
         x.other_site == y.other_site && x.site == y.site && x.sample == y.sample &&
         x.sample_on_body == y.sample_on_body && same_bits(x.point.x(), y.point.x()) &&
         same_bits(x.point.y(), y.point.y()) && same_bits(x.normal.x(), y.normal.x()) &&
         same_bits(x.normal.y(), y.normal.y()) && same_bits(x.closing_speed, y.closing_speed) &&
         same_bits(x.gap, y.gap) && same_bits(a.impulse_n, b.impulse_n) &&
         same_bits(a.impulse_t, b.impulse_t);
}

struct Ran {
  Events events;
  RunSummary summary;
};

inline Ran run_under(const World& world, SolverOptions options, const std::string& policy, double end) {
  options.policy = policy;
  Simulator simulator(world, options);
  Ran r;
  RunOptions run_options = until(end);
  run_options.frame_interval = end / 7.0;
  r.summary = simulator.run(run_options, &r.events);
  return r;
}

/// Runs the world with every exact policy; returns the number of collisions.
inline std::uint64_t expect_same_events(const World& world, const SolverOptions& options, double end) {
  const Ran reference = run_under(world, options, "global_backup", end);
  for (const std::string& policy : other_exact_policies()) {
    const Ran other = run_under(world, options, policy, end);
    EXPECT_EQ(other.summary.termination_text(), reference.summary.termination_text()) << policy;
    const auto &a = reference.events.events, &b = other.events.events;
    EXPECT_EQ(a.size(), b.size()) << policy;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
      if (!same(a[i], b[i])) {
        ADD_FAILURE() << policy << ", event " << i << " of " << a.size() << ": " << text(b[i])
                      << ", but global_backup: " << text(a[i]);
        break;
      }
    EXPECT_EQ(other.summary.state_hash, reference.summary.state_hash) << policy;
    EXPECT_EQ(other.events.frame_times, reference.events.frame_times) << policy;
  }
  return reference.summary.collisions;
}

}  // namespace brink::testing
