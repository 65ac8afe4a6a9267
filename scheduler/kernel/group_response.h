#pragma once
/// Collisions of one instant that are taken at once: every contact that hangs together through touching
/// bodies (orders `lcp` and `reflections`, and whatever the order, groups that do not end).

#include <optional>
#include <vector>

#include "brink/scheduler/kernel/collision_response.h"

namespace brink {

/// What there is to tell of a group.
struct GroupOutcome {
  std::vector<Outcome> collisions;  ///< contacts that pushed, in one order, whichever was found first
  bool endless = false;  ///< its laws could not part it without a loss that its materials do not have,
  Real delay = 0;        ///< from the clock to the moment of contact [s]
  double lost = 0.0;     ///< of so much energy [J]
};

/// The law that a group is resolved by.
enum class GroupLaw {
  complementarity,  ///< Newton's law at every contact at once
  reflections,      ///< reflections until none approaches (Smith et al. 2012)
  collapsed,  ///< of a group without end: where every contact loses, no rebound, and friction of all at once; else reflections
};

/// One group, from the contact that was found to its outcome:
///
///   collect   the contacts that touch now, from body to body
///   place     everything at the exact moment of contact
///   the law   impulses at all contacts
///   restart   the bodies that were pushed
class GroupResponse {
 public:
  /// What is given must outlive it.
  GroupResponse(const World& world, Trajectories& trajectories, ContactSearch& search, const NearPairs& near,
                CollisionResponse& response, CertificateWatch& watch, RunControl& run)
      : world_(world),
        trajectories_(trajectories),
        search_(search),
        near_(near),
        response_(response),
        watch_(watch),
        run_(run) {}

  /// At the present time. Bodies whose motion changed are appended to `changed`. Nothing on a halt.
  std::optional<GroupOutcome> resolve(const PairKey& pair, const FeatureContact& found, GroupLaw law,
                                      std::vector<int>& changed);

 private:
  class Group;

  const World& world_;
  Trajectories& trajectories_;
  ContactSearch& search_;
  const NearPairs& near_;
  CollisionResponse& response_;
  CertificateWatch& watch_;
  RunControl& run_;
};

}  // namespace brink
