#pragma once
/// Where the motion of a body that an island holds begins anew, one record each.

#include "brink/core/base/geometry.h"

namespace brink {

/// A place at which a body's motion has one twist before and another after, or one in the middle of a motion.
///
/// An island gives its members a new motion with every step, which no event tells of; so do a capture and a release.
/// From one state of a body that is known to its next (knots, collisions, frames) its motion is the cubic through both
/// with their twists: to rounding where the twist is constant, and else as near as the run was asked to tell.
struct Knot {
  double time = 0.0;  ///< [s]
  int body = -1;
  Pose pose;
  Twist before, after;
};

}  // namespace brink
