/// closest_point() settles where the ray starts: on the surface or inside, that is the answer. From outside, the
/// outline is met where the first of its sites is: the ray is held against each of them alone.
#include "brink/core/query/cast_ray.h"

#include "brink/core/base/error.h"
#include "brink/core/query/closest_point.h"
#include "brink/core/query/site_ray.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

/// @throws BadInput; NaN fails each of the three.
void check(const Ray& ray) {
  if (!ray.origin.allFinite()) throw BadInput("ray: origin is " + text(ray.origin) + "; it must be finite");
  if (!(std::abs(ray.direction.norm() - 1.0) <= 1e-9))
    throw BadInput("ray: direction is " + text(ray.direction) + "; its length must be 1");
  if (!(ray.length >= 0.0)) throw BadInput("ray: length is " + text(ray.length) + "; it must be >= 0");
}

}  // namespace

std::optional<RayHit> cast_ray(const Outline& outline, const Pose& pose, const Ray& ray) {
  check(ray);
  // first_hit() wants a start outside; what is on the surface is hit where it starts
  const SurfacePoint start = closest_point(outline, pose, ray.origin);
  if (start.gap <= 0.0) return RayHit{0.0, ray.origin, start.normal, start.site, start.gap < 0.0};
  const Frame frame(pose);
  // check() lets its length be off by 1e-9, and the frame's
  // sine and cosine are rounded; first_hit() wants 1
  const HalfLine local{frame.to_local(ray.origin), frame.direction_to_local(ray.direction).normalized()};
  SiteHit first;
  int at = -1;
  // Of sites hit at one distance, as where two meet, the first stays.
  for (std::size_t k = 0; k < outline.sites.size(); ++k) {
    const SiteHit hit = first_hit(outline.sites[k], local);
    if (!(hit.distance < first.distance)) continue;
    first = hit;
    at = static_cast<int>(k);
  }
  if (at < 0 || first.distance > ray.length) return std::nullopt;
  // The frame keeps lengths, so that the distance is the world's too.
  return RayHit{first.distance, ray.origin + first.distance * ray.direction,
                frame.direction_to_world(first.normal), at, false};
}

}  // namespace brink
