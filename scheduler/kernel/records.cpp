#include "brink/scheduler/kernel/records.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace brink {

namespace {

/// Time to the next checkpoint, as a multiple of what the last one took: a million bodies take seconds.
constexpr double kRestAfterCheckpoint = 19.0;

/// Of a clock that never goes back [s]. Its zero means nothing: only differences do.
double wall_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Sums of which no part can be infinite or NaN unless they are.
double sum(const Vec2& v) { return v.x() + v.y(); }
double sum(const Twist& t) { return sum(t.velocity) + t.omega; }
double sum(const Pose& p) { return sum(p.position) + p.angle; }
double sum(const BodyState& s) { return sum(s.pose) + sum(s.twist); }
double sum(const Contact& c) {
  return c.time + c.time_low + sum(c.point) + sum(c.normal) + c.closing_speed + c.gap;
}
double sum(const LastedContact& c) {
  return c.from + c.to + sum(c.point) + sum(c.normal) + c.normal_force + c.tangential_force;
}
double sum(const EventSide& side) { return side.known ? sum(side.after) + sum(side.before) : 0.0; }

}  // namespace

/// Numbers of which a sum overflows are beyond any that a run can go on with (is_in_range).
bool Records::is_told(double number, int body, double t) {
  if (std::isfinite(number)) return true;
  run_->stop(Termination::failed, fmt::format("the state of '{}' is not finite at t = {:.17g} s",
                                              trajectories_->world().bodies[body].name, t));
  return false;
}

/// The recorder may be null: the frame clock and the numbers of events go on all the same.
void Records::begin(Recorder* recorder) {
  recorder_ = recorder;
  next_checkpoint_ = wall_clock() + run_->options().checkpoint_seconds;
  wind_frame_clock(run_->time());
}

/// To the last frame up to time t, or, where that is due right now, the one before: another interval than the
/// last run's, or none in that run, must bring back nothing that is past.
void Records::wind_frame_clock(double t) {
  const double interval = run_->options().frame_interval;
  // from 2^53 on not every count of frames is a double
  if (!(interval > 0.0) || t / interval >= 0x1p53) return;
  auto k = static_cast<std::uint64_t>(t / interval);
  if (static_cast<double>(k) * interval > t) --k;  // the quotient was rounded up
  if (static_cast<double>(k + 1) * interval <= t) ++k;
  // a frame at t itself that nobody has recorded is still to come
  const bool due_now = k > 0 && static_cast<double>(k) * interval == t && last_frame_ != t;
  frame_ = due_now ? k - 1 : k;
}

std::optional<double> Records::frame_due(double t) const {
  const double interval = run_->options().frame_interval;
  if (!(interval > 0.0)) return std::nullopt;
  // a product, not a sum of intervals: no drift over many frames
  const double due = static_cast<double>(frame_ + 1) * interval;
  return due > t ? std::nullopt : std::optional(due);
}

bool Records::get_ready(double t) {
  while (recorder_ && !recorder_->get_ready(t))
    if (run_->is_asked_to_stop()) return false;
  return true;
}

void Records::frame_of_clock(double due) {
  ++frame_;
  frame(due);
}

/// A frame beside the clock does not move it on.
void Records::frame(double t) {
  last_frame_ = t;
  if (!recorder_) return;
  const std::vector<BodyState> states = trajectories_->states(t);
  for (std::size_t k = 0; k < states.size(); ++k)
    if (!is_told(sum(states[k]), static_cast<int>(k), t)) return;
  recorder_->frame(t, states);
}

void Records::event(EventKind kind, const PairKey& pair, const FeatureContact& contact, double impulse_n,
                    double impulse_t, Real delay, const EventSide& body, const EventSide& other) {
  Event event;
  // numbered whether or not anybody records: snapshots hold the number
  event.seq = seq_++;
  // Within an instant the clock may go back by a rounding; told times do not, and the low part makes up
  // for it.
  last_event_ = std::max(last_event_, run_->time());
  if (!records_events()) return;
  event.kind = kind;
  event.contact = world_contact(pair, contact);
  event.contact.time = last_event_;
  // the moment of contact is time + time_low, to more digits than a double has
  event.contact.time_low = static_cast<double>(run_->time() - last_event_ + delay);
  event.impulse_n = impulse_n;
  event.impulse_t = impulse_t;
  event.body = body;
  event.other = other;
  const double of_contact = sum(event.contact) + impulse_n + impulse_t;
  if (!is_told(of_contact + sum(body), pair.body, last_event_)) return;
  if (other.known && !is_told(sum(other), pair.other_body, last_event_)) return;
  tell(event);
}

/// Its time may lie ahead (a Zeno limit), so later events are not held to it.
void Records::ending(EventKind kind, const PairKey& pair, const FeatureContact& contact, double time) {
  Event event;
  event.seq = seq_++;
  if (!records_events()) return;
  event.kind = kind;
  event.contact = world_contact(pair, contact);
  event.contact.time = time;
  if (is_told(sum(event.contact), pair.body, run_->time())) tell(event);
}

/// One of the present instant is not told to be before an event that was told: they follow each other.
void Records::knot(Knot knot) {
  if (!records_events()) return;
  if (knot.time == run_->time()) knot.time = std::max(knot.time, last_event_);
  if (is_told(sum(knot.pose) + sum(knot.before) + sum(knot.after), knot.body, knot.time)) tell(knot);
}

/// A stretch of no length is none: its step was cut where it began.
void Records::lasted(const HeldContact& c) {
  if (!records_events() || !(run_->time() > c.since)) return;
  const LastedContact lasted{c.since,           run_->time(),      c.mode,
                             c.pair.body,       c.pair.other_body, c.pair.other_site,
                             c.feature.sample,  c.feature.site,    c.feature.sample_on_a,
                             c.place,           c.feature.normal,  c.normal_force,
                             c.tangential_force};
  if (is_told(sum(lasted), c.pair.body, run_->time())) tell(lasted);
}

/// In the order in which it happened.
void Records::tell_held_back() {
  for (const auto& what : take_back()) std::visit([this](const auto& of) { pass_on(of); }, what);
}

/// By the wall clock: when checkpoints are written changes nothing of the run. Below 0: never.
bool Records::checkpoint_due() const {
  return recorder_ && run_->options().checkpoint_seconds >= 0.0 && wall_clock() >= next_checkpoint_;
}

void Records::checkpoint(const std::function<std::vector<std::byte>()>& snapshot) {
  const double begin = wall_clock();
  recorder_->checkpoint(run_->time(), snapshot());
  const double end = wall_clock(), wish = run_->options().checkpoint_seconds;
  // 0 is at every chance, whatever that takes
  next_checkpoint_ = end + (wish > 0.0 ? std::max(wish, kRestAfterCheckpoint * (end - begin)) : 0.0);
}

}  // namespace brink
