#pragma once
/// Energy and momentum of a step at the level of velocities: what contacts may not make, and what nobody takes.

#include <optional>
#include <vector>

#include "brink/scheduler/islands/island_step.h"

namespace brink {

/// What all contacts together have given a body [N s], by its velocities before and after h [s] under that force; a turning counts as
/// at the radius of gyration, of what turns on an axle at `arm` [m]. What is held has an infinite mass, and nothing is told of it.
double contact_impulse(const Vec3& mass, const Vec3& force, const Vec3& before, const Vec3& after, double h,
                       double arm);

/// A contact that took part in a step.
struct PushingContact {
  std::size_t contact = 0;  ///< into IslandStep::contacts
  double lift = 0.0;        ///< how much higher than its gap it aimed [m]
  ContactLoad load;         ///< over the step [N s]
};

/// Of one step that has been solved. Costs go with bodies and contacts.
///
/// Those who push each other are a group: what a group wins is taken from its members, and momentum that the solver's digits have
/// changed is given back to them. Who are joined by springs are of one group. Other bodies that are not pushed, by more than roundings
/// of the largest push, are in none: they go as forces alone lead them.
class StepBalance {
 public:
  /// `step` as it begins, which outlives this; `velocity`: of all bodies, as the contacts made it.
  StepBalance(const IslandStep& step, double h, std::vector<PushingContact> contacts,
              const std::vector<Vec3>& velocity);

  /// Of each body; -1: it is not pushed.
  const std::vector<int>& groups() const { return group_; }
  /// From now on the two are of one group, with all who are of theirs; one of none joins. `velocity`: see the constructor.
  void unite(int body, int other, const std::vector<Vec3>& velocity);
  /// Of each group what the solver's digits have changed of the momentum that no site takes is given back to its members alike: among
  /// them it changes no gap, and none with a straight site across the line along which sites push. It is not given back where any
  /// other gap may be missed by that. `tolerance`: what contacts keep their gaps to [m].
  void keep_momentum(double tolerance, std::vector<Vec3>& velocity);
  /// What all groups won in the step beyond what forces and moving supports gave them [J]; `of`: the energies that they turned over,
  /// and the work of the forces along the contact tolerance.
  double won(const std::vector<Vec3>& velocity, double tolerance, double& of) const;
  /// What wires without thickness have given [J], where contacts that began nearer than they keep rose to that: a thousandth of
  /// the contact tolerance, which is how wires are told apart and nothing that anybody has to pay for.
  double rise_of_thin() const;
  /// The velocity that all of a group have in common and no contact changes [m/s]: across the line along which sites push them; 0
  /// where there are more lines than one.
  Vec2 common_velocity(int group, const std::vector<Vec3>& velocity) const;

  /// A group that has been slowed, and what its members have in common.
  struct Slowed {
    std::vector<bool> groups;  ///< of each whether it was
    std::vector<Vec2> common;  ///< [m/s]
    std::vector<bool> turns;  ///< but for the turning of all, so that they come by other places of each other
  };
  /// Makes each group that won, beyond what wires gave it, win nothing: its members go the same way, relative to what they have in common,
  /// only not as far. So no momentum is lost that no site takes, and bodies come by the same places of each other. `keep_turning`:
  /// of those whom no site pushes the turning of all about their centre of mass is in common as well, where that can be, and no
  /// angular momentum is lost either.
  Slowed win_nothing(std::vector<Vec3>& velocity, bool keep_turning) const;
  /// The same of all bodies as one, relative to nothing: then all come by the same places of everything.
  void win_nothing_together(std::vector<Vec3>& velocity) const;

 private:
  const Vec3& spending(std::size_t i) const {
    return step_->spending.empty() ? step_->force[i] : step_->spending[i];
  }
  void find_groups(const std::vector<Vec3>& velocity);
  std::optional<Vec2> line_of_pushes(int group, const std::vector<Vec3>& velocity) const;
  const LastingContact* give_back(double tolerance, std::vector<Vec3>& velocity) const;
  bool misses(const IslandContact& c, int group, const Vec2& faster, double tolerance,
              const std::vector<Vec3>& velocity) const;
  Vec2 common_across(int group, const std::vector<Vec3>& velocity, const Vec2& line) const;
  double won_by(int group, const std::vector<Vec3>& velocity, double tolerance, double& of) const;
  double rise_of_thin(int group) const;
  /// A motion as of one rigid body.
  struct Common {
    Vec2 velocity = Vec2::Zero();  ///< [m/s]
    double omega = 0.0;            ///< [rad/s]
    Vec2 about = Vec2::Zero();     ///< IslandStep::place
    Vec3 at(const Vec2& place) const;
  };
  Common common_motion(int group, const std::vector<Vec3>& velocity) const;
  template <class IsOne>
  bool slow_down(const Common& common, double given, IsOne&& is_one, std::vector<Vec3>& velocity) const;

  const IslandStep* step_;
  double h_;
  std::vector<PushingContact> contacts_;
  std::vector<int> group_;                  ///< of each body, or -1
  std::vector<std::optional<Vec2>> lines_;  ///< line_of_pushes() of each group
};

}  // namespace brink
