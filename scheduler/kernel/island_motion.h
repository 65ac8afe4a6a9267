#pragma once
/// How an island goes on from one instant: impacts at once, then rest, or a step of constant twists.

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "brink/core/base/go_on.h"
#include "brink/core/base/limits.h"
#include "brink/core/contacts/impulse.h"
#include "brink/scheduler/islands/island_step.h"
#include "brink/scheduler/kernel/collision_response.h"
#include "brink/scheduler/kernel/feature_approach.h"
#include "brink/scheduler/kernel/island_members.h"
#include "brink/scheduler/kernel/island_modes.h"
#include "brink/scheduler/kernel/island_parting.h"
#include "brink/scheduler/kernel/step_rows.h"
#include "brink/scheduler/kernel/wire_sides.h"

namespace brink {

class IslandMotion {
 public:
  /// Told of every impact: the contact, its other owner's place, how fast it closed [m/s], the impulse.
  using Impact =
      std::function<void(const HeldContact&, const RealVec& from, double closing, const ImpulseResult&)>;

  /// What is given must outlive it. `warm`: forces of the step before. Where GoOn says no, nothing that follows
  /// leads anywhere: there is no rest, and no step.
  IslandMotion(IslandMembers members, const ContactSearch& search, CollisionResponse& response,
               ConeQp& solver, IslandTally& tally, WarmContacts warm, GoOn go_on);

  const IslandMembers& members() const { return members_; }
  /// Bodies that are to be members before it steps, see joining(). None where nothing moves or pulls.
  std::vector<int> joining(const World& world, Trajectories& trajectories, double now);
  /// How long a step may be [s]; infinity: nothing moves or pulls.
  double longest() const;
  /// How long a step of h may be for the motions of near sites [s].
  double even_for(double h);
  /// A collision goes on through contacts of this instant: the one that closes fastest first, each by its own
  /// law, until none closes faster than what a step takes as plastic.
  void pass_on_impacts(const Impact& told);
  /// True if the members can be taken to be at rest: what is left of their motion is gone within the contact
  /// tolerance, or slower than `rest_speed` [m/s], and their contacts hold them. They are at rest then.
  bool rests(double rest_speed);
  /// From now on bounces end where they do not leave the contact tolerance any more, not the step.
  void expect_modes() { by_modes_ = true; }
  /// None were found: impacts are looked at anew, as steps have them.
  void expect_steps() { by_modes_ = false; }
  /// From now on impacts do not end steps: those that would come within a step are taken where it begins, as far apart
  /// as the two still are.
  void expect_agitation() { agitated_ = true; }
  /// What the members' contacts are found on the side of, where nothing else tells: what has met, or how they are pulled.
  void expect_sides(const StepCause& cause) { sides_.expect(cause); }
  /// The pair's bounces have their limit within the step: what touches of it stays together until then, though nothing presses yet.
  void expect_captured(const PairKey& pair) { captured_ = pair; }
  /// Where forces change with place, velocity or time, a step of so long will do [s], about.
  void expect_step(double h) { expected_ = h; }
  /// What to expect for the next [s]; infinity: anything.
  double next_step() const { return members_.are_constant() ? kForever : asked_; }
  /// True if impacts cut the step short, or were taken before they came.
  bool impacts_in_step() const { return impacts_in_step_; }
  const WarmContacts& warm() const { return warm_; }
  /// True if an impact is due now: what members lean on cannot stand by then.
  bool any_impacts();

  /// Members of a step that have stood still in it: their places.
  std::vector<int> still() const;
  /// From now on these, by their places, are at rest, and others may lean on them.
  void put_to_rest(const std::vector<int>& members);
  void wake_again() { std::fill(at_rest_.begin(), at_rest_.end(), 0); }
  bool is_at_rest(int member) const { return at_rest_[member] != 0; }
  /// Takes a step of `h` [s] at most by modes; false: not that way. @pre sites are covered as far.
  bool take(IslandModes& modes, double now, double h, bool on_time);
  /// Takes a step of `h` [s] at most, and less where that does not do. False: not even the shortest does.
  /// `tolerance`: what its places may be off by the order of the step [m], 0: any. @pre sites are covered as far.
  bool take(double h, double tolerance);
  /// The site that moves and leaves the members no room, where that was so; else -1.
  int closes_in() const { return closes_in_; }

  /// Who stays together, and who stands. It must not outlive this.
  IslandParting parting() const;
  /// The state from which a member moves through the step.
  ExtendedState after(int member) const;
  double duration() const { return h_; }  ///< of the step [s]

 private:
  void list(double reach);
  /// Of contacts from that place on.
  void remember_sides(std::size_t first) { sides_.remember(contacts_, first, {members_, *search_, warm_}); }
  void drop_contradicted();
  void list_farther(const std::vector<Vec3>& velocity);
  double impact_of(const HeldContact& c, const std::vector<Vec3>& velocity) const;
  void collide(const HeldContact& c, double closing, const Impact& told);
  ImpulseSide side_of(int member, const RealVec& arm) const;
  int site_that_closes_in() const;
  double next_arrival();
  double corners_part_in(double shortest) const;
  double most_absorbed(const PairKey& pair) const;
  bool bounces_by_modes(const PairKey& pair) const;
  bool absorbs(const HeldContact& c, double closing) const;
  FeatureApproach approach() const { return {members_, *search_}; }
  StepRows rows() const { return {members_, *search_, *response_, warm_, h_}; }
  void make_problem();
  StepOutcome take_under_forces(const GapsAlong& gaps);
  double way_in_step(int member, const std::vector<Vec3>& velocity) const;
  bool stays_within_reach() const;
  double change_of_speed() const;
  void take_forces();
  bool can_stop(double way);
  double kinetic_energy() const;

  IslandMembers members_;
  const ContactSearch* search_;
  CollisionResponse* response_;
  ConeQp* solver_;
  IslandTally* tally_;
  std::vector<char> at_rest_;  ///< of each member
  WarmContacts warm_;
  GoOn go_on_;
  bool by_modes_ = false, agitated_ = false, impacts_in_step_ = false;
  int closes_in_ = -1;
  double h_ = 0.0, absorbed_ = 0.0;
  double expected_ = kForever;
  double asked_ = 0.0;  ///< the length of the step, but for what impacts cut off it [s]
  WireSides sides_;
  std::optional<PairKey> captured_;
  std::vector<HeldContact> contacts_;
  std::vector<ContactLoad>
      gives_;  ///< what each of them has moved its bodies by, of a step of twists or at rest [N], [N m]
  std::vector<double> gaps_at_end_;  ///< of each of them, of a step by modes [m]
  IslandStep problem_;
};

}  // namespace brink
