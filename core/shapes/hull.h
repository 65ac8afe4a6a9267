#pragma once
/// The convex hull of an outline, as far as that is told at a glance.

#include <span>
#include <vector>

#include "brink/core/base/geometry.h"
#include "brink/core/shapes/site.h"

namespace brink {

/// A convex polygon, thickened: all of an outline is within `thickness` of it, to rounding. Of arcs it holds the triangle of the
/// ends and of where the tangents there meet. In the outline's frame.
struct Hull {
  std::vector<Vec2> corners;  ///< counter-clockwise, no three in a line [m]
  /// Outward unit normal of the side from each corner to the next; of two corners both sides of their line, of one none.
  std::vector<Vec2> normals;
  double thickness = 0.0;  ///< [m]
  double reach = 0.0;      ///< of the farthest corner from the origin [m]
};

/// Corners of the convex hull of points, counter-clockwise from the leftmost, no three in a line; of points on a line its two
/// ends. Cost: O(n log n). Source: Andrew 1979, "Another efficient algorithm for convex hulls in two dimensions".
std::vector<Vec2> convex_hull(std::vector<Vec2> points);

/// Cost: O(n log n) for n sites.
Hull hull_of(std::span<const Site> sites);

}  // namespace brink
