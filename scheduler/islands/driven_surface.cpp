#include "brink/scheduler/islands/driven_surface.h"

#include <cmath>

namespace brink {

namespace {

/// Sine of an angle between a contact's normal and a site's own there: more is an end, met from beside.
constexpr double kOfSide = 1e-3;

}  // namespace

/// Of a line with normal n through p: n' . (p' - p), each afterwards; of a circle by how much its centre is nearer to the body, or
/// in a hollow farther from it.
double advance_of_surface(const NearFeature& f, const Outline& b, double angle, const Frame& step) {
  const Frame before(Pose{{0.0, 0.0}, angle});
  const auto moved = [&](const Vec2& place) { return Vec2(step.to_world(place) - place); };
  const Vec2& n = f.normal;
  // a corner of the owner's, or an arc of its own: it comes to the body's side
  if (!f.sample_on_a) return n.dot(moved(before.direction_to_world(b.samples[f.sample].p)));
  const Site& site = b.sites[f.site];
  if (site.kind == SiteKind::segment) {
    const Vec2 along = before.direction_to_world((site.b - site.a).normalized());
    if (std::abs(along.dot(n)) <= kOfSide) return step.direction_to_world(n).dot(moved(f.point));
  }
  if (site.kind == SiteKind::arc) {
    const Vec2 centre = before.direction_to_world(site.center), way = f.point + f.gap * n - centre;
    const double distance = way.norm(), side = way.dot(n) < 0.0 ? -1.0 : 1.0;
    if (std::abs(cross(way, n)) <= kOfSide * distance)
      return side * (distance - (way - moved(centre)).norm());
  }
  return n.dot(moved(f.point));
}

}  // namespace brink
