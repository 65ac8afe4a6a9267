/// Island backup: global backup inside each island, a group of bodies that could meet before the horizon.
///
///   until the end
///     choose a horizon
///     pass: certificates of every pair that can meet before it; those pairs, and bodies that a force
///     couples, make islands; advance all bodies to the horizon
///     while the agenda has a contact before the horizon
///       back up the island of the earliest; resolve that one collision
///       pass again for the bodies it concerned: islands that they may now reach become one
///       advance the island to the horizon again
///
/// Contacts are taken in the order of time over all islands, so that an island that another one grows into
/// has not done anything too early.
#include "brink/core/base/disjoint_sets.h"
#include "brink/scheduler/policies/horizon.h"
#include "brink/scheduler/policies/policy.h"

namespace brink {

namespace {

class IslandBackup final : public Policy {
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
    HorizonTally had{agenda_.pairs().size(), 0};
    make_islands(kernel);
    kernel.advance_all(last);
    while (const auto next = agenda_.take_earliest(kernel, last)) {
      if (!kernel.record_frames(next->time)) return std::nullopt;
      // A copy: islands grow as the contact is dealt with, but these bodies alone are taken back, and
      // forward again.
      island_.assign(islands_.of(next->pair.body).begin(), islands_.of(next->pair.body).end());
      kernel.back_up(island_, last, next->time);
      changed_.clear();
      if (!deal_with(kernel, *next, seen)) return std::nullopt;
      had.restarts += changed_.size();
      last = last_beginning(kernel, begin, end, seen);
      kernel.advance(island_, next->time, last);
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
    if (!agenda_.pass_again(kernel, changed_, seen)) return false;
    // Islands only grow until the horizon ends. Three reasons: components are others now; the collision has
    // changed these bodies together; and what they may now reach could meet them.
    if (groupings_ != kernel.groupings()) unite_coupled(kernel);
    for (const int k : changed_) islands_.unite(changed_.front(), k);
    unite_near();
    return true;
  }

  void make_islands(const Kernel& kernel) {
    islands_.reset(kernel.body_count());
    unite_coupled(kernel);
    unite_near();
  }

  /// Bodies that move as one system: by forces that couple them, or by contacts that last.
  void unite_coupled(const Kernel& kernel) {
    groupings_ = kernel.groupings();
    std::vector<int> first;  // body of every component
    for (int k = 0; k < kernel.body_count(); ++k) {
      const int component = kernel.body(k).component;
      if (component < 0) continue;
      if (component >= static_cast<int>(first.size())) first.resize(component + 1, k);
      islands_.unite(first[component], k);
    }
    for (const auto& [lead, island] : kernel.islands()) {
      for (const int k : island.members) islands_.unite(lead, k);
      // who leans on one at rest may wake it
      for (const HeldContact& c : island.leaning) islands_.unite(lead, who_leans(island, c));
    }
  }

  /// Bodies of the pairs that the last pass looked at. Sites join nobody: they are not backed up.
  void unite_near() {
    for (const PairKey& pair : agenda_.pairs())
      if (!pair.with_site()) islands_.unite(pair.body, pair.other_body);
  }

  HorizonAgenda agenda_;
  DisjointSets islands_;
  std::uint64_t groupings_ = 0;  ///< as of the islands
  std::vector<int> island_;      ///< that is backed up
  std::vector<int> changed_;
};

}  // namespace

std::unique_ptr<Policy> make_island_backup() { return std::make_unique<IslandBackup>(); }

}  // namespace brink
