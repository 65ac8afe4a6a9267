#pragma once
/// Whether a run goes on: its clock, its counters, its end, and who is asked.

#include <optional>
#include <string>

#include "brink/core/base/work.h"
#include "brink/scheduler/kernel/ask_clock.h"
#include "brink/scheduler/kernel/stage_clock.h"
#include "brink/scheduler/run/run_options.h"
#include "brink/scheduler/run/summary.h"

namespace brink {

/// Why a run cannot go on, in one sentence.
struct Halt {
  Termination termination = Termination::failed;
  std::string why;
};

/// What all parts of the kernel share.
class RunControl {
 public:
  void begin(const RunOptions& options) {
    options_ = options;
    halt_.reset();
  }
  const RunOptions& options() const { return options_; }

  /// The present time [s].
  double time() const { return time_; }
  void set_time(double t) { time_ = t; }

  const std::optional<Halt>& halt() const { return halt_; }
  /// Ends the run for a reason: the first one counts.
  void stop(Termination termination, std::string why) {
    if (!halt_) halt_ = Halt{termination, std::move(why)};
  }
  /// The reason has gone: what failed was undone.
  void forget_halt() { halt_.reset(); }

  /// Asks `progress` whether to go on, each few thousand search iterations or collisions, and ten times a
  /// second in loops that do neither. Cheap: to be called in every loop that may take long. False on a halt.
  bool poll() {
    constexpr std::uint64_t between = 4096;
    if (indivisible_ > 0) return !halt_ || halt_->termination != Termination::failed;
    const std::uint64_t done = work_.search_iterations + 4 * work_.collisions + 64 * work_.passes + pieces_;
    if (halt_ || (done - polled_ < between && !ask_.due())) return !halt_;
    polled_ = done;
    return ask();
  }
  /// While one lives nobody is asked, and only a failure ends anything: what has begun is carried through, as
  /// half of it could not be gone on with.
  class Indivisible {
   public:
    explicit Indivisible(RunControl& run) : run_(&run) { ++run.indivisible_; }
    ~Indivisible() { --run_->indivisible_; }
    Indivisible(const Indivisible&) = delete;
    Indivisible& operator=(const Indivisible&) = delete;

   private:
    RunControl* run_;
  };

  /// Asks it now.
  bool ask() {
    if (options_.progress && !options_.progress(time_, work_.collisions))
      stop(Termination::stopped, "on request");
    return !halt_;
  }

  WorkCounters& work() { return work_; }
  StageTimer& timer() { return timer_; }
  const WorkCounters& work() const { return work_; }
  /// Pieces of motion that integrators have made: body-steps, and cells of moving sites.
  std::uint64_t pieces() const { return pieces_; }
  void count_pieces(std::uint64_t n) { pieces_ += n; }

  /// Null, or who is to be told what is done with a body.
  TraceSink* trace() const { return options_.trace; }
  void mark(TraceKind kind, int body, int other, double from, double to) const {
    if (options_.trace) options_.trace->mark({kind, body, other, from, to});
  }

 private:
  RunOptions options_;
  WorkCounters work_;
  StageTimer timer_;
  std::optional<Halt> halt_;
  int indivisible_ = 0;
  double time_ = 0.0;
  std::uint64_t pieces_ = 0;
  std::uint64_t polled_ = 0;  ///< work done when `progress` was last asked
  AskClock ask_;
};

}  // namespace brink
