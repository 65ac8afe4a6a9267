#pragma once
/// The union of simple polygons.

#include <vector>

#include "brink/core/base/geometry.h"

namespace brink {

/// Loops of the union's boundary with the solid on their left: outer loops counter-clockwise, holes
/// clockwise. Parts may be apart. Edges that the union covers vanish, and so do vertices that are collinear
/// up to rounding.
///
/// Vertices closer than 1e-12 of the extent are one vertex (the first given), vertices that close to an edge
/// lie on it, so parts that were meant to share an edge do. Vertices that were given keep their bits; only
/// crossings are computed. Where parts touch at a single vertex, loops are paired so that the sign of the
/// distance is right there: parts are taken apart, unless the solid turns by more than half round that
/// vertex.
///
/// Every polygon's edges are cut at all others, each piece is kept if exactly one of its sides is covered,
/// and kept pieces are joined into loops. Cost: pairs of edges, plus pieces times polygons.
/// @pre each polygon is simple and counter-clockwise (checked_polygon).
/// @throws BadInput if the pieces do not close (polygons that differ by about the tolerance in a
/// contradictory way).
std::vector<std::vector<Vec2>> union_of_polygons(const std::vector<std::vector<Vec2>>& polygons);

}  // namespace brink
