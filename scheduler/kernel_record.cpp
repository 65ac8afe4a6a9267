/// The kernel's records: frames on the frame clock, checkpoints, overlaps.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "brink/scheduler/broad_phase.h"
#include "brink/scheduler/kernel.h"

namespace brink {

namespace {

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

void Kernel::record_frames(double t) {
  if (run_.frame_interval <= 0.0) return;
  for (;;) {
    const double due = static_cast<double>(frame_ + 1) * run_.frame_interval;
    if (due > t) return;
    ++frame_;
    last_frame_ = due;
    if (recorder_) recorder_->frame(due, states(due));
    check_overlaps_at(due);
  }
}

void Kernel::end_frame() {
  if (last_frame_ == time_) return;
  last_frame_ = time_;
  if (recorder_) recorder_->frame(time_, states(time_));
  check_overlaps_at(time_);
}

void Kernel::check_overlaps_at(double t) {
  std::vector<Box> now;
  for (int k = 0; k < owner_count(); ++k)
    now.push_back(swept_box(outline_of(k), motion_of(k), t, t));
  for (const auto& [a, b] : overlapping_pairs(now))
    if (const auto pair = pair_of(a, b)) note_overlap(pair_gap(mover(pair->body), other_mover(*pair), t, scratch_));
}

std::vector<Contact> Kernel::overlaps() {
  std::vector<Contact> found;
  for (int a = 0; a < body_count(); ++a)
    for (int b = a + 1; b < owner_count(); ++b) {
      const PairKey pair = *pair_of(a, b);
      const auto contacts = touching(pair, 0.0);
      if (!contacts.empty() && contacts.front().gap < 0.0) found.push_back(world_contact(pair, contacts.front()));
    }
  std::stable_sort(found.begin(), found.end(), [](const Contact& x, const Contact& y) { return x.gap < y.gap; });
  return found;
}

bool Kernel::pause_point() {
  if (halt_) return false;
  if (run_.progress && !run_.progress(time_, work_.collisions)) {
    stop(Termination::stopped, "stopped on request");
    return false;
  }
  if (recorder_ && run_.checkpoint_seconds >= 0.0 && wall_clock() >= next_checkpoint_) {
    recorder_->checkpoint(time_, snapshot());
    next_checkpoint_ = wall_clock() + run_.checkpoint_seconds;
  }
  return true;
}

}  // namespace brink
