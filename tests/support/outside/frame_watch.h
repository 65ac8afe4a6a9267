#pragma once
/// A run with contacts that last, looked at from outside wherever its states are told.

#include "tests/support/outside/watch.h"

namespace brink::outside {

/// At every frame: no two are in each other by more than a part of the world's length, and energy has not
/// grown. A body in a step of an island has the velocity of the step's end all along, so weight has done its
/// work on the velocity before it does it on the place: by that of a step at most, energy is not known better.
class FrameWatch : public Watch {
 public:
  FrameWatch(const World& world, double until, double overlap, double start_overlap = 0)
      : Watch(world, WatchOptions{until, 0.5 * overlap, start_overlap}) {
    free_ = false;
    for (const Flyer& b : bodies_) largest_ = std::max(largest_, b.shape.reach);
  }

  Real gained = 0;  ///< the most that energy grew beyond the least before, of what there was at first
  double when = 0;  ///< that was [s]

  void frame(double t, std::span<const BodyState> states) override {
    Watch::frame(t, states);
    Real energy = 0, above = 0, below = 0;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const State s = state_of(states[k]);
      const Energy e = energy_of(k, s);
      energy += e.sum;
      if (frames_ == 0) first_ += e.scale;
      const Real power = world_.bodies[k].mass * dot(bodies_[k].flight.pull, s.velocity);
      (power > 0 ? above : below) += std::abs(power) * longest_step();
    }
    if (frames_++ > 0 && (energy - above - least_) / first_ > gained) {
      gained = (energy - above - least_) / first_;
      when = t;
    }
    least_ = std::min(least_, energy + below);
  }

 private:
  /// A twentieth of the time in which a body falls by its size [s].
  Real longest_step() const { return 0.05L * std::sqrt(2 * largest_ / world_.gravity.norm()); }

  Real largest_ = 0, first_ = 0, least_ = kNever;
  long frames_ = 0;
};

}  // namespace brink::outside
