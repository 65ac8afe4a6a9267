#pragma once
/// Where a ray first meets one site: closed forms. Internal to core/query.

#include "brink/core/shapes/site.h"

namespace brink {

/// A half line that starts outside of the site, in the site's frame.
struct HalfLine {
  Vec2 origin = Vec2::Zero();
  Vec2 direction = Vec2::UnitX();  ///< unit
};

struct SiteHit {
  double distance = std::numeric_limits<double>::infinity();  ///< infinite: none [m]
  Vec2 normal = Vec2::Zero();                                 ///< unit, out of the site, against the ray
};

/// The first place where the ray comes within site.radius of the core.
///
/// A site with thickness is the union of its offset lines or circles and a disc about each end; as the ray
/// starts outside, the least distance to any of these is that to the union. A solid's site without thickness
/// is met from its right side alone. Which side of the ray an end lies on is computed from the end alone, so
/// sites that share an end bit for bit leave no slit.
SiteHit first_hit(const Site& site, const HalfLine& ray);

}  // namespace brink
