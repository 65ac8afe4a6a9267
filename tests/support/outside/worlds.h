#pragma once
/// Gaps of what stands in a world at its start, seen from outside: geometry that shares no code with Brink.

#include "brink/core/world/world.h"
#include "tests/support/outside/gap.h"

namespace brink::outside {

struct Standing {
  Shape shape;
  Place place;
};

/// Bodies first, then sites.
inline std::vector<Standing> standing(const World& world) {
  std::vector<Standing> out;
  for (const Body& body : world.bodies)
    out.push_back({shape_of(*body.outline), {vec(body.initial.pose.position), body.initial.pose.angle}});
  for (const FixedSite& site : world.sites)
    out.push_back({shape_of(*site.outline), {vec(site.pose.position), site.pose.angle}});
  return out;
}

inline double gap(const Standing& a, const Standing& b) {
  return static_cast<double>(gap(a.shape, a.place, b.shape, b.place));
}

}  // namespace brink::outside
