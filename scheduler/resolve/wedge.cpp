#include "brink/scheduler/resolve/wedge.h"

#include <algorithm>

#include "brink/core/shapes/curve_site.h"
#include "brink/scheduler/resolve/tolerances.h"

namespace brink {

Wedge wedge_at(const Outline& outline, const Vec2& vertex) {
  // Sites join bit for bit, and vertex samples are copies of their ends: to compare for equality finds
  // all that meet there, several corners where a union pinches.
  Wedge w;
  const auto add = [&](const Vec2& travel, double sense) {
    w.edges.push_back(sense * travel);
    // the solid lies to the left of the travel: out of it is to the right
    w.normals.push_back(-perp(travel));
    if (!outline.solid) w.normals.push_back(perp(travel));  // a wire has two sides
  };
  for (const Site& site : outline.sites) {
    if (site.kind == SiteKind::point) continue;
    if (site.a == vertex) add(direction_at_start(site), 1.0);
    if (site.b == vertex) add(direction_at_end(site), -1.0);
  }
  return w;
}

/// n points from `behind` to `front`: no edge of `front` may lead back over the line across it, and none of
/// `behind` forward. Edges along the line do neither.
bool parts(const Vec2& n, const Wedge& front, const Wedge& behind) {
  return std::all_of(front.edges.begin(), front.edges.end(),
                     [&](const Vec2& e) { return n.dot(e) >= -kParallelEdges; }) &&
         std::all_of(behind.edges.begin(), behind.edges.end(),
                     [&](const Vec2& e) { return n.dot(e) <= kParallelEdges; });
}

}  // namespace brink
