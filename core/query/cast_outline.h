#pragma once
/// How far an outline can move straight on, without turning, until it touches another.

#include "brink/core/shapes/outline.h"

namespace brink {

struct OutlineHit {
  enum class Status {
    passes,   ///< it never touches the other
    touches,  ///< after `distance`
    overlaps  ///< it is in the other where it starts
  };
  Status status = Status::passes;
  double distance = 0.0;  ///< [m], >= 0
};

/// The way of `a`, which stands at `pose_a` and moves along `direction`, to its first contact with `b`, which
/// stands at `pose_b`. World frame.
///
/// Touching where it starts counts, with distance 0, if moving on would lead into `b`. What it only grazes, to
/// 1e-10 of the lesser size, does not count: it slides down a wall that it touches.
///
/// Closed forms: every sample of each against the lines and circles of the other's sites, in the order of
/// their distances, each held against outline_gap() a little further on. Errors: a rounding of the sizes and
/// of the distance over the sine of the angle at which the surfaces meet; gaps after the move may be that much
/// below 0. An image in a plane that repeats is the caller's: shift a pose. Cost: samples of each times sites
/// of the other, and outline_gap() a few times.
/// @throws BadInput if the direction is not finite or its length is off 1 by more than 1e-9, or if one stands
/// so far from the other that closest_point() would.
OutlineHit cast_outline(const Outline& a, const Pose& pose_a, const Vec2& direction, const Outline& b,
                        const Pose& pose_b);

}  // namespace brink
