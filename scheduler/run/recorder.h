#pragma once
/// What a run tells the outside world, as it happens.

#include <cstddef>
#include <span>
#include <vector>

#include "brink/core/base/geometry.h"
#include "brink/scheduler/run/event.h"
#include "brink/scheduler/run/knot.h"
#include "brink/scheduler/run/lasted_contact.h"
#include "brink/scheduler/run/summary.h"

namespace brink {

/// Receives frames, events and checkpoints in time order; what it does not override is not kept. Calls come
/// from the thread that runs the simulator.
class Recorder {
 public:
  virtual ~Recorder() = default;
  /// Does a part of what the frame at t takes, beside the bodies' states; true: nothing is left of it. Asked before
  /// each frame until it is, or until the run is asked to stop.
  virtual bool get_ready(double /*t*/) { return true; }
  /// Every body's state at a frame time (t = 0, each frame interval, the end).
  virtual void frame(double /*t*/, std::span<const BodyState> /*states*/) {}
  virtual void event(const Event& /*event*/) {}
  /// A contact that lasted, when its stretch ends: at its own `to`, or, last of all, at the end of the run that
  /// it outlasts. A run that goes on from there tells those again, whole, when they end.
  virtual void contact_lasted(const LastedContact& /*contact*/) {}
  /// A body's motion in an island, told when what follows is known: of each body in the order of time. Those of a
  /// motion that the end of a run cuts are told last of all; a run that goes on tells them again.
  virtual void knot(const Knot& /*knot*/) {}
  /// Everything needed to go on from t with the same bits (Simulator::restore). All before is complete.
  virtual void checkpoint(double /*t*/, const std::vector<std::byte>& /*state*/) {}
};

}  // namespace brink
