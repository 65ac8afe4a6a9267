/// The kernel's records: frames on the frame clock, checkpoints, overlaps.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <tuple>

#include "brink/core/shapes/outline_crossing.h"
#include "brink/scheduler/broad_phase/broad_phase.h"
#include "brink/scheduler/kernel/kernel.h"
#include "brink/scheduler/kernel/stage_clock.h"

namespace brink {

namespace {

/// Overlaps at the start up to this part of the scene's length are let go: coordinates written with few
/// digits.
constexpr double kStartOverlap = 1e-6;
/// The search for them ends after so many: all bodies may be in one place.
constexpr std::size_t kOverlapsCounted = 1000;

double wall_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void Kernel::begin(const RunOptions& options, Recorder* recorder) {
  run_ = options;
  recorder_ = recorder;
  halt_.reset();
  next_checkpoint_ = wall_clock() + run_.checkpoint_seconds;
  if (!options.first_frame) return;
  last_frame_ = time_;
  if (recorder_) recorder_->frame(time_, states(time_));
  check_overlaps_at(time_);
}

bool Kernel::record_frames(double t) {
  if (watched_) hold_to_known(t);
  while (run_.frame_interval > 0.0 && !halt_) {
    const double due = static_cast<double>(frame_ + 1) * run_.frame_interval;
    if (due > t) break;
    const StageClock clock(work_.seconds_record);
    ++frame_;
    last_frame_ = due;
    swap_with_certain();
    if (recorder_) recorder_->frame(due, states(due));
    check_overlaps_at(due);
    swap_with_certain();
    if (!poll()) time_ = due;  // all is clear up to t, and so up to here
  }
  return !halt_;
}

void Kernel::end_frame() {
  roll_back_all();
  if (last_frame_ == time_) return;
  last_frame_ = time_;
  if (recorder_) recorder_->frame(time_, states(time_));
  check_overlaps_at(time_);
}

void Kernel::each_near_at(double t, const std::function<bool(const PairKey&)>& visit) const {
  std::vector<Box> now;
  for (int k = 0; k < owner_count(); ++k) now.push_back(box_at(k, t));
  each_overlapping(now, world_.periods, [&](const ImagePair& p) {
    const auto pair = pair_of(p.a, p.b, p.image);
    return !pair || visit(*pair);
  });
}

std::optional<Contact> Kernel::crossing_at(const PairKey& pair, double t) const {
  const Mover a = mover(pair.body), b = other_mover(pair);
  const ExtendedState at = a.motion->extended_state(t), other = b.motion->extended_state(t);
  const Vec2 base = other.position.cast<double>();  // far away, nothing of what is between them is lost
  const OutlineCrossing crossing =
      deepest_crossing(a.outline(), at.seen_from(base).pose, b.outline(), other.seen_from(base).pose);
  if (crossing.depth <= 0.0) return std::nullopt;
  FeatureContact f;
  f.time = t;
  f.point = base + crossing.point;
  f.normal = crossing.normal;
  f.gap = -crossing.depth;
  return world_contact(pair, f);
}

std::vector<Contact> Kernel::overlaps(std::size_t most) {
  std::vector<Contact> found;
  each_near_at(time_, [&](const PairKey& pair) {
    const auto contacts = touching(pair, 0.0);
    if (!contacts.empty() && contacts.front().gap < 0.0)
      found.push_back(world_contact(pair, contacts.front()));
    else if (const auto crossing = crossing_at(pair, time_))
      found.push_back(*crossing);
    return found.size() < most;
  });
  const auto order = [](const Contact& c) { return std::tuple(c.gap, c.body, c.other_body, c.other_site); };
  std::sort(found.begin(), found.end(),
            [&](const Contact& x, const Contact& y) { return order(x) < order(y); });
  return found;
}

bool Kernel::may_start(std::string* why) {
  const double allowed = kStartOverlap * world_.length();
  const std::vector<Contact> found = overlaps(kOverlapsCounted);
  if (!found.empty()) start_overlap_ = -found.front().gap;
  if (found.empty() || found.front().gap >= -allowed) return true;
  const Contact& c = found.front();
  const std::string& other =
      c.other_body >= 0 ? world_.bodies[c.other_body].name : world_.sites[c.other_site].name;
  *why = fmt::format(
      "'{}' and '{}' overlap by {:.3g} m at the start, near ({:.4g}, {:.4g}); at most {:.1g} m is allowed"
      " ({} overlapping pair(s) in all)",
      world_.bodies[c.body].name, other, -c.gap, c.point.x(), c.point.y(), allowed,
      found.size() < kOverlapsCounted ? std::to_string(found.size())
                                      : fmt::format("{} or more", kOverlapsCounted));
  return false;
}

bool Kernel::pause_point() {
  if (halt_) return false;
  if (run_.progress && !run_.progress(time_, work_.collisions)) {
    stop(Termination::stopped, "on request");
    return false;
  }
  if (recorder_ && run_.checkpoint_seconds >= 0.0 && wall_clock() >= next_checkpoint_) {
    recorder_->checkpoint(time_, snapshot());
    next_checkpoint_ = wall_clock() + run_.checkpoint_seconds;
  }
  return true;
}

}  // namespace brink
