#pragma once
/// Outlines that cross without a vertex of one inside the other: what two-sided sampling of a gap cannot see.

#include "brink/core/shapes/outline.h"

namespace brink {

struct OutlineCrossing {
  double depth = 0.0;  ///< how far the nearer end of two crossing segments reaches through [m]; 0: none cross
  Vec2 point = Vec2::Zero();   ///< where the deepest two cross, in the world
  Vec2 normal = Vec2::Zero();  ///< unit, across b's segment
};

/// The deepest crossing of a segment of `a` with one of `b`. Arcs are left out: an arc that crosses has an
/// end, or its own sample, inside. Cost: all pairs of segments.
OutlineCrossing deepest_crossing(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b);

}  // namespace brink
