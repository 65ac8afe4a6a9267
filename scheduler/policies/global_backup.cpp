/// Global backup (Baraff 1997; the classic method):
///
///   until the end
///     choose a horizon
///     pass: certificates of every pair that can meet before it; advance all bodies to it
///     while the agenda has a contact before the horizon
///       back all bodies up to the earliest; resolve that one collision
///       pass again for the bodies it concerned; advance all to the horizon
///
/// The horizon changes what work is done, never what happens: motions keep their origin and contact times are
/// canonical.
#include "brink/scheduler/policies/horizon.h"
#include "brink/scheduler/policies/policy.h"

namespace brink {

namespace {

class GlobalBackup final : public Policy {
 public:
  bool steps_islands() const override { return true; }
  void run(Kernel& kernel, double until) override {
    run_horizons(kernel, until, [&](double end) { return run_horizon(kernel, end); });
  }

 private:
  /// One horizon, contact by contact; nothing on a halt.
  std::optional<HorizonTally> run_horizon(Kernel& kernel, double end) {
    const double begin = kernel.time();
    double seen = look_ahead(kernel, seen_beyond(end));
    double last = last_beginning(kernel, begin, end, seen);
    if (!agenda_.pass(kernel, begin, seen)) return std::nullopt;
    // pairs of the whole pass: the next pass_again() looks at a few alone
    HorizonTally had{agenda_.pairs().size(), 0};
    kernel.advance_all(last);
    while (const auto next = agenda_.take_earliest(kernel, last)) {
      // Of contacts at the same time, the one that an order puts first may be a rounding later than the next:
      // each is resolved at its own time, which its two bodies' motions still cover.
      if (!kernel.record_frames(next->time)) return std::nullopt;
      kernel.back_up_all(next->time);
      changed_.clear();
      if (!deal_with(kernel, *next, seen)) return std::nullopt;
      had.restarts += changed_.size();
      last = last_beginning(kernel, begin, end, seen);
      kernel.advance_all(last);
    }
    return kernel.record_frames(last) ? std::optional(had) : std::nullopt;
  }

  /// False on a halt. A new motion may fail before, and then no more is seen.
  bool deal_with(Kernel& kernel, const Certificate& next, double& seen) {
    if (next.kind == Certificate::Kind::undecided) return agenda_.search_on(kernel, next, seen);
    const bool done = next.kind == Certificate::Kind::island
                          ? kernel.step_island(changed_)
                          : kernel.resolve(next.pair, next.contact, changed_);
    if (!done) return false;
    seen = look_ahead(kernel, seen);
    return agenda_.pass_again(kernel, changed_, seen);
  }

  HorizonAgenda agenda_;
  std::vector<int> changed_;
};

}  // namespace

std::unique_ptr<Policy> make_global_backup() { return std::make_unique<GlobalBackup>(); }

}  // namespace brink
