#pragma once
/// Flights side by side, so that a processor compares several of them with one at a time.

#include "brink/core/base/wide.h"
#include "brink/scheduler/broad_phase/flight.h"

namespace brink {

/// Some bodies, and when another's flight can meet them, in a plane that does not repeat.
class FlightBatch {
 public:
  static constexpr int kMost = 28;

  /// Where the numbers of kMost bodies are to be written, for meet(); and some more, of which nothing is asked.
  int* bodies() { return bodies_; }
  int body(int i) const { return bodies_[i]; }
  /// When a flight can meet the i-th at the soonest, by the last meet(); infinite: never. One that does not
  /// fly freely may be met at once.
  double begin(int i) const { return begin_[i]; }

  /// Compares the first `count` of bodies() with `a` from `now` on: meeting()'s own bits, whatever the processor can
  /// do at once. Bit i of the answer: the i-th may be met before that time.
  unsigned meet(int count, const Flight* flights, const Course& a, double now, double before);

 private:
  static constexpr int kRoom = kMost + 4;

  int bodies_[kRoom] = {};
  alignas(sizeof(Four)) double begin_[kRoom];
};

}  // namespace brink
