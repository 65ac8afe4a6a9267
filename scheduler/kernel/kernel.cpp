#include "brink/scheduler/kernel/kernel.h"

#include <fmt/core.h>

#include <algorithm>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/kernel/snapshot.h"
#include "brink/scheduler/kernel/stage_clock.h"
#include "brink/scheduler/kernel/tolerances.h"

namespace brink {

bool KernelView::is_searched(int a, int b, const Image& image) const {
  const auto pair = parts_.search.pair_of(a, b, image);
  return pair && !parts_.search.is_left_out(*pair);
}

/// Only the first collision ahead of time can be confirmed: the others hang on it. Times are compared to the bit,
/// since two searches on the same motions find the same contact.
bool KernelView::is_resolved_ahead(const Certificate& c) const {
  const auto collisions = parts_.speculation.of(c.pair.body);
  if (collisions.empty()) return false;
  const Outcome& first = collisions.front()->outcome;
  return first.pair == c.pair && first.contact.time == c.contact.time &&
         first.contact.site == c.contact.site && first.contact.sample == c.contact.sample &&
         first.contact.sample_on_a == c.contact.sample_on_a;
}

// -- motions --

double Kernel::follow_motions_all_the_way(double t) {
  double covered = follow_motions(t);
  while (covered < std::min(t, reach()) && !halt()) covered = follow_motions(t);
  return covered;
}

bool Kernel::fail_before(double until) {
  // Only once the clock is there: a collision on the way may start the motion that fails afresh.
  return reach() < until && time() >= reach() && parts_.trajectories.stop_at_reach();
}

// -- clocks --

void Kernel::trace_all(TraceKind kind, double from, double to) const {
  if (!parts_.run.trace()) return;
  for (int k = 0; k < body_count(); ++k) parts_.run.mark(kind, k, -1, from, to);
}

void Kernel::advance_all(double t) {
  // within an instant t may lie a rounding before the clock: that is no advance
  if (t > time()) {
    parts_.run.work().advances += body_count();
    trace_all(TraceKind::advance, time(), t);
  }
  parts_.run.set_time(t);
}

/// In the trace each of the two goes from where its motion began; t may lie a rounding before that.
void Kernel::advance_pair(const PairKey& pair, double t) {
  parts_.run.work().advances += pair.with_site() ? 1 : 2;
  parts_.run.set_time(t);
  if (!parts_.run.trace()) return;
  for (const int k : {pair.body, pair.other_body})
    if (k >= 0) parts_.run.mark(TraceKind::advance, k, -1, std::min(body(k).motion.begin(), t), t);
}

void Kernel::advance(std::span<const int> bodies, double from, double t) {
  parts_.run.work().advances += bodies.size();
  parts_.run.set_time(t);
  for (const int k : bodies) parts_.run.mark(TraceKind::advance, k, -1, from, t);
}

void Kernel::back_up_all(double t) {
  if (t < time()) {
    parts_.run.work().backups += body_count();
    // time that clocks were taken through in vain: motions stay as they are
    parts_.run.work().body_seconds_thrown_away += (time() - t) * body_count();
    trace_all(TraceKind::back_up, time(), t);
  }
  parts_.run.set_time(t);
}

void Kernel::back_up(std::span<const int> bodies, double from, double t) {
  parts_.run.work().backups += bodies.size();
  parts_.run.work().body_seconds_thrown_away += (from - t) * static_cast<double>(bodies.size());
  parts_.run.set_time(t);
  for (const int k : bodies) parts_.run.mark(TraceKind::back_up, k, -1, from, t);
}

// -- passes and searches --

/// All bodies are tested at once: as many passes as bodies, and a horizon in the counters.
std::vector<PairKey> Kernel::near_pairs(double from, double to) {
  const StageTimer::Scope timed(parts_.run.timer(), parts_.run.work().seconds_look);
  ++parts_.run.work().horizons;
  parts_.run.work().passes += body_count();
  trace_all(TraceKind::pass, from, to);
  return parts_.near.all(from, to);
}

std::vector<PairKey> Kernel::near_pairs_of(int body, double from, double to) {
  const StageTimer::Sampled timed = looking();
  ++parts_.run.work().passes;
  const TraceScope scope(parts_.run.trace(), {TraceKind::pass, body, -1, from, to});
  // ahead of what is certain a body has several motions: the bounds of all of them count
  return parts_.near.of(body, from, to, !parts_.speculation.empty());
}

/// Until when an island that steps leaves the two on those motions [s], and an instant that begins then is over.
double KernelView::end_of_steps(const BodyTrack& body, const BodyTrack* other, const PairKey& pair) const {
  const auto end_of = [&](int k, const BodyTrack& track) {
    return track.component == BodyTrack::kHeld && is_held(k) ? step_end(k) : kForever;
  };
  const double end = std::min(end_of(pair.body, body), other ? end_of(pair.other_body, *other) : kForever);
  return end < kForever ? end + kWholeInstant * same_instant(end) : end;
}

std::optional<Certificate> Kernel::search(const PairKey& pair, double from, double to,
                                          const Instalment& instalment) {
  const BodyTrack* other = pair.with_site() ? nullptr : &body(pair.other_body);
  Instalment part = instalment;
  part.until = std::min(part.until, end_of_steps(body(pair.body), other, pair));
  auto found = parts_.search.search(pair, body(pair.body), other, from, to, part);
  // a policy that is held to known contacts is told of this one here
  if (found) parts_.policy_watch.found(*found);
  return found;
}

std::optional<Certificate> Kernel::search(const PairKey& pair, std::uint64_t version,
                                          std::uint64_t other_version, double from, double to,
                                          const Instalment& instalment) {
  const Speculation& of = parts_.speculation;
  const BodyTrack* other = pair.with_site() ? nullptr : of.track(pair.other_body, other_version);
  const BodyTrack& body = *of.track(pair.body, version);
  Instalment part = instalment;
  part.until = std::min(part.until, end_of_steps(body, other, pair));
  auto found = parts_.search.search(pair, body, other, from, to, part);
  if (found) parts_.policy_watch.found(*found);
  return found;
}

void Kernel::note_pictures(const WorkCounters& drawn) {
  WorkCounters& work = parts_.run.work();
  work.passes += drawn.passes;
  work.pixels_drawn += drawn.pixels_drawn;
  work.pixels_read += drawn.pixels_read;
}

std::vector<Certificate> Kernel::simultaneous(const Certificate& c) {
  const Speculation& of = parts_.speculation;
  return parts_.search.simultaneous(
      c, *of.track(c.pair.body, c.version_body),
      c.pair.with_site() ? nullptr : of.track(c.pair.other_body, c.version_other));
}

// -- resolving --

/// The response, then the event, then what the collision is the end of, then who is integrated together from here
/// on: each may ask for what the one before has done.
bool Kernel::resolve(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed) {
  parts_.policy_watch.going_to(time());
  return do_or_cut(may_step_long(pair), [&] { return respond_and_tell(pair, found, changed); });
}

/// Of contacts that are taken together any may be with an island.
bool Kernel::may_step_long(const PairKey& pair) const {
  const Islands& islands = parts_.islands;
  if (takes_together(order()))
    return std::any_of(islands.all().begin(), islands.all().end(),
                       [&](const auto& island) { return islands.takes_long(island.first); });
  return islands.takes_long(pair.body) || (!pair.with_site() && islands.takes_long(pair.other_body));
}

bool Kernel::respond_and_tell(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed) {
  // A group is made of everything that touches now, so nobody may be on a motion that is only guessed. A
  // contact that a picture shows names no features from which a group could be collected.
  if (takes_together(order()) || (!found.seen && parts_.endings.collapsed(time()))) {
    roll_back_all();
    return resolve_group(pair, found, changed);
  }
  if (parts_.response.asks_others(found)) roll_back_all();
  const auto outcome = respond(pair, found, changed);
  if (!outcome) return false;
  const bool goes_on = tell(*outcome, changed);
  return regroup_after(pair, changed) && goes_on;
}

/// The law and the new motions, timed. Nobody is told yet: a collision ahead of time is told when it is confirmed.
std::optional<Outcome> Kernel::respond(const PairKey& pair, const FeatureContact& found,
                                       std::vector<int>& changed) {
  const StageTimer::Sampled timed(parts_.run.timer(), parts_.run.work().seconds_response, responses_timed_);
  return parts_.response.collide(pair, found, changed);
}

bool Kernel::has_quick_way() const {
  return options().detector == "field" && options().closed_forms && !takes_together(order()) &&
         !parts_.run.trace() && !parts_.records.records_events() && parts_.search.is_unfiltered() &&
         !parts_.grouping && !parts_.policy_watch.is_on() && parts_.speculation.empty();
}

/// respond() and tell(), of all that a collision may be the end of only what this one may be. `collide`: false where it
/// is not plain.
template <class Collide>
bool Kernel::resolve_plainly(const PairKey& pair, double gap, Collide&& collide) {
  if (!parts_.endings.is_plain(time())) return false;
  {
    const StageTimer::Sampled timed(parts_.run.timer(), parts_.run.work().seconds_response, responses_timed_);
    if (!collide()) return false;
  }
  if (halt()) return true;
  parts_.watch.note_overlap(gap);
  count(pair);
  ++parts_.run.work().collisions_quick;
  parts_.records.event_untold();
  parts_.endings.collided_plainly(pair, time());
  poll();
  stop_at_limit(collisions());
  return true;
}

bool Kernel::resolve_discs(const PairKey& pair, const DiscContact& found) {
  return resolve_plainly(pair, found.gap, [&] { return parts_.response.collide_discs(pair, found); });
}

bool Kernel::resolve_at_wall(const PairKey& pair, const WallContact& found) {
  return resolve_plainly(pair, found.gap, [&] { return parts_.response.collide_with_wall(pair, found); });
}

/// In an instant that has had too many collisions the law is `collapsed`, whatever the order.
bool Kernel::resolve_group(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed) {
  const GroupLaw law = parts_.endings.collapsed(time()) ? GroupLaw::collapsed
                       : order() == Order::lcp          ? GroupLaw::complementarity
                                                        : GroupLaw::reflections;
  const StageTimer::Scope timed(parts_.run.timer(), parts_.run.work().seconds_response);
  const auto group = parts_.groups.resolve(pair, found, law, changed);
  if (!group) return false;
  if (group->endless) {
    parts_.records.event(EventKind::group, pair, found, 0.0, 0.0, group->delay);
    // one that lost nothing is an event all the same, but no energy was taken that the summary should tell
    if (group->lost > 0.0 && parts_.taken.count++ == 0) {
      parts_.taken.first = pair;
      parts_.taken.time = time();
    }
    parts_.taken.energy += std::max(0.0, group->lost);
  }
  // all are told before any is judged: an island that steps from one of them tells impacts of its own
  for (const Outcome& o : group->collisions) {
    parts_.watch.note_overlap(o.contact.gap);
    count(o.pair);
    parts_.records.event(EventKind::collision, o.pair, o.contact, o.impulse_n, o.impulse_t, o.delay, o.body,
                         o.other);
  }
  for (const Outcome& o : group->collisions) parts_.watch.collided(o.pair);
  bool goes_on = true;  // where the run stops for now, all of them have happened
  for (const Outcome& o : group->collisions) {
    goes_on = judge(o, changed) && goes_on;
    // a stop may be gone on from, so what follows from the others is done; a failure may not
    if (halt() && halt()->termination == Termination::failed) break;
  }
  return regroup_after(pair, changed) && goes_on;
}

/// Also where the run stops here: it may go on later.
bool Kernel::regroup_after(const PairKey& pair, std::vector<int>& changed) {
  if (!parts_.grouping) return true;
  auto together = parts_.grouping(*this, pair);
  return !together || regroup(std::move(*together), changed);
}

bool Kernel::regroup(std::vector<std::vector<int>> together, std::vector<int>& changed) {
  // what was done ahead was done by components that may be no more
  roll_back_all();
  ++parts_.groupings;
  return parts_.trajectories.regroup(std::move(together), changed);
}

/// A collision that is certain is counted, recorded, and judged. False where the run is not to go on.
bool Kernel::tell(const Outcome& o, std::vector<int>& changed) {
  parts_.watch.note_overlap(o.contact.gap);
  count(o.pair);
  {
    const StageTimer::Sampled timed(parts_.run.timer(), parts_.run.work().seconds_record, events_timed_);
    parts_.records.event(EventKind::collision, o.pair, o.contact, o.impulse_n, o.impulse_t, o.delay, o.body,
                         o.other);
  }
  parts_.watch.collided(o.pair);
  return judge(o, changed);
}

/// The trace has it on the lane of each body that took part.
void Kernel::count(const PairKey& pair) {
  WorkCounters& work = parts_.run.work();
  ++work.collisions;
  ++(pair.with_site() ? work.collisions_body_site : work.collisions_body_body);
  if (!parts_.run.trace()) return;
  parts_.run.mark(TraceKind::collision, pair.body, parts_.search.other_owner(pair), time(), time());
  if (!pair.with_site()) parts_.run.mark(TraceKind::collision, pair.other_body, pair.body, time(), time());
}

/// What comes of the collision. Where it is the last for now, all that it brings about is done before.
bool Kernel::judge(const Outcome& o, std::vector<int>& changed) {
  // before the judgement: impacts in an island that steps because of it are counted, too
  const std::uint64_t count = collisions();
  const bool goes_on = judge_ending(o, changed);
  return !stop_at_limit(count) && goes_on;
}

/// Of max_collisions, or of stop_after_collisions(); true if it is met.
bool Kernel::stop_at_limit(std::uint64_t count) {
  if (!parts_.endings.at_limit(count)) return false;
  // a limit below the option's is that of stop_after_collisions()
  stop(Termination::stopped, options().max_collisions > 0 && count >= options().max_collisions
                                 ? fmt::format("max_collisions = {} reached at t = {:.15g}", count, time())
                                 : fmt::format("a collision at t = {:.15g}", time()));
  return true;
}

/// What it may be the end of.
bool Kernel::judge_ending(const Outcome& o, std::vector<int>& changed) {
  const auto ending = parts_.endings.collided(o, time(), parts_.response.loss_of(o.pair),
                                              parts_.response.gap_rounding(o.pair));
  if (!ending) return go_on_in_islands(o, changed) && poll();
  switch (ending->kind) {
    case Ending::Kind::zeno:
      if (parts_.islands.allowed()) return begin_to_last(o, ending->time, changed);
      parts_.records.ending(EventKind::zeno, o.pair, o.contact, ending->time);
      // ending->count: bounces low enough to be remembered (ZenoWatch); the streak: all in a row
      stop(Termination::failed,
           fmt::format(
               "Zeno at t = {:.15g} after {} bounces of {}: a contact that lasts begins, and {} ends there",
               ending->time,
               std::max<std::uint64_t>(ending->count, parts_.speculation.certain(o.pair.body).streak),
               name_of(o.pair),
               options().persistent ? fmt::format("policy \"{}\"", options().policy)
                                    : "solver.persistent = false"));
      return false;
    case Ending::Kind::group:
      // told once; from the next collision of this instant on resolve() takes contacts together, of which nobody is ahead
      roll_back_all();
      parts_.records.ending(EventKind::group, o.pair, o.contact, parts_.records.last_event());
      return go_on_in_islands(o, changed) && poll();
    case Ending::Kind::endless_group:
      stop(Termination::failed,
           fmt::format("a group of collisions at t = {:.15g} does not end ({} so far, the last {})", time(),
                       ending->count, name_of(o.pair)));
      return false;
  }
  return false;
}

/// The pair's bounces have their limit: a contact that lasts begins.
bool Kernel::begin_to_last(const Outcome& o, double limit, std::vector<int>& changed) {
  const StageTimer::Scope timed(parts_.run.timer(), parts_.run.work().seconds_islands);
  // an island takes in whoever is near, so nobody may be ahead of what is certain
  roll_back_all();
  // the collision itself has been told already: not before it
  parts_.records.ending(EventKind::persist, o.pair, o.contact, parts_.records.last_event());
  return parts_.islands.capture(o.pair, o.contact, limit, changed);
}

/// A collision of a member is a step of its island.
bool Kernel::go_on_in_islands(const Outcome& o, std::vector<int>& changed) {
  const bool concerned = is_held(o.pair.body) || (!o.pair.with_site() && is_held(o.pair.other_body));
  if (!concerned) return true;
  const StageTimer::Scope timed(parts_.run.timer(), parts_.run.work().seconds_islands);
  // An island steps from the present states of its members, and takes in who comes near.
  roll_back_all();
  // without an impulse two features have slid off each other within the step
  return parts_.islands.collided(o.pair, o.contact, o.impulse_n > 0.0, changed);
}

bool Kernel::step_island(std::vector<int>& changed) {
  parts_.run.set_time(next_step());
  parts_.policy_watch.going_to(time());
  const StageTimer::Scope timed(parts_.run.timer(), parts_.run.work().seconds_islands);
  roll_back_all();
  if (!parts_.watch.step_begins(parts_.islands.all().at(parts_.islands.next_island()).contacts)) return false;
  const bool goes_on = do_or_cut(parts_.islands.takes_long(parts_.islands.next_island()),
                                 [&] { return parts_.islands.step(changed); });
  // impacts within islands are collisions, too
  return goes_on && !stop_at_limit(collisions());
}

/// Begins a motion at another place with the same twist; nothing is told.
void Kernel::displace(int k, const Vec2& shift) {
  const Restart moved{k, body(k).motion.extended_state(time()).shifted(shift)};
  std::vector<int> changed;
  parts_.trajectories.restart({&moved, 1}, changed);
}

namespace {

/// Why a search could not tell, for people. `length`: the scene's [m]. The numbers in the text are those of
/// same_instant() and kSlowOfSize.
std::string reason(PairAnswer::Why why, const std::string& pair, double length) {
  switch (why) {
    case PairAnswer::Why::place:
      return fmt::format(
          "{} are close, but too far from the origin, or turned too often, for their gap to be told "
          "to solver.contact_tolerance of the scene's length, {:.3g} m (under springs and other forces that "
          "change, and of sites that formulas move, from some thousand lengths on; move the scene to the "
          "origin)",
          pair, length);
    case PairAnswer::Why::speed:
      return fmt::format(
          "{} are close, but too fast for the clock: they move more than a thousandth of their "
          "size within one instant (7e-15 s, or 32 of its roundings)",
          pair);
    case PairAnswer::Why::steps:
      break;
  }
  return fmt::format("the search for first contact of {} makes no headway", pair);
}

}  // namespace

/// Frames up to the certificate are shown: the pair is clear until then, and everybody else by the policy's word.
void Kernel::give_up(const Certificate& c) {
  // all up to there is told
  roll_back_all();
  if (extend_motions(c.time)) {
    record_frames(c.time);
    // within an instant the certificate may lie a rounding before the clock
    advance_all(std::max(time(), c.time));
  }
  parts_.records.ending(EventKind::undecided, c.pair, c.contact, c.time);
  stop(Termination::failed,
       fmt::format("undecided at t = {:.17g}: {}", c.time, reason(c.why, name_of(c.pair), world().length())));
}

// -- resolving ahead of time --

/// The clock is at the contact while it is resolved, since responses work at the present time, and then back where
/// it was. Whoever is changed goes on to `end`, or nothing is done.
bool Kernel::resolve_ahead(const Certificate& c, double end, std::vector<int>& changed) {
  // an island's step is taken when it is certain, so its members are never ahead
  if (is_held(c.pair.body) || (!c.pair.with_site() && is_held(c.pair.other_body))) return false;
  // nor what others have a part in: they may be ahead, or behind
  if (parts_.response.asks_others(c.contact)) return false;
  // contacts that are taken together are so when they are certain
  if (parts_.endings.is_crawling()) return false;
  const double present = time();
  advance_pair(c.pair, c.time);
  // before anything is resolved: it keeps what this collision is about to change
  const Speculation::Entry entry = parts_.speculation.before(c.pair);
  const auto outcome = respond(c.pair, c.contact, changed);
  bool done = outcome.has_value();
  // a motion that fails on the way makes nothing certain: then nothing is done ahead
  for (const int k : changed) done = done && extend_motion(k, end);
  // responses work at the clock's time; for everybody else it has not moved
  parts_.run.set_time(present);
  if (outcome) entry->outcome = *outcome;
  entry->end = end;
  // also where it failed: undo() takes it out again
  parts_.speculation.add(entry);
  WorkCounters& work = parts_.run.work();
  work.states_kept = std::max<std::uint64_t>(work.states_kept, states_kept());
  if (done) return true;
  if (halt() && halt()->termination == Termination::failed)
    parts_.run.forget_halt();  // may never come to pass
  changed.clear();
  parts_.speculation.undo(entry);
  return false;
}

/// What was resolved ahead of time is told as if it had been resolved now: the same event, and the same judgement
/// of what it ends.
bool Kernel::confirm(const Certificate& c, std::vector<int>& changed) {
  const Speculation::Entry entry = parts_.speculation.of(c.pair.body).front();
  // what it left is certain now; collisions that hang on it stay ahead
  parts_.speculation.remove(entry);
  parts_.run.set_time(entry->time);
  parts_.policy_watch.going_to(time());
  // Their motions are as they were: what has changed is that they are certain.
  for (const AheadCollision::Former& f : entry->former) changed.push_back(f.body);
  const bool goes_on = tell(entry->outcome, changed);
  return regroup_after(c.pair, changed) && goes_on;
}

// -- the run --

bool Kernel::record_frames(double t) {
  // a policy that shows frames up to t says that nothing is left before
  parts_.policy_watch.going_to(t);
  // one frame after another: a fault that the watch sees at one ends the run there
  while (!halt()) {
    const auto frame = parts_.records.frame_due(t);
    const auto look = parts_.looks.due(frame.value_or(t), collisions());
    if (!frame && !look) break;
    const double due = look ? *look : *frame;
    const StageTimer::Scope timed(parts_.run.timer(), parts_.run.work().seconds_record);
    // a run that goes on has this frame before it still
    if (!look && !parts_.records.get_ready(due)) break;
    // shown and watched are the motions that are certain; the newest may have begun after the frame
    parts_.speculation.swap_with_certain();
    if (!look) parts_.records.frame_of_clock(due);
    parts_.watch.frame(due);
    parts_.speculation.swap_with_certain();
    if (!poll()) parts_.run.set_time(due);  // all is clear up to t, and so up to here
  }
  return !halt();
}

void Kernel::show_frame() {
  const StageTimer::Scope timed(parts_.run.timer(), parts_.run.work().seconds_record);
  parts_.records.get_ready(time());
  parts_.records.frame(time());
  parts_.watch.frame(time());
}

bool Kernel::pause_point() {
  if (halt() || !parts_.run.ask()) return false;
  // not where the run has just been stopped: its last checkpoint is written at its end
  if (parts_.records.checkpoint_due()) {
    const StageTimer::Scope timed(parts_.run.timer(), parts_.run.work().seconds_record);
    parts_.records.checkpoint([this] { return snapshot(); });
  }
  return true;
}

/// RunKernel::restore() puts back what is here, part by part.
std::vector<std::byte> Kernel::snapshot() const {
  SavedRun saved;
  saved.time = time();
  saved.horizon = horizon();
  if (halt() && halt()->termination == Termination::failed) saved.failure = halt()->why;
  saved.watch = parts_.watch.saved();
  saved.records = parts_.records.saved();
  saved.endings = parts_.endings.saved();
  saved.islands = parts_.islands.saved();
  saved.taken = parts_.taken;
  saved.random = parts_.random.state();
  saved.work = parts_.run.work();
  // starts of motions, not their pieces: they are made again (snapshot.h)
  saved.trajectories = parts_.trajectories.saved();
  return encode(saved, parts_.fingerprint);
}

}  // namespace brink
