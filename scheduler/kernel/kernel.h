#pragma once
/// The simulator's kernel of verbs: advance, pass, back up, resolve, record. Policies say when; only the
/// kernel acts.

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "brink/core/base/large_vector.h"
#include "brink/core/base/random.h"
#include "brink/core/contacts/impulse.h"
#include "brink/core/fields/pass_window.h"
#include "brink/core/world/forces.h"
#include "brink/scheduler/classic/depth_detector.h"
#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/kernel/ahead.h"
#include "brink/scheduler/kernel/ask_clock.h"
#include "brink/scheduler/kernel/body_track.h"
#include "brink/scheduler/kernel/site_motion.h"
#include "brink/scheduler/kernel/thin_walls.h"
#include "brink/scheduler/resolve/instant_bodies.h"
#include "brink/scheduler/resolve/pair_materials.h"
#include "brink/scheduler/resolve/zeno.h"
#include "brink/scheduler/run/options.h"
#include "brink/scheduler/run/recorder.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink {

/// Why a run cannot go on, in one sentence.
struct Halt {
  Termination termination = Termination::failed;
  std::string why;
};

/// Groups of contacts that had to be taken together with a loss that their materials do not have.
struct TakenGroups {
  std::uint64_t count = 0;
  double energy = 0.0;  ///< that it took [J]
  PairKey first;        ///< the first group was found at this pair ...
  double time = 0.0;    ///< ... at this time [s]
};

struct DiscRebound;
struct ExtendedContact;

class Kernel {
 public:
  /// @throws BadInput, IoError as Simulator.
  Kernel(World world, SolverOptions options);
  ~Kernel();

  // -- what is known --
  const World& world() const { return world_; }
  const SolverOptions& options() const { return options_; }
  double time() const { return time_; }
  int body_count() const { return static_cast<int>(bodies_.size()); }
  const BodyTrack& body(int k) const { return bodies_[k]; }
  BodyState state(int k, double t) const { return bodies_[k].motion.state(t); }
  std::vector<BodyState> states(double t) const;
  const Motion& site_motion(int k) const { return sites_[k].motion(); }
  /// Pose of fixed site k at time t, of its frame as it was written. @pre its motion covers t.
  Pose site_pose(int k, double t) const {
    const Pose pose = sites_[k].motion().pose(t);
    return {pose.position - frames_moved_[k], pose.angle};
  }
  /// Body or site (owners count bodies first, then sites).
  const Outline& outline_of(int owner) const { return *outlines_[owner]; }
  /// The pair of owner a with that image of owner b; nothing if they are one, or two sites.
  std::optional<PairKey> pair_of(int owner_a, int owner_b, const Image& image = {}) const;
  /// True if the body is on a parabola for as long as it meets nothing.
  bool is_free(int k) const { return bodies_[k].component < 0; }
  bool site_moves(int k) const { return sites_[k].moves(); }
  /// True if pairs are found by rendered passes (detector "pass").
  bool by_passes() const { return passes_ != nullptr; }
  /// Raised whenever the state was changed from outside the verbs: what a policy knows is void.
  std::uint64_t revision() const { return revision_; }
  double touch() const { return limits_.touch; }
  /// True if a sharp corner or end of somebody may meet a wire without thickness of another: nobody may be
  /// moved past a contact, not even by the rounding of an instant.
  bool points_meet_wires() const { return points_meet_wires_; }
  double contact_tolerance() const { return limits_.tolerance; }
  const std::optional<Halt>& halt() const { return halt_; }
  /// Where the first of the motions ends that cannot go on [s]; infinity: none that is known. A collision
  /// before may start it afresh, so a policy goes on to there, and then calls fail_before().
  double reach() const { return reach_; }
  WorkCounters& work() { return work_; }
  const WorkCounters& work() const { return work_; }
  Random& random() { return random_; }
  /// Null, or who is to be told what is done with a body.
  TraceSink* trace() const { return run_.trace; }
  double max_overlap() const { return max_overlap_; }
  const TakenGroups& taken() const { return taken_; }
  std::string name_of(const PairKey& pair) const;

  // -- verbs --
  /// Makes sure that every motion covers [.., t]. False (and halt() says why) if an integrator cannot: the
  /// run then ends where it is. What runs on to the failure, and needs little memory, uses follow_motions().
  bool extend_motions(double t);
  /// Lets every motion go on towards t, each by no more than an instalment of steps. Returns how far all of
  /// them cover, <= t: the policy goes on to there and asks again. Asks `progress`: halt() may be set.
  double follow_motions(double t);
  /// The same in as many instalments as it takes: less than t at reach() alone, or on a halt.
  double follow_motions_all_the_way(double t);
  /// Takes all bodies forward to t; frames due on the way are recorded by record_frames().
  void advance_all(double t);
  /// Makes sure that one body's motion covers [.., t]. False (and halt() says why) if its integrator cannot.
  bool extend_motion(int body, double t);
  double follow_motion(int body, double t);
  /// Likewise every moving site's.
  bool extend_sites(double t);
  double follow_sites(double t);
  /// Ends the run as failed if it has come to reach(), and that lies before `until`; true if so.
  bool fail_before(double until);
  /// Nobody will ask a motion for a time before t any more.
  void forget_before(double t);
  /// True if motions have grown so much since the last forget_before() that it is worth a call.
  bool much_to_forget() const;
  /// Takes the bodies of one pair to t, and the clock with them; others stay at their own times. Within an
  /// instant t may lie a rounding before the clock.
  void advance_pair(const PairKey& pair, double t);
  /// Takes all bodies back to t inside their motions; nothing is integrated twice.
  void back_up_all(double t);
  /// Takes some bodies, which are at `from`, forward to t, and the clock with them; others stay where they
  /// are.
  void advance(std::span<const int> bodies, double from, double t);
  /// Takes some bodies, which are at `from`, back to t inside their motions, and the clock with them.
  void back_up(std::span<const int> bodies, double from, double t);
  /// Pairs of owners whose moving bounds meet during [from, to] (every pair, where the plan's broad phase is
  /// off).
  std::vector<PairKey> near_pairs(double from, double to);
  /// Pairs of one body with everything else: one pass.
  std::vector<PairKey> near_pairs_of(int body, double from, double to);
  /// Starts to fetch what a search or a resolve of the body reads.
  void expect(int k) const {
    prefetch(&bodies_[k]);
    prefetch(&world_.bodies[k].outline);
    prefetch(&world_.bodies[k].material);
    prefetch(&outlines_[k]);
    prefetch(&body_index_[k]);
  }
  /// Searches one pair; the certificate of a contact or an undecided end, or nothing if clear to the end.
  /// With `most_steps` > 0 the search stops after so many of its steps, undecided: to go on later, if it then
  /// still matters.
  std::optional<Certificate> search(const PairKey& pair, double from, double to, int most_steps = 0);
  /// The other features of the certificate's pair that touch and approach at its time, each as a certificate
  /// of its own (two corners of a box that lands flat): what an order other than `index` chooses from.
  std::vector<Certificate> simultaneous(const Certificate& c);
  /// True if neither body has been resolved since the certificate was issued (what is only resolved ahead of
  /// time does not count).
  bool fresh(const Certificate& c) const;
  /// Contacts of a pair at the present time with gap <= `tolerance`, deepest first.
  std::vector<FeatureContact> touching(const PairKey& pair, double tolerance);
  /// What the particles see at time t (detector `depth` alone), `from` being when they looked last. @pre the
  /// motions cover t. Valid until the next look.
  const DepthSight& look(double from, double t);
  /// Resolves one collision at the present time and records it; with an order that takes contacts together,
  /// every contact of this instant that hangs together with it through touching bodies, one event for each
  /// that pushed. Raises versions. False on a halt. Bodies whose motion changed are appended to `changed`.
  bool resolve(const PairKey& pair, const FeatureContact& contact, std::vector<int>& changed);
  /// Puts a body elsewhere, at the present time (approximate policies only).
  void displace(int body, const Vec2& shift);
  /// Records frames due up to and including t; checks them for overlaps. False on a halt: the clock is then
  /// at the last of them.
  bool record_frames(double t);
  /// Asks `progress` whether to go on, each few thousand search iterations or collisions, and ten times a
  /// second in loops that do neither. Cheap: to be called in every loop that may take long. False on a halt.
  bool poll();
  /// Records that a pair's search cannot tell, and ends the run.
  void give_up(const Certificate& c);
  /// Ends the run for a reason.
  void stop(Termination termination, std::string why);
  /// A place where the run may be resumed from: writes a checkpoint if one is due; asks `progress`. False to
  /// stop.
  bool pause_point();

  // -- verbs ahead of time: what is done with them may be undone --
  /// Resolves a contact of two newest motions, whatever the present time, and takes the bodies that it
  /// changes on to `end`; nobody is told yet. They are appended to `changed`. False, and nothing has changed,
  /// where that cannot be done.
  bool resolve_ahead(const Certificate& c, double end, std::vector<int>& changed);
  /// True if the contact is the first that its bodies have had ahead of time.
  bool is_resolved_ahead(const Certificate& c) const;
  /// Makes that collision certain, takes the clock to it and records it. False on a halt. @pre
  /// is_resolved_ahead(c), and nothing earlier is left.
  bool confirm(const Certificate& c, std::vector<int>& changed);
  /// Takes a body back to its motion of that version and to time t, and everyone whose collisions hang on
  /// what is undone; they are appended to `undone`. @pre one of versions(body).
  void roll_back(int body, std::uint64_t version, double t, std::vector<int>& undone);
  /// Takes everyone back to what is certain.
  void roll_back_all();
  /// Motions that body k certainly has now, and after collisions ahead of time, in order; the last is the
  /// newest.
  std::vector<std::uint64_t> versions(int k) const;
  /// When that motion ends in a collision ahead of time; infinity: it is the newest. Nothing if it was
  /// undone, or has ended for certain.
  std::optional<double> end_of_version(int k, std::uint64_t version) const;
  /// As search(pair, from, to), with motions of those versions. @pre among versions() of the two.
  std::optional<Certificate> search(const PairKey& pair, std::uint64_t version, std::uint64_t other_version,
                                    double from, double to);
  /// Former states of bodies that are kept to go back to.
  std::size_t states_kept() const { return ahead_.kept(); }

  // -- watching a policy --
  /// From now on every contact that a search finds is remembered until one of its bodies is resolved. Costs
  /// about as much as an agenda; off for Brink's own policies.
  void watch();
  /// Nothing at all if watch() was not called. @throws BadInput, naming the pair and both times, if a contact
  /// that is known and still holds comes before t.
  void hold_to_known(double t);
  /// The same for the end of a run. @throws BadInput also if the policy came back too early.
  void hold_to_end(double until);

  // -- watching the searches --
  /// From now on what searches certify is checked as the run goes on: overlaps and sides of the pairs just
  /// resolved, of all pairs at frames, and ways through wires without thickness. What is seen ends the run.
  /// `exact`: false for a policy that may miss contacts; then nothing is checked. Cost: below 3 %.
  void hold_to_certificates(bool exact);

  // -- running --
  void begin(const RunOptions& options, Recorder* recorder);
  /// Records the last frame, at the present time, unless the frame clock has just done so.
  void end_frame();
  std::uint64_t collisions() const { return work_.collisions; }
  /// See Simulator.
  std::vector<Contact> overlaps(std::size_t most);
  /// False, and the deepest of the first overlaps in *why, if pairs overlap at the present time by more than
  /// rounding of a file.
  bool may_start(std::string* why);
  Plan plan() const;
  /// The horizon that a policy last chose; kept here so that a resumed run does the same work.
  double& horizon() { return horizon_; }
  std::vector<std::byte> snapshot() const;
  void restore(std::span<const std::byte> bytes);

 private:
  friend class SnapshotCodec;
  struct Failure {  ///< of a motion that cannot go on
    double time = std::numeric_limits<double>::infinity();
    std::string why;
  };
  struct Coupled {  ///< a component and its integrator
    Component component;
    std::unique_ptr<Integrator> integrator;
    double started = 0.0;
    std::vector<BodyState> start_states;
    Failure failure;
  };

  void make_indices();
  void add_component(Component component);
  void start_component(Coupled& c, double t, std::vector<BodyState> states);
  struct Restart {
    int body;
    ExtendedState state;
  };
  /// Starts bodies of one component, or one free body, afresh at the present time. False on a halt.
  bool restart(std::span<const Restart> touched);
  /// A free body alone.
  void restart_free(int body, const BodyState& start, const BodyState& low);
  /// As restart(); bodies whose motion changed are appended to `changed`.
  bool restart_noted(std::span<const Restart> touched, std::vector<int>& changed);
  /// Extends one component towards t by an instalment and fetches its motions; how far they cover, <= t.
  double follow(Coupled& c, double t);
  double follow_site(int site, double t);
  void integrate_again(Coupled& c);
  /// The same all the way. False and halt() if its integrator cannot.
  bool cover(Coupled& c, double t);
  bool cover_site(int site, double t);
  /// Steps of one instalment for a component or a moving site.
  std::uint64_t instalment() const;
  void note_failure(Failure& of, double end, const std::string& name, const std::string& why);
  void find_reach();
  bool stop_at(const Failure& failure);
  void fetch_motions(const Coupled& c);
  Mover mover(int body) const { return mover(body, bodies_[body]); }
  Mover mover(int body, const BodyTrack& track) const {
    return {body_index_[body], &track.motion, track.velocity_rounding};
  }
  Mover site_mover(int site) const { return {site_index_[site], &sites_[site].motion(), 0.0}; }
  /// The pair's other owner, where its image is. Valid until the next call.
  Mover other_mover(const PairKey& pair) const {
    return other_mover(pair, pair.with_site() ? nullptr : &bodies_[pair.other_body]);
  }
  /// The same with a motion that the other body has or had (null: a site).
  Mover other_mover(const PairKey& pair, const BodyTrack* other) const;
  std::optional<Certificate> search_between(const PairKey& pair, const BodyTrack& body,
                                            const BodyTrack* other, double from, double to,
                                            int most_steps = 0);
  /// The body as of its last collision that is certain.
  const BodyTrack& certain(int k) const;
  /// The body with its motion of that version; null if there is none.
  const BodyTrack* track(int k, std::uint64_t version) const;
  AheadLog::Entry before(const PairKey& pair) const;
  struct Undone {  ///< a body and the times between which it is undone
    int body;
    double from, to;
  };
  void undo_last(int body, std::vector<Undone>& taken_back);
  void undo(const AheadLog::Entry& entry);
  void swap_with_certain();
  /// From the other owner to its image [m].
  Vec2 shift_of(const PairKey& pair) const { return world_.periods.shift(pair.image); }
  /// The state at t of the pair's other owner, where its image is.
  ExtendedState other_state(const PairKey& pair, double t) const;
  /// Index of the pair's other owner: bodies first, then sites.
  int other_owner(const PairKey& pair) const {
    return pair.with_site() ? body_count() + pair.other_site : pair.other_body;
  }
  /// Marks every body, if there is a trace.
  void trace_all(TraceKind kind, double from, double to) const;
  void note_overlap(double gap) { max_overlap_ = std::max(max_overlap_, -gap); }
  /// Calls visit for each pair whose boxes at t overlap, until it returns false.
  void each_near_at(double t, const std::function<bool(const PairKey&)>& visit) const;
  /// What holds an owner at t; a still site's own box, not a disc's: it may lie far from its frame's origin.
  Box box_at(int owner, double t) const;
  std::vector<PairKey> overlapping(const std::vector<Box>& boxes) const;
  void check_overlaps_at(double t);
  /// The deepest overlap that is none [m]: the contact tolerance, or what the world started with.
  double allowed_overlap() const { return std::max(limits_.tolerance, start_overlap_); }
  bool check_overlap(const PairKey& pair, double t);
  /// After a resolve `delay` [s] from the present time. False on a halt.
  bool check_resolved(const PairKey& pair, const FeatureContact& found, Real delay);
  /// Before body k is resolved at time `to`. False on a halt.
  bool check_flight(int k, double to);
  bool report_overlap(const PairKey& pair, double depth, double t, const char* what);
  std::optional<Contact> crossing_at(const PairKey& pair, double t) const;
  const Motion& motion_of(int owner) const;
  int owner_count() const { return static_cast<int>(bodies_.size() + sites_.size()); }
  void refresh_boxes(double from, double to, bool all);
  void add_images(int a, int b, std::vector<PairKey>& pairs) const;
  std::vector<PairKey> pairs_by_pass(int body, double from, double to);
  /// From the clock's present double to the exact moment of contact: a fraction of a rounding [s]. The
  /// collision is resolved there, and the new motion is the one that passes through that moment, so that long
  /// runs do not drift by roundings of time. None where sharp points may meet wires without thickness: there
  /// a motion must not begin, not even by such a fraction, beside the path on which everybody is tested.
  Real delay_to_contact(const FeatureContact& found, const ExtendedContact& c) const;
  const Material& material_of(const PairKey& pair) const;
  /// The response now if the pair are two free discs without friction (a quick way to what respond() says).
  std::optional<DiscRebound> disc_rebound(const PairKey& pair, double level) const;
  /// Works out a collision at the present time and changes the motions; nothing if neither side can move.
  std::optional<Outcome> settle(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed);
  /// Counts and records it, and judges what it may be the end of. False on a halt.
  bool tell(const Outcome& outcome);
  struct Response;
  /// The response at that moment.
  Response respond(const PairKey& pair, const FeatureContact& found) const;
  /// The ways by which a body and what it met are pushed apart if they have sunk into each other [m].
  std::pair<RealVec, RealVec> push_apart(const PairKey& pair, const FeatureContact& found,
                                         const RealVec& n) const;
  /// Starts the touched components afresh with the twists after. False on a halt.
  bool deflect(const PairKey& pair, const Response& response, std::vector<int>& changed);
  /// Collisions of one instant that are taken to be without end: a row of n touching bodies can need n^2 / 2.
  std::uint64_t endless_group() const;
  /// True if the present instant has had so many: its contacts are then taken together.
  bool collapsed() const;
  /// Counts a collision of the present instant, or the first of a new one.
  void count_in_instant(const PairKey& pair);
  /// Notes that a group was taken with a loss [J] that its materials do not have.
  void note_taken(const PairKey& pair, double lost);
  class GroupResolve;
  bool resolve_group(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed);
  void count_collision(const PairKey& pair);
  bool records_events() const { return recorder_ && run_.record_events; }
  void record_ending(EventKind kind, const Outcome& outcome, double time);
  bool judge_endings(const Outcome& outcome);
  BounceLoss loss_of(const PairKey& pair) const;
  /// Notes that a body has been resolved now, with owner `partner`; returns the time since its last [s].
  double note_resolve(int body, int partner, double magnitude);
  Contact world_contact(const PairKey& pair, const FeatureContact& f) const;

  World world_;                     ///< its sites recentred()
  std::vector<Vec2> frames_moved_;  ///< by which the frame of each site was moved for that [m]
  SolverOptions options_;
  WorkCounters work_;
  SearchLimits limits_;
  bool reflects_ = false;  ///< response "reflection"
  bool points_meet_wires_ =
      false;  ///< a sharp corner or end of somebody, and a wire without thickness of another
  Random random_;
  LargeVector<BodyTrack> bodies_;
  AheadLog ahead_;
  std::vector<Coupled> components_;
  std::vector<SiteMotion> sites_;
  std::vector<Box> still_boxes_;  ///< of every site where it stands; empty if it moves
  std::vector<Failure> site_failures_;
  double reach_ = std::numeric_limits<double>::infinity();
  std::vector<const Outline*> outlines_;  ///< of every owner
  mutable PairMaterials pair_materials_;
  std::vector<const SiteIndex*> body_index_, site_index_;
  std::vector<std::unique_ptr<SiteIndex>> indices_;
  std::unique_ptr<PassRenderer> passes_;
  std::unique_ptr<DepthDetector> depth_;  ///< detector `depth` alone
  mutable SearchScratch scratch_;
  mutable Motion image_motion_;  ///< of the last other_mover() that was an image
  ZenoWatch zeno_;
  std::vector<Box> boxes_;                   ///< moving bounds of every owner over the present horizon
  double boxes_from_ = 0.0;                  ///< where that horizon began [s]
  std::vector<std::uint64_t> box_versions_;  ///< of the bodies, when their box was made
  std::unique_ptr<Agenda> watched_;          ///< contacts that a policy must not skip; null: not watched
  std::optional<Halt> halt_;
  std::uint64_t revision_ = 0;
  double time_ = 0.0;
  double horizon_ = 0.0;
  double max_overlap_ = 0.0;
  bool checked_ = false;  ///< hold_to_certificates()
  bool walls_made_ = false;
  ThinWalls walls_;                    ///< of still sites
  std::vector<bool> material_centre_;  ///< of bodies whose centre of mass is in them
  double checked_until_ = 0.0;         ///< flights before were looked at, at the last frame [s]
  double start_overlap_ = 0.0;         ///< deepest overlap that the world started with [m]
  std::uint64_t seq_ = 0;
  std::uint64_t frame_ = 0;   ///< frames recorded by the frame clock
  double last_frame_ = -1.0;  ///< time of the last frame recorded [s]
  double last_event_ = 0.0;   ///< time of the last event recorded [s]
  double instant_ = -1.0;     ///< time of the current group of collisions
  std::uint64_t in_instant_ = 0;
  InstantBodies bodies_in_instant_;
  TakenGroups taken_;
  RunOptions run_;
  std::uint64_t polled_ = 0;  ///< work done when `progress` was last asked
  AskClock ask_;
  std::uint64_t integrated_ = 0;  ///< body-steps of integrators, and pieces of moving sites
  std::uint64_t forgotten_ = 0;   ///< the same when forget_before() was last called
  Recorder* recorder_ = nullptr;
  double next_checkpoint_ = 0.0;  ///< wall clock [s]
};

}  // namespace brink
