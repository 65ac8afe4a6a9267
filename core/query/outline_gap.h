#pragma once
/// Two outlines where they stand: how far apart, or how deep in each other.

#include "brink/core/shapes/outline.h"

namespace brink {

/// World frame.
struct OutlineGap {
  double gap = 0.0;             ///< [m]; > 0: the distance; < 0: minus the depth
  Vec2 point_a = Vec2::Zero();  ///< on a's surface
  Vec2 point_b = Vec2::Zero();  ///< on b's surface: point_a = point_b + gap * normal
  Vec2 normal = Vec2::Zero();   ///< unit, out of b, into a
  int sample = -1;              ///< into Outline::samples of a or b; -1: no sample tells, the outlines cross
  bool sample_on_a = true;      ///< whose sample it is
  int site = -1;                ///< into Outline::sites of the other
};

/// The gap of `a`, standing at `pose_a`, and `b`, standing at `pose_b`.
///
/// Apart, it is the exact distance of the two surfaces, with the closest features: the samples of each are
/// held against the sites of the other (design: shapes, sites, samples). Overlapping, the depth is that of the
/// deepest vertex inside the other, or of the deepest crossing of two sites: how far the nearer end, or an
/// arc's bulge, reaches through. It is a measure of how deep, not the least translation that parts them. Where
/// no sample tells (sample -1) both points are where the two cross, and the normal is across b's site there, or
/// a's; of a wire, either way.
///
/// Two outlines that only touch are told to a rounding of their sizes and their distance from each other; how
/// far away from the world's origin they are costs no digits but those of the poses themselves. Two images in a
/// plane that repeats are the caller's: shift a pose. Cost: samples of each times sites of the other, and pairs
/// of sites.
/// @throws BadInput if one stands so far from the other that closest_point() would.
OutlineGap outline_gap(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b);

/// True if the two are surely apart by more than `margin` [m]: quicker than outline_gap(), and stops at the
/// first doubt. False where they overlap or touch, and also where an arc's circle, taken as whole, would (it
/// counts beyond its sector here).
bool surely_apart(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b, double margin);

}  // namespace brink
