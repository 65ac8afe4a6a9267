#pragma once
/// Whether bodies at rest stay so: forces of their contacts are found anew within rings about what has changed, and
/// held where they are at the rims.
///
///   for rings of more and more contacts
///     forces within their cones that balance weights, what leans on the ring, and the forces at its rim: all stay
///   else those whom no such forces hold do not
///
/// Forces that balance a ring together with the old ones beside it balance all: so what is shown of a ring holds for
/// the island. Source of the question asked of a ring: ConeQp::rest_forces().

#include <map>
#include <set>
#include <vector>

#include "brink/core/contacts/cone_qp.h"
#include "brink/scheduler/kernel/collision_response.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/island.h"

namespace brink {

/// What pushes bodies at rest from outside: x, y [N], angle [N m], by body.
using RestLoads = std::map<int, Vec3>;

/// Adds what the contact does to those of its two bodies that are `asked`.
template <class Asked>
void add_load(RestLoads& loads, const HeldContact& c, const RealVec& arm, Asked&& asked) {
  const Vec2 force = c.normal_force * c.feature.normal + c.tangential_force * perp(c.feature.normal);
  const auto add = [&](int body, const Vec2& f, const Vec2& at) {
    loads.try_emplace(body, Vec3::Zero()).first->second += Vec3(f.x(), f.y(), cross(at, f));
  };
  if (asked(c.pair.body)) add(c.pair.body, force, arm.cast<double>());
  if (!c.pair.with_site() && asked(c.pair.other_body)) add(c.pair.other_body, -force, c.feature.point);
}

class RestCheck {
 public:
  /// What is given must outlive it.
  RestCheck(const World& world, const Trajectories& trajectories, const ContactSearch& search,
            CollisionResponse& response, ConeQp& solver, double now)
      : world_(&world),
        trajectories_(&trajectories),
        search_(&search),
        response_(&response),
        solver_(&solver),
        now_(now) {}

  /// Members of the island at rest that do not stay so, of those near `about`, members at which something has changed;
  /// none: all stay, and its contacts have forces that hold them. Cost: a search for forces of some hundred bodies.
  std::set<int> moving(Island& island, const std::set<int>& about, const RestLoads& loads) const;
  /// Contact point minus the centre of mass of the pair's body, at rest [m].
  RealVec arm(const HeldContact& contact) const;

 private:
  struct Ring;
  Ring ring(const Island& island, const std::set<int>& about, int contacts) const;
  RestProblem problem(const Island& island, const Ring& ring, const RestLoads& loads) const;

  const World* world_;
  const Trajectories* trajectories_;
  const ContactSearch* search_;
  CollisionResponse* response_;
  ConeQp* solver_;
  double now_;
};

}  // namespace brink
