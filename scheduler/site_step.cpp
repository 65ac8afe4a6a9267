#include "brink/scheduler/site_step.h"

namespace brink {

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
  if (nearest.foot == Foot::interior) return {nearest.distance, (q - arc.center).normalized()};
  if (nearest.distance == 0.0) return {};
  return {nearest.distance, Vec2((q - nearest.point) / nearest.distance)};
}

}  // namespace brink
