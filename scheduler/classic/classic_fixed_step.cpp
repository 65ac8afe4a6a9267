/// The classic method without backing up (detector `depth`); declares itself approximate:
///
///   until the end
///     advance all bodies by one step and look
///     resolve what touches and approaches
///     push apart what overlaps, by the depth of the particle that is deepest inside
///
/// What passes through another body inside a step is missed.
#include <cmath>

#include "brink/scheduler/classic/classic_policy.h"
#include "brink/scheduler/classic/classic_rebound.h"

namespace brink {

namespace {

class ClassicFixedStep final : public ClassicPolicy {
  bool step(Kernel& kernel, double end) override {
    const double from = kernel.time();
    end = kernel.follow_motions_all_the_way(end);
    if (kernel.halt() || !kernel.record_frames(std::nextafter(end, 0.0))) return false;
    kernel.advance_all(end);
    const DepthSight seen = sight().look(from, end);
    if (!resolve_all(kernel, seen.contacts)) return false;
    push_all_apart(kernel, seen.overlaps);
    return kernel.record_frames(end) && kernel.poll();
  }
};

}  // namespace

std::unique_ptr<Policy> make_classic_fixed_step() { return std::make_unique<ClassicFixedStep>(); }

}  // namespace brink
