#pragma once
/// What is kept of bodies that islands hold, beside their motions: what they go back to, and the step that they are in.

#include <map>

#include "brink/core/base/extended.h"
#include "brink/core/base/geometry.h"
#include "brink/scheduler/kernel/body_track.h"

namespace brink {

/// A held body's step: it moves with the twist that it comes to have at the end, from the start on.
struct HeldStep {
  double start = 0.0, end = 0.0;  ///< [s]
  Twist before;                   ///< at the start
};

/// How a body moved by itself before an island held it, to which it is let go.
struct HeldBody {
  int component = BodyTrack::kFree;
  Acceleration acceleration;  ///< of a free one
  HeldStep step;
};

/// The held bodies, by id. Cost of a look: O(log n).
class HeldBodies {
 public:
  void add(int k, const HeldBody& body) { held_[k] = body; }
  /// Lets it go. @pre held
  HeldBody take(int k) {
    const HeldBody body = held_.at(k);
    held_.erase(k);
    return body;
  }
  /// @pre held
  const HeldBody& at(int k) const { return held_.at(k); }
  const std::map<int, HeldBody>& all() const { return held_; }

  void note_step(int k, const HeldStep& step) { held_.at(k).step = step; }
  /// Its twist is the one that it was given from here on.
  void forget_step(int k) { note_step(k, {}); }
  /// The twist that a body has come to by now, of which the motion has the twist of the step's end from the start on:
  /// the part of the step's change of velocity that is left is taken off. Outside of a step: what is given.
  ExtendedTwist come_to(int k, double now, ExtendedTwist at_end) const;

 private:
  std::map<int, HeldBody> held_;
};

}  // namespace brink
