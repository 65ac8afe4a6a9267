#pragma once
/// A quick bound below the gap of two outlines where they stand.

#include "brink/core/shapes/outline.h"

namespace brink {

/// No more than outline_gap() of the two [m], but for roundings of the poses; minus infinity where nothing is known. Looks
/// go on, from the cheapest to the dearest, until the bound is more than `enough` [m]:
///
///   discs    that hold the outlines, about their origins
///   centres  the place of one's origin against the other's sites, less the disc of the one; for containers, too
///   lines    that part the two: the outlines' supports across a line, which is turned toward the place where the hulls
///            are nearest (Gilbert 1966, "An iterative procedure for computing the minimum of a quadratic form on a convex
///            set", SIAM J. Control 4(1)); an arc counts as its whole circle
///   sides    of either hull, beyond which all corners of the other are: what touches along a side is told to rounding
///
/// Cost: all sites of both once, all samples of both up to eight times, and up to 16 corners beside 16 sides, where every
/// look is needed.
double gap_at_least(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b,
                    double enough);

}  // namespace brink
