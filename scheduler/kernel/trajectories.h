#pragma once
/// Every body's motion, and every moving site's.
///
/// How far a motion is made at a time is work, not physics: steps depend on the start alone, so a long horizon is cut into
/// instalments (memory, looks at `progress`). What fails is followed to its end: a collision before may start it afresh.

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "brink/core/base/large_vector.h"
#include "brink/core/world/forces.h"
#include "brink/integrators/integrator.h"
#include "brink/scheduler/kernel/body_track.h"
#include "brink/scheduler/kernel/component_start.h"
#include "brink/scheduler/kernel/held_bodies.h"
#include "brink/scheduler/kernel/knot_teller.h"
#include "brink/scheduler/kernel/run_control.h"
#include "brink/scheduler/kernel/site_motion.h"
#include "brink/scheduler/run/event.h"
#include "brink/scheduler/run/options.h"

namespace brink {

class Trajectories {
 public:
  using Sets = std::vector<std::vector<int>>;  ///< of bodies

  /// Starts everything at t = 0. `world` must outlive it. @throws BadInput as make_integrator.
  Trajectories(const World& world, const SolverOptions& options, RunControl& run);

  const World& world() const { return *world_; }
  int body_count() const { return static_cast<int>(bodies_.size()); }
  int site_count() const { return static_cast<int>(sites_.size()); }
  /// Owners count bodies first, then sites.
  int owner_count() const { return body_count() + site_count(); }
  const BodyTrack& body(int k) const { return bodies_[k]; }
  BodyTrack& body(int k) { return bodies_[k]; }
  const SiteMotion& site(int k) const { return sites_[k]; }
  const Motion& motion_of(int owner) const {
    return owner < body_count() ? bodies_[owner].motion : sites_[owner - body_count()].motion();
  }
  std::vector<BodyState> states(double t) const;
  std::size_t component_count() const { return components_.size(); }
  /// Bodies of a component, ascending.
  std::span<const int> members(int component) const { return components_[component].component.bodies; }
  /// True if the body is on a parabola for as long as it meets nothing.
  bool is_free(int k) const { return bodies_[k].component == BodyTrack::kFree; }
  /// True if an island holds the body: it knows how it moves until it is restarted.
  bool is_held(int k) const { return bodies_[k].component == BodyTrack::kHeld; }
  /// True if its motion is a closed form under constant accelerations.
  bool is_ballistic(int k) const;

  // -- going on: bool is false on a halt, where an integrator failed or `progress` said stop --
  /// Lets every motion go on towards t by an instalment at most. Returns how far all of them cover, <= t.
  double follow(double t);
  double follow_body(int k, double t);
  double follow_sites(double t);
  /// All the way to t.
  bool cover(double t);
  bool cover_body(int k, double t);
  bool cover_sites(double t);
  /// Where the first of the motions ends that cannot go on [s]; infinity: none that is known.
  double reach() const { return reach_; }
  /// Halts for the motion that ends at reach().
  bool stop_at_reach();
  /// True if motions have grown so much since the last forget_before() that it is worth a call.
  bool much_to_forget() const;
  /// Nobody will ask a motion for a time before t any more.
  void forget_before(double t);

  // -- starting afresh, at the present time; versions are raised --
  /// Bodies of one component, or one free body. Bodies whose motion changed are appended to `changed`.
  void restart(std::span<const Restart> touched, std::vector<int>& changed);
  /// From now on the twist with which a body comes into its last restart is kept, or not.
  void keep_twists_before(bool keep) { before_.assign(keep ? bodies_.size() : 0, {}); }
  bool keeps_twists_before() const { return !before_.empty(); }
  /// How a body comes out of its restart of this moment; not known where twists are not kept.
  EventSide last_restart(int k) const {
    if (!keeps_twists_before()) return {};
    return {true, state_now(k).rounded(), before_[k]};
  }
  using TellKnot = KnotTeller::Tell;
  /// From now on `tell` is told how held bodies move, to `tolerance` [m] (KnotTeller); empty: nobody is.
  void tell_knots(TellKnot tell, double tolerance) { knots_ = {std::move(tell), tolerance}; }
  /// Tells those of motions that go on still, up to the present time.
  void tell_lasting_knots() const;
  /// A free body.
  void restart_free(int k, const BodyState& start, const BodyState& low);
  // -- islands --
  /// From now on the bodies move with constant twists from these states, or as follow_own() says, whatever
  /// forces there are, until they are restarted or released. @pre all bodies of a component, or none, and where they have
  /// come to: one that is not there to the contact tolerance ends the run, as a pose jumps nowhere.
  void hold(std::span<const Restart> bodies, std::vector<int>& changed);
  /// The last hold() of the body begins a motion of its own, from the state that it was given (as hold() asks for it). @pre it
  /// has no end.
  void follow_own(int k, Motion motion);
  /// The last hold() of the body begins such a step.
  void note_step(int k, const HeldStep& step) { held_.note_step(k, step); }
  /// The body's state now, in extended precision. Of one that is held its motion has the twist of the step's
  /// end; this has what it has come to by now, in proportion.
  ExtendedState state_now(int k) const;
  /// Its twist alone: cheaper.
  ExtendedTwist twist_now(int k) const;
  /// Forces act on the bodies again, from the present time on. @pre held; all bodies of a component, or none.
  void release(std::span<const int> bodies, std::vector<int>& changed);
  /// What forces would do to a held body now.
  Acceleration acceleration(int k) const;
  /// The same at another time, were those bodies in those states. @pre ascending; all of a component, or none.
  void accelerations(std::span<const int> bodies, double t, std::span<const BodyState> states,
                     std::span<Acceleration> out) const {
    accelerations_along(bodies, t, states, states, out);
  }
  /// The same along the lines of other states (Dynamics::accelerations_along).
  void accelerations_along(std::span<const int> bodies, double t, std::span<const BodyState> lines,
                           std::span<const BodyState> states, std::span<Acceleration> out) const;
  /// When that next jumps [s]; until when it changes evenly (Dynamics); and whether until then it depends on
  /// nothing.
  double next_break(int k) const;
  double steady_until(int k);
  bool is_constant(int k) const;
  /// The component that drives the body where no island holds it.
  int own_component(int k) const { return is_held(k) ? held_.at(k).component : bodies_[k].component; }
  /// Bodies that forces couple to the body, itself included, ascending.
  std::vector<int> coupled_to(int k) const;

  /// From now on the bodies of each set are integrated together, beside those that forces couple; sets that
  /// are not named again are split. Components that stay as they are keep their motions, bit for bit. Bodies
  /// whose motion changed are appended to `changed`, unless they are there. False, and nothing has changed but
  /// halt(), where one of them cannot be followed to the present.
  bool regroup(Sets together, std::vector<int>& changed);

  // -- going back --
  ComponentStart start_of(int component) const;
  /// Starts the component there again and goes on to where it has come.
  void go_back_to(const ComponentStart& start);
  struct Saved {
    Sets together;                       ///< that regroup() was last given
    std::vector<BodyTrack> bodies;       ///< motions of those that no integrator drives alone
    std::vector<ComponentStart> starts;  ///< of every component
    std::map<int, HeldStep> steps;       ///< of bodies that an island holds
    std::vector<int> asleep;             ///< bodies that an island holds, but an integrator would drive

    bool is_asleep(int k) const { return std::binary_search(asleep.begin(), asleep.end(), k); }
  };
  Saved saved() const;
  /// As they were saved at time t, whoever was together. @throws BadInput where a motion cannot be made again.
  void restore(const Saved& saved, double t);

 private:
  struct Failure {  ///< of a motion that cannot go on
    double time = std::numeric_limits<double>::infinity();
    std::string why;
  };
  struct Coupled {  ///< a component and its integrator
    Component component;
    std::unique_ptr<Integrator> integrator;
    ComponentStart begun;
    Failure failure;
    bool dormant = false;       ///< an island holds its bodies
    std::uint64_t crawled = 0;  ///< steps in a row of which more than kEndless are left to the end
  };

  void add_component(Component component, ComponentStart start);
  void add_free(const Component& component, double t, const BodyState& start, const BodyState& low);
  void add_coupled(Component component, ComponentStart start);
  bool stays(const Component& component) const;
  bool catch_up(const Component& component, double t);
  void follow_again(Coupled& c, double t);
  void begin_anew(Component component, double t, std::vector<int>& changed);
  void start(Coupled& c, ComponentStart from);
  void put_to_sleep(Coupled& c);
  void note_pace(Coupled& c, double from, double to, std::uint64_t steps);
  void tell_knot(int k, const BodyState& after) const;
  void tell_bends(int k) const;
  void note_twist_before(int k) {
    if (!before_.empty()) before_[k] = twist_now(k).rounded();
  }
  void hold_again(std::span<const int> members, const Saved& saved);
  void fetch(const Coupled& c);
  double follow(Coupled& c, double t);
  double follow_site(int site, double t);
  bool cover(Coupled& c, double t);
  std::uint64_t instalment() const;
  void note_failure(Failure& of, double end, const std::string& name, const std::string& why);
  void find_reach();
  bool stop_at(const Failure& failure);
  void watch_start(int k, const ExtendedState& start);

  const World* world_;
  const SolverOptions* options_;
  bool closed_forms_;  ///< are asked for: another integrator that is named drives even what has one
  double most_jump_;   ///< of where a motion of an island begins [m]
  RunControl* run_;
  LargeVector<BodyTrack> bodies_;
  std::vector<Coupled> components_;
  Sets together_;
  HeldBodies held_;
  std::vector<SiteMotion> sites_;
  std::vector<Failure> site_failures_;
  std::vector<Twist> before_;  ///< each body's last restart; empty: not kept
  KnotTeller knots_;
  double reach_ = std::numeric_limits<double>::infinity();
  std::uint64_t forgotten_ = 0;  ///< pieces made when forget_before() was last called
};

}  // namespace brink
