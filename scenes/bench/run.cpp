/// What is compared with what:
///
///     exact policies              motions as they are, at the default tolerance
///     erk, adams, bdf             the default policy; tolerances from 1e-4 (driven) or 1e-6 to 1e-12
///     rk4                         where forces drive the body: steps
///     approximate policies        steps; these may miss contacts
///
/// Errors are of single runs, which repeat bit for bit; times are medians of repeats.
#include "brink/scenes/bench/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "brink/scenes/bench/hits.h"
#include "brink/scheduler/policies/policy.h"

namespace brink::bench {
namespace {

/// Steps beyond which a setting is left out, as it would take too long.
constexpr double kMostSteps = 1e6, kMostIntegratorSteps = 1e5;
/// Of repeats, together [s].
constexpr double kMostSeconds = 1.0;

/// One run from the beginning in a simulator of its own. Checkpoints would take time that is not the
/// simulation's.
Outcome run_once(const Problem& problem, const SolverOptions& options) {
  Simulator simulator(problem.world, options);
  Hits hits;
  RunOptions run;
  run.until = problem.until;
  run.checkpoint_seconds = -1.0;
  Outcome outcome;
  outcome.summary = simulator.run(run, &hits);
  outcome.hits = std::move(hits.times);
  outcome.states = simulator.states();
  return outcome;
}

/// An integrator over tolerances: five where it has work to do, two where motions are known in closed form
/// anyway.
void add_tolerances(const char* integrator, bool driven, std::vector<Setting>& all) {
  for (const int digits : driven ? std::vector{4, 6, 8, 10, 12} : std::vector{6, 12}) {
    Setting s{integrator, fmt::format("tolerance 1e-{}", digits), false, {}};
    s.options.integrator = integrator;
    s.options.tolerance = std::pow(10.0, -digits);
    // Two digits below the relative one, for places near 0.
    s.options.absolute_tolerance = 0.01 * s.options.tolerance;
    all.push_back(s);
  }
}

/// Steps of 10 ms to 10 us, but those that would make too many. `choose` sets what the step is of.
void add_steps(const Problem& problem, const char* series, bool approximate,
               const std::function<void(SolverOptions&)>& choose, std::vector<Setting>& all) {
  for (const int digits : {2, 3, 4, 5}) {
    Setting s{series, fmt::format("step 1e-{} s", digits), approximate, {}};
    s.options.step = std::pow(10.0, -digits);
    choose(s.options);
    if (problem.until / s.options.step <= (approximate ? kMostSteps : kMostIntegratorSteps)) all.push_back(s);
  }
}

}  // namespace

std::vector<Setting> settings(const Problem& problem) {
  std::vector<Setting> all;
  // Every policy that is exact, also one that the program has added.
  for (const Choice& policy : policies()) {
    if (make_policy(policy.name)->approximate()) continue;
    Setting s{std::string(policy.name), problem.driven ? "default tolerance" : "closed form", false, {}};
    s.options.policy = policy.name;
    all.push_back(s);
  }
  for (const char* integrator : {"erk", "adams", "bdf"}) add_tolerances(integrator, problem.driven, all);
  if (problem.driven)
    add_steps(
        problem, "rk4", false, [](SolverOptions& o) { o.integrator = "rk4"; }, all);
  for (const Choice& policy : policies())
    if (make_policy(policy.name)->approximate())
      add_steps(
          problem, policy.name.data(), true, [&](SolverOptions& o) { o.policy = policy.name; }, all);
  return all;
}

Row measure(const Problem& problem, const Setting& setting, int repeats) {
  Row row;
  row.problem = problem.name;
  row.setting = setting;
  row.expected = problem.hits.size();
  std::vector<double> seconds;
  double spent = 0.0;
  // At least once, however long it takes.
  for (int k = 0; k < repeats && (k == 0 || spent < kMostSeconds); ++k) {
    const Outcome outcome = run_once(problem, setting.options);
    // The simulation must not depend on what was run before in this process.
    if (k > 0 && outcome.summary.state_hash != row.summary.state_hash) row.same_hash = false;
    row.summary = outcome.summary;
    // The same for all repeats while their bits are.
    row.error = problem.error(problem, outcome);
    row.collisions = outcome.hits.size();
    seconds.push_back(outcome.summary.wall_seconds);
    spent += seconds.back();
  }
  // Contacts that are more than expected are none that were missed.
  row.missed = row.expected - std::min(row.expected, row.collisions);
  row.repeats = static_cast<int>(seconds.size());
  // The upper median: one slow run in three does not count.
  std::nth_element(seconds.begin(), seconds.begin() + row.repeats / 2, seconds.end());
  row.wall_seconds = seconds[row.repeats / 2];
  return row;
}

}  // namespace brink::bench
