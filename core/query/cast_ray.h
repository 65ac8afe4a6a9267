#pragma once
/// The first hit of a ray on one outline, where the outline stands.

#include <limits>
#include <optional>

#include "brink/core/shapes/outline.h"

namespace brink {

/// The places origin + t * direction, 0 <= t <= length. World frame.
struct Ray {
  Vec2 origin = Vec2::Zero();
  Vec2 direction = Vec2::UnitX();                           ///< unit
  double length = std::numeric_limits<double>::infinity();  ///< [m]
};

struct RayHit {
  double distance = 0.0;       ///< along the ray [m], 0 .. length
  Vec2 point = Vec2::Zero();   ///< in the world, on the surface (starts_inside: the origin)
  Vec2 normal = Vec2::Zero();  ///< unit, out of the outline, never along the ray (inside: of closest_point())
  int site = -1;               ///< into Outline::sites; where sites meet, one of them
  bool starts_inside = false;  ///< the origin is inside: distance 0
};

/// Where the ray first meets `outline`, standing at `pose`, or nothing.
///
/// Touching counts: an origin on the surface is hit at distance 0, and so is a corner or a disc that the ray
/// grazes. Wires, with and without thickness, are hit from either side, solids from outside; a ray that starts
/// in the free room of a container meets its wall. No ray slips through where two sites of one outline meet.
///
/// Closed forms: a line or a circle a site, its offsets and a circle about each end where it has a thickness.
/// Errors: a rounding of the distances involved over the sine of the angle at which the ray meets the surface.
/// Cost: all sites, twice. An image in a plane that repeats is the caller's: shift the pose.
/// @throws BadInput if origin or direction is not finite, the direction's length is off 1 by more than 1e-9,
/// length is < 0 or NaN, or the origin is farther than kFarthestQuery (closest_point.h) from the outline's.
std::optional<RayHit> cast_ray(const Outline& outline, const Pose& pose, const Ray& ray);

}  // namespace brink
