#pragma once
/// Who of an island stays together after its step, who is let go, and what holds those who have come to rest.

#include <optional>
#include <utility>
#include <vector>

#include "brink/core/base/geometry.h"
#include "brink/scheduler/islands/island_step.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/feature_approach.h"
#include "brink/scheduler/kernel/island.h"
#include "brink/scheduler/kernel/island_members.h"

namespace brink {

/// What an island has come to: a step, or rest. Places are those of its members.
struct StepTaken {
  const IslandMembers& members;
  const ContactSearch& search;
  const std::vector<char>& at_rest;          ///< of each member
  const std::vector<HeldContact>& contacts;  ///< in order
  const std::vector<ContactLoad>&
      gives;  ///< what each of them has moved its bodies by [N], [N m]; not by modes
  const std::vector<double>& gaps_at_end;  ///< of each of them, of a step by modes [m]
  const IslandStep& problem;               ///< with the velocities of its end; not by modes
  double h;                                ///< how long it is [s]
  bool by_modes, agitated;
  const std::optional<PairKey>& captured;  ///< whose bounces have their limit within the step
};

/// Members that push each other, or are coupled to such, together; and those that nothing pushes.
struct IslandParts {
  std::vector<std::vector<int>> together;  ///< members, ascending
  std::vector<int> free;
};

/// A view of a step that is taken.
class IslandParting {
 public:
  /// What is given must outlive it.
  explicit IslandParting(const StepTaken& step) : step_(step) {}

  IslandParts parts(bool rests) const;
  /// The island that these are from now on, at rest or until the step's `end` [s].
  Island island_of(const std::vector<int>& together, bool rests, double end) const;
  /// Contacts by which those who stand may hold each other, with sites, but for those of supports alone; and those in which
  /// others lean on them, or are near.
  std::vector<HeldContact> that_hold() const;
  std::vector<HeldContact> that_lean() const;
  /// True of supports, and of who has been put to rest.
  bool stands(int body) const;
  /// A force no larger than that is none [N].
  double no_force() const;

 private:
  FeatureApproach approach() const { return {step_.members, step_.search}; }
  bool pushes(const HeldContact& c) const;
  double contact_force_on(int member) const;
  bool falls_back(const HeldContact& c, std::vector<Vec3>& velocity) const;
  bool stays_near(std::size_t contact, bool both_pushed, std::vector<Vec3>& velocity) const;
  std::vector<std::pair<int, int>> neighbours() const;
  ContactMode mode_of(const HeldContact& c, bool rests) const;
  HeldContact as_held(const HeldContact& c, ContactMode mode) const;

  StepTaken step_;
};

}  // namespace brink
