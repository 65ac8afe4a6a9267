#pragma once
/// What is kept of bodies that islands hold, beside their motions: what they go back to, and the step that they are in.

#include <optional>
#include <vector>

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

/// The held bodies, by id.
class HeldBodies {
 public:
  void add(int k, const HeldBody& body) {
    if (k >= static_cast<int>(held_.size())) held_.resize(k + 1);
    held_[k] = body;
  }
  /// Lets it go. @pre held
  HeldBody take(int k) {
    const HeldBody body = at(k);
    held_[k].reset();
    return body;
  }
  /// @pre held
  const HeldBody& at(int k) const { return held_[k].value(); }
  /// Tells of each of them, ascending: visit(id, body).
  template <class Visit>
  void each(Visit&& visit) const {
    for (int k = 0; k < static_cast<int>(held_.size()); ++k)
      if (held_[k]) visit(k, *held_[k]);
  }

  /// @pre held
  void note_step(int k, const HeldStep& step) { held_[k].value().step = step; }
  /// Its twist is the one that it was given from here on.
  void forget_step(int k) { note_step(k, {}); }
  /// The twist that a body has come to by now, of which the motion has the twist of the step's end from the start on:
  /// the part of the step's change of velocity that is left is taken off. Outside of a step: what is given.
  ExtendedTwist come_to(int k, double now, ExtendedTwist at_end) const;

 private:
  std::vector<std::optional<HeldBody>> held_;  ///< by id; of bodies that are not held nothing
};

}  // namespace brink
