#pragma once
/// Area or length, centroid and second moment of an outline, exact up to rounding.

#include "brink/core/shapes/shapes.h"

namespace brink {

/// Sums over a region (or a wire) about a reference point: size, first moment, polar second moment.
struct Moments {
  double size = 0.0;
  Vec2 first = Vec2::Zero();
  double second = 0.0;
};

/// What the region left of a directed segment or arc contributes to the sums about `about`, by Green's
/// theorem: the sum over a closed boundary is the sum over the region inside (> 0 if counter-clockwise).
void add_region(Moments& sums, const Site& site, const Vec2& about);

/// What the core contributes as a wire of unit density a metre.
void add_wire(Moments& sums, const Site& site, const Vec2& about);

/// Moves the sums taken about `about` to the centroid. A region of no size has its centroid at `about`.
Measure finish_measure(const Moments& sums, const Vec2& about);

/// The measure of an outline, by what it is:
/// - a point with a radius: a disc;
/// - solid, no radius: the region inside its loops (a container: the free region, size > 0);
/// - not solid, no radius: a wire, by length;
/// - with a radius: the region within `radius` of the outline (and of its inside if solid), overlaps counted
/// once.
Measure measure_of(const Outline& outline);

}  // namespace brink
