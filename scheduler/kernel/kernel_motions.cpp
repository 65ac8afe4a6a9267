/// The kernel's motions: made in instalments, given up when they are past, followed to where they fail.
///
/// How far a motion is made at a time is work, not physics: steps depend on the start alone. So a long
/// horizon is cut where an instalment ends, which bounds memory and the time between two looks at `progress`;
/// and a motion that fails is followed to its end, since a collision before may start it afresh.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "brink/scheduler/kernel/kernel.h"
#include "brink/scheduler/kernel/stage_clock.h"

namespace brink {

namespace {

/// Pieces of motion that one round of instalments makes at most, of all bodies together: some 50 MB.
constexpr std::uint64_t kMostPieces = 1U << 17;
constexpr std::uint64_t kShortest = 16, kLongest = 4096;  ///< instalments [steps]

}  // namespace

std::uint64_t Kernel::instalment() const {
  const std::uint64_t movers = bodies_.size() + sites_.size();
  return std::clamp(kMostPieces / std::max<std::uint64_t>(movers, 1), kShortest, kLongest);
}

void Kernel::fetch_motions(const Coupled& c) {
  for (std::size_t i = 0; i < c.component.bodies.size(); ++i)
    bodies_[c.component.bodies[i]].motion = c.integrator->motion(static_cast<int>(i));
}

double Kernel::follow(Coupled& c, double t) {
  const double covered = bodies_[c.component.bodies.front()].motion.end();
  if (covered >= t) return t;
  if (covered >= c.failure.time) return covered;
  const std::uint64_t before = work_.solver_steps;
  const Extent extent = c.integrator->extend(t, instalment());
  integrated_ += (work_.solver_steps - before) * c.component.bodies.size();
  fetch_motions(c);
  if (extent.status == Extent::Status::failed)
    note_failure(c.failure, extent.end, "'" + world_.bodies[c.component.bodies.front()].name + "'",
                 extent.why);
  return std::min(extent.end, t);
}

double Kernel::follow_site(int s, double t) {
  if (!sites_[s].is_prescribed() || sites_[s].motion().end() >= t) return t;
  const Extent extent = sites_[s].extend(t, instalment());
  integrated_ += instalment();
  if (extent.status == Extent::Status::failed)
    note_failure(site_failures_[s], extent.end, "site '" + world_.sites[s].name + "'", extent.why);
  return std::min(extent.end, t);
}

double Kernel::follow_motion(int k, double t) {
  const BodyTrack& b = bodies_[k];
  if (b.component < 0 || b.motion.end() >= t) return t;
  const StageClock clock(work_.seconds_motion);
  const double covered = follow(components_[b.component], t);
  poll();
  return covered;
}

double Kernel::follow_sites(double t) {
  double covered = t;
  for (std::size_t s = 0; s < sites_.size() && poll(); ++s)
    covered = std::min(covered, follow_site(static_cast<int>(s), t));
  return covered;
}

double Kernel::follow_motions(double t) {
  const StageClock clock(work_.seconds_motion);
  double covered = t;
  for (Coupled& c : components_) {
    if (!poll()) return time_;
    covered = std::min(covered, follow(c, t));
  }
  return std::min(covered, follow_sites(t));
}

double Kernel::follow_motions_all_the_way(double t) {
  double covered = follow_motions(t);
  while (covered < std::min(t, reach_) && !halt_) covered = follow_motions(t);
  return covered;
}

bool Kernel::cover(Coupled& c, double t) {
  while (follow(c, t) < t)
    if (stop_at(c.failure) || !poll()) return false;
  return true;
}

bool Kernel::cover_site(int s, double t) {
  while (follow_site(s, t) < t)
    if (stop_at(site_failures_[s]) || !poll()) return false;
  return true;
}

bool Kernel::extend_motion(int k, double t) {
  const BodyTrack& b = bodies_[k];
  if (b.component < 0 || b.motion.end() >= t) return true;
  const StageClock clock(work_.seconds_motion);
  return cover(components_[b.component], t);
}

bool Kernel::extend_sites(double t) {
  for (std::size_t s = 0; s < sites_.size(); ++s)
    if (!cover_site(static_cast<int>(s), t)) return false;
  return true;
}

bool Kernel::extend_motions(double t) {
  const StageClock clock(work_.seconds_motion);
  for (Coupled& c : components_)
    if (!cover(c, t)) return false;
  return extend_sites(t);
}

void Kernel::note_failure(Failure& of, double end, const std::string& name, const std::string& why) {
  of = {end, fmt::format("motion of {} stopped at t = {:.17g}: {}", name, end, why)};
  find_reach();
}

void Kernel::find_reach() {
  reach_ = std::numeric_limits<double>::infinity();
  for (const Coupled& c : components_) reach_ = std::min(reach_, c.failure.time);
  for (const Failure& f : site_failures_) reach_ = std::min(reach_, f.time);
}

bool Kernel::stop_at(const Failure& failure) {
  if (std::isfinite(failure.time)) stop(Termination::failed, failure.why);
  return std::isfinite(failure.time);
}

bool Kernel::fail_before(double until) {
  if (reach_ >= until || time_ < reach_) return false;
  for (const Coupled& c : components_)
    if (c.failure.time == reach_) return stop_at(c.failure);
  for (const Failure& f : site_failures_)
    if (f.time == reach_) return stop_at(f);
  return false;
}

bool Kernel::much_to_forget() const { return integrated_ - forgotten_ > kMostPieces; }

void Kernel::forget_before(double t) {
  if (!much_to_forget()) return;
  forgotten_ = integrated_;
  for (Coupled& c : components_) c.integrator->forget_before(t);
  for (SiteMotion& s : sites_) s.forget_before(t);
}

}  // namespace brink
