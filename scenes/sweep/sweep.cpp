/// Threads go through the list of runs by one shared counter; what each run is made by is settled in the
/// store, where other processes take from the same list. So there is no queue, and no order to be kept: a
/// result depends on its run alone.
#include "brink/scenes/sweep/sweep.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

#include "brink/core/base/error.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink {
namespace {

using Clock = std::chrono::steady_clock;

/// Threads of one process at work on one list of runs.
class Crew {
 public:
  Crew(const Experiment& experiment, SweepStore& store, const SweepRequest& request)
      : experiment_(experiment), store_(store), request_(request) {}

  /// Goes through the list once. Returns how many runs were made.
  /// A run that another thread or process has taken is passed over: the list is gone through once.
  std::size_t work() {
    next_ = 0;
    made_ = 0;
    const auto cores = static_cast<std::size_t>(std::max(1U, std::thread::hardware_concurrency()));
    const std::size_t jobs = request_.jobs > 0 ? static_cast<std::size_t>(request_.jobs) : cores;
    // No more threads than runs: each would find nothing to do.
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < std::min(jobs, experiment_.runs.size()); ++k)
      threads.emplace_back([this] { serve(); });
    for (std::thread& thread : threads) thread.join();
    if (error_) std::rethrow_exception(error_);
    return made_;
  }
  // Asked by every thread: failed_ is atomic, and `stop` may be called from several (SweepRequest).
  bool stopped() const { return failed_ || (request_.stop && request_.stop()); }

 private:
  /// One thread: takes what is next on the list, as long as there is something and nobody has asked to
  /// stop.
  void serve() {
    try {
      for (std::size_t k = next_++; k < experiment_.runs.size() && !stopped(); k = next_++)
        if (store_.take(experiment_.runs[k])) make(experiment_.runs[k]);
    } catch (...) {
      // The first failure is rethrown by work(); those of other threads are dropped.
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      failed_ = true;
    }
  }

  /// Makes a run that has been taken. Whatever happens it is finished or given back when this returns.
  void make(const SweepRun& run) {
    try {
      const SweepResult result = make_sweep_run(experiment_, run, [this] { return stopped(); });
      // A stopped run has no result: what it reached depends on the moment.
      if (stopped()) return store_.let_go(run);
      store_.finish(run, result);
      ++made_;
      // One thread at a time tells; the runs themselves share nothing.
      const std::lock_guard lock(mutex_);
      if (request_.done) request_.done(run, result);
    } catch (...) {
      give_back(run);
      throw;
    }
  }

  /// After a failure; where even that fails, the run is waiting again once this process has ended.
  void give_back(const SweepRun& run) {
    try {
      store_.let_go(run);
    } catch (const IoError&) {
    }
  }

  const Experiment& experiment_;
  SweepStore& store_;
  const SweepRequest& request_;
  // next_ may run past the end by one for each thread.
  std::atomic<std::size_t> next_ = 0, made_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

SweepResult make_sweep_run(const Experiment& experiment, const SweepRun& run,
                           const std::function<bool()>& stop) {
  // The seconds_limit counts the simulation alone, as wall_seconds does: the clock starts after planning.
  try {
    const Scene scene = load_scene(run.scene, run.overrides);
    Simulator simulator(scene.world, scene.solver);
    const auto begin = Clock::now();
    bool late = false;
    RunOptions options;
    options.until = experiment.until.value_or(scene.duration);
    options.frame_interval = scene.output.frame_interval;
    // Nothing but the summary is kept of a run.
    options.checkpoint_seconds = -1.0;
    options.record_events = false;
    // Asked by the kernel now and then, not at every event: a run may be late by a little before it is
    // stopped.
    options.progress = [&](double, std::uint64_t) {
      const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      late = experiment.seconds_limit > 0.0 && seconds > experiment.seconds_limit;
      return !late && !(stop && stop());
    };
    RunSummary summary = simulator.run(options);
    // A run that `stop` ended is given back, so its reason is never seen; one that was late is a
    // result that says so.
    if (late) summary.why = fmt::format("seconds_limit = {} s", experiment.seconds_limit);
    return sweep_result(summary);
  } catch (const BadInput& e) {
    // What this combination of options cannot do is a row of the table. An IoError is none:
    // it ends the sweep.
    return sweep_failure(e.what());
  }
}

// A process that shares the folder may be killed while this one works: its runs are found waiting in the
// next round.
void run_sweep(const Experiment& experiment, SweepStore& store, const SweepRequest& request) {
  Crew crew(experiment, store, request);
  // Once more as long as something was made: meanwhile another process may have ended and left runs behind.
  do store.reclaim();
  while (crew.work() > 0 && !crew.stopped());
}

}  // namespace brink
