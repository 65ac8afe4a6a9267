#pragma once
/// The results of a sweep, in one SQLite file that several processes may share.
///
///     run   id, key, scene, settings (JSON: axis -> value), overrides (JSON), state, worker, termination,
///           state_hash, and one column for each of sweep_columns()
///
/// `state` is waiting, running or done. A process takes a run by turning waiting into running in one
/// statement, so no run is made twice. Every process holds a lock on one byte of DIR/sweep.lock, the byte of
/// its worker number; the system lets it go however the process ends, and runs of workers without a lock are
/// waiting again.

#include <memory>
#include <optional>

#include "brink/scenes/sweep/experiment.h"
#include "brink/scenes/sweep/results.h"

namespace brink {

class SweepStore {
 public:
  /// Opens DIR/sweep.db, or makes it, and adds the runs that it does not have yet; results of other
  /// experiments in the same file stay as they are.
  /// @throws IoError naming the file.
  SweepStore(const std::filesystem::path& dir, const Experiment& experiment);
  ~SweepStore();

  // May be called from several threads.
  /// True if the run was waiting and is now this process's to make.
  bool take(const SweepRun& run);
  void finish(const SweepRun& run, const SweepResult& result);
  /// Gives back a run that was taken and not finished.
  void let_go(const SweepRun& run);
  /// Makes runs of processes that have ended waiting again. Returns how many.
  int reclaim();
  /// The result of every run of the experiment, in its order; nothing where it is not done.
  std::vector<std::optional<SweepResult>> results(const Experiment& experiment);

  const std::filesystem::path& file() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brink
