#pragma once
/// A small island's step by modes: at the level of accelerations, to the tolerance of the run (mode_motion.h).
///
///   what touches and closes meets without a rebound; what bounced last is at rest against its site
///   modes: those that the step before ended in, if nothing came between; else chosen anew
///   on to the end of the step, or to what comes before: a change of mode, the end of a feature, an arrival
///
/// Motions are dense pieces, continuous with their twists. The gaps of all features near the members are kept:
/// closed ones as they were, to a quarter of the contact tolerance; open ones are looked at by steps that cannot pass.

#include <memory>
#include <optional>
#include <vector>

#include "brink/scheduler/islands/modes/mode_motion.h"
#include "brink/scheduler/kernel/collision_response.h"
#include "brink/scheduler/kernel/island_members.h"
#include "brink/scheduler/run/event.h"

namespace brink {

/// At most so many bodies; contacts that touch: an option.
inline constexpr std::size_t kModeBodies = 8;
/// Where forces change with place, velocity or time, so many contacts at least: first order says little there.
inline constexpr std::size_t kContactsOfChanging = 16;

class IslandModes {
 public:
  struct Limits {
    double tolerance = 1e-10;   ///< of an integration step, relative
    std::size_t contacts = 16;  ///< that touch, at most; 0: no modes
  };
  enum class Outcome {
    moved,
    wider,  ///< a member came farther than contacts were listed for
    none,   ///< not by modes
  };

  /// What is given must outlive it. `warm`: contacts of the step before.
  IslandModes(const IslandMembers& members, Trajectories& trajectories, const ContactSearch& search,
              CollisionResponse& response, const Limits& limits, const WarmContacts& warm);

  /// `too_large`: too many members, or contacts. `unsuited`: few, but not by modes (too far away for gaps to be kept, rolling
  /// resistance, corner right on corner).
  enum class Fit { suited, unsuited, too_large };
  Fit fit() const;
  /// Goes on from `now` by h at most. `contacts`: everything that is near the members within h. `on_time`: the step
  /// before has come to its end, and nothing has happened since. @pre sites are covered as far.
  Outcome take(double now, double h, std::vector<HeldContact> contacts, bool on_time);

  // -- what take() has found
  const std::vector<HeldContact>& contacts() const { return contacts_; }
  double end() const { return end_; }  ///< of the step [s]
  /// Of each of contacts(), where the step ends [m].
  std::vector<double> gaps_at_end() const;
  /// Of a member; after the end it goes on with the twist that it has there.
  Motion motion(int member) const { return Motion::dense(tracks_[member]); }
  /// Contacts that begin to stick, slip or part with this step.
  struct Change {
    HeldContact contact;
    EventKind kind;
  };
  std::vector<Change> changes() const;
  /// The state of a member that stays in no island: as it was, but for what met at the beginning.
  ExtendedState let_go(int member) const;
  /// What met without a rebound, faster than the slowest bounce, at the beginning.
  struct Impact {
    HeldContact contact;
    double closing = 0.0;                   ///< [m/s]
    double normal = 0.0, tangential = 0.0;  ///< impulses on the pair's body [N s]
  };
  const std::vector<Impact>& impacts() const { return impacts_; }

  /// What closes no faster is at rest against its site: a bounce of that speed does not leave the contact
  /// tolerance where the largest pull brings it back [m/s].
  static double slowest_bounce(const IslandMembers& members, const ContactSearch& search);
  /// True of a speed, up to so many `times` that of a bounce that does not leave the tolerance: by the largest pull, or as this
  /// contact closes again by itself (IslandMembers::fall).
  static bool is_slow(const IslandMembers& members, const ContactSearch& search, const HeldContact& contact,
                      double speed, double times);
  /// True if it says of a place what another contact of `all`, which touches there, says better: the end of a site
  /// that goes on, by which the sample passes; a joint of a floor under a corner that slides over it.
  static bool is_shadow(const ContactSearch& search, const HeldContact& contact,
                        const std::vector<HeldContact>& all);

 private:
  using States = std::vector<BodyState>;
  void make_problem(std::vector<HeldContact> contacts, double h);
  void add_contact(const HeldContact& contact);
  bool is_corner_on_corner(const HeldContact& c) const;
  template <class Is>
  bool any_of_other_corner(const HeldContact& c, const std::vector<HeldContact>& all, Is&& is) const;
  bool is_told_by_other_corner(const HeldContact& c, const std::vector<HeldContact>& all) const;
  bool is_told_by_other_side(const HeldContact& contact) const;
  bool touches(const HeldContact& c) const;
  /// How what touches approaches now.
  enum class Approach {
    none,
    slow,  ///< so that no bounce of it would leave the contact tolerance
    fast,
  };
  Approach approach(const States& states) const;
  bool meet(States& states);
  double least_touch() const;
  bool has_come(const HeldContact& c) const;
  std::optional<std::vector<MotionMode>> former_modes() const;
  std::vector<bool> closed_now(const States& states, Approach how) const;
  bool go_on_from(const States& states, Approach how, double until, bool on_time);
  bool go_on_with_arrived(const States& states, Approach how, double until);
  bool move_on(ModeMotion& motion, double until);
  bool begins_where_members_are() const;
  void note(const ModeMotion& motion);
  bool within_reach() const;
  bool keeps_apart() const;
  double gap(const PairKey& pair, double t) const;
  double speed() const;

  const IslandMembers* members_;
  Trajectories* trajectories_;
  const ContactSearch* search_;
  CollisionResponse* response_;
  Limits limits_;
  const WarmContacts* warm_;
  double now_ = 0.0, end_ = 0.0;
  double touch_ = 0.0;  ///< least_touch()
  int arrived_ = -1;    ///< contact of the problem that arrives where the step begins
  std::vector<HeldContact> contacts_;
  std::vector<Impact> impacts_;
  std::vector<BodyState> begun_;     ///< with what these have made of the members' twists
  std::vector<bool> touching_;       ///< of each contact of the problem
  std::vector<bool> told_by_other_;  ///< contacts that are none of the problem, see is_told_by_other_side()
  std::vector<std::size_t> of_;      ///< contact that it is a shape of, of each contact of the problem
  std::vector<std::size_t> place_;   ///< of each contact's present shape in the problem
  ModeProblem problem_;
  std::vector<std::shared_ptr<Track>> tracks_;
};

}  // namespace brink
