/// Fixed step, the naive baseline; declares itself approximate:
///
///   until the end
///     advance all bodies by one step
///     for each pair that overlaps: resolve its deepest approaching contact, push the two apart by the
///     overlap
///
/// What passes through another body inside a step is missed.
#include <algorithm>
#include <cmath>

#include "brink/scheduler/policies/policy.h"

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
      // whole steps from t = 0, so that a resumed run steps at the same times
      double end = (std::floor(from / step + 1e-9) + 1.0) * step;
      end = std::min(until, end > from ? end : from + step);
      if (!kernel.extend_motions(end)) return;
      const std::vector<PairKey> pairs = kernel.near_pairs(from, end);
      kernel.record_frames(std::nextafter(end, 0.0));
      kernel.advance_all(end);
      for (const PairKey& pair : pairs)
        if (!separate(kernel, pair)) return;
      kernel.record_frames(end);
    }
  }

 private:
  /// Resolves and pushes apart one pair that overlaps. False on a halt.
  bool separate(Kernel& kernel, const PairKey& pair) {
    const auto overlaps = kernel.touching(pair, 0.0);
    if (overlaps.empty()) return true;
    const FeatureContact& deepest = overlaps.front();
    changed_.clear();
    if (deepest.closing_speed > 0.0 && !kernel.resolve(pair, deepest, changed_)) return false;
    push_apart(kernel, pair, deepest);
    return true;
  }

  /// Shares the overlap between the two by their inverse masses.
  static void push_apart(Kernel& kernel, const PairKey& pair, const FeatureContact& contact) {
    const auto mobility = [&](int k) {
      const Body& b = kernel.world().bodies[k];
      return Vec2(b.inverse_mass_x(), b.inverse_mass_y());
    };
    const Vec2 a = mobility(pair.body), b = pair.with_site() ? Vec2(0.0, 0.0) : mobility(pair.other_body);
    const double yield = contact.normal.cwiseAbs2().dot(a + b);
    if (!(yield > 0.0)) return;
    const Vec2 push = contact.normal * (-contact.gap / yield);
    kernel.displace(pair.body, push.cwiseProduct(a));
    if (!pair.with_site()) kernel.displace(pair.other_body, -push.cwiseProduct(b));
  }

  std::vector<int> changed_;
};

}  // namespace

std::unique_ptr<Policy> make_fixed_step() { return std::make_unique<FixedStep>(); }

}  // namespace brink
