#pragma once
/// Smooth curves as circular arcs: adaptive biarc fitting.
///
/// A biarc is two arcs that meet the curve's ends and end tangents and each other's tangent (Bolton 1975,
/// "Biarc curves"; the equal-lengths choice of the joint). The curve is cut at its breaks, a biarc is tried,
/// and a piece that is off by more than the tolerance, or turns by more than a quarter, is halved in
/// parameter. Nearly straight arcs become segments.

#include <vector>

#include "brink/core/shapes/site.h"
#include "brink/core/shapes/smooth_curve.h"

namespace brink {

/// Appends segments and arcs of thickness `radius` that run from `start` to `end`, bit for bit the ends
/// given, along the curve.
/// @returns an upper bound on the distance from any point of the curve to the arcs [m], at most `tolerance`:
/// the largest
///   distance at dense parameters plus the most it can grow between two of them (second derivatives are
///   bounded).
/// @throws BadInput if the tolerance is below 1e-10 of the curve's coordinates: rounding would drown it.
/// @pre tolerance > 0, start and end are the curve's ends up to rounding.
double fit_arcs(const SmoothCurve& curve, const Vec2& start, const Vec2& end, double tolerance, double radius,
                std::vector<Site>& sites);

}  // namespace brink
