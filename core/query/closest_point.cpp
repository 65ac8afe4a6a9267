#include "brink/core/query/closest_point.h"

#include "brink/core/base/error.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/text.h"

namespace brink {

SurfacePoint closest_point(const Outline& outline, const Pose& pose, const Vec2& q) {
  return closest_point_at(Frame(pose), outline, q);
}

SurfacePoint closest_point_at(const Frame& frame, const Outline& outline, const Vec2& q) {
  if (!q.allFinite()) throw BadInput("closest point: the place is " + text(q) + "; it must be finite");
  // In the outline's frame, where sites are: far from the world's origin their coordinates stay small.
  const Vec2 local = frame.to_local(q);
  if (!(local.lpNorm<Eigen::Infinity>() <= kFarthestQuery))
    throw BadInput("closest point: the place is " + text(q) + "; it must be within " + text(kFarthestQuery) +
                   " m of the outline's origin");
  SurfacePoint found;
  found.gap = gap_by_brute_force(outline, local, &found.site);
  const Site& site = outline.sites[static_cast<std::size_t>(found.site)];
  const Nearest nearest = nearest_on(site, local);
  // far from a solid the site does not tell the side: gap_by_brute_force() does
  const bool is_far = site.solid && is_beyond(outline, nearest.distance);
  // Outward: outside from the core to the place, inside from the place to the core.
  const Vec2 away = (found.gap < 0.0 ? -1.0 : 1.0) * (local - nearest.point);
  const Vec2 normal = is_far ? away.normalized() : normal_at(site, nearest, local);
  // from the core: as q - gap * normal it would be rounded as q is, however far away that is
  found.point = frame.to_world(nearest.point + site.radius * normal);
  found.normal = frame.direction_to_world(normal);
  return found;
}

}  // namespace brink
