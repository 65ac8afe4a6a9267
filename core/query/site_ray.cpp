#include "brink/core/query/site_ray.h"

#include <algorithm>

#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"

namespace brink {

namespace {

/// What lies behind the origin is not met.
void keep_first(SiteHit& hit, double distance, const Vec2& normal) {
  if (distance >= 0.0 && distance < hit.distance) hit = {distance, normal};
}

/// A disc, thickness or bare point. It is met where the ray enters: the ray starts outside.
void meet_disc(const Vec2& center, double radius, const HalfLine& ray, SiteHit& hit) {
  const Vec2 from = ray.origin - center;
  const double distance = time_until_within(from, ray.direction, radius);
  if (!(distance < hit.distance)) return;
  // a bare point has no normal of its own: against the ray
  keep_first(hit, distance,
             radius > 0.0 ? Vec2((from + distance * ray.direction).normalized()) : Vec2(-ray.direction));
}

/// The segment from a to b, which can be met against its unit normal alone.
void meet_segment(const Vec2& a, const Vec2& b, const Vec2& normal, const HalfLine& ray, SiteHit& hit) {
  const Vec2 to_a = a - ray.origin, to_b = b - ray.origin;
  const double side_a = cross(ray.direction, to_a), side_b = cross(ray.direction, to_b);
  // both ends beyond one side of the ray's line. At an end that sharp sites share,
  // the neighbour computes the same sign: no ray passes between the two
  if (std::max(side_a, side_b) < 0.0 || std::min(side_a, side_b) > 0.0) return;
  const double along_a = ray.direction.dot(to_a), along_b = ray.direction.dot(to_b);
  const double approach = -normal.dot(ray.direction), height = -normal.dot(to_a);
  // however flat the ray, it meets the segment between the ends; along it, at the nearer one
  const double distance = approach > 0.0 ? height / approach : std::min(along_a, along_b);
  keep_first(hit, std::clamp(distance, std::min(along_a, along_b), std::max(along_a, along_b)), normal);
}

/// The arc of `site` moved out by `offset` from its centre; met from outside its circle, from inside, or both.
class OffsetArc {
 public:
  OffsetArc(const Site& site, double offset, bool from_outside, bool from_inside)
      : site_(site),
        radius_(site.arc_radius + offset),
        offset_(offset),
        from_outside_(from_outside),
        from_inside_(from_inside) {}

  /// The ray's line cuts a cap, at most half of the disc, off the circle. The arc, at most a quarter of it,
  /// crosses the line once if one of its ends is in the cap, and twice if it goes over the cap's middle.
  void meet(const HalfLine& ray, SiteHit& hit) const {
    const Vec2 w = site_.center - ray.origin;
    const double along = ray.direction.dot(w), beside = cross(ray.direction, w);
    const double height = std::abs(beside), side = beside >= 0.0 ? 1.0 : -1.0;
    // 0 where rounding has the line miss the circle although an end of the arc is beyond the line
    const double half = std::sqrt(std::max(0.0, (radius_ - height) * (radius_ + height)));
    const Vec2 a = end(site_.a) - ray.origin, b = end(site_.b) - ray.origin;
    const double side_a = side * cross(ray.direction, a), side_b = side * cross(ray.direction, b);
    if (side_a == 0.0) meet_end(ray, a, hit);
    if (side_b == 0.0) meet_end(ray, b, hit);
    const bool a_in_cap = side_a < 0.0, b_in_cap = side_b < 0.0;
    const bool twice =
        !a_in_cap && !b_in_cap && height <= radius_ && in_sector(site_, -side * perp(ray.direction));
    if (!twice && a_in_cap == b_in_cap) return;
    // the cap's end that is counter-clockwise is the far one where the centre is on the left
    const bool at_far_end = (a_in_cap == (site_.sweep > 0.0)) == (side > 0.0);
    // a ray goes into a circle at its near meeting and out at its far one:
    // it comes from outside to the one and from inside to the other
    if (from_outside_ && (twice || !at_far_end)) meet_circle(ray, near(w, along, half, ray), 1.0, hit);
    if (from_inside_ && (twice || at_far_end)) meet_circle(ray, far(w, along, half, ray), -1.0, hit);
  }

 private:
  Vec2 end(const Vec2& core) const {
    if (offset_ == 0.0) return core;
    // An end of the offset arc, on the same radius as the core's. Without offset the core's bits are kept,
    // which neighbours share.
    return site_.center + (core - site_.center) * (radius_ / site_.arc_radius);
  }
  /// The product of the two distances, > 0 where the ray starts outside the circle; rounds relative to the
  /// distance from the arc.
  double product(const Vec2& w, const HalfLine& ray) const {
    return (beyond_circle(site_, ray.origin, -w) - offset_) * (w.norm() + radius_);
  }
  /// With far() the roots along -+ half of t^2 - 2 along t + product = 0. Where the difference would
  /// cancel, the root is the product over the other root.
  double near(const Vec2& w, double along, double half, const HalfLine& ray) const {
    return along > 0.0 ? product(w, ray) / (along + half) : along - half;
  }
  double far(const Vec2& w, double along, double half, const HalfLine& ray) const {
    return along < 0.0 ? product(w, ray) / (along - half) : along + half;
  }
  void meet_circle(const HalfLine& ray, double distance, double out, SiteHit& hit) const {
    const Vec2 radial = (ray.origin + distance * ray.direction - site_.center).normalized();
    keep_first(hit, distance, out * radial);
  }
  /// The ray goes through an end.
  void meet_end(const HalfLine& ray, const Vec2& to_end, SiteHit& hit) const {
    const Vec2 radial = (ray.origin + to_end - site_.center).normalized();
    const double out = radial.dot(ray.direction) > 0.0 ? -1.0 : 1.0;
    if (out > 0.0 ? from_outside_ : from_inside_) keep_first(hit, ray.direction.dot(to_end), out * radial);
  }

  const Site& site_;
  double radius_, offset_;
  bool from_outside_, from_inside_;
};

/// Part of a solid's boundary that has no thickness: met from its free side alone.
bool is_sharp_solid(const Site& site) { return site.solid && site.radius == 0.0; }

void meet_segment_site(const Site& site, const HalfLine& ray, SiteHit& hit) {
  Vec2 normal = -perp((site.b - site.a).normalized());
  // seen from behind: a ray from outside has met another side of a sharp
  // solid before; wires, and what is thick, are met from either side
  if (normal.dot(ray.direction) > 0.0) {
    if (is_sharp_solid(site)) return;
    normal = -normal;
  }
  meet_segment(site.a + site.radius * normal, site.b + site.radius * normal, normal, ray, hit);
}

void meet_arc_site(const Site& site, const HalfLine& ray, SiteHit& hit) {
  if (site.radius > 0.0) {
    // thick: the outer offset from outside and the inner one from inside; none where the hollow is filled
    OffsetArc(site, site.radius, true, false).meet(ray, hit);
    if (site.arc_radius > site.radius) OffsetArc(site, -site.radius, false, true).meet(ray, hit);
    return;
  }
  // a solid lies to the left of its arcs: those that turn left are round toward its free side
  const bool both = !is_sharp_solid(site);
  OffsetArc(site, 0.0, both || site.sweep > 0.0, both || site.sweep < 0.0).meet(ray, hit);
}

}  // namespace

SiteHit first_hit(const Site& site, const HalfLine& ray) {
  SiteHit hit;
  if (site.kind == SiteKind::segment) meet_segment_site(site, ray, hit);
  if (site.kind == SiteKind::arc) meet_arc_site(site, ray, hit);
  // ends of sharp sites are met as parts of them
  if (site.kind == SiteKind::point || site.radius > 0.0) meet_disc(site.a, site.radius, ray, hit);
  if (site.kind != SiteKind::point && site.radius > 0.0) meet_disc(site.b, site.radius, ray, hit);
  return hit;
}

}  // namespace brink
