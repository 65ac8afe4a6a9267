#pragma once
/// The scheduler's own timeline: what it did with which body, when and for how long. Off (a null sink) it
/// costs one comparison a verb.

#include <chrono>

namespace brink {

enum class TraceKind {
  advance,    ///< a body taken forward from `from` to `to` [s, simulated]
  back_up,    ///< a body taken back from `from` to `to` inside its motion
  roll_back,  ///< a body whose motion since `to` was undone because of a contact that came late
  pass,       ///< one body tested against everything else over [from, to]
  search,     ///< a first-contact search of the body and `other` over [from, to]
  collision,  ///< at `from` == `to`, told once for each body that took part
};
const char* to_string(TraceKind kind);

/// One thing the scheduler did.
struct TraceMark {
  TraceKind kind = TraceKind::advance;
  int body = -1;
  int other = -1;  ///< search, collision: the other owner, bodies first, then sites; else -1
  double from = 0.0, to = 0.0;
  double seconds = 0.0;  ///< wall-clock time that it took, up to now; 0: not measured
};

/// Receives marks as they happen, from the thread that runs the simulator.
class TraceSink {
 public:
  virtual ~TraceSink() = default;
  virtual void mark(const TraceMark& mark) = 0;
};

/// Marks at the end of a scope, with the time since its begin. Nothing where the sink is null.
class TraceScope {
 public:
  TraceScope(TraceSink* sink, const TraceMark& mark) : sink_(sink) {
    if (!sink_) return;
    mark_ = mark;
    begin_ = Clock::now();
  }
  ~TraceScope() {
    if (!sink_) return;
    mark_.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    sink_->mark(mark_);
  }
  TraceScope(const TraceScope&) = delete;
  TraceScope& operator=(const TraceScope&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  TraceSink* sink_;
  TraceMark mark_;
  Clock::time_point begin_;
};

}  // namespace brink
