#pragma once
/// One problem under one setting: how wrong, how long, how much was missed.

#include "brink/scenes/bench/problems.h"

namespace brink::bench {

struct Setting {
  std::string series;        ///< what is joined by a line in the plot: "body_clocks", "erk", "fixed_step"
  std::string label;         ///< its tolerance or step
  bool approximate = false;  ///< a policy that may miss contacts
  SolverOptions options;
};

/// Every exact policy with the motions as they are; the default policy over integrators and tolerances; the
/// approximate policies over steps.
std::vector<Setting> settings(const Problem& problem);

struct Row {
  std::string problem;
  Setting setting;
  double error = 0.0;
  double wall_seconds = 0.0;  ///< median of the repeats, the simulation alone
  int repeats = 0;
  std::size_t expected = 0, collisions = 0;
  std::size_t missed = 0;  ///< impacts that never came
  RunSummary summary;      ///< of the last repeat
  bool same_hash = true;   ///< all repeats gave the same bits
};

/// Repeats up to `repeats` times or until a second has gone by.
Row measure(const Problem& problem, const Setting& setting, int repeats);

}  // namespace brink::bench
