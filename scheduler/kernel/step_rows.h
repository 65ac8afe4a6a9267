#pragma once
/// What a step of an island is asked: its members with their masses and forces, and a row for each contact.

#include <vector>

#include "brink/core/base/geometry.h"
#include "brink/core/contacts/cone_qp.h"
#include "brink/scheduler/islands/island_step.h"
#include "brink/scheduler/kernel/collision_response.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/island.h"
#include "brink/scheduler/kernel/island_members.h"

namespace brink {

/// On each member [N], [N m].
std::vector<Vec3> forces_of(const IslandMembers& members, const std::vector<Acceleration>& accelerations);

/// By how much the accelerations of any member's points differ at most under the two [m/s^2].
double largest_change(const IslandMembers& members, const std::vector<Vec3>& forces,
                      const std::vector<Vec3>& others);

/// Makes the problem of a step of `h` [s]. Geometry is that of the step's start; of a site that moves and that a body is not
/// abreast of yet, that where it comes to.
class StepRows {
 public:
  /// What is given must outlive it. `warm`: forces of the step before, from which friction bounds come. @pre sites are covered as
  /// far.
  StepRows(const IslandMembers& members, const ContactSearch& search, CollisionResponse& response,
           const WarmContacts& warm, double h)
      : members_(&members), search_(&search), response_(&response), warm_(&warm), h_(h) {}

  /// An approach as slow as this rebounds with e v <= a h: it has turned back by the end of the step [m/s].
  double most_absorbed(const PairKey& pair) const;
  /// Without contacts.
  IslandStep members_alone() const;
  /// Those that the problem does not have yet: rows come in the order of contacts, pair after pair.
  void add(const std::vector<HeldContact>& contacts, IslandStep& problem) const;

 private:
  bool is_beside_driven(const HeldContact& c) const;
  bool is_straight(const HeldContact& c) const;
  IslandContact island_contact(const HeldContact& c) const;
  void drive(const HeldContact& c, IslandContact& made) const;
  LastingContact rows_of(const HeldContact& c) const;
  void note_shape(const HeldContact& c, IslandContact& made) const;

  const IslandMembers* members_;
  const ContactSearch* search_;
  CollisionResponse* response_;
  const WarmContacts* warm_;
  double h_;
};

}  // namespace brink
