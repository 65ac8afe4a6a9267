#pragma once
/// Flights side by side, so that a processor compares several of them with one at a time.

#include <array>
#include <span>

#include "brink/scheduler/broad_phase/flight.h"

namespace brink {

/// Some bodies, and when another's flight can meet them, in a plane that does not repeat. To be made by `{}`, which
/// clears all of it at once: what is computed past size() is of numbers, too.
class FlightBatch {
 public:
  static constexpr int kMost = 64;

  int size() const { return size_; }
  int body(int i) const { return body_[i]; }
  /// When a flight can meet the i-th at the soonest, by the last meet(); infinite: never. One that does not
  /// fly freely may be met at once.
  double begin(int i) const { return begin_[i]; }

  /// The flights of some bodies, but for `except`. @pre at most kMost.
  void gather(std::span<const int> bodies, int except, std::span<const Flight> flights) {
    int i = 0;
    for (const int body : bodies) {
      const Flight& f = flights[body];
      body_[i] = body;
      x_[i] = f.x;
      y_[i] = f.y;
      vx_[i] = f.vx;
      vy_[i] = f.vy;
      start_[i] = f.start;
      radius_[i] = f.radius;
      disc_[i] = f.disc;
      i += body != except;  // without a branch
    }
    size_ = i;
  }
  /// Compares all of them with `a` from `now` on: meeting()'s own bits, whatever the processor can do at once.
  void meet(const Course& a, double now);
  /// Those that `a` may meet before that time, by the last meet(): their numbers, written to `met`; how many.
  int met_before(double time, std::array<int, kMost>& met) const {
    int count = 0;
    for (int i = 0; i < size_; ++i) {
      met[count] = i;
      count += begin_[i] < time;  // without a branch: which they are cannot be foreseen
    }
    return count;
  }

 private:
  template <class T>
  using Row = T[kMost + 8];

  int size_;
  Row<int> body_;
  alignas(64) Row<double> x_, y_, vx_, vy_, start_, radius_, disc_, begin_;
};

}  // namespace brink
