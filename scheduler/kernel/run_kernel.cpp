#include "brink/scheduler/kernel/run_kernel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "brink/core/base/error.h"
#include "brink/core/world/recentred.h"
#include "brink/scheduler/kernel/snapshot.h"
#include "brink/scheduler/kernel/start_places.h"

namespace brink {

namespace {

/// Slower than this nothing closes or parts [m/s]: a rounding of velocities.
constexpr double kStillAtStart = 1e-12;

/// The same world if it and the options are valid, each by itself and together. @throws BadInput
World checked(World world, const SolverOptions& options) {
  world.check();
  std::string error;
  if (!options.is_valid(&error)) throw BadInput(error);
  if (world.periods.any() && options.detector != "field")
    throw BadInput("solver: detector = \"" + options.detector +
                   "\" in a periodic world; allowed there: \"field\"");
  return world;
}

/// Moves the frame of each site near it; by how much.
/// Distances are taken in a site's own frame: one written far from its origin would lose digits in each.
std::vector<Vec2> recentre_sites(World& world) {
  std::vector<Vec2> moved;
  for (FixedSite& s : world.sites) {
    const Vec2 as_written = s.pose.position;
    s = recentred(s);
    moved.push_back(s.pose.position - as_written);
  }
  return moved;
}

}  // namespace

/// Parts are made as they are declared, each of those before it. The world is the first: its sites are moved in
/// place, by `frames_moved`, before anybody looks at them.
KernelParts::KernelParts(World given, SolverOptions chosen)
    : world(checked(std::move(given), chosen)),
      frames_moved(recentre_sites(world)),
      options(std::move(chosen)),
      fingerprint(snapshot_fingerprint(world, options)),
      order(order_of(options.order)),
      trajectories(world, options, run),
      search(world, options, trajectories, run),
      near(world, options, trajectories, search, run),
      watch(world, trajectories, search, near, run),
      response(world, options, trajectories, search, near, watch, run),
      groups(world, trajectories, search, near, response, watch, run),
      speculation(trajectories, run),
      endings(search.limits().tolerance, options.max_collisions),
      records(trajectories, run),
      islands(world, trajectories, search, response, records, run,
              {options.rest_speed, options.island_tolerance}),
      policy_watch(options.policy, search, speculation),
      random(options.seed) {}

RunKernel::RunKernel(World world, SolverOptions options) : Kernel(std::move(world), std::move(options)) {}

const std::string& RunKernel::start_fault() {
  if (!start_fault_ || start_fault_->revision != revision())
    start_fault_ = {revision(), parts_.watch.start_fault()};
  return start_fault_->why;
}

void RunKernel::begin(const RunOptions& options, Recorder* recorder) {
  start_fault_.reset();  // from here on the policy may change what it was found in
  parts_.run.begin(options);
  parts_.records.begin(recorder);
  parts_.looks.begin(options, parts_.trajectories.owner_count(), time());
  let_help(options.threads - 1);
  tell_knots();
  // the watch looks at all pairs there, before the first collision
  if (options.first_frame) show_frame();
  // a run that goes on from where it met the limit has met it
  stop_at_limit(collisions());
}

/// So many threads beside this one.
void RunKernel::let_help(int count) {
  parts_.helpers.reset();  // before what they work on
  if (count > 0) parts_.helpers = std::make_unique<Helpers>(count);
  parts_.search.let_help(parts_.helpers.get());
}

/// What is told of motions, by whichever trajectories there are now.
void RunKernel::tell_knots() {
  // events tell twists before and after: kept only where events are told
  const bool told = parts_.records.records_events();
  parts_.trajectories.keep_twists_before(told);
  const auto tell_knot = [this](const Knot& knot) { parts_.records.knot(knot); };
  parts_.trajectories.tell_knots(told ? Trajectories::TellKnot(tell_knot) : nullptr,
                                 parts_.search.limits().tolerance);
}

/// Only at t = 0, and only where forces may press: what touches later has met before.
void RunKernel::let_touching_last() {
  // a run that goes on has its islands from before
  if (!parts_.islands.allowed() || time() != 0.0) return;
  const double tolerance = parts_.search.limits().tolerance;
  if (world().gravity.isZero(0.0) && world().forces.empty()) return;  // nothing presses
  std::vector<std::pair<PairKey, FeatureContact>> touching;
  parts_.near.each_at(time(), [&](const PairKey& pair) {
    if (!parts_.run.poll()) return false;
    if (parts_.search.is_left_out(pair)) return true;
    for (const FeatureContact& c : parts_.search.touching(pair, tolerance, time()))
      // one is enough: the island lists the pair's features itself
      if (std::abs(c.closing_speed) <= kStillAtStart) return touching.emplace_back(pair, c), true;
    return true;
  });
  if (touching.empty() || halt()) return;
  // events in the order of pairs, whatever the order in which boxes met
  std::sort(touching.begin(), touching.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<int> changed;
  do_or_cut(true, [&] { return parts_.islands.begin(touching, changed); });
  // motions have changed by no verb of the policy's: what it knows is void
  parts_.policy_watch.forget_all();
  ++parts_.revision;
}

void RunKernel::end() {
  let_help(0);
  // what was done ahead of the end is not to be seen
  roll_back_all();
  if (!parts_.before_cut.empty()) undo_cut();
  if (parts_.records.last_frame() != time()) show_frame();
}

/// Back to before the verb that was cut, for the reason that it was cut for.
void RunKernel::undo_cut() {
  restore(std::exchange(parts_.before_cut, {}));
  tell_knots();
  stop(Termination::stopped, RunControl::kOnRequest);
}

void RunKernel::check_returned(double until) {
  if (!halt()) parts_.policy_watch.returned(time(), until);
}

void RunKernel::stop_after_collisions(std::uint64_t count) {
  // the nearer of the two limits holds
  const std::uint64_t most = options().max_collisions, here = collisions() + count;
  parts_.endings.set_limit(count > 0 && (most == 0 || here < most) ? here : most);
}

void RunKernel::set_pair_filter(PairFilter filter) {
  if (options().detector == "depth")
    throw BadInput("set_pair_filter: detector = \"depth\" sees everybody; allowed: \"field\", \"pass\"");
  parts_.search.set_filter(std::move(filter));
  parts_.watch.look_again();
  ++parts_.revision;
}

/// The island of a member begins a step at once: its contacts are not those of before.
void RunKernel::go_on_from(int k, const ExtendedState& state) {
  const Restart restart{k, state};
  std::vector<int> changed;
  // first, since an island steps from the present states of its members
  parts_.trajectories.restart({&restart, 1}, changed);
  if (parts_.islands.is_member(k)) parts_.islands.disturbed(k, changed);
  // given, not computed: what collisions left behind is no longer in these velocities
  for (const int j : changed) parts_.trajectories.body(j).velocity_rounding = 0.0;
  parts_.policy_watch.forget_all();
  ++parts_.revision;
}

/// One corner after the other: what is moved out of one wire may stand in another then. Who stands between two is
/// given up after some rounds: the watch tells.
void RunKernel::move_out_of_wires() {
  constexpr int kRounds = 16;
  std::vector<Vec2> moved(world().bodies.size(), Vec2::Zero());
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Vec2> shifts =
        shifts_out_of_wires(world(), parts_.trajectories, parts_.near, parts_.search, time());
    if (shifts.empty()) break;
    for (int k = 0; k < static_cast<int>(shifts.size()); ++k) {
      if (shifts[k].isZero(0.0)) continue;
      ExtendedState s = parts_.trajectories.state_now(k);
      s.position += shifts[k].cast<Real>();
      go_on_from(k, s);
      moved[k] += shifts[k];
    }
  }
  for (const Vec2& by : moved) {
    if (by.isZero(0.0)) continue;
    ++moved_at_start_.bodies;
    moved_at_start_.most = std::max(moved_at_start_.most, by.norm());
  }
}

/// The twist along a lock must be 0: nothing would ever take it away (Trajectories).
void RunKernel::set_state(int k, const BodyState& state) {
  if (!state.pose.position.allFinite() || !std::isfinite(state.pose.angle) ||
      !state.twist.velocity.allFinite() || !std::isfinite(state.twist.omega))
    throw BadInput(fmt::format("set_state of '{}': every number must be finite", world().bodies[k].name));
  const Body& b = world().bodies[k];
  const Twist& v = state.twist;
  if ((b.lock_x && v.velocity.x() != 0.0) || (b.lock_y && v.velocity.y() != 0.0) ||
      (b.lock_angle && v.omega != 0.0))
    throw BadInput(fmt::format("set_state of '{}': a locked coordinate must have no velocity", b.name));
  go_on_from(k, ExtendedState(state));
}

void RunKernel::apply_impulse(int k, const Vec2& impulse, const Vec2& point) {
  const Body& b = world().bodies[k];
  if (!impulse.allFinite() || !point.allFinite())
    throw BadInput(fmt::format("apply_impulse to '{}': every number must be finite", b.name));
  ExtendedState s = parts_.trajectories.state_now(k);
  // dv = M^-1 p and d(omega) = (arm x p) / I, in which a lock has 0
  const RealVec p = impulse.cast<Real>(), arm = point.cast<Real>() - s.position;
  s.twist.velocity += RealVec(b.inverse_mass_x() * p.x(), b.inverse_mass_y() * p.y());
  s.twist.omega += b.inverse_inertia() * extended::cross(arm, p);
  if (const Twist v = s.twist.rounded(); !v.velocity.allFinite() || !std::isfinite(v.omega))
    throw BadInput(fmt::format("apply_impulse to '{}': it would be too fast for a number", b.name));
  go_on_from(k, s);
}

/// In this order: the bytes are read and held against the world, motions are made again beside the present ones,
/// and only then anything is put back.
void RunKernel::restore(std::span<const std::byte> bytes) {
  let_help(0);  // there are some still where a run has ended by an exception
  SavedRun saved = decode(bytes, world(), parts_.fingerprint);
  const WorkCounters before = work();
  try {
    // Made beside the present ones, so that nothing has changed if a motion cannot be made again; the
    // integrators count their work into the run's counters all the same, which are put back.
    Trajectories again(world(), options(), parts_.run);
    again.restore(saved.trajectories, saved.time);
    parts_.trajectories = std::move(again);
  } catch (...) {
    work() = before;
    throw;
  }
  // Nothing is refused from here on: the snapshot is put back whole.
  parts_.run.set_time(saved.time);
  parts_.run.forget_halt();
  if (!saved.failure.empty()) parts_.run.stop(Termination::failed, saved.failure);
  parts_.horizon = saved.horizon;
  parts_.watch.restore(saved.watch);
  parts_.records.restore(saved.records);
  parts_.endings.restore(std::move(saved.endings));
  // after the trajectories, which say who is held
  parts_.islands.restore(saved.islands);
  parts_.taken = saved.taken;
  parts_.random.set_state(saved.random);
  parts_.policy_watch.forget_all();
  // last: making motions again was counted
  work() = saved.work;
  ++parts_.revision;
}

}  // namespace brink
