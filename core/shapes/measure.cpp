#include "brink/core/shapes/measure.h"

#include <numbers>

#include "brink/core/base/sine_cosine.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/thick_boundary.h"

namespace brink {

namespace {

/// x - sin x, without cancellation for small x.
double less_sine(double x) {
  // x / (x - sin x) is 12.5 at 0.7 and less above: the difference loses at most four bits
  if (std::abs(x) > 0.7) return x - sine_cosine(x).sine;
  // the series x^3 / 3! - x^5 / 5! + ...
  double term = x * x * x / 6, sum = 0.0;
  for (int n = 4; std::abs(term) > 1e-18 * std::abs(sum); n += 2) {
    sum += term;
    term *= -x * x / (n * (n + 1));
    if (term == 0.0) break;
  }
  return sum;
}

/// Adds sums taken about `center` to sums taken about `about`.
/// With x = y + shift, |x|^2 = |y|^2 + 2 y . shift + |shift|^2; `center` need not be the part's centroid.
void add_moved(Moments& sums, const Moments& part, const Vec2& center, const Vec2& about) {
  const Vec2 shift = center - about;
  sums.size += part.size;
  sums.first += part.first + part.size * shift;
  sums.second += part.second + 2 * shift.dot(part.first) + part.size * shift.squaredNorm();
}

/// Unit vector from the centre through the middle of the arc.
Vec2 bisector(const Site& arc) { return (point_along(arc, 0.5) - arc.center).normalized(); }

/// The region between an arc and its chord, about the circle's centre: sector less triangle.
Moments between_arc_and_chord(const Site& arc) {
  const double r = arc.arc_radius, angle = arc.sweep;
  const double half_sine = sine_cosine(angle / 2).sine;
  Moments m;
  // signed as the sweep is; the second moment is r^4 angle / 4 of the sector less r^4
  // (2 sin + sin cos) / 12 of the triangle, as two differences x - sin x
  m.size = r * r / 2 * less_sine(angle);
  m.first = 2.0 / 3.0 * r * r * r * half_sine * half_sine * half_sine * bisector(arc);
  m.second = r * r * r * r / 12 * (2 * less_sine(angle) + less_sine(2 * angle) / 2);
  return m;
}

/// The polar second moment of a disc about its centre is pi r^4 / 2.
Measure measure_of_disc(const Site& s) {
  const double area = std::numbers::pi * s.radius * s.radius;
  return {area, s.a, area * s.radius * s.radius / 2};
}

}  // namespace

void add_region(Moments& sums, const Site& site, const Vec2& about) {
  // An arc counts as its chord, and what lies between the two is added at the end.
  const Vec2 a = site.a - about, b = site.b - about;
  // the triangle from `about` over a and b: round a closed boundary what is covered outside of it cancels
  // Its area is a x b / 2; its centroid, (a + b) / 3 from `about`; its second moment, area (a^2 + a.b + b^2) / 6.
  const double twice = cross(a, b);
  sums.size += twice / 2;
  sums.first += twice / 6 * (a + b);
  sums.second += twice / 12 * (a.squaredNorm() + a.dot(b) + b.squaredNorm());
  if (site.kind == SiteKind::arc) add_moved(sums, between_arc_and_chord(site), site.center, about);
}

void add_wire(Moments& sums, const Site& site, const Vec2& about) {
  if (site.kind == SiteKind::point) return;
  Moments m;
  m.size = length(site);
  if (site.kind == SiteKind::segment) {
    // about its middle, where the first moment is 0
    m.second = m.size * m.size * m.size / 12;
    add_moved(sums, m, 0.5 * (site.a + site.b), about);
    return;
  }
  const double r = site.arc_radius;
  // the integral of r^2 times the unit vector over the angle, in which what is across the bisector cancels
  m.first = 2 * r * r * sine_cosine(std::abs(site.sweep) / 2).sine * bisector(site);
  m.second = m.size * r * r;
  add_moved(sums, m, site.center, about);
}

Measure finish_measure(const Moments& sums, const Vec2& about) {
  if (sums.size == 0.0) return {0.0, about, 0.0};
  // by the parallel axis theorem
  const Vec2 offset = sums.first / sums.size;
  return {sums.size, about + offset, sums.second - sums.size * offset.squaredNorm()};
}

/// Cost: all sites; with a thickness that of thick_boundary().
Measure measure_of(const Outline& outline) {
  if (outline.is_point()) return measure_of_disc(outline.sites[0]);
  // near the centroid, where finish_measure() takes off little: about an origin
  // 1e8 m away, the second moment of 1 m would be what is left of 1e16
  const Vec2 about = outline.bounds.center();
  bool thick = false;
  for (const Site& s : outline.sites) thick |= s.radius > 0.0;
  Moments sums;
  if (thick) {
    for (const Site& piece : thick_boundary(outline)) add_region(sums, piece, about);
  } else if (outline.solid) {
    // a container's loops run clockwise round the free region
    for (const Site& s : outline.sites) add_region(sums, outline.container ? reversed(s) : s, about);
  } else {
    for (const Site& s : outline.sites) add_wire(sums, s, about);
  }
  // thick_boundary() too has the solid on its left, so the free region counts negative
  if (thick && outline.container) sums = {-sums.size, -sums.first, -sums.second};
  return finish_measure(sums, about);
}

}  // namespace brink
