#pragma once
/// The point of one outline's surface that is closest to a place, where the outline stands.

#include "brink/core/shapes/outline.h"

namespace brink {

/// A place of an outline's surface, thickness included, seen from a query point q. World frame.
struct SurfacePoint {
  double gap = 0.0;            ///< signed distance of q [m]: > 0 outside, < 0 inside
  Vec2 point = Vec2::Zero();   ///< on the surface: q - gap * normal
  Vec2 normal = Vec2::Zero();  ///< unit, out of the outline; of a wire: toward q
  int site = -1;               ///< into Outline::sites; of sites equally near the first
};

/// Places farther from an outline's origin than this have no distance from it [m]: their squares overflow.
inline constexpr double kFarthestQuery = 1e150;

/// The closest point of `outline`, standing at `pose`, to q. The gap is that of gap_by_brute_force().
///
/// Outside, the answer is exact. Inside a thickness where others of the outline's sites lie too (the filled
/// notch of a rounded polygon, the joint of a thick chain) the answer is that of the nearest core: the surface
/// is at least as far as -gap, and `point` may be covered. On a wire without thickness the normal is to the
/// right of the site's direction. An image in a plane that repeats is the caller's: shift the pose.
///
/// Errors: a rounding of the distance between q and the outline, and of pose.position. Cost: all sites.
/// @throws BadInput if q is not finite, or farther than kFarthestQuery from the outline's origin.
SurfacePoint closest_point(const Outline& outline, const Pose& pose, const Vec2& q);
/// The same of an outline that is asked often where it stands.
SurfacePoint closest_point_at(const Frame& frame, const Outline& outline, const Vec2& q);

}  // namespace brink
