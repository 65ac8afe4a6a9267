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
    // what has failed cannot go on from there
    if (halt_ && halt_->termination != Termination::failed) halt_.reset();
    asked_to_stop_ = false;
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
    if (indivisible_ > 0) return !is_cut() && (!halt_ || halt_->termination != Termination::failed);
    if (halt_ || !is_due()) return !halt_;
    return ask();
  }
  /// While one lives only a failure ends anything: what has begun is carried through, as half of it could not be
  /// gone on with. Nobody is asked unless it can be undone.
  class Indivisible {
   public:
    explicit Indivisible(RunControl& run) : run_(&run) { ++run.indivisible_; }
    ~Indivisible() { --run_->indivisible_; }
    Indivisible(const Indivisible&) = delete;
    Indivisible& operator=(const Indivisible&) = delete;

   private:
    RunControl* run_;
  };

  /// While one lives what is indivisible can be undone, so it need not be carried through where somebody says
  /// stop. A limit that is met in the middle of it does not cut it.
  class Undoable {
   public:
    explicit Undoable(RunControl& run) : run_(&run) { run.undoable_ = true; }
    ~Undoable() { run_->undoable_ = run_->cut_ = false; }
    Undoable(const Undoable&) = delete;
    Undoable& operator=(const Undoable&) = delete;

   private:
    RunControl* run_;
  };
  /// In the middle of what is indivisible, as poll(): true if it has been cut, and is to be undone.
  bool is_cut() {
    if (cut_ || !undoable_) return cut_;
    return cut_ = is_asked_to_stop();
  }
  /// The same, with nobody asked.
  bool was_cut() const { return cut_; }
  /// Asks as poll() does, also where the run has its end already.
  bool is_asked_to_stop() {
    if (!asked_to_stop_ && is_due()) ask();
    return asked_to_stop_;
  }

  /// Asks it now.
  bool ask() {
    if (options_.progress && !options_.progress(time_, work_.collisions)) {
      asked_to_stop_ = true;
      stop(Termination::stopped, kOnRequest);
    }
    return !halt_;
  }
  static constexpr const char* kOnRequest = "on request";

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
  bool is_due() {
    constexpr std::uint64_t between = 4096;
    // a large picture takes a second by itself
    const std::uint64_t drawn = 64 * work_.passes + work_.pixels_drawn / 256;
    const std::uint64_t done = work_.search_iterations + 4 * work_.collisions + drawn + pieces_;
    if (done - polled_ < between && !ask_.due()) return false;
    polled_ = done;
    return true;
  }

  RunOptions options_;
  WorkCounters work_;
  StageTimer timer_;
  std::optional<Halt> halt_;
  int indivisible_ = 0;
  bool undoable_ = false, cut_ = false, asked_to_stop_ = false;
  double time_ = 0.0;
  std::uint64_t pieces_ = 0;
  std::uint64_t polled_ = 0;  ///< work done when `progress` was last asked
  AskClock ask_;
};

}  // namespace brink
