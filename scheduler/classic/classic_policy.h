#pragma once
/// What both policies of the classic method share: steps of one length, looked at by particles.

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "brink/scheduler/classic/sight.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/policies/steps.h"

namespace brink {

class ClassicPolicy : public Policy {
 public:
  bool approximate() const override { return true; }
  void prepare(Kernel& kernel) override { sight_.emplace(kernel); }
  std::vector<std::string> plan() const override { return sight_->describe(); }

  void run(Kernel& kernel, double until) override {
    while (kernel.time() < until && !kernel.halt()) {
      if (!kernel.pause_point()) return;
      kernel.forget_before(kernel.time());
      if (!step(kernel, std::min(until, step_end(kernel.time(), kernel.options().step)))) return;
      if (kernel.fail_before(until)) return;
    }
  }

 protected:
  Sight& sight() { return *sight_; }

 private:
  /// From the present time to `end`, or as far as the motions go; frames are recorded. False on a halt.
  virtual bool step(Kernel& kernel, double end) = 0;

  std::optional<Sight> sight_;
};

}  // namespace brink
