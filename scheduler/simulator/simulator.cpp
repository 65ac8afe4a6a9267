#include "brink/scheduler/simulator/simulator.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "brink/core/base/error.h"
#include "brink/core/base/hash.h"
#include "brink/integrators/stepping.h"
#include "brink/scheduler/kernel/near_pairs.h"
#include "brink/scheduler/kernel/run_kernel.h"
#include "brink/scheduler/policies/policy.h"
#include "brink/scheduler/simulator/make_plan.h"

namespace brink {

namespace {

/// Raises a flag for as long as it lives.
class Raised {
 public:
  explicit Raised(bool& flag) : flag_(flag) { flag_ = true; }
  ~Raised() { flag_ = false; }
  Raised(const Raised&) = delete;
  Raised& operator=(const Raised&) = delete;

 private:
  bool& flag_;
};

}  // namespace

/// A policy is made for the kernel that it drives, and prepared before contacts may last: it says whether it takes
/// the steps of islands.
struct Simulator::Impl {
  Impl(World world, SolverOptions options)
      : kernel(std::move(world), options), policy(make_policy(options.policy, options.detector)) {
    if (policy->looks_at_all_pairs()) check_all_pairs(kernel.world(), options);
    policy->prepare(kernel);
    if (options.persistent && policy->steps_islands()) kernel.let_contacts_last();
    // What may miss contacts is not held to certificates; Brink's own exact policies are held to the
    // order of known contacts in their tests, not in every run.
    if (policy->approximate()) return;
    kernel.move_out_of_wires();
    kernel.hold_to_certificates();
    if (is_added_policy(options.policy)) kernel.hold_to_known_contacts();
  }
  /// @throws BadInput if there is no such body, or site.
  void require(const char* what, int k, std::size_t count) const {
    if (k < 0 || static_cast<std::size_t>(k) >= count)
      throw BadInput(fmt::format("there is no {} {}: the world has {}", what, k, count));
  }
  void require_body(int k) const { require("body", k, kernel.world().bodies.size()); }
  /// @throws BadInput while a run is going on, as where a recorder asks.
  void require_between_runs(const char* what) const {
    if (runs) throw BadInput(fmt::format("{}: a run of this simulator is going on", what));
  }

  RunKernel kernel;
  std::unique_ptr<Policy> policy;
  double energy_initial = 0.0;
  bool runs = false;  ///< a run is going on
};

Simulator::Simulator(World world, SolverOptions options)
    : impl_(std::make_unique<Impl>(std::move(world), std::move(options))) {
  impl_->energy_initial = total_energy(this->world(), states());
}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

/// What is asked for is checked, the start is looked at, the policy drives the kernel to the end or to a halt, and
/// the summary is made from what the parts have counted. A call goes on from the present time: counters, islands
/// and motions stay from call to call.
RunSummary Simulator::run(const RunOptions& options, Recorder* recorder) {
  if (!std::isfinite(options.until) || options.until < time())
    throw BadInput(
        fmt::format("until = {} must be finite and >= the present time {}", options.until, time()));
  if (!(options.frame_interval >= 0.0))
    throw BadInput(fmt::format("frame_interval = {} must be >= 0", options.frame_interval));
  if (!(options.look_interval >= 0.0))
    throw BadInput(fmt::format("look_interval = {} must be >= 0", options.look_interval));
  if (options.threads < 1 || options.threads > RunOptions::kMostThreads)
    throw BadInput(
        fmt::format("threads = {} must be from 1 to {}", options.threads, RunOptions::kMostThreads));
  impl_->require_between_runs("run");
  const Raised going_on(impl_->runs);
  RunKernel& kernel = impl_->kernel;
  // At the start alone: a policy that may miss contacts can stand in overlaps later on.
  if (time() == 0.0)
    if (const std::string why = start_fault(); !why.empty()) throw BadInput(why);
  const auto begin = std::chrono::steady_clock::now();
  kernel.begin(options, recorder);
  if (!kernel.halt()) {
    // after the first frame, before the policy has looked at anything
    kernel.let_touching_last();
    impl_->policy->run(kernel, options.until);
    kernel.check_returned(options.until);
  }
  kernel.end();

  RunSummary summary;
  if (const auto& halt = kernel.halt()) {
    summary.termination = halt->termination;
    summary.why = halt->why;
  } else {
    summary.termination = Termination::reached_end;
  }
  // Whatever the wall clock says: from here the run can be gone on with.
  const std::vector<BodyState> last = states();
  // nothing goes on from states that are not finite: the checkpoint before stays
  if (recorder && std::all_of(last.begin(), last.end(), [](const BodyState& s) { return is_finite(s); }))
    recorder->checkpoint(time(), kernel.snapshot());
  kernel.tell_lasting();  // beyond the checkpoint: a run that goes on tells them again
  // from the same states as the energy, all at the present time
  const Momentum momentum = total_momentum(world(), last);
  summary.end_time = time();
  summary.collisions = kernel.collisions();
  summary.energy_initial = impl_->energy_initial;
  summary.energy_final = total_energy(world(), last);
  summary.momentum = momentum.linear;
  summary.angular_momentum = momentum.angular;
  summary.max_overlap = kernel.max_overlap();
  summary.rest_energy = summary.energy_taken = kernel.island_tally().energy_of_rest;
  if (const TakenGroups& taken = kernel.taken(); taken.count > 0) {
    summary.groups_taken = taken.count;
    summary.energy_taken += taken.energy;
    summary.first_taken = fmt::format("{} at t = {:.15g} s", kernel.name_of(taken.first), taken.time);
  }
  summary.moved_at_start = kernel.moved_at_start().bodies;
  summary.moved_by = kernel.moved_at_start().most;
  const IslandTally& islands = kernel.island_tally();
  summary.contacts_lasting = islands.captured;
  // those that came to rest moved nobody
  summary.island_steps = islands.steps - islands.slept;
  summary.steps_by_modes = islands.by_modes;
  summary.small_by_steps = islands.small_by_steps;
  for (const auto& [lead, island] : kernel.islands()) {
    if (!island.rests) continue;
    ++summary.islands_at_rest;
    summary.resting += island.members.size();
  }
  summary.approach_absorbed = islands.absorbed;
  summary.friction_residual = islands.friction_residual;
  summary.island_energy = islands.energy_won;
  summary.state_hash = state_hash();
  summary.work = kernel.work();
  summary.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

double Simulator::time() const { return impl_->kernel.time(); }
const World& Simulator::world() const { return impl_->kernel.world(); }
BodyState Simulator::state(int k) const {
  impl_->require_body(k);
  return impl_->kernel.state(k, time());
}
std::vector<BodyState> Simulator::states() const { return impl_->kernel.states(time()); }
Pose Simulator::site_pose(int k) const {
  impl_->require("site", k, world().sites.size());
  return impl_->kernel.site_pose(k, time());
}

/// Over bits: two runs with one hash have come to the same states, to the last digit.
std::uint64_t Simulator::state_hash() const {
  StateHash hash;
  hash.add(time());
  for (const BodyState& s : states()) hash.add(s);
  return hash.value();
}

std::string Simulator::start_fault() const { return impl_->kernel.start_fault(); }

void Simulator::set_pair_filter(std::function<bool(int a, int b)> filter) {
  impl_->require_between_runs("set_pair_filter");
  impl_->kernel.set_pair_filter(std::move(filter));
}
void Simulator::set_state(int k, const BodyState& state) {
  impl_->require_between_runs("set_state");
  impl_->require_body(k);
  impl_->kernel.set_state(k, state);
}
void Simulator::apply_impulse(int k, const Vec2& impulse, const Vec2& point) {
  impl_->require_between_runs("apply_impulse");
  impl_->require_body(k);
  impl_->kernel.apply_impulse(k, impulse, point);
}

/// The limit is this call's alone, also where it throws.
RunSummary Simulator::step_to_next_event(RunOptions options, Recorder* recorder) {
  impl_->kernel.stop_after_collisions(1);
  try {
    const RunSummary summary = run(options, recorder);
    impl_->kernel.stop_after_collisions(0);
    return summary;
  } catch (...) {
    impl_->kernel.stop_after_collisions(0);
    throw;
  }
}

std::vector<Contact> Simulator::overlaps(std::size_t most) const { return impl_->kernel.overlaps(most); }
Plan Simulator::plan() const { return make_plan(impl_->kernel, impl_->policy->plan()); }
std::vector<std::byte> Simulator::snapshot() const { return impl_->kernel.snapshot(); }
void Simulator::restore(std::span<const std::byte> snapshot) {
  impl_->require_between_runs("restore");
  impl_->kernel.restore(snapshot);
}

}  // namespace brink
