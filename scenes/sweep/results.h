#pragma once
/// What is kept of one run of a sweep.

#include <map>
#include <string>
#include <vector>

#include "brink/scheduler/run/recorder.h"

namespace brink {

struct SweepResult {
  std::string termination;                ///< "reached_end", "stopped: why", "failed: why"
  std::string state_hash;                 ///< 16 hexadecimal digits; empty if the run could not start
  std::map<std::string, double> numbers;  ///< by column; NaN where there is none
};

/// Names of the numbers: end_time, collisions, wall_seconds, energy_initial, energy_final, energy_drift
/// (relative), momentum_x, momentum_y, angular_momentum, max_overlap, groups_taken,
/// energy_taken, and every work counter.
const std::vector<std::string>& sweep_columns();

/// "s", "J", "kg m/s"; empty for a number without a unit.
std::string sweep_unit(const std::string& column);

SweepResult sweep_result(const RunSummary& summary);
/// Of a run that could not start.
SweepResult sweep_failure(const std::string& why);

}  // namespace brink
