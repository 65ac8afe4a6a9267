#pragma once
/// Outlines that cross without a vertex of one inside the other: what two-sided sampling of a gap cannot see.

#include "brink/core/shapes/outline.h"

namespace brink {

struct OutlineCrossing {
  double depth = 0.0;          ///< [m], see deepest_crossing(); 0: none
  Vec2 point = Vec2::Zero();   ///< where the deepest two cross, in the world
  Vec2 normal = Vec2::Zero();  ///< unit, across b's segment
};

/// The deepest crossing of a segment of `a` with one of `b`: how far the nearer end reaches through. Where
/// none cross by more than rounding, two solids may still share an inside, along edges that coincide or from
/// vertex on edge to vertex on edge (boxes of one height in one row; a shape on itself): then a place in
/// both, and how deep it lies in the one that has it less deep. Arcs are left out: an arc that crosses has an
/// end, or its own sample, inside. Cost: all pairs of segments.
/// @param gap  what their samples say [m], where that is known: two that share an inside along edges have vertices on
///             edges, so nobody looks for it where the gap is more than 1e-6 of the lesser size.
OutlineCrossing deepest_crossing(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b,
                                 double gap = 0.0);

}  // namespace brink
