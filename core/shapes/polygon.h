#pragma once
/// Simple polygons: checked and oriented.

#include <string>
#include <vector>

#include "brink/core/base/geometry.h"

namespace brink {

/// The polygon's vertices counter-clockwise, without exact repeats of a vertex by the next (those are merged
/// silently). A clockwise polygon is turned round. Bits of coordinates are kept.
/// @throws BadInput, naming the polygon as `what`, on fewer than three vertices, NaN or infinity, no area, or
/// sides that
///   cross or touch.
std::vector<Vec2> checked_polygon(const std::vector<Vec2>& vertices, const std::string& what);

/// Signed area [m^2], > 0 counter-clockwise.
double signed_area(const std::vector<Vec2>& vertices);

/// Even-odd rule; points on the boundary may go either way. Cost: all vertices.
bool polygon_contains(const std::vector<Vec2>& vertices, const Vec2& p);

}  // namespace brink
