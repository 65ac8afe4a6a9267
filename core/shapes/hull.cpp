#include "brink/core/shapes/hull.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace brink {

namespace {

/// What is within the tangents at its ends of an arc, a quarter turn at most: where they meet.
Vec2 apex(const Site& arc) {
  const double c = std::cos(0.5 * arc.sweep);
  return arc.center + ((arc.a - arc.center) + (arc.b - arc.center)) / (2.0 * c * c);
}

/// Takes from the end of a chain what would not turn to the left on the way to p, but nothing of the first `kept`.
void add_to_chain(std::vector<Vec2>& chain, std::size_t kept, const Vec2& p) {
  while (chain.size() > kept && !(cross(chain.back() - chain[chain.size() - 2], p - chain.back()) > 0.0))
    chain.pop_back();
  chain.push_back(p);
}

}  // namespace

std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  const auto before = [](const Vec2& p, const Vec2& q) {
    return std::tuple(p.x(), p.y()) < std::tuple(q.x(), q.y());
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2> chain;
  for (const Vec2& p : points) add_to_chain(chain, 1, p);  // below, from left to right
  const std::size_t below = chain.size();
  for (auto p = points.rbegin() + 1; p != points.rend(); ++p) add_to_chain(chain, below, *p);
  chain.pop_back();  // the first one again
  return chain;
}

Hull hull_of(std::span<const Site> sites) {
  Hull hull;
  std::vector<Vec2> points;
  for (const Site& site : sites) {
    hull.thickness = std::max(hull.thickness, site.radius);
    points.push_back(site.a);
    if (site.kind != SiteKind::point) points.push_back(site.b);
    if (site.kind == SiteKind::arc) points.push_back(apex(site));
  }
  hull.corners = convex_hull(std::move(points));
  for (const Vec2& p : hull.corners) hull.reach = std::max(hull.reach, p.norm());
  const std::size_t n = hull.corners.size();
  for (std::size_t k = 0; n > 1 && k < n; ++k)
    hull.normals.push_back(-perp(hull.corners[(k + 1) % n] - hull.corners[k]).normalized());
  return hull;
}

}  // namespace brink
