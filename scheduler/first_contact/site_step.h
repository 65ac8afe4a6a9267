#pragma once
/// The certified step of one moving point against one site.

#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/outline.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/safe_step.h"

namespace brink {

/// Distance from q to the convex hull of an arc (the circular segment between arc and chord) and its
/// gradient; 0 inside.
struct HullDistance {
  double distance = 0.0;
  Vec2 gradient = Vec2::Zero();
};
HullDistance distance_to_arc_hull(const Site& arc, const Nearest& nearest, const Vec2& q);

/// Gap of a point with `radius` (thickness of both sides together) to one site, and how long it cannot close.
struct SiteStep {
  double gap;   ///< unsigned distance - radius [m]
  double rate;  ///< d(gap)/dt of the unsigned distance [m/s]
  double safe;  ///< certified: the gap stays > 0 for this long [s]
};

/// How far a point is outside a line that has all of an outline behind it, and how that changes.
struct Facing {
  double gap = 0.0;   ///< [m]
  double rate = 0.0;  ///< [m/s]
};

/// The line between q and the core of a convex polygon: at the nearest point where that is seen at a glance
/// (the foot on the side that q is farthest outside of, or its corner), else along that side. A step that is
/// safe for the line is safe for every site, so one stands for all. Cost: one dot product a side.
/// @pre outline.facets is not empty.
Facing facing_convex(const Outline& outline, const Vec2& q, const Vec2& rate);

/// True of an outline that facing() tells of: a convex polygon, rounded or not, or one segment.
inline bool has_facing(const Outline& o) {
  return !o.facets.empty() || (o.sites.size() == 1 && o.sites[0].kind == SiteKind::segment);
}

/// A line between q and all of such an outline, its thickness included: as far off as the outline where that is seen
/// at a glance. A step that is safe for the line is safe for the outline. @pre has_facing(outline).
Facing facing(const Outline& outline, const Vec2& q, const Vec2& rate);

/// d(distance)/dt of q from the site's core. Abreast of the site it is that along the site's own normal: the foot's rounding,
/// which is one of the site's size, would turn the way from it.
inline double distance_rate(const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& rate) {
  if (nearest.foot == Foot::interior) {
    if (site.kind == SiteKind::segment) {
      const Vec2 d = site.b - site.a;
      return cross(d, rate) / (cross(d, q - site.a) < 0.0 ? -d.norm() : d.norm());
    }
    const Vec2 w = q - site.center;
    if (site.kind == SiteKind::arc && !w.isZero(0.0))
      return w.dot(rate) / (beyond_circle(site, q, w) < 0.0 ? -w.norm() : w.norm());
  }
  return nearest.distance > 0.0 ? (q - nearest.point).dot(rate) / nearest.distance : 0.0;
}

/// The step of what is not abreast of an arc: until it comes to one of its ends, by `to_end` (distance [m],
/// its rate [m/s]) -> [s], or abreast. `bend`: of q's path [m/s^2].
template <class ToEnd>
double step_beyond_ends(const Site& arc, const Vec2& q, const Vec2& rate, double bend, ToEnd&& to_end) {
  const auto until = [&](const Vec2& away, auto&& step) {
    const double distance = away.norm();
    return distance > 0.0 ? step(distance, away.dot(rate) / distance) : 0.0;
  };
  const auto plain = [&](double distance, double falls) { return safe_step(distance, falls, bend); };
  const Vec2 w = q - arc.center;
  double least = std::numeric_limits<double>::infinity();
  for (const Vec2& end : {arc.a, arc.b}) {
    const Vec2 side = (end - arc.center) / arc.arc_radius;  // of the sector that is abreast
    const Vec2 to_side = w.dot(side) > 0.0 ? Vec2(w - w.dot(side) * side) : w;
    least = std::min({least, until(q - end, to_end), until(to_side, plain)});
  }
  return least;
}

/// `df` is distance_rate() of the same place. @pre bounds hold for at least the time that the caller will use
/// of `safe`.
inline SiteStep site_step(const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& rate,
                          double df, double radius, double slack, const PathBounds& bounds) {
  const double gap = nearest.distance - radius;
  SiteStep step{gap, df, 0.0};
  const double f = std::max(gap, 0.0) + slack;
  if (site.kind != SiteKind::arc) {  // convex
    step.safe = safe_step(f, df, bounds.acceleration);
    return step;
  }
  // An arc is held apart by its circle, or by its convex hull: whichever is certain for longer.
  step.safe = bounds.speed > 0.0 ? f / bounds.speed : std::numeric_limits<double>::infinity();
  const Vec2 w = q - site.center;
  const double rho = w.norm();
  const double beyond = beyond_circle(site, q, w);
  const double circle = std::abs(beyond) - radius + slack;
  if (circle > 0.0 && rho > 0.0) {
    const double radial = w.dot(rate) / rho;
    const bool inside = beyond < 0.0;
    const double curvature = bounds.acceleration + (inside ? bounds.speed * bounds.speed / rho : 0.0);
    step.safe = std::max(step.safe, safe_step(circle, inside ? -radial : radial, curvature));
  }
  const HullDistance hull = distance_to_arc_hull(site, nearest, q);
  if (hull.distance - radius + slack > 0.0 && hull.distance > 0.0)
    step.safe = std::max(
        step.safe, safe_step(hull.distance - radius + slack, hull.gradient.dot(rate), bounds.acceleration));
  if (nearest.foot != Foot::interior)
    step.safe = std::max(
        step.safe, step_beyond_ends(site, q, rate, bounds.acceleration, [&](double distance, double falls) {
          return safe_step(distance - radius + slack, falls, bounds.acceleration);
        }));
  return step;
}

}  // namespace brink
