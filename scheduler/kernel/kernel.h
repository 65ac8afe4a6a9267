#pragma once
/// The kernel of verbs: advance, pass, back up, resolve, record. Policies say when; only the kernel acts.

#include "brink/scheduler/kernel/kernel_view.h"

namespace brink {

/// What a policy may do. Bodies hold motions: advancing and backing up set clocks and counts, and change no
/// motion. bool: false on a halt, whose reason halt() says.
class Kernel : public KernelView {
 public:
  // -- motions --
  /// Makes sure that every motion covers [.., t], or ends the run where an integrator cannot. What runs on to
  /// a failure, and needs little memory, uses follow_motions().
  bool extend_motions(double t) { return parts_.trajectories.cover(t); }
  bool extend_motion(int body, double t) { return parts_.trajectories.cover_body(body, t); }
  bool extend_sites(double t) { return parts_.trajectories.cover_sites(t); }
  /// Lets every motion go on towards t, each by no more than an instalment of steps. Returns how far all of
  /// them cover, <= t: the policy goes on to there and asks again. Asks `progress`: halt() may be set.
  double follow_motions(double t) { return parts_.trajectories.follow(t); }
  double follow_motion(int body, double t) { return parts_.trajectories.follow_body(body, t); }
  double follow_sites(double t) { return parts_.trajectories.follow_sites(t); }
  /// The same in as many instalments as it takes: less than t at reach() alone, or on a halt.
  double follow_motions_all_the_way(double t);
  /// Ends the run as failed if it has come to reach(), and that lies before `until`; true if so.
  bool fail_before(double until);
  /// Nobody will ask a motion for a time before t any more.
  void forget_before(double t) {
    // the watch looks at flights from where it last did
    if (much_to_forget()) parts_.watch.flights(t);
    parts_.trajectories.forget_before(t);
  }

  // -- clocks --
  /// All bodies go forward to t; frames due on the way are recorded by record_frames().
  void advance_all(double t);
  /// The bodies of one pair, and the clock with them; others stay at their own times. Within an instant t may
  /// lie a rounding before the clock.
  void advance_pair(const PairKey& pair, double t);
  /// Some bodies, which are at `from`, and the clock with them; others stay where they are.
  void advance(std::span<const int> bodies, double from, double t);
  /// All bodies go back to t inside their motions; nothing is integrated twice.
  void back_up_all(double t);
  void back_up(std::span<const int> bodies, double from, double t);

  // -- passes and searches --
  /// Pairs of owners whose moving bounds meet during [from, to] (every pair, where the plan's broad phase is
  /// off).
  std::vector<PairKey> near_pairs(double from, double to);
  /// Pairs of one body with everything else: one pass.
  std::vector<PairKey> near_pairs_of(int body, double from, double to);
  /// Notes that a policy has made a pass of its own.
  void note_pass(int body, double t) {
    ++parts_.run.work().passes;
    parts_.run.mark(TraceKind::pass, body, -1, t, t);
  }
  /// While it lives a policy looks around, with a method of its own: its seconds are counted.
  [[nodiscard]] StageTimer::Sampled looking() {
    return StageTimer::Sampled(parts_.run.timer(), parts_.run.work().seconds_look, looks_timed_);
  }
  /// Searches one pair; the certificate of a contact or an undecided end, or nothing if clear to the end.
  /// Of two that an island holds until the end of its step, undecided from there on: they move otherwise then.
  std::optional<Certificate> search(const PairKey& pair, double from, double to,
                                    const Instalment& instalment = {});
  /// True if more than one thread works for this run: then it is worth telling what will be asked for.
  bool has_helpers() const { return parts_.helpers != nullptr; }
  /// That search will be asked for soon, if neither motion changes before. Helpers may begin it, and search() asks them
  /// first: the answer is the same. True if they may; tell them by wake_helpers().
  bool expect_search(const PairKey& pair, double from, double to, int most_steps) {
    return parts_.search.expect_search(pair, from, to, most_steps);
  }
  void wake_helpers() { parts_.helpers->wake(); }
  /// The same with motions of those versions. @pre among versions() of the two.
  std::optional<Certificate> search(const PairKey& pair, std::uint64_t version, std::uint64_t other_version,
                                    double from, double to, const Instalment& instalment = {});
  /// The other features of the certificate's pair that touch and approach at its time, each as a certificate
  /// of its own (two corners of a box that lands flat): what an order other than `index` chooses from.
  std::vector<Certificate> simultaneous(const Certificate& c);
  /// Contacts of a pair at the present time with gap <= `tolerance`, deepest first.
  std::vector<FeatureContact> touching(const PairKey& pair, double tolerance) {
    return parts_.search.touching(pair, tolerance, time());
  }
  /// Notes the passes of a policy that draws itself, and their pixels.
  void note_pictures(const WorkCounters& drawn);
  void note_stale() { ++parts_.run.work().certificates_stale; }
  void note_queue_operations(std::uint64_t n) { parts_.run.work().queue_operations += n; }
  /// A number below n, drawn with the scene's seed.
  std::size_t draw(std::size_t n) { return parts_.random.below(n); }

  // -- resolving --
  /// Resolves one collision at the present time and records it; with an order that takes contacts together,
  /// every contact of this instant that hangs together with it through touching bodies, one event for each
  /// that pushed. Raises versions. Bodies whose motion changed are appended to `changed`.
  bool resolve(const PairKey& pair, const FeatureContact& contact, std::vector<int>& changed);
  /// The island whose step ends first takes its next, at next_step(), which is the present time then. Bodies
  /// whose motion changed are appended to `changed`; their versions are raised.
  bool step_island(std::vector<int>& changed);
  /// Puts a body elsewhere, at the present time (approximate policies only).
  void displace(int body, const Vec2& shift);
  /// Records that a pair's search cannot tell, and ends the run.
  void give_up(const Certificate& c);

  // -- plain discs, by the quick way: the same bits, events and counts as by search() and resolve() --
  /// True while nobody looks on: no trace, no events, no filter, no grouping, no policy that is held to contacts.
  bool has_quick_way() const;
  /// True of a body that may be one of the two, while it is in free flight.
  bool is_plain_disc(int k) const { return parts_.response.is_plain_disc(k); }
  /// The contact; false: ask search().
  bool search_discs(const PairKey& pair, double from, double to, DiscContact& contact) {
    return parts_.search.search_discs(pair, parts_.response.radius_of_plain_disc(pair.body),
                                      parts_.response.radius_of_plain_disc(pair.other_body), from, to,
                                      contact);
  }
  /// Resolves it, alone in its instant, at the present time. False, and nothing has changed: ask resolve().
  bool resolve_discs(const PairKey& pair, const DiscContact& contact);
  /// True of a site that such a disc meets by the quick way.
  bool is_plain_wall(int site) const { return parts_.response.is_plain_wall(site); }
  /// The same of a disc and a wall.
  bool search_wall(const PairKey& pair, double from, double to, WallContact& contact) {
    return parts_.search.search_wall(pair, parts_.response.radius_of_plain_disc(pair.body), from, to,
                                     contact);
  }
  /// When such a disc can touch such a wall at the soonest, or sooner [s]; infinity: not before it is resolved.
  double soonest_at_wall(int k, int site) const {
    return parts_.search.soonest_at_wall(k, parts_.response.radius_of_plain_disc(k), site);
  }
  bool resolve_at_wall(const PairKey& pair, const WallContact& contact);
  FeatureContact contact_with_wall(const PairKey& pair, const WallContact& contact) {
    return parts_.search.contact_with_wall(pair, contact);
  }
  /// All of that contact, for resolve().
  FeatureContact contact_of_discs(const PairKey& pair, const DiscContact& contact) {
    return parts_.search.contact_of_discs(pair, parts_.response.radius_of_plain_disc(pair.body),
                                          parts_.response.radius_of_plain_disc(pair.other_body),
                                          contact.time);
  }

  // -- resolving ahead of time: what is done may be undone --
  /// Resolves a contact of two newest motions, whatever the present time, and takes the bodies that it
  /// changes on to `end`; nobody is told yet. False, and nothing has changed, where that cannot be done.
  bool resolve_ahead(const Certificate& c, double end, std::vector<int>& changed);
  /// Makes that collision certain, takes the clock to it and records it. @pre is_resolved_ahead(c), and
  /// nothing earlier is left.
  bool confirm(const Certificate& c, std::vector<int>& changed);
  /// Takes a body back to its motion of that version and to time t, and everyone whose collisions hang on
  /// what is undone; they are appended to `undone`. @pre one of versions(body).
  void roll_back(int body, std::uint64_t version, double t, std::vector<int>& undone) {
    parts_.speculation.roll_back(body, version, t, undone);
  }
  /// Takes everyone back to what is certain.
  void roll_back_all() { parts_.speculation.roll_back_all(); }

  // -- the run --
  /// Records frames due up to and including t; checks them, and looks that are due between them, for overlaps. On a halt
  /// the clock is at the last of them.
  bool record_frames(double t);
  /// Asks whether to go on. Cheap: to be called in every loop that may take long.
  bool poll() { return parts_.run.poll(); }
  /// A place where the run may be resumed from: writes a checkpoint if one is due; asks whether to go on.
  bool pause_point();
  /// Ends the run for a reason.
  void stop(Termination termination, std::string why) { parts_.run.stop(termination, std::move(why)); }
  void choose_horizon(double seconds) { parts_.horizon = seconds; }

 protected:
  using KernelView::KernelView;
  /// Records a frame at the present time, and looks at all pairs.
  void show_frame();
  std::vector<std::byte> snapshot() const;
  /// Does what may step an island. Where that takes long it may be cut, and is undone at the end of the run: nobody is
  /// told of any of it, and the run is gone on with from before.
  template <class Verb>
  bool do_or_cut(bool takes_long, Verb&& verb);
  /// From now on the bodies of each set are integrated together, beside those that forces couple; sets that
  /// are not named again are split. For what answers collisions, not for policies: they learn of it by
  /// `changed`, to which bodies whose motion changed are appended. What was resolved ahead of time is undone.
  bool regroup(std::vector<std::vector<int>> together, std::vector<int>& changed);
  /// Ends the run if that many collisions are the limit; true if so.
  bool stop_at_limit(std::uint64_t collisions);

 private:
  std::optional<Outcome> respond(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed);
  bool regroup_after(const PairKey& pair, std::vector<int>& changed);
  bool resolve_group(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed);
  template <class Collide>
  bool resolve_plainly(const PairKey& pair, double gap, Collide&& collide);
  bool tell(const Outcome& outcome, std::vector<int>& changed);
  void count(const PairKey& pair);
  bool may_step_long(const PairKey& pair) const;
  bool respond_and_tell(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed);
  bool judge(const Outcome& outcome, std::vector<int>& changed);
  bool judge_ending(const Outcome& outcome, std::vector<int>& changed);
  bool begin_to_last(const Outcome& outcome, double limit, std::vector<int>& changed);
  bool go_on_in_islands(const Outcome& outcome, std::vector<int>& changed);
  void trace_all(TraceKind kind, double from, double to) const;

  unsigned looks_timed_ = 0, responses_timed_ = 0,
           events_timed_ = 0;  ///< how many there were, for one in some of them
};

template <class Verb>
bool Kernel::do_or_cut(bool takes_long, Verb&& verb) {
  // what has met its limit is not asked any more
  if (!takes_long || halt()) return verb();
  // a snapshot is of what is certain
  roll_back_all();
  std::vector<std::byte> before = snapshot();
  const RunControl::Undoable undoable(parts_.run);
  Records::HeldBack held_back(parts_.records);
  const bool goes_on = verb();
  // not asked again: what is complete by now stays
  if (parts_.run.was_cut()) {
    parts_.before_cut = std::move(before);
    return false;
  }
  held_back.told();
  return goes_on;
}

}  // namespace brink
