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
#include <algorithm>

#include "brink/scheduler/policies/order.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/stage_clock.h"

namespace brink {

namespace {

/// A horizon below this would only repeat broad phases [s].
constexpr double kShortest = 1e-9;

class GlobalBackup final : public Policy {
 public:
  void run(Kernel& kernel, double until) override {
    if (kernel.horizon() <= 0.0) kernel.horizon() = first_horizon(kernel, until);
    while (kernel.time() < until && !kernel.halt()) {
      if (!kernel.pause_point()) return;
      const double end = std::min(until, kernel.time() + kernel.horizon());
      const std::uint64_t before = kernel.collisions();
      if (!run_horizon(kernel, end)) return;
      adapt(kernel, kernel.collisions() - before);
    }
  }

 private:
  /// One horizon, contact by contact. False on a halt.
  bool run_horizon(Kernel& kernel, double end) {
    if (!kernel.extend_motions(end)) return false;
    const double from = kernel.time();
    if (!pass(kernel, from, end)) return false;
    kernel.advance_all(end);
    while (const auto next = take_earliest(kernel, agenda_)) {
      // Of contacts at the same time, the one that an order puts first may be a rounding later than the next:
      // each is resolved at its own time, which its two bodies' motions still cover.
      kernel.record_frames(next->time);
      kernel.back_up_all(next->time);
      if (next->kind == Certificate::Kind::undecided) {
        if (!search_on(kernel, *next, end)) return false;
        kernel.advance_all(end);
        continue;
      }
      changed_.clear();
      if (!kernel.resolve(next->pair, next->contact, changed_)) return false;
      if (!kernel.extend_motions(end)) return false;
      if (!pass_again(kernel, end)) return false;
      kernel.advance_all(end);
    }
    kernel.record_frames(end);
    return true;
  }

  /// Certificates of every pair that can meet before the end. False on a halt.
  bool pass(Kernel& kernel, double from, double end) {
    const StageClock clock(kernel.work().seconds_search);
    agenda_.clear();
    const std::vector<PairKey> pairs = kernel.near_pairs(from, end);
    pairs_ =
        kernel.options().skip_broad_phase ? pairs.size() : 0;  // without it every pair is met at any horizon
    for (const PairKey& pair : pairs) test(kernel, pair, from, end);
    return kernel.poll();
  }

  /// The same for the bodies whose motion a resolve has changed. False on a halt.
  bool pass_again(Kernel& kernel, double end) {
    const StageClock clock(kernel.work().seconds_search);
    const double now = kernel.time();
    for (const int body : changed_)
      for (const PairKey& pair : kernel.near_pairs_of(body, now, end))
        if (!tested_already(pair, body)) test(kernel, pair, now, end);
    return kernel.poll();
  }

  /// A pair of two changed bodies is met from both: it is tested at the first.
  bool tested_already(const PairKey& pair, int body) const {
    if (pair.with_site()) return false;
    const int other = pair.body == body ? pair.other_body : pair.body;
    return other < body && std::find(changed_.begin(), changed_.end(), other) != changed_.end();
  }

  void test(Kernel& kernel, const PairKey& pair, double from, double end) {
    const auto certificate = kernel.search(pair, from, end);
    if (!certificate) return;
    agenda_.insert(*certificate);
    if (certificate->kind != Certificate::Kind::contact || !kernel.options().picks_among_all()) return;
    for (const Certificate& other : kernel.simultaneous(*certificate)) agenda_.insert(other);
  }

  /// Goes on with a search that stopped at its cap; gives up where a hundred such in a row led nowhere.
  bool search_on(Kernel& kernel, const Certificate& c, double end) {
    const auto again = kernel.search(c.pair, c.time, end);
    const bool undecided = again && again->kind == Certificate::Kind::undecided;
    undecided_ = undecided ? undecided_ + 1 : 0;
    if (undecided && (again->time <= c.time || undecided_ > 100)) kernel.give_up(*again);
    if (again) agenda_.insert(*again);
    return kernel.poll();
  }

  /// About the time in which the fastest body crosses itself.
  static double first_horizon(const Kernel& kernel, double until) {
    double horizon = until;
    for (int k = 0; k < kernel.body_count(); ++k) {
      const double speed = kernel.state(k, kernel.time()).twist.velocity.norm();
      const double size = 2.0 * kernel.world().bodies[k].outline->bounding_radius;
      if (speed > 0.0 && size > 0.0) horizon = std::min(horizon, size / speed);
    }
    return std::max(horizon, 1e-9 * std::max(1.0, until));
  }

  /// Longer while little happens, shorter while much does.
  void adapt(Kernel& kernel, std::uint64_t collisions) const {
    const auto n = static_cast<std::uint64_t>(kernel.body_count());
    if (pairs_ > 6 * n + 16 || collisions > 2 * n + 16)
      kernel.horizon() = std::max(0.5 * kernel.horizon(), kShortest);
    else if (pairs_ < 3 * n + 8 && collisions < n / 2 + 4)
      kernel.horizon() *= 1.5;
  }

  Agenda agenda_;
  std::size_t pairs_ = 0;
  int undecided_ = 0;  ///< searches in a row that met their cap
  std::vector<int> changed_;
};

}  // namespace

std::unique_ptr<Policy> make_global_backup() { return std::make_unique<GlobalBackup>(); }

}  // namespace brink
