#include "brink/core/shapes/distance.h"

#include "brink/core/shapes/curve_site.h"

namespace brink {

Vec2 normal_at(const Site& site, const Nearest& nearest, const Vec2& q) {
  const double side = side_of(site, nearest, q);
  if (nearest.foot == Foot::interior && site.kind != SiteKind::point) {
    // from the site, not from q - point, which near the surface is all rounding
    const Vec2 right = right_normal(site, nearest.point);
    if (site.solid) return right;
    return (q - nearest.point).dot(right) < 0.0 ? Vec2(-right) : right;
  }
  // a vertex: the gap grows straight away from it; the pseudo-normal tells nothing but the side
  if (nearest.distance > 0.0) return (q - nearest.point) * (side / nearest.distance);
  // q is the place itself, which has no direction of its own
  if (site.kind == SiteKind::point) return {1.0, 0.0};
  const Vec2& pseudo = nearest.foot == Foot::start ? site.pseudo_a : site.pseudo_b;
  const double length = pseudo.norm();
  return site.solid && length > 0.0 ? Vec2(pseudo / length) : right_normal(site, nearest.point);
}

}  // namespace brink
