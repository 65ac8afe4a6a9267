#pragma once
/// A run's records: frames on the frame clock, events, checkpoints. A state that is not finite is told to nobody:
/// the run fails instead, and names the body and the time.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/island.h"
#include "brink/scheduler/kernel/speculation.h"
#include "brink/scheduler/run/recorder.h"

namespace brink {

class Records {
 public:
  Records(const Trajectories& trajectories, RunControl& run) : trajectories_(&trajectories), run_(&run) {}

  void begin(Recorder* recorder);

  // -- frames --
  /// When the next frame of the clock is due, if that is up to t [s].
  std::optional<double> frame_due(double t) const;
  /// What the recorder does before a frame at t. False: the run is asked to stop, and that is not done.
  bool get_ready(double t);
  /// Records that frame.
  void frame_of_clock(double due);
  /// Records one beside the clock.
  void frame(double t);
  /// The time of the last one [s]; < 0: there was none.
  double last_frame() const { return last_frame_; }

  // -- events --
  /// A collision, or the group that it is of, `delay` [s] after the present time. `body`, `other`: what they came
  /// to, where they have begun their motions anew.
  void event(EventKind kind, const PairKey& pair, const FeatureContact& contact, double impulse_n,
             double impulse_t, Real delay, const EventSide& body = {}, const EventSide& other = {});
  /// The same where nobody records events.
  void event_untold() {
    ++seq_;
    last_event_ = std::max(last_event_, run_->time());
  }
  bool records_events() const { return recorder_ && run_->options().record_events; }
  /// What comes to an end at a time of its own.
  void ending(EventKind kind, const PairKey& pair, const FeatureContact& contact, double time);
  /// The time of the last event, to which the next one is told not to be before [s].
  double last_event() const { return last_event_; }

  /// How a body moves in an island.
  void knot(Knot knot);

  /// A contact that lasted up to the present time.
  void lasted(const HeldContact& contact);

  // -- what may be undone --
  /// While one lives nobody is told of events, knots and contacts that lasted. Those are dropped with it, unless
  /// they are told() before.
  class HeldBack {
   public:
    explicit HeldBack(Records& records) : records_(&records) { records.holds_back_ = true; }
    ~HeldBack() { records_->take_back(); }
    HeldBack(const HeldBack&) = delete;
    HeldBack& operator=(const HeldBack&) = delete;
    void told() { records_->tell_held_back(); }

   private:
    Records* records_;
  };

  // -- checkpoints --
  bool checkpoint_due() const;
  /// Writes what `snapshot` gives. The next one is due after RunOptions::checkpoint_seconds, and no sooner than after so many
  /// times what this one took that all take a twentieth of the time.
  void checkpoint(const std::function<std::vector<std::byte>()>& snapshot);

  struct Saved {
    std::uint64_t seq = 0, frame = 0;
    double last_frame = -1.0, last_event = 0.0;
  };
  Saved saved() const { return {seq_, frame_, last_frame_, last_event_}; }
  void restore(const Saved& s) {
    seq_ = s.seq;
    frame_ = s.frame;
    last_frame_ = s.last_frame;
    last_event_ = s.last_event;
  }

 private:
  using Told = std::variant<Event, Knot, LastedContact>;
  void wind_frame_clock(double t);
  /// Now, or once it is known that it stays.
  template <class What>
  void tell(const What& what) {
    if (holds_back_)
      held_back_.emplace_back(what);
    else
      pass_on(what);
  }
  void pass_on(const Event& event) { recorder_->event(event); }
  void pass_on(const Knot& knot) { recorder_->knot(knot); }
  void pass_on(const LastedContact& contact) { recorder_->contact_lasted(contact); }
  void tell_held_back();
  /// From now on they are told at once. What was held back until now.
  std::vector<Told> take_back() {
    holds_back_ = false;
    return std::exchange(held_back_, {});
  }
  /// True if `number`, a sum of all that is to be told of the body at t, is finite; else the run has failed.
  bool is_told(double number, int body, double t);

  const Trajectories* trajectories_;
  RunControl* run_;
  Recorder* recorder_ = nullptr;
  std::uint64_t seq_ = 0;         ///< of the next event
  std::uint64_t frame_ = 0;       ///< frames recorded by the frame clock
  double last_frame_ = -1.0;      ///< time of the last frame recorded [s]
  double last_event_ = 0.0;       ///< time of the last event recorded [s]
  double next_checkpoint_ = 0.0;  ///< wall clock [s]
  bool holds_back_ = false;
  std::vector<Told> held_back_;
};

}  // namespace brink
