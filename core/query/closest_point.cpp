#include "brink/core/query/closest_point.h"

#include "brink/core/base/error.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/text.h"

namespace brink {

SurfacePoint closest_point(const Outline& outline, const Pose& pose, const Vec2& q) {
  if (!q.allFinite()) throw BadInput("closest point: the place is " + text(q) + "; it must be finite");
  const Frame frame(pose);
  const Vec2 local = frame.to_local(q);
  SurfacePoint found;
  found.gap = gap_by_brute_force(outline, local, &found.site);
  const Site& site = outline.sites[static_cast<std::size_t>(found.site)];
  const Nearest nearest = nearest_on(site, local);
  const Vec2 normal = normal_at(site, nearest, local);
  // from the core: as q - gap * normal it would be rounded as q is, however far away that is
  found.point = frame.to_world(nearest.point + site.radius * normal);
  found.normal = frame.direction_to_world(normal);
  return found;
}

}  // namespace brink
