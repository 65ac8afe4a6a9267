#pragma once
/// Whether an island at rest stays so where what leans on it changes.
///
/// A part of it is asked first, with the forces at its rim held: who is within a few contacts of the change, and what these stand
/// on, down to sites. Where that does not stay, all are.

#include <vector>

#include "brink/core/base/go_on.h"
#include "brink/core/contacts/cone_qp.h"
#include "brink/scheduler/kernel/collision_response.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/island.h"
#include "brink/scheduler/kernel/trajectories.h"

namespace brink {

class RestCheck {
 public:
  /// What is given must outlive it. `now`: the present time [s].
  RestCheck(const World& world, const Trajectories& trajectories, const ContactSearch& search,
            CollisionResponse& response, ConeQp& solver, double now, GoOn go_on);

  struct Answer {
    bool stays = false;
    std::vector<int> near;   ///< those who are changed, and who is within a few contacts of them
    std::vector<int> moved;  ///< where it does not: those whom the forces move most
    double moves_by = 0.0;   ///< where it does not: the largest of their accelerations (RestResult::residual)
    double beyond = 0.0;  ///< by how much friction is beyond its cone, of the largest force, where it stays
  };
  /// Those bodies of the island feel other forces than its contacts balance now. Where it stays, its contacts have the forces that
  /// hold it, as means over `h` [s]; else they are as before. Cost: a problem of rest of that part, which takes about as long as a
  /// step of as many; where that does not stay by little, one of all, and where friction does not do by little, one more.
  Answer ask(Island& island, const std::vector<int>& changed, double h) const;

  /// Bodies of the island on which what leans on it presses otherwise in `leaning` than in island.leaning, by more than nothing
  /// beside what forces pull them by.
  std::vector<int> differs(const Island& island, const std::vector<HeldContact>& leaning) const;

 private:
  class Graph;
  struct Part;
  Part near_part(const Graph& graph, const std::vector<int>& changed) const;
  Part whole(const Graph& graph, Part part) const;
  struct Question;
  Question question_of(const Graph& graph, const Part& part) const;
  bool settles(Island& island, const Graph& graph, const Part& part, double widened, double h,
               Answer& answer) const;
  LastingContact rows_of(const HeldContact& c) const;
  void press(const HeldContact& c, int body, Vec3& force) const;

  const World* world_;
  const Trajectories* trajectories_;
  const ContactSearch* search_;
  CollisionResponse* response_;
  ConeQp* solver_;
  double now_;
  GoOn go_on_;
};

}  // namespace brink
