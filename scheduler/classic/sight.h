#pragma once
/// What the particles of a running world see: the classic detector, looking at a kernel's motions.

#include <string>
#include <vector>

#include "brink/scheduler/classic/depth_detector.h"
#include "brink/scheduler/kernel/kernel.h"

namespace brink {

class Sight {
 public:
  /// @throws BadInput where a body's sampling is not valid; IoError without a GL context. The kernel must
  /// outlive it.
  explicit Sight(Kernel& kernel);

  /// What the particles see at time t, `from` being when they looked last. @pre the motions cover t.
  DepthSight look(double from, double t);
  /// One line a sampling: how many particles, and what can slip between them.
  std::vector<std::string> describe() const { return detector_.describe(); }

 private:
  Kernel& kernel_;
  WorkCounters drawn_;
  DepthDetector detector_;
};

}  // namespace brink
