#include "brink/scheduler/first_contact/site_step.h"

namespace brink {

Facing facing_convex(const Outline& outline, const Vec2& q, const Vec2& rate) {
  const std::size_t count = outline.sites.size();
  // A convex polygon lies behind the line of each of its sides. So the largest of the signed distances
  // to these lines is a lower bound of the distance to the polygon, and is that distance where the foot
  // lies on the side.
  std::size_t side = 0;
  double gap = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < count; ++k) {
    const double outside = outline.facets[k].dot(q - outline.sites[k].a);
    side = outside > gap ? k : side;  // two selects: which is farthest cannot be predicted
    gap = outside > gap ? outside : gap;
  }
  const Site& site = outline.sites[side];
  const Vec2 d = site.b - site.a;
  const double along = d.dot(q - site.a);
  const Facing of_side{gap, outline.facets[side].dot(rate)};
  const bool past_b = along > d.squaredNorm();
  // inside the polygon, or abreast of the side: its line is as close as any
  if (gap <= 0.0 || (along >= 0.0 && !past_b)) return of_side;
  // Past an end of the side its line tells less than there is, at a sharp corner next to nothing, and
  // steps by it would creep. If q is past this end of both sides that meet there, it lies between their
  // normals, and the line through the corner across the direction to q has the whole polygon behind it.
  const std::size_t after = side + 1 == count ? 0 : side + 1, before = side == 0 ? count - 1 : side - 1;
  const Site& next = outline.sites[past_b ? after : before];
  const Vec2 from_corner = q - (past_b ? site.b : site.a);
  const Vec2 next_side = past_b ? Vec2(next.b - next.a) : Vec2(next.a - next.b);
  if (from_corner.dot(next_side) > 0.0) return of_side;  // the next side is nearer than their corner
  // Not 0: it is no less than the gap, which is > 0.
  const double distance = from_corner.norm();
  return {distance, from_corner.dot(rate) / distance};
}

Facing facing(const Outline& outline, const Vec2& q, const Vec2& rate) {
  const Site& site = outline.sites[0];
  Facing line;
  if (!outline.facets.empty()) {
    line = facing_convex(outline, q, rate);
  } else {
    // the distance to a segment is convex: it never lies below its support line at the present foot
    const Nearest nearest = nearest_on(site, q);
    line = {nearest.distance, distance_rate(site, nearest, q, rate)};
  }
  line.gap -= site.radius;
  return line;
}

HullDistance distance_to_arc_hull(const Site& arc, const Nearest& nearest, const Vec2& q) {
  const double turn = arc.sweep > 0.0 ? 1.0 : -1.0;
  const Vec2 chord = arc.b - arc.a;
  const Vec2 w = q - arc.a;
  // The arc lies to the right of its chord when it turns left, and the reverse.
  const double behind = turn * cross(chord, w);  // > 0: on the concave side of the chord
  if (behind > 0.0) {
    const double along = w.dot(chord), length2 = chord.squaredNorm();
    if (along > 0.0 && along < length2) {
      const double length = std::sqrt(length2);
      return {behind / length, Vec2(perp(chord) * (turn / length))};
    }
  } else if (nearest.foot == Foot::interior && beyond_circle(arc, q, q - arc.center) <= 0.0) {
    return {};  // between chord and arc
  }
  // Abreast of the arc and outside its circle. The centre itself is not met here: the sector is no wider
  // than a quarter turn, so the centre is on the concave side, abreast of the chord.
  if (nearest.foot == Foot::interior) return {nearest.distance, (q - arc.center).normalized()};
  // Nearest to an end, which is a corner of the hull, too.
  if (nearest.distance == 0.0) return {};
  return {nearest.distance, Vec2((q - nearest.point) / nearest.distance)};
}

}  // namespace brink
