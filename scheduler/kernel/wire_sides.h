#pragma once
/// On which side of a wire without thickness a sharp sample is, where roundings could tell either: remembered from step to step.

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "brink/scheduler/first_contact/first_contact.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/island.h"
#include "brink/scheduler/kernel/island_members.h"

namespace brink {

/// Why an island begins a step.
struct StepCause {
  bool on_time = false;                 ///< the one before has come to its end: its modes may hold still
  bool run_begins = false;              ///< what lies on each other is placed there
  const PairKey* pair = nullptr;        ///< that has met, outlives the cause; null: none
  const FeatureContact* met = nullptr;  ///< of that pair
  bool captured = false;                ///< its bounces have their limit where the step ends, if not before
};

/// What an island's step knows of sides beside its geometry: a contact tells its own surely by where the sample's edges lead,
/// hardly, or not at all (SideTold). In this order, the first that tells:
///
///   the step before        it had the contact, on that side
///   the edges, surely
///   the piece next to it   it was upon that in the step before: nobody goes through a wire round its corner
///   contacts on the line   of the step before, or what has just met: nobody changes sides along a line
///   contacts on the circle of the step before, of arcs on one circle: nor along that
///   the depth              no step leaves anybody beyond a wire by more than some contact tolerances
///   parallel contacts      two that come to lie flush, along more than one line, are on one side of each other
///
/// and over all of them: contacts of pieces that go on into each other do not contradict each other, and the older one is right.
class WireSides {
 public:
  /// What the sides are looked up in. Outlives the call.
  struct Known {
    const IslandMembers& members;
    const ContactSearch& search;
    const WarmContacts& before;  ///< of the step before
  };

  void expect(const StepCause& cause);
  /// Turns the features over that are on the other side, of contacts from that place on. Those before are right. Cost: for
  /// a contact that nothing else tells a look at all.
  void remember(std::vector<HeldContact>& contacts, std::size_t first, const Known& known) const;

 private:
  bool remember(HeldContact& c, const Known& known) const;
  bool comes_from_search(const HeldContact& c, const Known& known) const;
  bool contradicts(const HeldContact& c, const Known& known) const;
  std::optional<bool> is_elsewhere(const HeldContact& c, const Known& known) const;
  std::optional<bool> is_elsewhere_on_circle(const HeldContact& c, const Known& known) const;
  std::optional<bool> is_round_a_corner(const HeldContact& c, const Known& known) const;

  bool run_begins_ = false;
  std::optional<std::pair<PairKey, FeatureContact>> met_;
};

}  // namespace brink
