#pragma once
/// How two features of an island's members come together, or pass by each other, if all members go on as they do now.

#include <limits>
#include <utility>
#include <vector>

#include "brink/core/base/geometry.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/island.h"
#include "brink/scheduler/kernel/island_members.h"

namespace brink {

struct FeatureArrival {
  double time = std::numeric_limits<double>::infinity();  ///< from now [s]
  double closing = 0.0;                                   ///< then, or a little before [m/s]
};

/// A view of members at one instant. `velocity`: theirs, by place: x, y [m/s], angle [rad/s].
class FeatureApproach {
 public:
  /// What is given must outlive it.
  FeatureApproach(const IslandMembers& members, const ContactSearch& search)
      : members_(&members), search_(&search) {}

  /// The gap that two features keep [m]: 0, but for a wire without thickness.
  double kept(const NearFeature& f) const;
  /// By how much a step may miss that [m]: through a wire without thickness nothing comes.
  double most_missed(const NearFeature& f) const;
  bool touches(const HeldContact& c) const;
  bool is_sharp(const HeldContact& c) const;
  bool is_kept_by_corner(const HeldContact& c, const std::vector<HeldContact>& contacts) const;
  /// When the two features meet, within `h` [s]; infinity: they do not. Cost: some tens of distances at most.
  FeatureArrival arrival(const HeldContact& c, const std::vector<Vec3>& velocity, double h) const;
  bool passes_by(const HeldContact& c, const std::vector<Vec3>& velocity, double then, double closing) const;
  /// When a sharp corner that lies on another is beside it [s]; infinity: it lies on none, or does not move.
  double corner_parts_in(const HeldContact& c, const std::vector<Vec3>& velocity) const;

 private:
  std::pair<Vec3, Vec3> velocities_of(const HeldContact& c, const std::vector<Vec3>& velocity) const;
  double fastest_approach(const HeldContact& c, const std::vector<Vec3>& velocity) const;

  const IslandMembers* members_;
  const ContactSearch* search_;
};

}  // namespace brink
