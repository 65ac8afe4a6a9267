/// Fixed step, the naive baseline; declares itself approximate:
///
///   until the end
///     advance all bodies by one step
///     for each pair that overlaps: resolve its deepest approaching contact, push the two apart by the
///     overlap
///
/// What passes through another body inside a step is missed.
#include <algorithm>

#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/policies/steps.h"

namespace brink {

namespace {

class FixedStep final : public Policy {
 public:
  bool approximate() const override { return true; }

  void run(Kernel& kernel, double until) override {
    const double step = kernel.options().step;
    while (kernel.time() < until && !kernel.halt()) {
      if (!kernel.pause_point()) return;
      const double from = kernel.time();
      kernel.forget_before(from);
      const double end = kernel.follow_motions_all_the_way(std::min(until, step_end(from, step)));
      if (kernel.halt()) return;
      // who could meet in the step; a pair that a push alone brings together waits for the next
      const std::vector<PairKey> pairs = kernel.near_pairs(from, end);
      // Frames within the step are of the motions before it is answered; one at its very end shows what
      // has been pushed apart.
      if (kernel.halt() || !kernel.record_frames(std::nextafter(end, 0.0))) return;
      kernel.advance_all(end);
      for (const PairKey& pair : pairs)
        if (!separate(kernel, pair)) return;
      if (!kernel.record_frames(end) || kernel.fail_before(until)) return;
    }
  }

 private:
  /// Resolves and pushes apart one pair that overlaps. False on a halt.
  bool separate(Kernel& kernel, const PairKey& pair) {
    const auto overlaps = kernel.touching(pair, 0.0);
    if (overlaps.empty()) return true;
    // Resolved before it is pushed: the contact was found where the bodies are now.
    const FeatureContact& deepest = overlaps.front();
    changed_.clear();
    if (deepest.closing_speed > 0.0 && !kernel.resolve(pair, deepest, changed_)) return false;
    push_apart(kernel, pair, -deepest.gap * deepest.normal);
    return true;
  }

  std::vector<int> changed_;
};

}  // namespace

std::unique_ptr<Policy> make_fixed_step() { return std::make_unique<FixedStep>(); }

}  // namespace brink
