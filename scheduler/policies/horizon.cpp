#include "brink/scheduler/policies/horizon.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/limits.h"
#include "brink/scheduler/broad_phase/broad_phase.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/policies/order.h"
#include "brink/scheduler/policies/tolerances.h"

namespace brink {

namespace {

/// About the time in which a first body crosses itself, as fast as it is and as it is pulled [s]; infinity: none moves.
double crossing_time(const KernelView& kernel) {
  double first = kForever;
  for (int k = 0; k < kernel.body_count(); ++k) {
    const double speed = kernel.state(k, kernel.time()).twist.velocity.norm(),
                 pull = kernel.body(k).motion.rate(kernel.time()).linear.norm();
    const double size = 2.0 * kernel.world().bodies[k].outline->bounding_radius;
    // size = speed t + pull t^2 / 2
    const double crossing = 2.0 * size / (speed + std::sqrt(speed * speed + 2.0 * pull * size));
    if (crossing > 0.0) first = std::min(first, crossing);
  }
  return first;
}

/// Of the first horizon of a run to `until` [s].
double first_length(Kernel& kernel, double until) {
  const double shortest = kShortestHorizon * std::max(1.0, until);
  // an integrator has told no acceleration before its first step
  kernel.follow_motions(kernel.time() + shortest);
  return std::max(std::min(until, crossing_time(kernel)), shortest);
}

/// The end of the next horizon from the present time [s].
double next_end(Kernel& kernel, double until) {
  if (kernel.horizon() <= 0.0) kernel.choose_horizon(first_length(kernel, until));
  return std::min(until, kernel.time() + kernel.horizon());
}

/// Learns from a horizon.
void adapt(Kernel& kernel, const HorizonTally& had) {
  const auto n = static_cast<std::size_t>(kernel.body_count());
  const std::size_t pairs =
      kernel.options().broad_phase ? had.pairs : 0;  // else every pair is met at any horizon
  // Halved, grown by half, or, between two bounds that lie well apart, kept: so it does not swing. Each body
  // counts for a few neighbours; the constants are for worlds of few bodies.
  const double half = std::max(0.5 * kernel.horizon(), kShortestHorizon);
  if (had.restarts > 4 * n + 32)
    kernel.choose_horizon(half);
  else if (pairs > 6 * n + 16 && half >= kOfCrossing * crossing_time(kernel))
    kernel.choose_horizon(half);  // who is near in next to no time is near at any horizon
  else if (pairs < 3 * n + 8 && had.restarts < n + 8)
    kernel.choose_horizon(1.5 * kernel.horizon());
}

}  // namespace

void run_horizons(Kernel& kernel, double until,
                  const std::function<std::optional<HorizonTally>(double end)>& run_one) {
  // Between horizons nothing is left before the present time: a run may be resumed from there, and no motion
  // is asked for what lies before.
  while (kernel.time() < until && !kernel.halt()) {
    if (!kernel.pause_point()) return;
    kernel.forget_before(kernel.time());
    const std::optional<HorizonTally> had = run_one(next_end(kernel, until));
    if (!had || kernel.fail_before(until)) return;
    adapt(kernel, *had);
  }
}

double seen_beyond(double end) { return end + 4.0 * same_instant(end); }

double look_ahead(Kernel& kernel, double end) {
  double seen = kernel.follow_motions(end);
  const Periods& periods = kernel.world().periods;
  if (!periods.any()) return seen;
  const double now = kernel.time();
  const int bodies = kernel.body_count(), sites = static_cast<int>(kernel.world().sites.size());
  for (int k = 0; k < bodies + sites; ++k) {
    const Motion& motion = k < bodies ? kernel.body(k).motion : kernel.site_motion(k - bodies);
    if (motion.is_still()) continue;
    // ahead of what is certain a motion may begin later than now
    const double from = std::max(now, motion.begin());
    const auto goes_far = [&] {
      const Vec2 way = swept_box(kernel.outline_of(k), motion, from, seen).extent();
      return (periods.size.array() > 0.0 && !(way.array() <= kMostPeriods * periods.size.array())).any();
    };
    while (seen - now > kShortestHorizon && from < seen && goes_far()) seen = now + 0.5 * (seen - now);
  }
  return seen;
}

double last_beginning(const KernelView& kernel, double begin, double end, double seen) {
  // an instant that begins by then is over before `seen`
  const double last = seen - 2.0 * same_instant(seen);
  return std::min(end, seen < kernel.reach() && last > begin ? last : seen);
}

/// What the agenda held of the last horizon is dropped: what of it lies ahead is found again.
bool HorizonAgenda::pass(Kernel& kernel, double from, double end) {
  agenda_.clear();
  pairs_ = kernel.near_pairs(from, end);
  for (const PairKey& pair : pairs_) {
    if (!kernel.poll()) return false;
    test(kernel, pair, from, end);
  }
  return kernel.poll();
}

/// Certificates of former motions stay on the agenda: they are stale, and dropped when they come up.
bool HorizonAgenda::pass_again(Kernel& kernel, std::span<const int> changed, double end) {
  const double now = kernel.time();
  pairs_.clear();
  for (const int body : changed) {
    const std::vector<PairKey> near = kernel.near_pairs_of(body, now, end);
    pairs_.insert(pairs_.end(), near.begin(), near.end());
  }
  std::sort(pairs_.begin(), pairs_.end());  // a pair of two changed bodies is met from both
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  for (const PairKey& pair : pairs_) {
    if (!kernel.poll()) return false;
    test(kernel, pair, now, end);
  }
  return kernel.poll();
}

void HorizonAgenda::test(Kernel& kernel, const PairKey& pair, double from, double end) {
  if (const auto certificate = kernel.search(pair, from, end)) insert(kernel, *certificate);
}

/// A search names one feature; an order that picks among all contacts of an instant must see the pair's others.
void HorizonAgenda::insert(Kernel& kernel, const Certificate& c) {
  agenda_.insert(c);
  if (c.kind != Certificate::Kind::contact || !picks_among_all(kernel.order())) return;
  for (const Certificate& other : kernel.simultaneous(c)) agenda_.insert(other);
}

std::optional<Certificate> HorizonAgenda::take_earliest(Kernel& kernel, double last) {
  return brink::take_earliest(kernel, agenda_, last);
}

bool HorizonAgenda::search_on(Kernel& kernel, const Certificate& c, double end) {
  const auto again = kernel.search(c.pair, c.time, end);
  const bool undecided = again && again->kind == Certificate::Kind::undecided;
  undecided_ = undecided ? undecided_ + 1 : 0;
  // No headway, or too many searches in a row without an answer.
  if (undecided && (again->time <= c.time || undecided_ > kMostUndecided)) kernel.give_up(*again);
  if (again) insert(kernel, *again);
  return kernel.poll();
}

}  // namespace brink
