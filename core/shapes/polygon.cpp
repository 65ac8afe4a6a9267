#include "brink/core/shapes/polygon.h"

#include <algorithm>

#include "brink/core/base/error.h"
#include "brink/core/shapes/crossing.h"
#include "brink/core/shapes/loops.h"
#include "brink/core/shapes/text.h"

namespace brink {

double signed_area(const std::vector<Vec2>& vertices) {
  // about a vertex, so that far from the origin no digits cancel; see enclosed_area()
  double twice = 0.0;
  for (std::size_t k = 1; k + 1 < vertices.size(); ++k)
    twice += cross(vertices[k] - vertices[0], vertices[k + 1] - vertices[0]);
  return twice / 2;
}

/// How often a ray from p to the right crosses the boundary: an odd number of times from inside.
bool polygon_contains(const std::vector<Vec2>& vertices, const Vec2& p) {
  bool inside = false;
  for (std::size_t k = 0, j = vertices.size() - 1; k < vertices.size(); j = k++) {
    const Vec2 &a = vertices[j], &b = vertices[k];
    // a vertex at p's height counts as below it: of the two edges that meet
    // there, a boundary that goes through the height crosses it once
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    // p to the left of the edge taken upward: a ray to the right crosses it
    const bool left = cross(b - a, p - a) > 0.0;
    if (left == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

std::vector<Vec2> checked_polygon(const std::vector<Vec2>& vertices, const std::string& what) {
  for (std::size_t k = 0; k < vertices.size(); ++k)
    if (!vertices[k].allFinite())
      throw BadInput(what + ": vertex " + std::to_string(k) + " is " + text(vertices[k]) +
                     "; coordinates must be finite");
  std::vector<Vec2> kept = without_repeats(vertices, true);
  if (kept.size() < 3)
    throw BadInput(what + ": has " + std::to_string(kept.size()) +
                   " distinct vertices; at least 3 are needed");
  Box box;
  for (const Vec2& v : kept) box.add(v);
  const double area = signed_area(kept);
  // less could be the rounding of its triangles, and the orientation with it
  if (!(std::abs(area) > 1e-14 * box.extent().squaredNorm()))
    throw BadInput(what + ": its area is " + text(area) + " m^2; it must enclose some");
  // not finished: require_simple() reads sites and bounds alone
  Outline outline;
  outline.bounds = box;
  add_loop(outline, segments_through(kept, true, 0.0), true);
  require_simple(outline, what);
  // the first vertex stays the first
  if (area < 0.0) std::reverse(kept.begin() + 1, kept.end());
  return kept;
}

}  // namespace brink
