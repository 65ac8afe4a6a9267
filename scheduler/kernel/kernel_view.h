#pragma once
/// What is known of a run: all that a policy may look at.

#include "brink/scheduler/kernel/kernel_parts.h"

namespace brink {

class KernelView {
 public:
  const World& world() const { return parts_.world; }
  const SolverOptions& options() const { return parts_.options; }
  /// The option of that name.
  Order order() const { return parts_.order; }
  /// The present time [s].
  double time() const { return parts_.run.time(); }
  const std::optional<Halt>& halt() const { return parts_.run.halt(); }
  std::uint64_t collisions() const { return parts_.run.work().collisions; }
  /// Raised whenever the state was changed from outside the verbs: what a policy knows is void.
  std::uint64_t revision() const { return parts_.revision; }

  // -- owners: bodies first, then sites --
  int body_count() const { return parts_.trajectories.body_count(); }
  int owner_count() const { return parts_.trajectories.owner_count(); }
  /// The body with its newest motion.
  const BodyTrack& body(int k) const { return parts_.trajectories.body(k); }
  BodyState state(int k, double t) const { return body(k).motion.state(t); }
  std::vector<BodyState> states(double t) const { return parts_.trajectories.states(t); }
  const Motion& motion_of(int owner) const { return parts_.trajectories.motion_of(owner); }
  const Motion& site_motion(int k) const { return parts_.trajectories.site(k).motion(); }
  bool site_moves(int k) const { return parts_.trajectories.site(k).moves(); }
  /// Pose of fixed site k at time t, of its frame as it was written. @pre its motion covers t.
  Pose site_pose(int k, double t) const {
    const Pose pose = site_motion(k).pose(t);
    return {pose.position - parts_.frames_moved[k], pose.angle};
  }
  const Outline& outline_of(int owner) const { return parts_.search.outline_of(owner); }
  /// An owner as searches see it.
  Mover mover(int owner) const { return parts_.search.mover(owner); }
  /// True if the body is on a parabola for as long as it meets nothing.
  bool is_free(int k) const { return parts_.trajectories.is_free(k); }
  /// True if its motion is a closed form under constant accelerations.
  bool is_ballistic(int k) const { return parts_.trajectories.is_ballistic(k); }
  /// Groups of bodies that an integrator drives together.
  std::size_t component_count() const { return parts_.trajectories.component_count(); }
  /// Raised whenever bodies have been grouped anew: components are others now.
  std::uint64_t groupings() const { return parts_.groupings; }
  /// Where the first of the motions ends that cannot go on [s]; infinity: none that is known. A collision
  /// before may start it afresh, so a policy goes on to there, and then calls fail_before().
  double reach() const { return parts_.trajectories.reach(); }
  /// True if motions have grown so much since the last forget_before() that it is worth a call.
  bool much_to_forget() const { return parts_.trajectories.much_to_forget(); }
  /// Starts to fetch what a search or a resolve of the body reads.
  void expect(int k) const {
    prefetch(&parts_.trajectories.body(k));
    prefetch(&parts_.world.bodies[k].outline);
    prefetch(&parts_.world.bodies[k].material);
    parts_.search.expect(k);
  }

  /// The same of a plain disc that goes the quick way.
  void expect_disc(int k) const {
    prefetch(&parts_.trajectories.body(k));
    parts_.response.expect(k);
    parts_.watch.expect(k);
  }

  // -- islands --
  /// When the next step of an island ends [s]; infinity: never. To be asked for with step_island().
  double next_step() const { return parts_.islands.next_step(); }
  /// Its least member. @pre next_step() is finite.
  int next_island() const { return parts_.islands.next_island(); }
  /// Steps that islands have begun so far.
  std::uint64_t island_steps() const { return parts_.islands.tally().steps; }
  /// True if an island holds the body.
  bool is_held(int k) const { return parts_.trajectories.is_held(k); }
  /// When the step of the island that holds body k ends [s], and its motion with it; infinity: at rest.
  double step_end(int k) const { return parts_.islands.step_end(k); }
  /// By their least member.
  const std::map<int, Island>& islands() const { return parts_.islands.all(); }

  // -- pairs --
  /// False if a filter says that owners a and b never meet.
  bool may_meet(int a, int b) const { return parts_.search.may_meet(a, b); }
  /// False where an island keeps the gap of owner a and that image of owner b: until one of their motions
  /// changes, searches find nothing.
  bool is_searched(int a, int b, const Image& image) const;
  /// The pair of owner a with that image of owner b; nothing if they are one, two sites, or never meet.
  std::optional<PairKey> pair_of(int a, int b, const Image& image = {}) const {
    return parts_.search.pair_of(a, b, image);
  }
  std::string name_of(const PairKey& pair) const { return parts_.search.name_of(pair); }
  double contact_tolerance() const { return parts_.search.limits().tolerance; }
  /// True if a sharp corner or end of somebody may meet a wire without thickness of another: nobody may be
  /// moved past a contact, not even by the rounding of an instant.
  bool points_meet_wires() const { return parts_.search.points_meet_wires(); }
  /// True if pairs are found by rendered passes (detector "pass").
  bool by_passes() const { return parts_.near.by_passes(); }
  /// True if neither body has been resolved since the certificate was issued (what is only resolved ahead of
  /// time does not count).
  bool fresh(const Certificate& c) const { return is_fresh(parts_.speculation, c); }

  // -- collisions ahead of time --
  /// Motions that body k certainly has now, and after collisions ahead of time, in order; the last is the
  /// newest.
  std::vector<std::uint64_t> versions(int k) const { return parts_.speculation.versions(k); }
  /// How many of them it has come to ahead of time.
  std::size_t motions_ahead(int k) const { return parts_.speculation.of(k).size(); }
  /// When that motion ends in a collision ahead of time; infinity: it is the newest. Nothing if it was
  /// undone, or has ended for certain.
  std::optional<double> end_of_version(int k, std::uint64_t version) const {
    return parts_.speculation.end_of_version(k, version);
  }
  /// Former states of bodies that are kept to go back to.
  std::size_t states_kept() const { return parts_.speculation.kept(); }
  /// True if the contact is the first that its bodies have had ahead of time.
  bool is_resolved_ahead(const Certificate& c) const;

  /// The horizon that a policy last chose [s]; kept here so that a resumed run does the same work.
  double horizon() const { return parts_.horizon; }

 protected:
  KernelView(World world, SolverOptions options) : parts_(std::move(world), std::move(options)) {}
  double end_of_steps(const BodyTrack& body, const BodyTrack* other, const PairKey& pair) const;

  KernelParts parts_;
};

}  // namespace brink
