#pragma once
/// How far to run, and what to tell on the way.

#include <cstdint>
#include <functional>

#include "brink/scheduler/run/trace.h"

namespace brink {

/// When frames, checkpoints and progress reports are due.
struct RunOptions {
  double until = 1.0;           ///< [s]
  double frame_interval = 0.0;  ///< [s]; 0: only at the start and the end
  /// All pairs are looked at about so often for overlaps, at multiples of this, where frames are rarer [s]; 0: of `until` by
  /// kLooks. In large worlds fewer times, so that all looks cost about a hundredth of the collisions.
  static constexpr double kLooks = 64.0;
  double look_interval = 0.0;
  /// Wall-clock seconds between checkpoints, or more where each takes more than a twentieth of that; < 0: none, 0: at every
  /// chance.
  double checkpoint_seconds = 1.0;
  bool first_frame = true;  ///< record the frame at the starting time (false when resuming)
  bool record_events = true;
  /// That may work for the run, this one included. Whatever their number, what happens is the same, to the bit
  /// (docs/scheduling.md).
  static constexpr int kMostThreads = 64;
  int threads = 1;
  TraceSink* trace = nullptr;  ///< told what the scheduler does; may be null
  /// Called now and then with the time reached; return false to stop the run. May be empty.
  std::function<bool(double t, std::uint64_t collisions)> progress;
};

}  // namespace brink
