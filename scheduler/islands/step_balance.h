#pragma once
/// Energy and momentum of a step at the level of velocities: what contacts may not make, and what nobody takes.

#include <optional>
#include <vector>

#include "brink/scheduler/islands/island_step.h"

namespace brink {

/// What all contacts together have given a body [N s], by its velocities before and after h [s] under that force; a turning counts as
/// at the radius of gyration. What is held has an infinite mass, and nothing is told of it.
double contact_impulse(const Vec3& mass, const Vec3& force, const Vec3& before, const Vec3& after, double h);

/// A contact that took part in a step.
struct PushingContact {
  std::size_t contact = 0;  ///< into IslandStep::contacts
  double lift = 0.0;        ///< how much higher than its gap it aimed [m]
  ContactLoad load;         ///< over the step [N s]
};

/// Of one step that has been solved. Costs go with bodies and contacts.
class StepBalance {
 public:
  /// `step` as it begins, which outlives this; `velocity`: of all bodies, as the contacts made it.
  StepBalance(const IslandStep& step, double h, std::vector<PushingContact> contacts,
              const std::vector<Vec3>& velocity);

  /// Those whom contacts push, by more than roundings of the largest push: all others go as forces alone lead them.
  const std::vector<bool>& pushed() const { return pushed_; }
  /// From now on all count as pushed.
  void push_all() { pushed_.assign(pushed_.size(), true); }
  /// What the solver's digits have changed of the momentum that no site takes is given back to all who are pushed alike: among them
  /// it changes no gap, and none with a site across line_of_pushes(); where others are near, only what changes no gap by more than
  /// a miss that does not count. `tolerance`: what contacts keep their gaps to [m].
  void keep_momentum(double tolerance, std::vector<Vec3>& velocity) const;
  /// What the bodies that are pushed won in the step beyond what forces and moving supports gave them [J]; `of`: the energies
  /// that it turned over, and the work of the forces along the contact tolerance.
  double won(const std::vector<Vec3>& velocity, double tolerance, double& of) const;
  /// What wires without thickness have given [J], where contacts that began nearer than they keep rose to that: a thousandth of
  /// the contact tolerance, which is how wires are told apart and nothing that anybody has to pay for.
  double rise_of_thin() const;
  /// The velocity that all bodies that are pushed have in common and no contact changes [m/s]: across the line along which sites
  /// push; 0 where there are more lines than one.
  Vec2 common_velocity(const std::vector<Vec3>& velocity) const;
  /// Makes the step win nothing, but for rise_of_thin(): all who are pushed go the same way, relative to what they have in `common`,
  /// only not as far. So no momentum is lost that no site takes, and bodies come by the same places of each other.
  void win_nothing(const Vec2& common, std::vector<Vec3>& velocity) const;

 private:
  std::optional<Vec2> line_of_pushes(const std::vector<Vec3>& velocity) const;
  Vec2 common_across(const std::vector<Vec3>& velocity, const Vec2& line) const;

  const IslandStep* step_;
  double h_;
  std::vector<PushingContact> contacts_;
  std::vector<bool> pushed_;
  std::optional<Vec2> line_;  ///< line_of_pushes()
};

}  // namespace brink
