/// The classic method without backing up (detector `depth`); declares itself approximate:
///
///   until the end
///     advance all bodies by one step and look
///     resolve what touches and approaches
///     push apart what overlaps, by the depth of the particle that is deepest inside
///
/// What passes through another body inside a step is missed.
#include <algorithm>
#include <cmath>
#include <optional>

#include "brink/scheduler/classic/classic_rebound.h"
#include "brink/scheduler/classic/sight.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/policies/steps.h"

namespace brink {

namespace {

class ClassicFixedStep final : public Policy {
 public:
  bool approximate() const override { return true; }
  void prepare(Kernel& kernel) override { sight_.emplace(kernel); }
  std::vector<std::string> plan() const override { return sight_->describe(); }

  void run(Kernel& kernel, double until) override {
    while (kernel.time() < until && !kernel.halt()) {
      if (!kernel.pause_point()) return;
      const double from = kernel.time();
      kernel.forget_before(from);
      const double end =
          kernel.follow_motions_all_the_way(std::min(until, step_end(from, kernel.options().step)));
      if (kernel.halt() || !kernel.record_frames(std::nextafter(end, 0.0))) return;
      kernel.advance_all(end);
      const DepthSight seen = sight_->look(from, end);
      if (!resolve_all(kernel, seen.contacts)) return;
      push_all_apart(kernel, seen.overlaps);
      if (!kernel.record_frames(end) || !kernel.poll() || kernel.fail_before(until)) return;
    }
  }

 private:
  std::optional<Sight> sight_;
};

}  // namespace

std::unique_ptr<Policy> make_classic_fixed_step() { return std::make_unique<ClassicFixedStep>(); }

}  // namespace brink
