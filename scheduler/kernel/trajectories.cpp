#include "brink/scheduler/kernel/trajectories.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "brink/core/base/error.h"
#include "brink/core/base/limits.h"
#include "brink/core/base/log.h"
#include "brink/scheduler/kernel/stage_clock.h"
#include "brink/scheduler/kernel/states_apart.h"

namespace brink {

namespace {

/// Pieces of motion that one round of instalments makes at most, of all bodies together: some 50 MB.
constexpr std::uint64_t kMostPieces = 1U << 17;
constexpr std::uint64_t kShortest = 16, kLongest = 4096;  ///< instalments [steps]
/// Who is warned of: whose integrator has taken so many steps in a row of which more than kEndless are left to the end.
constexpr std::uint64_t kCrawls = 1U << 17;
constexpr double kEndless = 1e10;

/// A locked coordinate has no velocity: nothing would ever take it away.
BodyState held(const Body& body, BodyState s) {
  if (body.lock_x) s.twist.velocity.x() = 0.0;
  if (body.lock_y) s.twist.velocity.y() = 0.0;
  if (body.lock_angle) s.twist.omega = 0.0;
  return s;
}

/// Above all versions that were undone, too: a certificate of one of those must not seem to speak of this
/// motion.
void raise_version(BodyTrack& b) { b.version = std::max(b.version, b.last_undone) + 1; }

/// A start at t [s]. `with_lows`: what the rounding of poses to double leaves over is kept beside the states; else
/// it is dropped.
ComponentStart start_from(double t, std::span<const ExtendedState> states, bool with_lows) {
  ComponentStart start;
  start.time = t;
  for (const ExtendedState& s : states) {
    start.states.push_back(s.rounded());
    if (with_lows) start.lows.push_back(s.low().pose);
  }
  return start;
}

/// True for a parabola that no break ends: it needs no integrator. One whose thrust starts or stops is
/// made of several.
bool moves_in_closed_form(const Dynamics& dynamics, double t) {
  return dynamics.size() == 1 && dynamics.constant() && std::isinf(dynamics.next_break(t));
}

}  // namespace

/// What moves a body is told by BodyTrack::component:
///   - kFree: a parabola, made here, that reaches for ever;
///   - an index: the integrator of that component, which appends to its motions as it is asked (follow());
///   - kHeld: an island, which gives the body a new motion with every step. What drove it before is kept in
///     `held_`, and an integrator among that sleeps until release().
/// Bodies pass from one to another at the present time alone, but where a state is put back, and each time the
/// version is raised.
Trajectories::Trajectories(const World& world, const SolverOptions& options, RunControl& run)
    : world_(&world),
      options_(&options),
      closed_forms_(options.integrator == "auto" || options.integrator == "ballistic"),
      most_jump_(options.contact_tolerance * world.length()),
      run_(&run) {
  bodies_.resize(world.bodies.size());
  std::vector<BodyState> initial;
  for (const Body& b : world.bodies) initial.push_back(held(b, b.initial));
  for (Component& c : make_components(world)) {
    std::vector<ExtendedState> states;
    for (const int k : c.bodies) states.emplace_back(initial[k]);
    // given as doubles: no rounding has left anything over
    add_component(std::move(c), start_from(0.0, states, false));
  }
  run.work().component_resets = 0;  // first starts are no resets
  for (const FixedSite& site : world.sites) sites_.emplace_back(site);
  site_failures_.resize(sites_.size());
}

/// A parabola where nothing else is needed, an integrator otherwise.
void Trajectories::add_component(Component component, ComponentStart start) {
  if (!closed_forms_ || !moves_in_closed_form(*component.dynamics, start.time))
    return add_coupled(std::move(component), std::move(start));
  BodyState low;
  if (!start.lows.empty()) low.pose = start.lows.front();
  add_free(component, start.time, start.states.front(), low);
}

void Trajectories::add_free(const Component& component, double t, const BodyState& start,
                            const BodyState& low) {
  Acceleration acceleration;
  // constant, so those of the start are those of every time (moves_in_closed_form)
  component.dynamics->accelerations(t, {&start, 1}, {&acceleration, 1});
  BodyTrack& b = bodies_[component.bodies.front()];
  b.motion = Motion::ballistic(t, start, acceleration, kForever, low);
  b.component = -1;
}

/// Components are numbered as they are added. Snapshots list their starts in that order, without numbers.
void Trajectories::add_coupled(Component component, ComponentStart from) {
  for (std::size_t i = 0; i < component.bodies.size(); ++i) {
    BodyTrack& b = bodies_[component.bodies[i]];
    b.component = static_cast<int>(components_.size());
    b.place_in_component = static_cast<int>(i);
  }
  Coupled coupled{std::move(component), nullptr, {}, {}};
  coupled.integrator = make_integrator(options_->integrator, coupled.component.dynamics,
                                       options_->integrator_options(), &run_->work());
  components_.push_back(std::move(coupled));
  start(components_.back(), std::move(from));
}

std::vector<BodyState> Trajectories::states(double t) const {
  std::vector<BodyState> all;
  all.reserve(bodies_.size());
  for (const BodyTrack& b : bodies_) all.push_back(b.motion.state(t));
  return all;
}

bool Trajectories::is_ballistic(int k) const {
  return bodies_[k].component < 0 ||
         (closed_forms_ && components_[bodies_[k].component].component.dynamics->constant());
}

// -- going on --

/// The more bodies there are, the fewer steps each makes in a round.
std::uint64_t Trajectories::instalment() const {
  const std::uint64_t movers = bodies_.size() + sites_.size();
  return std::clamp(kMostPieces / std::max<std::uint64_t>(movers, 1), kShortest, kLongest);
}

/// A motion taken before the first extend() does not grow (Integrator::motion), so it is taken anew each
/// time. What the rounding of a grouped body's place left over is kept beside the integrator.
void Trajectories::fetch(const Coupled& c) {
  for (std::size_t i = 0; i < c.component.bodies.size(); ++i) {
    Motion& motion = bodies_[c.component.bodies[i]].motion;
    motion = c.integrator->motion(static_cast<int>(i));
    if (!c.begun.lows.empty()) motion.keep_low(c.begun.lows[i]);
  }
}

/// One instalment. A failure is noted, not acted on: its time may never come, if a collision before starts
/// the component afresh.
double Trajectories::follow(Coupled& c, double t) {
  // an island moves its bodies: the integrator is not asked until it is started afresh
  if (c.dormant) return t;
  const int first = c.component.bodies.front();
  // one integrator makes the pieces of all its bodies: they end together
  const double covered = bodies_[first].motion.end();
  // also beyond t: steps are the integrator's own
  if (covered >= t) return t;
  // a failure is lasting: the integrator would only say so again
  if (covered >= c.failure.time) return covered;
  const std::uint64_t before = run_->work().solver_steps;
  const Extent extent = c.integrator->extend(t, instalment());
  // a step makes one piece for each body
  run_->count_pieces((run_->work().solver_steps - before) * c.component.bodies.size());
  if (run_->work().solver_steps > before)
    note_pace(c, covered, extent.end, run_->work().solver_steps - before);
  fetch(c);
  if (extent.status == Extent::Status::failed)
    note_failure(c.failure, extent.end, "'" + world_->bodies[first].name + "'", extent.why);
  return std::min(extent.end, t);
}

/// Says so, once, where steps have become so short that the run would not end in hours: a force that is not continuous, say, is
/// followed in ever shorter ones.
void Trajectories::note_pace(Coupled& c, double from, double to, std::uint64_t steps) {
  const double left = run_->options().until - to, step = (to - from) / static_cast<double>(steps);
  const std::uint64_t before = c.crawled;
  c.crawled = std::isfinite(left) && left > kEndless * step ? before + steps : 0;
  if (before >= kCrawls || c.crawled < kCrawls) return;
  log().warn(
      "the motion of '{}' is followed in steps of {:.1e} s at t = {:.9g} s, and {:.0e} of them are left: "
      "its force jumps there, or changes too fast",
      world_->bodies[c.component.bodies.front()].name, step, to, left / step);
}

/// One instalment of a site that moves by formulas; all others are known for ever.
double Trajectories::follow_site(int s, double t) {
  if (!sites_[s].is_prescribed() || sites_[s].motion().end() >= t) return t;
  const Extent extent = sites_[s].extend(t, instalment());
  // cells are not counted one by one: as many as there may have been
  run_->count_pieces(instalment());
  if (extent.status == Extent::Status::failed)
    note_failure(site_failures_[s], extent.end, "fixed site '" + world_->sites[s].name + "'", extent.why);
  return std::min(extent.end, t);
}

/// Of a body that an integrator drives, its whole component; free and held ones are there already.
double Trajectories::follow_body(int k, double t) {
  const BodyTrack& b = bodies_[k];
  if (b.component < 0 || b.motion.end() >= t) return t;
  const StageTimer::Scope timed(run_->timer(), run_->work().seconds_motion);
  const double covered = follow(components_[b.component], t);
  run_->poll();
  return covered;
}

/// A halt leaves sites that were not reached as they are: what is returned is no promise for them.
double Trajectories::follow_sites(double t) {
  double covered = t;
  for (int s = 0; s < site_count() && run_->poll(); ++s) covered = std::min(covered, follow_site(s, t));
  return covered;
}

double Trajectories::follow(double t) {
  if (components_.empty() && sites_.empty()) return t;  // free flights go on by themselves
  const StageTimer::Scope timed(run_->timer(), run_->work().seconds_motion);
  double covered = t;
  for (Coupled& c : components_) {
    // on a halt: all cover the present time at least
    if (!run_->poll()) return run_->time();
    covered = std::min(covered, follow(c, t));
  }
  return std::min(covered, follow_sites(t));
}

/// Instalment after instalment, so that `progress` is asked in between. Halts where the motion fails before t.
bool Trajectories::cover(Coupled& c, double t) {
  while (follow(c, t) < t)
    if (stop_at(c.failure) || !run_->poll()) return false;
  return true;
}

bool Trajectories::cover_body(int k, double t) {
  const BodyTrack& b = bodies_[k];
  if (b.component < 0 || b.motion.end() >= t) return true;
  const StageTimer::Scope timed(run_->timer(), run_->work().seconds_motion);
  return cover(components_[b.component], t);
}

bool Trajectories::cover_sites(double t) {
  for (int s = 0; s < site_count(); ++s)
    while (follow_site(s, t) < t)
      if (stop_at(site_failures_[s]) || !run_->poll()) return false;
  return true;
}

bool Trajectories::cover(double t) {
  if (components_.empty() && sites_.empty()) return true;
  const StageTimer::Scope timed(run_->timer(), run_->work().seconds_motion);
  for (Coupled& c : components_)
    if (!cover(c, t)) return false;
  return cover_sites(t);
}

/// `end`: where the motion ends [s]; `name`: what the message calls it.
void Trajectories::note_failure(Failure& of, double end, const std::string& name, const std::string& why) {
  of = {end, fmt::format("motion of {} stopped at t = {:.17g}: {}", name, end, why)};
  find_reach();
}

void Trajectories::find_reach() {
  reach_ = std::numeric_limits<double>::infinity();
  // from all: the failure that was nearest may have gone with a fresh start
  for (const Coupled& c : components_) reach_ = std::min(reach_, c.failure.time);
  for (const Failure& f : site_failures_) reach_ = std::min(reach_, f.time);
}

/// Ends the run for that failure, if it is one; true then.
bool Trajectories::stop_at(const Failure& failure) {
  if (std::isfinite(failure.time)) run_->stop(Termination::failed, failure.why);
  return std::isfinite(failure.time);
}

/// By the failure that made reach_: several at one time are one halt.
bool Trajectories::stop_at_reach() {
  for (const Coupled& c : components_)
    if (c.failure.time == reach_) return stop_at(c.failure);
  for (const Failure& f : site_failures_)
    if (f.time == reach_) return stop_at(f);
  return false;
}

bool Trajectories::much_to_forget() const { return run_->pieces() - forgotten_ > kMostPieces; }

/// Mostly does nothing: pieces are given back in lots, when a round's worth of new ones has been made.
void Trajectories::forget_before(double t) {
  if (!much_to_forget()) return;
  forgotten_ = run_->pieces();
  for (Coupled& c : components_)
    if (!c.dormant) c.integrator->forget_before(t);
  for (SiteMotion& s : sites_) s.forget_before(t);
}

// -- starting afresh --

/// The component begins there, at the present time or, where it is put back, before. All its motions are new.
void Trajectories::start(Coupled& c, ComponentStart from) {
  c.begun = std::move(from);
  c.integrator->start(c.begun.time, c.begun.states);
  fetch(c);
  // the failure was of the motion that ends here
  if (std::isfinite(c.failure.time)) {
    c.failure = {};
    find_reach();
  }
  ++run_->work().component_resets;
}

void Trajectories::restart_free(int k, const BodyState& start, const BodyState& low) {
  note_twist_before(k);
  if (is_held(k)) tell_knot(k, start);
  Motion& motion = bodies_[k].motion;
  // The acceleration stays: a free body's own, or none of one that an island holds.
  if (motion.is_ballistic())
    motion.start_anew(run_->time(), start, low);
  else  // held, on a motion of its own
    motion = Motion::ballistic(run_->time(), start, {}, kForever, low);
  raise_version(bodies_[k]);
  ++run_->work().component_resets;
}

void Trajectories::restart(std::span<const Restart> touched, std::vector<int>& changed) {
  // A component has one integrator: where one body is touched, all begin anew with it, the others as they
  // are.
  const int first = touched.front().body, component = bodies_[first].component;
  if (component < 0) {
    changed.push_back(first);
    // its twist is the restart's from here on, also of one that is hit right where its step begins
    if (is_held(first)) held_.forget_step(first);
    return restart_free(first, touched.front().state.rounded(), touched.front().state.low());
  }
  Coupled& c = components_[component];
  changed.insert(changed.end(), c.component.bodies.begin(), c.component.bodies.end());
  std::vector<ExtendedState> states;
  for (const int j : c.component.bodies) {
    // those that are not touched go on from where they are
    states.push_back(bodies_[j].motion.extended_state(run_->time()));
    raise_version(bodies_[j]);
  }
  for (const Restart& r : touched) {
    note_twist_before(r.body);
    states[bodies_[r.body].place_in_component] = r.state;
  }
  // lows stay where the component had them (ComponentStart); one without them starts from rounded states
  start(c, start_from(run_->time(), states, !c.begun.lows.empty()));
}

// -- islands --

void Trajectories::hold(std::span<const Restart> bodies, std::vector<int>& changed) {
  for (const Restart& r : bodies) {
    BodyTrack& b = bodies_[r.body];
    watch_start(r.body, r.state);
    tell_knot(r.body, r.state.rounded());
    // One that is held already keeps what it was before its island: it is let go to that.
    if (b.component != BodyTrack::kHeld) {
      held_.add(r.body, {b.component, b.component < 0 ? b.motion.acceleration() : Acceleration{}, {}});
      if (b.component >= 0) put_to_sleep(components_[b.component]);
      b.component = BodyTrack::kHeld;
    }
    // without acceleration: what forces do in a step is in the twist that its island gives
    b.motion = Motion::ballistic(run_->time(), r.state.rounded(), {}, std::numeric_limits<double>::infinity(),
                                 r.state.low());
    // until note_step() says otherwise its twist is the one that it has come to
    held_.forget_step(r.body);
    raise_version(b);
    changed.push_back(r.body);
  }
}

/// Ends the run where a motion does not begin where the body is: nobody jumps, whatever an island makes of its contacts.
void Trajectories::watch_start(int k, const ExtendedState& start) {
  const double jump = states_apart(start, bodies_[k].motion.extended_state(run_->time()),
                                   world_->bodies[k].outline->bounding_radius);
  if (jump <= most_jump_) return;
  run_->stop(
      Termination::failed,
      fmt::format(
          "'{}' jumps by {:.3g} m at t = {:.17g}, where a contact that lasts begins or goes on (at most "
          "{:.3g} m is allowed): this must not be",
          world_->bodies[k].name, jump, run_->time(), most_jump_));
}

/// Called before the motion is another, also one that begins with the same twist: it may bend from here on.
void Trajectories::tell_knot(int k, const BodyState& after) const {
  if (!knots_) return;
  tell_bends(k);
  knots_.begins_anew(k, run_->time(), bodies_[k].motion, after);
}

void Trajectories::tell_bends(int k) const {
  if (is_held(k))
    knots_.bends(k, run_->time(), bodies_[k].motion, world_->bodies[k].outline->bounding_radius);
}

void Trajectories::tell_lasting_knots() const {
  if (!knots_) return;
  for (int k = 0; k < body_count(); ++k) tell_bends(k);
}

/// What met without a rebound is in the motion, and not in the state that was held.
void Trajectories::follow_own(int k, Motion motion) {
  watch_start(k, motion.extended_state(run_->time()));
  if (knots_) tell_knot(k, motion.state(run_->time()));
  bodies_[k].motion = std::move(motion);
}

ExtendedState Trajectories::state_now(int k) const {
  ExtendedState s = bodies_[k].motion.extended_state(run_->time());
  if (is_held(k)) s.twist = held_.come_to(k, run_->time(), s.twist);
  return s;
}

ExtendedTwist Trajectories::twist_now(int k) const {
  const ExtendedTwist twist = bodies_[k].motion.extended_twist(run_->time());
  return is_held(k) ? held_.come_to(k, run_->time(), twist) : twist;
}

/// Its integrator is not asked any more. A failure goes with the motion that would have come to it.
void Trajectories::put_to_sleep(Coupled& c) {
  c.dormant = true;
  c.failure = {};
  find_reach();
}

/// Free bodies fly on at once. A component is started in a second round, when all its bodies are free of islands:
/// until then each keeps the motion that it was held on, from which its state is read.
void Trajectories::release(std::span<const int> bodies, std::vector<int>& changed) {
  for (const int k : bodies) {
    BodyTrack& b = bodies_[k];
    tell_knot(k, b.motion.state(run_->time()));
    const HeldBody former = held_.take(k);
    raise_version(b);
    changed.push_back(k);
    b.component = former.component;
    // its component is started below, when all its bodies are free of islands
    if (former.component >= 0) continue;
    const ExtendedState s = b.motion.extended_state(run_->time());
    b.motion = Motion::ballistic(run_->time(), s.rounded(), former.acceleration,
                                 std::numeric_limits<double>::infinity(), s.low());
  }
  for (Coupled& c : components_) {
    // all bodies of a component are held, or none: the first tells of all
    if (!c.dormant || bodies_[c.component.bodies.front()].component < 0) continue;
    c.dormant = false;
    std::vector<ExtendedState> states;
    for (const int k : c.component.bodies) states.push_back(bodies_[k].motion.extended_state(run_->time()));
    start(c, start_from(run_->time(), states, !c.begun.lows.empty()));
  }
}

/// Forces of a component see all its bodies, at the places that their island gives them.
Acceleration Trajectories::acceleration(int k) const {
  const HeldBody& former = held_.at(k);
  if (former.component < 0) return former.acceleration;
  const Component& c = components_[former.component].component;
  std::vector<BodyState> states;
  for (const int j : c.bodies) states.push_back(bodies_[j].motion.state(run_->time()));
  std::vector<Acceleration> all(states.size());
  c.dynamics->accelerations(run_->time(), states, all);
  return all[bodies_[k].place_in_component];
}

/// No motion is looked at: `states` stand for them. The dynamics of a component are asked once, for all its bodies.
void Trajectories::accelerations_along(std::span<const int> bodies, double t,
                                       std::span<const BodyState> lines, std::span<const BodyState> states,
                                       std::span<Acceleration> out) const {
  const auto place = [&](int k) {
    return std::lower_bound(bodies.begin(), bodies.end(), k) - bodies.begin();
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const HeldBody& former = held_.at(bodies[i]);
    if (former.component < 0) {
      out[i] = former.acceleration;
      continue;
    }
    const Component& c = components_[former.component].component;
    if (c.bodies.front() != bodies[i]) continue;  // all at once, with their first
    std::vector<BodyState> of, along;
    for (const int j : c.bodies) {
      of.push_back(states[place(j)]);
      along.push_back(lines[place(j)]);
    }
    std::vector<Acceleration> all(of.size());
    if (lines.data() == states.data())
      c.dynamics->accelerations(t, of, all);
    else
      c.dynamics->accelerations_along(t, along, of, all);
    for (std::size_t j = 0; j < all.size(); ++j) out[place(c.bodies[j])] = all[j];
  }
}

/// Forces on a body that flies freely by itself are constant: nothing ever changes them.
double Trajectories::steady_until(int k) {
  const HeldBody& former = held_.at(k);
  if (former.component < 0) return std::numeric_limits<double>::infinity();
  return components_[former.component].component.dynamics->steady_until(run_->time());
}

double Trajectories::next_break(int k) const {
  const HeldBody& former = held_.at(k);
  if (former.component < 0) return std::numeric_limits<double>::infinity();
  return components_[former.component].component.dynamics->next_break(run_->time());
}

bool Trajectories::is_constant(int k) const {
  const HeldBody& former = held_.at(k);
  return former.component < 0 || components_[former.component].component.dynamics->constant();
}

/// Also of a held body: its own component is the one that it was taken from.
std::vector<int> Trajectories::coupled_to(int k) const {
  const int component = own_component(k);
  return component < 0 ? std::vector<int>{k} : components_[component].component.bodies;
}

// -- grouping --

/// True if these bodies are a component already.
bool Trajectories::stays(const Component& component) const {
  // one without an integrator that is alone now was alone before
  const int former = bodies_[component.bodies.front()].component;
  return former < 0 ? component.bodies.size() == 1 : components_[former].component.bodies == component.bodies;
}

/// Nobody is asked whether to go on: what answers a collision is not to be broken off.
bool Trajectories::catch_up(const Component& component, double t) {
  for (const int k : component.bodies) {
    if (bodies_[k].component < 0) continue;
    Coupled& c = components_[bodies_[k].component];
    while (follow(c, t) < t)
      if (stop_at(c.failure)) return false;
  }
  return true;
}

/// Its bodies go on from where they are at t [s], with what rounding leaves over of their places.
void Trajectories::begin_anew(Component component, double t, std::vector<int>& changed) {
  std::vector<ExtendedState> states;
  for (const int k : component.bodies) {
    states.push_back(bodies_[k].motion.extended_state(t));
    raise_version(bodies_[k]);
    if (std::find(changed.begin(), changed.end(), k) == changed.end()) changed.push_back(k);
  }
  add_component(std::move(component), start_from(t, states, true));
}

bool Trajectories::regroup(Sets together, std::vector<int>& changed) {
  const double now = run_->time();
  std::vector<Component> after = make_components(*world_, together);
  // In two rounds: what may fail comes first, while nothing has changed yet.
  std::vector<bool> stay;
  for (const Component& c : after) {
    stay.push_back(stays(c));
    if (!stay.back() && !catch_up(c, now)) return false;
  }
  // all are at the present, so nothing can fail from here on
  together_ = std::move(together);
  // Components are numbered in the order of make_components, as after a restore from a snapshot.
  std::vector<Coupled> before = std::exchange(components_, {});
  for (std::size_t i = 0; i < after.size(); ++i) {
    // of bodies whose turn has not come the number still counts in `before`
    const int former = bodies_[after[i].bodies.front()].component;
    if (!stay[i]) {
      begin_anew(std::move(after[i]), now, changed);
    } else if (former >= 0) {
      for (const int k : after[i].bodies) bodies_[k].component = static_cast<int>(components_.size());
      components_.push_back(std::move(before[former]));
    }
  }
  // failures of components that are no more have gone with them
  find_reach();
  return true;
}

// -- going back --

ComponentStart Trajectories::start_of(int component) const {
  ComponentStart start = components_[component].begun;
  start.component = component;
  return start;
}

void Trajectories::go_back_to(const ComponentStart& s) {
  Coupled& c = components_[s.component];
  // as far as the motions that have been put back had come
  const double end = bodies_[c.component.bodies.front()].motion.end();
  start(c, s);
  // steps depend on the start alone, so these are the same pieces, bit for bit
  cover(c, end);
}

/// Motions are copied as handles. What an island holds is in two lists: its steps, and which of its bodies have an
/// integrator that sleeps.
Trajectories::Saved Trajectories::saved() const {
  Saved all{together_, {bodies_.begin(), bodies_.end()}, {}, {}, {}};
  held_.each([&](int k, const HeldBody& former) {
    all.steps[k] = former.step;
    if (former.component >= 0) all.asleep.push_back(k);
  });
  for (int c = 0; c < static_cast<int>(components_.size()); ++c) all.starts.push_back(start_of(c));
  return all;
}

/// Components are made in the order of make_components(), in which their starts were saved; each goes on to t [s]
/// by the steps that it took before. @pre nothing is held here yet.
void Trajectories::restore(const Saved& saved, double t) {
  together_ = saved.together;
  // What bodies keep beside their motions; those follow component by component.
  for (int k = 0; k < body_count(); ++k) {
    const BodyTrack& as = saved.bodies[k];
    BodyTrack& b = bodies_[k];
    b.version = as.version;
    b.velocity_rounding = as.velocity_rounding;
    b.resolved_at = as.resolved_at;
    b.last_partner = as.last_partner;
    b.streak = as.streak;
  }
  components_.clear();
  find_reach();
  for (Component& c : make_components(*world_, together_)) {
    const Motion& m = saved.bodies[c.bodies.front()].motion;
    const std::vector<int> members = c.bodies;
    // One that an island holds gets what it had before the island first, and is then taken from it again.
    const bool held = saved.bodies[members.front()].component == BodyTrack::kHeld;
    if (saved.bodies[members.front()].component < 0 && !saved.is_asleep(members.front())) {
      add_free(c, m.origin(), m.start(), m.start_low());
    } else {
      // its own number is the count of those before it
      add_coupled(std::move(c), saved.starts[components_.size()]);
      // asleep: it is started afresh when it is let go, so nothing of its motion will be asked for
      if (!held) follow_again(components_.back(), t);
    }
    if (held) hold_again(members, saved);
  }
  for (SiteMotion& s : sites_) {
    Extent extent = s.extend(t, instalment());
    // a site's motion is a function of time alone: only the part from t on is kept
    for (; extent.status == Extent::Status::unfinished; extent = s.extend(t, instalment()))
      s.forget_before(t);
    if (extent.end < t) throw BadInput("snapshot: " + extent.why);
  }
}

/// As hold() would, but for the motions, which are those of the snapshot.
void Trajectories::hold_again(std::span<const int> members, const Saved& saved) {
  for (const int k : members) {
    BodyTrack& b = bodies_[k];
    held_.add(k,
              {b.component, b.component < 0 ? b.motion.acceleration() : Acceleration{}, saved.steps.at(k)});
    if (b.component >= 0) put_to_sleep(components_[b.component]);
    b.component = BodyTrack::kHeld;
    b.motion = saved.bodies[k].motion;
  }
}

/// To t [s] at least, keeping only the pieces from there on. @throws BadInput where the motion ends before.
void Trajectories::follow_again(Coupled& c, double t) {
  while (follow(c, t) < t) {
    if (std::isfinite(c.failure.time)) throw BadInput("snapshot: " + c.failure.why);
    c.integrator->forget_before(t);
  }
}

}  // namespace brink
