#pragma once
/// Islands: bodies joined by contacts that last. An island is at rest, or goes on in steps.
///
///   begin      bodies start touching: they are an island from the start
///   capture    bounces of a pair have come to their limit: its bodies are an island from now on
///   step       what has come apart leaves; the others move on together, few by modes (island_modes.h), many at
///              the level of velocities (island_step.h), or come to rest
///   collided   a member was hit: what it hit may join, and the island begins a step at once
///
/// Of many at rest only those wake who are moved (islands_at_rest.cpp): a step leans on the others as on sites, and it is taken
/// only where they stay under what it puts on them. Who stands while others go on comes to rest alike.
///
/// Steps begin at events and see the states of their members alone, so they are the same whoever schedules.
/// Pairs of an island are not searched for contacts while it takes a step: the step keeps their gaps.

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "brink/scheduler/kernel/collision_response.h"
#include "brink/scheduler/kernel/island_motion.h"
#include "brink/scheduler/kernel/near_pairs.h"
#include "brink/scheduler/kernel/records.h"
#include "brink/scheduler/kernel/rest_check.h"

namespace brink {

class Islands {
 public:
  struct Limits {
    double rest_speed = 0.0;  ///< [m/s], 0: none
    double tolerance = 0.0;   ///< what a step may be off in place [m], 0: any
  };
  /// What is given must outlive it.
  Islands(const World& world, Trajectories& trajectories, ContactSearch& search, CollisionResponse& response,
          Records& records, RunControl& run, const Limits& limits);

  /// Contacts may last from now on: an option, and a policy that asks for next_step().
  void allow(const IslandModes::Limits& by_modes) {
    allowed_ = true;
    by_modes_ = by_modes;
  }
  bool allowed() const { return allowed_; }
  /// When the next step of an island ends [s]; infinity: none takes steps.
  double next_step() const { return next_step_; }
  /// Its least member; of several at one time the least of all. @pre next_step() is finite.
  int next_island() const;
  /// By their least member.
  const std::map<int, Island>& all() const { return islands_; }
  /// True if the next step of its island takes long: so many members that a snapshot of everybody is little beside it.
  bool takes_long(int body) const;
  bool is_member(int body) const { return trajectories_->is_held(body); }
  /// When the step of that member's island ends [s]; infinity: it is at rest.
  double step_end(int body) const { return islands_.at(lead_of_.at(body)).due; }
  const IslandTally& tally() const { return tally_; }

  // -- what happens at the present time: bodies whose motion changed are appended to `changed`; false on a halt
  /// The pair's bounces come to an end at `limit` [s]: from now on their contact lasts. Where nothing cuts the
  /// first step, it ends there, and the event `zeno` is told.
  bool capture(const PairKey& pair, const FeatureContact& contact, double limit, std::vector<int>& changed);
  /// Contacts that are there at the start, and neither close nor part: they last from now on, and the bodies
  /// that they join are islands.
  bool begin(const std::vector<std::pair<PairKey, FeatureContact>>& touching, std::vector<int>& changed);
  /// The island whose step ends now, and first, takes its next.
  bool step(std::vector<int>& changed);
  /// A collision has been resolved, of which one side at least is a member; pushed: by an impulse. One without is what
  /// a step makes of two features that slide off each other within it, and lets go: the next one holds them until then.
  bool collided(const PairKey& pair, const FeatureContact& found, bool pushed, std::vector<int>& changed);
  /// A body has been given another state.
  bool disturbed(int body, std::vector<int>& changed);

  struct Saved {
    std::vector<Island> islands;
    IslandTally tally;
  };
  Saved saved() const;
  /// Tells the records of contacts that last still, up to the present time.
  void tell_lasting() const;
  /// @pre the trajectories are restored.
  void restore(const Saved& saved);

 private:
  /// A step that is looked for.
  struct Attempt {
    std::set<int> members = {};
    double longest = std::numeric_limits<double>::infinity();  ///< [s]
    std::set<int> roused = {};        ///< of many at rest: these join, and no others for them
    std::set<int> were_at_rest = {};  ///< all of those so far
    double moved = 0.0;           ///< what the last who were roused for that would have moved by (RestCheck)
    bool leans = true;            ///< false: whoever is near joins
    std::set<int> supports = {};  ///< at rest, and near
    IslandPace pace = {};
    WarmContacts warm = {};  ///< of all who were taken out of islands for it
  };

  void gather(int body, std::set<int>& members) const;
  void gather_or_rouse(int body, Attempt& attempt) const;
  double slides_off_in(const PairKey& pair, const FeatureContact& f) const;
  double larger_step_end(int body, std::size_t than) const;
  IslandMotion set_out(Attempt& attempt);
  bool follow_sites(double now, double h);
  double steady_for(const std::set<int>& members, double now);
  void tell_at(double limit, const PairKey& pair, const FeatureContact& contact);
  bool begin_step(Attempt attempt, std::vector<int>& changed, const StepCause& cause = {});
  bool carry_out_step(Attempt attempt, std::vector<int>& changed, const StepCause& cause);
  std::optional<bool> attempt_step(Attempt& attempt, std::vector<int>& changed, const StepCause& cause);
  void part(const IslandMotion& motion, bool rests, const IslandModes* modes, const IslandPace& pace,
            std::vector<int>& changed);

  // -- islands at rest, and who leans on them (islands_at_rest.cpp)
  bool stands_among_many(int body) const;
  void rouse(Attempt& attempt);
  void rouse(Island island, const std::set<int>& roused, Attempt& attempt);
  bool carries(const IslandMotion& motion, Attempt& attempt);
  bool lay_to_rest(IslandMotion& motion, bool all, Attempt& attempt);
  Island at_rest_with(const IslandMotion& motion, const std::vector<int>& still, const Attempt& attempt,
                      std::set<int>& with) const;
  void enter_at_rest(Island island, const std::set<int>& with, const std::vector<int>& laid, double no_force,
                     Attempt& attempt);
  void lean_no_more(const std::vector<int>& bodies);
  RestCheck rest_check();
  void tell(const IslandModes& modes, const IslandMembers& members);
  FeatureContact as_told(const HeldContact& c, const RealVec& from) const;
  void note_mode(const HeldContact& c, const RealVec& from, EventKind kind);
  void note_change(EventKind kind, int lead);
  void note_impact(const HeldContact& c, const RealVec& from, double closing, double normal,
                   double tangential);
  void take_out(const std::set<int>& members, IslandPace& pace, WarmContacts& warm);
  void put_in(Island island);
  void tell_ended();
  void find_next();

  const World* world_;
  Trajectories* trajectories_;
  ContactSearch* search_;
  CollisionResponse* response_;
  Records* records_;
  RunControl* run_;
  ConeQp solver_;
  Limits limits_;
  bool allowed_ = false;
  IslandModes::Limits by_modes_;
  std::map<int, Island> islands_;
  std::map<int, int> lead_of_;  ///< of every member
  WarmContacts taken_out_;      ///< that pressed, until it is known whether they go on; who does has no mode
  double next_step_ = std::numeric_limits<double>::infinity();
  IslandTally tally_;
};

}  // namespace brink
