#pragma once
/// Where an island's members and the sites beside them are along one step.

#include <unordered_map>
#include <utility>
#include <vector>

#include "brink/scheduler/islands/near_features.h"
#include "brink/scheduler/kernel/island_members.h"

namespace brink {

/// Members move with constant twists, sites as they do. Gaps are asked for contact after contact, at the same few moments each:
/// where an owner is at those is found once.
class StepPlaces {
 public:
  /// `velocity`: x, y [m/s], angle [rad/s] of each member. Both outlive it.
  StepPlaces(const IslandMembers& members, const std::vector<Vec3>& velocity)
      : members_(&members), velocity_(&velocity), of_members_(members.bodies().size()) {}

  /// The gap of the contact's features so long [s] into the step [m]: IslandMembers::gap(), to the bit.
  double gap(const HeldContact& contact, double later);

 private:
  /// At the moments that were asked for first.
  using AtMoments = std::vector<std::pair<double, OutlineAt>>;

  OutlineAt of_member(int member, double later);
  /// Of the image that the pair meets.
  OutlineAt of_other(const PairKey& pair, double later);

  const IslandMembers* members_;
  const std::vector<Vec3>* velocity_;
  std::vector<AtMoments> of_members_;            ///< and of supports
  std::unordered_map<int, AtMoments> of_sites_;  ///< by site
};

}  // namespace brink
