#include "brink/scheduler/kernel/islands.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "brink/core/base/disjoint_sets.h"
#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"

namespace brink {

namespace {

/// A step by modes that led on by less than this part of what was asked for is hasty, and so is a try at one that failed.
constexpr double kHasty = 0.05;
/// It costs as much as so many others: of steps at the level of velocities each makes up for one, of longer ones by modes
/// for so many. Who owes more than so many hasty steps takes none by modes: what buzzes without end gets on.
constexpr int kCostOfHasty = 16, kWorthOfLong = 4, kMostHasty = 64;

/// From this many members on, an island of which so many steps were cut short by impacts is agitated: its impacts
/// are taken where a step begins then. It stays so until some steps more had none.
constexpr std::size_t kCrowd = 8;
constexpr int kAgitated = 8, kMostAgitation = 32;

/// A step of so many members takes hundredths of a second, and a snapshot of so many bodies for each of them a tenth of that.
constexpr std::size_t kMany = 256, kBodiesEach = 64;

/// True if one of them bounces on another, on one of the others, or on a site.
bool any_bounces(const World& world, const std::set<int>& members, const std::set<int>& others = {}) {
  std::set<int> among, met;  // materials
  for (const int k : members) among.insert(world.bodies[k].material);
  met = among;
  for (const int k : others) met.insert(world.bodies[k].material);
  for (const FixedSite& site : world.sites) met.insert(site.material);
  return std::any_of(among.begin(), among.end(), [&](int a) {
    return std::any_of(met.begin(), met.end(),
                       [&](int b) { return combined(world, a, b).restitution > 0.0; });
  });
}

/// Where restitution is 0 a step takes every approach as plastic, and what cuts it comes from elsewhere.
bool is_agitated(const World& world, const IslandPace& pace, const std::set<int>& members) {
  return members.size() >= kCrowd && pace.agitation >= kAgitated && any_bounces(world, members);
}

/// From its highest an island calms down in 25 steps without impacts.
int next_agitation(int agitation, bool impacts) {
  return std::clamp(agitation + (impacts ? 1 : -1), 0, kMostAgitation);
}

/// What an island owes after one more step. A chatter that ends is followed to its end; in one that does not a hasty step
/// by modes comes to kCostOfHasty of the other kind.
int next_hasty(int hasty, bool tried, bool led_on) {
  if (tried && !led_on) return hasty + kCostOfHasty;
  return std::max(0, hasty - (tried ? kWorthOfLong : 1));
}

/// True if the last steps by modes led on by too little for more of them.
bool buzzes(const IslandPace& pace) { return pace.hasty >= kMostHasty * kCostOfHasty; }

/// Where it is, without speed.
ExtendedState at_rest(ExtendedState state) {
  state.twist = ExtendedTwist();
  return state;
}

}  // namespace

Islands::Islands(const World& world, Trajectories& trajectories, ContactSearch& search,
                 CollisionResponse& response, Records& records, RunControl& run, const Limits& limits)
    : world_(&world),
      trajectories_(&trajectories),
      search_(&search),
      response_(&response),
      records_(&records),
      run_(&run),
      limits_(limits) {}

/// The body, the island that it is in, and what springs couple to any of those, over and over: an island
/// holds components whole (Trajectories::hold). And who leans on it: their step has taken it to stand still.
void Islands::gather(int body, std::set<int>& members) const {
  // here already, and so are all who come with it
  if (members.count(body)) return;
  const auto lead = lead_of_.find(body);
  const Island* island = lead != lead_of_.end() ? &islands_.at(lead->second) : nullptr;
  const std::vector<int> with = island ? island->members : std::vector{body};
  members.insert(with.begin(), with.end());
  // springs couple each of these to others, and those bring their islands along
  for (const int k : with)
    for (const int j : trajectories_->coupled_to(k)) gather(j, members);
  if (!island) return;
  for (const HeldContact& c : island->leaning) gather(who_leans(*island, c), members);
}

/// Of many at rest the body alone.
void Islands::gather_or_rouse(int body, Attempt& attempt) const {
  if (stands_among_many(body))
    attempt.roused.insert(body);
  else
    gather(body, attempt.members);
}

/// Takes the islands of these members out of the list; their pairs are searched again. What is known of their contacts, to
/// start the next step from, goes to `warm`, and their pace joins `pace`.
void Islands::take_out(const std::set<int>& members, IslandPace& pace, WarmContacts& warm) {
  for (const int k : members) {
    // islands are listed by their least member: each is met once
    const auto found = islands_.find(k);
    if (found == islands_.end()) continue;
    if (found->second.rests) note_change(EventKind::wake, k), ++tally_.woken;
    for (const HeldContact& c : found->second.contacts) search_->search_again(c.pair);
    warm.add(found->second.contacts);
    // told when they have ended (tell_ended); what presses on in the same mode goes on as one stretch (put_in)
    taken_out_.add(pressing(found->second.contacts));
    // what cuts a step short may be others, too: one more than its end takes off
    const bool cut_short = !found->second.rests && found->second.due > run_->time();
    if (cut_short) found->second.pace.agitation += 2;
    pace.join(found->second.pace);
    for (const int j : found->second.members) lead_of_.erase(j);
    islands_.erase(found);
  }
}

/// Enters an island: its pairs are left out of searches. A contact that presses in the mode that it had when it was
/// taken out is one stretch with before; in another mode a new one begins.
void Islands::put_in(Island island) {
  for (HeldContact& c : island.contacts) {
    search_->leave_out(c.pair);
    if (c.mode == ContactMode::none) continue;
    HeldContact* before = taken_out_.find(c);
    const bool goes_on = before != nullptr && before->mode == c.mode;
    // a stretch that goes on keeps its beginning
    c.since = goes_on ? before->since : run_->time();
    if (goes_on) before->mode = ContactMode::none;  // it has not ended
  }
  // the least member names its island, in lists and events
  const int lead = island.members.front();
  for (const int k : island.members) lead_of_[k] = lead;
  islands_[lead] = std::move(island);
}

/// Those that were taken out and are in no island now have ended.
void Islands::tell_ended() {
  for (const HeldContact& c : taken_out_)
    if (c.mode != ContactMode::none) records_->lasted(c);
  taken_out_.clear();
}

void Islands::tell_lasting() const {
  for (const auto& [lead, island] : islands_)
    for (const HeldContact& c : island.contacts)
      if (c.mode != ContactMode::none) records_->lasted(c);
}

/// Due whenever the list or a due time in it has changed. Cost: a look at every island.
void Islands::find_next() {
  next_step_ = std::numeric_limits<double>::infinity();
  for (const auto& [lead, island] : islands_) next_step_ = std::min(next_step_, island.due);
}

/// An island, by its least member, comes to rest or is woken.
void Islands::note_change(EventKind kind, int lead) {
  FeatureContact none;
  none.time = run_->time();
  none.point = trajectories_->body(lead).motion.pose(run_->time()).position;
  records_->ending(kind, {lead, -1, -1, {}}, none, std::max(run_->time(), records_->last_event()));
}

/// An impact inside an island is a collision like any other.
void Islands::note_impact(const HeldContact& c, const RealVec& from, double closing, double normal,
                          double tangential) {
  WorkCounters& work = run_->work();
  ++work.collisions;
  ++(c.pair.with_site() ? work.collisions_body_site : work.collisions_body_body);
  FeatureContact f = as_told(c, from);
  f.closing_speed = closing;
  records_->event(EventKind::collision, c.pair, f, normal, tangential, 0);
}

/// At the present time, for events. `from`: position of the pair's other owner, from which the feature's point is
/// seen [m].
FeatureContact Islands::as_told(const HeldContact& c, const RealVec& from) const {
  FeatureContact f;
  f.time = run_->time();
  f.sample_on_a = c.feature.sample_on_a;
  f.sample = c.feature.sample;
  f.site = c.feature.site;
  f.point = (from + c.feature.point.cast<Real>()).cast<double>();
  f.normal = c.feature.normal;
  f.gap = c.feature.gap;
  return f;
}

/// A contact begins to stick, to slip, or is no more.
void Islands::note_mode(const HeldContact& c, const RealVec& from, EventKind kind) {
  records_->ending(kind, c.pair, as_told(c, from), std::max(run_->time(), records_->last_event()));
}

/// What happened at the beginning of a step by modes.
void Islands::tell(const IslandModes& modes, const IslandMembers& members) {
  ++tally_.by_modes;
  for (const IslandModes::Impact& i : modes.impacts())
    note_impact(i.contact, members.other_state(i.contact.pair).position, i.closing, i.normal, i.tangential);
  for (const IslandModes::Change& c : modes.changes())
    note_mode(c.contact, members.other_state(c.contact.pair).position, c.kind);
}

/// When the step ends that the island of this body is in the middle of, if that one is larger than so many [s]; else
/// infinity.
double Islands::larger_step_end(int body, std::size_t than) const {
  const auto lead = lead_of_.find(body);
  if (lead == lead_of_.end()) return kForever;
  const Island& other = islands_.at(lead->second);
  const bool goes_on = !other.rests && other.due - run_->time() > same_instant(run_->time());
  return goes_on && other.members.size() > than ? other.due : kForever;
}

/// Members are held from now on, also those that join; what they push each other with is taken out. Those of a larger
/// island in the middle of its step do not: the two meet where that step ends, and `longest` is no later. Else what
/// falls onto a heap would begin the heap's step anew, and the heap's own look about takes it in in time.
/// Of many at rest nobody joins for being near: they are leant on.
IslandMotion Islands::set_out(Attempt& attempt) {
  rouse(attempt);
  std::set<int>& members = attempt.members;
  // who joins brings an island of its own along, and may be near to others in turn
  for (;;) {
    take_out(members, attempt.pace, attempt.warm);
    std::vector<Restart> as_they_are;
    for (const int k : members)
      if (!trajectories_->is_held(k))
        as_they_are.push_back({k, trajectories_->body(k).motion.extended_state(run_->time())});
    // told to nobody: part() and give_up() change the motion of every member once more
    std::vector<int> held;
    trajectories_->hold(as_they_are, held);
    const auto motion_on = [&](const std::set<int>& supports) {
      return IslandMotion(IslandMembers(*world_, *trajectories_, *search_, run_->time(), members, supports),
                          *search_, *response_, solver_, tally_, attempt.warm,
                          [this] { return !run_->is_cut(); });
    };
    IslandMotion motion = motion_on({});
    // who asked for a tolerance has exact impacts
    const bool agitated = limits_.tolerance == 0.0 && is_agitated(*world_, attempt.pace, members);
    if (agitated) motion.expect_agitation();
    attempt.leans = attempt.leans && !agitated && motion.members().are_constant();
    attempt.supports.clear();
    std::vector<int> more = motion.joining(*world_, *trajectories_, run_->time());
    std::erase_if(more, [&](int k) {
      const double other_ends = larger_step_end(k, members.size());
      attempt.longest = std::min(attempt.longest, other_ends - run_->time());
      const bool stands = attempt.leans && stands_among_many(k);
      if (stands) attempt.supports.insert(k);
      return stands || other_ends < kForever;
    });
    if (more.empty()) return attempt.supports.empty() ? std::move(motion) : motion_on(attempt.supports);
    for (const int k : more) gather(k, members);
  }
}

/// Sites are known through a step of h [s]. False where a site's motion fails.
bool Islands::follow_sites(double now, double h) {
  if (!trajectories_->cover_sites(now + h)) return false;
  trajectories_->follow_sites(now + 2.0 * h);  // what is beyond the end must not depend on who has asked
  return true;
}

/// How long no force on the members jumps, or changes by more than a step sees that looks at its begin and halfway [s].
double Islands::steady_for(const std::set<int>& members, double now) {
  double until = kForever;
  for (const int k : members)
    until = std::min({until, trajectories_->next_break(k), trajectories_->steady_until(k)});
  return until - now;
}

/// `longest`: the step is no longer [s]. The last thing that its caller does: false where the run stops for now, too,
/// which may go on later.
bool Islands::begin_step(Attempt attempt, std::vector<int>& changed, const StepCause& cause) {
  return carry_out_step(std::move(attempt), changed, cause) && run_->poll();
}

/// Members gather and are held; what closes fast meets; then they are at rest, or move on by modes, or at
/// the level of velocities; and who pushes whom makes the islands from here on.
/// Members are in no island from set_out() to part(): a failure between the two lets all of them go. `longest`
/// bounds the step [s]; false where the run is not to go on.
bool Islands::carry_out_step(Attempt attempt, std::vector<int>& changed, const StepCause& cause) {
  // Islands are out of their list while this goes on: a stop in between would leave their bodies held by
  // nobody. What is cut all the same is undone by whoever has made that possible.
  const RunControl::Indivisible whole(*run_);
  for (;;)
    if (const std::optional<bool> done = attempt_step(attempt, changed, cause)) return *done;
}

/// Nothing: more wake, who join.
std::optional<bool> Islands::attempt_step(Attempt& attempt, std::vector<int>& changed,
                                          const StepCause& cause) {
  IslandMotion motion = set_out(attempt);
  const std::set<int>& members = attempt.members;
  IslandPace& pace = attempt.pace;
  // Members are in no island by now: all are let go to what moved them before.
  const auto give_up = [&] {
    trajectories_->release(std::vector<int>(members.begin(), members.end()), changed);
    tell_ended();
    find_next();
    return false;
  };
  const double now = run_->time();
  const bool leans = !attempt.supports.empty();
  const auto again = [&, before = tally_] {
    const int factorisations = static_cast<int>(tally_.factorisations - before.factorisations);
    tally_ = before;
    tally_.factorisations += factorisations;
    return std::nullopt;
  };
  const auto wake_all = [&] {
    for (const int k : attempt.supports) gather(k, attempt.members);
    attempt.leans = false;
    return again();
  };
  // what stands takes no part in impacts
  if (leans && any_bounces(*world_, members, attempt.supports) && motion.any_impacts()) return wake_all();
  motion.expect_step(pace.step);
  motion.expect_sides(cause);
  if (cause.captured) motion.expect_captured(*cause.pair);
  IslandModes modes(motion.members(), *trajectories_, *search_, *response_, by_modes_, motion.warm());
  // what buzzes is spared modes for some steps
  const IslandModes::Fit fit = modes.fit();
  const bool may_have_modes = !leans && !buzzes(pace) && fit == IslandModes::Fit::suited;
  if (may_have_modes) motion.expect_modes();
  const std::uint64_t collisions = run_->work().collisions;
  // before impacts: those of an agitated island are looked for along the step
  if (const double ahead = motion.longest(); std::isfinite(ahead) && !follow_sites(now, ahead))
    return give_up();
  const auto pass_on_impacts = [&] {
    if (leans || !any_bounces(*world_, members)) return;
    motion.pass_on_impacts(
        [this](const HeldContact& c, const RealVec& from, double closing, const ImpulseResult& r) {
          note_impact(c, from, closing, r.normal, r.tangential);
        });
  };
  pass_on_impacts();
  // an impact here is news: modes that the step before ended in do not hold
  const bool on_time = cause.on_time && run_->work().collisions == collisions;
  if (run_->is_cut()) return give_up();
  const bool rests = motion.rests(limits_.rest_speed);
  // anew: impacts have changed speeds
  double h = 0.0;
  const auto set_length = [&] {
    h = std::min({attempt.longest, motion.longest(), steady_for(members, now)});
    if (rests || !std::isfinite(h)) return true;
    if (!follow_sites(now, h)) return false;
    h = motion.even_for(h);
    return true;
  };
  if (!set_length()) return give_up();
  // rest first: it is exact and free; modes next, as they keep to a tolerance; steps of first order last
  const bool by_modes = !rests && motion.take(modes, now, h, on_time);
  if (may_have_modes && !rests && !by_modes) {
    // what modes would have met all at once, or left to another contact, is an impact where a step begins
    motion.expect_steps();
    pass_on_impacts();
    if (run_->is_cut() || !set_length()) return give_up();
  }
  if (!rests && !by_modes && !motion.take(h, limits_.tolerance)) {
    if (run_->is_cut()) return give_up();
    run_->stop(
        Termination::failed,
        fmt::format("an island of {} bodies, '{}' the first, finds no step at t = {:.17g} that keeps its "
                    "contacts{}",
                    members.size(), world_->bodies[*members.begin()].name, now,
                    motion.closes_in() < 0 ? ""
                                           : fmt::format(": '{}', which moves, leaves no room",
                                                         world_->sites[motion.closes_in()].name)));
    return give_up();
  }
  if (!carries(motion, attempt)) return run_->is_cut() ? std::optional(give_up()) : again();
  // at rest they are laid beside those whom they touch
  const bool laid = attempt.leans && !by_modes && (leans || !rests) && std::isfinite(h) &&
                    lay_to_rest(motion, rests, attempt);
  if (run_->is_cut()) return give_up();
  if (rests && leans && !laid) return wake_all();
  ++tally_.steps;
  if (by_modes) tell(modes, motion.members());
  if (!by_modes && !rests && fit != IslandModes::Fit::too_large) ++tally_.small_by_steps;
  pace.hasty = next_hasty(pace.hasty, may_have_modes && !rests, by_modes && modes.end() - now >= kHasty * h);
  pace.agitation = next_agitation(pace.agitation, motion.impacts_in_step());
  pace.step = rests || by_modes ? kForever : motion.next_step();
  if (rests) ++tally_.slept;
  if (rests && !laid) note_change(EventKind::sleep, *members.begin());
  // of those who have joined for this step and stand after all nothing is told
  if (!attempt.were_at_rest.empty())
    note_change(EventKind::wake, *attempt.were_at_rest.begin()), ++tally_.woken;
  // only for a step that has been found: it puts members into islands again
  part(motion, rests, by_modes ? &modes : nullptr, pace, changed);
  if (run_->is_cut()) return false;
  tell_ended();
  // a body that was held, let go and held again is in it more than once
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  find_next();
  return true;
}

/// Members that push each other are islands; those that nothing pushes are let go, as they were.
void Islands::part(const IslandMotion& motion, bool rests, const IslandModes* modes, const IslandPace& pace,
                   std::vector<int>& changed) {
  // who pushes whom is known from the step that has been found
  const IslandParting parting = motion.parting();
  const IslandParts parts = parting.parts(rests);
  const IslandMembers& members = motion.members();
  const double now = run_->time(), end = modes ? modes->end() : now + motion.duration();
  std::vector<Restart> held, as_they_are;
  std::vector<int> free;
  // each set is an island of its own: what has come apart steps by itself from here on
  for (const std::vector<int>& together : parts.together) {
    for (const int i : together)
      // a step of constant twists begins where the member is, with the twist that it comes to
      held.push_back({members.bodies()[i], rests || modes ? members.state(i) : motion.after(i)});
    Island island = parting.island_of(together, rests, end);
    island.pace = pace;
    put_in(std::move(island));
    if (run_->is_cut()) return;
  }
  for (const int i : parts.free) {
    free.push_back(members.bodies()[i]);
    as_they_are.push_back({members.bodies()[i], modes ? modes->let_go(i) : members.state(i)});
  }
  for (int i = 0; i < static_cast<int>(members.count()); ++i)
    if (motion.is_at_rest(i)) held.push_back({members.bodies()[i], at_rest(members.state(i))});
  trajectories_->hold(held, changed);
  // Those that are let go as well: their impacts of this instant are in their states, and release() goes
  // on from what is held.
  trajectories_->hold(as_they_are, changed);
  trajectories_->release(free, changed);
  lean_no_more(free);
  if (rests) return;
  for (const std::vector<int>& together : parts.together)
    // a step by modes is a motion of its own; one of constant twists notes what it began with, for
    // collisions within it
    for (const int i : together) {
      if (modes)
        trajectories_->follow_own(members.bodies()[i], modes->motion(i));
      else
        trajectories_->note_step(members.bodies()[i], {now, end, members.state(i).twist.rounded()});
    }
}

/// Where the limit is now, the event is told at once. Where it lies ahead, it is told when the first step ends
/// there (step()), and not at all where something else ends that step before.
bool Islands::capture(const PairKey& pair, const FeatureContact& contact, double limit,
                      std::vector<int>& changed) {
  std::set<int> members;
  gather(pair.body, members);
  if (!pair.with_site()) gather(pair.other_body, members);
  ++tally_.captured;
  const double left = limit - run_->time();
  // The limit may still lie ahead. The island begins now, and its first step ends there at the latest:
  // that is where the event is told.
  const bool later = left > same_instant(limit);
  if (!later) records_->ending(EventKind::zeno, pair, contact, records_->last_event());
  if (!carry_out_step({.members = members, .longest = later ? left : kForever}, changed,
                      {.pair = &pair, .met = &contact, .captured = later}))
    return false;
  if (later) tell_at(limit, pair, contact);
  return run_->poll();
}

/// Of the island that the pair's body is in now: the limit of its bounces is told when the clock comes to it.
void Islands::tell_at(double limit, const PairKey& pair, const FeatureContact& contact) {
  const auto lead = lead_of_.find(pair.body);
  if (lead == lead_of_.end()) return;
  Island& island = islands_.at(lead->second);
  // something else ends the step before: no limit is told that bounces did not come to
  if (!island.rests && std::abs(island.due - limit) > same_instant(limit)) return;
  // forces jump before: it is woken then
  if (island.due <= limit && island.rests) return;
  // one at rest has its next step at the limit, only to tell it, and what it waited for afterwards
  island.then = island.due;
  island.due = limit;
  island.series = pair;
  island.series_contact = contact;
  find_next();
}

/// Bodies that touch, and those that touch them in turn, begin a step together. Pairs are told before any island
/// has come to rest.
bool Islands::begin(const std::vector<std::pair<PairKey, FeatureContact>>& touching,
                    std::vector<int>& changed) {
  DisjointSets joined;
  joined.reset(trajectories_->body_count());
  for (const auto& [pair, contact] : touching) {
    records_->ending(EventKind::persist, pair, contact, records_->last_event());
    ++tally_.captured;
    // sites join nobody: two bodies on one floor are two islands
    if (!pair.with_site()) joined.unite(pair.body, pair.other_body);
  }
  for (const auto& [pair, contact] : touching) {
    if (is_member(pair.body)) continue;  // with another of its contacts
    std::set<int> members;
    // with whom springs couple to them, as islands hold components whole
    for (const int k : joined.of(pair.body)) gather(k, members);
    if (!carry_out_step({.members = members}, changed, {.run_begins = true, .pair = &pair, .met = &contact}))
      return false;
  }
  return run_->poll();
}

bool Islands::takes_long(int body) const {
  const auto lead = lead_of_.find(body);
  if (lead == lead_of_.end()) return false;
  const std::size_t members = islands_.at(lead->second).members.size();
  return members >= kMany && kBodiesEach * members >= world_->bodies.size();
}

/// To the bit: next_step_ is the `due` of one of them. The list is by least members, so the first that fits is the
/// least.
int Islands::next_island() const {
  return std::find_if(islands_.begin(), islands_.end(),
                      [&](const auto& i) { return i.second.due == next_step_; })
      ->first;
}

/// The end of a step is no news to its members: with `on_time` the next may go on in the modes that they have.
bool Islands::step(std::vector<int>& changed) {
  Island& island = islands_.at(next_island());
  // bounces that led to its capture have the limit here that was foreseen then
  if (island.series.body >= 0)
    records_->ending(EventKind::zeno, island.series, island.series_contact,
                     std::max(island.due, records_->last_event()));
  if (std::exchange(island.series.body, -1) >= 0 && island.rests) {  // it has come to rest before
    island.due = island.then;
    find_next();
    return run_->poll();
  }
  std::set<int> members;
  gather(island.members.front(), members);
  return begin_step({.members = members}, changed, {.on_time = true});
}

/// How long the sample goes on before it comes to an end of the straight site, as the two move now [s].
double Islands::slides_off_in(const PairKey& pair, const FeatureContact& f) const {
  const double now = run_->time();
  ExtendedState a = trajectories_->state_now(pair.body), b = search_->other_state(pair, now);
  if (!pair.with_site()) b.twist = trajectories_->state_now(pair.other_body).twist;
  const Outline &of_a = search_->outline_of(pair.body),
                &of_b = search_->outline_of(search_->other_owner(pair));
  // both are seen from the other's place: far from the origin nothing of what is between them is lost
  const Vec2 base = b.position.cast<double>();
  const Placed at_a(of_a, a.seen_from(base)), at_b(of_b, b.seen_from(base));
  const Sample& sample = (f.sample_on_a ? of_a : of_b).samples[f.sample];
  // of an arc or a point no such time is told: the step has a length of its own
  const Site& site = (f.sample_on_a ? of_b : of_a).sites[f.site];
  if (site.kind != SiteKind::segment) return kForever;
  const SamplePath path = sample_path(f.sample_on_a ? at_a : at_b, f.sample_on_a ? at_b : at_a, sample.p);
  const Vec2 d = (site.b - site.a).normalized();
  const double speed = d.dot(path.rate), left = speed > 0.0 ? d.dot(site.b - path.q) : d.dot(path.q - site.a);
  // an instant more than that: by then it is beyond the end, not a rounding before it
  return speed != 0.0 && left >= 0.0 ? left / std::abs(speed) + same_instant(now) : kForever;
}

bool Islands::collided(const PairKey& pair, const FeatureContact& found, bool pushed,
                       std::vector<int>& changed) {
  Attempt attempt;
  gather_or_rouse(pair.body, attempt);
  if (!pair.with_site()) gather_or_rouse(pair.other_body, attempt);
  // what a picture shows names no features that could slide
  if (!pushed && !found.seen) attempt.longest = slides_off_in(pair, found);
  return begin_step(std::move(attempt), changed, {.pair = &pair, .met = &found});
}

bool Islands::disturbed(int body, std::vector<int>& changed) {
  std::set<int> members;
  gather(body, members);
  return begin_step({.members = members}, changed);
}

Islands::Saved Islands::saved() const {
  Saved all{{}, tally_};
  for (const auto& [lead, island] : islands_) all.islands.push_back(island);
  return all;
}

void Islands::restore(const Saved& saved) {
  for (const auto& [lead, island] : islands_)
    // what the present islands keep is searched again before others take over
    for (const HeldContact& c : island.contacts) search_->search_again(c.pair);
  islands_.clear();
  lead_of_.clear();
  taken_out_.clear();
  for (const Island& island : saved.islands) {
    // put_in() finds them there, so that their stretches go on
    taken_out_.add(pressing(island.contacts));
    put_in(island);
  }
  taken_out_.clear();  // all of them go on
  tally_ = saved.tally;
  find_next();
}

}  // namespace brink
