#include "brink/core/shapes/loops.h"

#include <algorithm>

#include "brink/core/base/error.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/measure.h"
#include "brink/core/shapes/text.h"

namespace brink {

/// The outline is not finished by it: samples, bounds and the rest come from finish_outline().
void add_loop(Outline& outline, const std::vector<Site>& sites, bool closed) {
  outline.loops.push_back({static_cast<int>(outline.sites.size()), static_cast<int>(sites.size()), closed});
  outline.sites.insert(outline.sites.end(), sites.begin(), sites.end());
}

std::vector<Site> segments_through(const std::vector<Vec2>& vertices, bool closed, double radius) {
  std::vector<Site> sites;
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k)
    sites.push_back(segment_site(vertices[k], vertices[k + 1], radius));
  if (closed) sites.push_back(segment_site(vertices.back(), vertices.front(), radius));
  return sites;
}

std::vector<Vec2> without_repeats(const std::vector<Vec2>& vertices, bool closed) {
  std::vector<Vec2> kept;
  for (const Vec2& v : vertices)
    if (kept.empty() || kept.back() != v) kept.push_back(v);
  while (closed && kept.size() > 1 && kept.back() == kept.front()) kept.pop_back();
  return kept;
}

double enclosed_area(const std::vector<Site>& sites) {
  Moments sums;
  // the sum is the same about any place; about one of the loop its terms are no larger than the loop:
  // about the origin, 1 m^2 at 1e6 m is a difference of areas of 1e6 m^2
  for (const Site& s : sites) add_region(sums, s, sites.front().a);
  return sums.size;
}

std::vector<Site> reversed(const std::vector<Site>& sites) {
  std::vector<Site> back;
  // each is turned, and so is their order: the next starts where the last ended
  for (auto s = sites.rbegin(); s != sites.rend(); ++s) back.push_back(reversed(*s));
  return back;
}

namespace {

/// Mass and inertia are to come from the measure: they must be numbers > 0.
void require_usable(const Outline& outline, const Measure& m) {
  // an area's second moment is of the fourth power of its size: infinite above 1e77 m, 0 below 1e-81 m
  if (!std::isfinite(m.size) || !m.centroid.allFinite() || !std::isfinite(m.second_moment))
    throw BadInput("shape: reaches to " + text(outline.bounding_radius) +
                   " m, too far for its second moment to be a number; use smaller coordinates");
  // it has no measure, and is allowed: its inertia has to be given (make_body.h)
  const bool bare_point = outline.is_point() && outline.sites[0].radius == 0.0;
  if (!bare_point && !(m.size > 0.0 && m.second_moment > 0.0))
    throw BadInput("shape: has size " + text(m.size) + " and second moment " + text(m.second_moment) +
                   "; both must be > 0 (is it very small, or in another unit?)");
}

}  // namespace

Shape finish_shape(Outline outline) {
  finish_outline(outline);
  const Measure measure = measure_of(outline);
  require_usable(outline, measure);
  return {std::move(outline), measure};
}

void require_positive(const char* name, double value) {
  if (!(value > 0.0 && std::isfinite(value)))
    throw BadInput(std::string(name) + " is " + text(value) + "; it must be > 0 and finite");
}

void require_radius(double value) {
  if (!(value >= 0.0 && std::isfinite(value)))
    throw BadInput("radius is " + text(value) + "; it must be >= 0 and finite");
}

void require_finite(const char* name, const Vec2& value) {
  if (!value.allFinite())
    throw BadInput(std::string(name) + " is " + text(value) + "; coordinates must be finite");
}

}  // namespace brink
