#pragma once
/// Sweeps: every run of an experiment, on all cores, each with its own Simulator.

#include <filesystem>
#include <functional>

#include "brink/scenes/sweep/experiment.h"
#include "brink/scenes/sweep/store.h"

namespace brink {

struct SweepRequest {
  int jobs = 0;  ///< runs at the same time; 0: one a core
  /// Asked now and then, from several threads; true ends the sweep: runs under way are given back.
  std::function<bool()> stop;
  /// Told after each run of this process, by one thread at a time.
  std::function<void(const SweepRun&, const SweepResult&)> done;
};

/// One run: the scene with its overrides, nothing recorded but the result. What cannot start (overlaps at the
/// start, options that do not go together) is a result that says so.
/// @throws IoError where a file cannot be read or no GL context opens.
SweepResult make_sweep_run(const Experiment& experiment, const SweepRun& run,
                           const std::function<bool()>& stop = {});

/// Makes every run that waits in the store, until none is left or `stop` says so. Runs that another process
/// has taken are left to it. Which thread makes which run changes no result but wall seconds.
/// @throws IoError as make_sweep_run and SweepStore; the runs under way are given back.
void run_sweep(const Experiment& experiment, SweepStore& store, const SweepRequest& request);

}  // namespace brink
