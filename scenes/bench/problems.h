#pragma once
/// Problems with known answers, and how far a run is from them.

#include <functional>
#include <string>
#include <vector>

#include "brink/scheduler/simulator/simulator.h"

namespace brink::bench {

inline constexpr double kGravity = 9.81;  ///< [m/s^2]

/// What a run of a problem gave.
struct Outcome {
  RunSummary summary;
  std::vector<double> hits;       ///< times of all collisions [s], in order
  std::vector<BodyState> states;  ///< at the end
};

struct Problem {
  std::string name, title;
  std::string error_of;  ///< what the error is, with its unit: "worst impact time [s]"
  World world;
  double until = 1.0;        ///< [s]
  std::vector<double> hits;  ///< known times of all collisions [s], in order
  bool driven = false;       ///< integrators matter: no motion in closed form
  /// Distance from the answer, >= 0.
  std::function<double(const Problem&, const Outcome&)> error;
};

/// Every problem, in the order in which they are run.
std::vector<Problem> problems();

}  // namespace brink::bench
