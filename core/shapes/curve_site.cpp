#include "brink/core/shapes/curve_site.h"

#include <array>
#include <numbers>

#include "brink/core/base/sine_cosine.h"

namespace brink {

namespace {

/// v turned by an angle [rad], exactly at whole quarter turns.
/// As the product of complex numbers.
Vec2 turned(const Vec2& v, double angle) {
  const Vec2 u = unit_at(angle);
  return {u.x() * v.x() - u.y() * v.y(), u.y() * v.x() + u.x() * v.y()};
}

/// Unit direction of travel at a point of the arc.
Vec2 tangent(const Site& arc, const Vec2& p) {
  const Vec2 left = perp((p - arc.center).normalized());
  return arc.sweep > 0 ? left : Vec2(-left);
}

}  // namespace

Vec2 unit_at(double angle) {
  const double quarters = std::round(angle / kQuarterTurn);
  // up to the roundings of the multiple and of a change from degrees it is the multiple: cos(pi / 2) is
  // 6e-17 in doubles, and the ends of a circle's quarters would lie beside its axes
  if (std::abs(angle - quarters * kQuarterTurn) > 4e-16 * std::max(1.0, std::abs(angle)))
    return {sine_cosine(angle).cosine, sine_cosine(angle).sine};
  static const std::array<Vec2, 4> axes{Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)};
  // fmod() keeps the sign: quarters below 0 are lifted
  return axes[static_cast<int>(std::fmod(quarters, 4.0) + 4.0) % 4];
}

Site point_site(const Vec2& p, double radius) {
  Site s;
  s.radius = radius;
  s.a = s.b = p;
  return s;
}

Site segment_site(const Vec2& a, const Vec2& b, double radius) {
  Site s;
  s.kind = SiteKind::segment;
  s.radius = radius;
  s.a = a;
  s.b = b;
  return s;
}

void add_arc(std::vector<Site>& sites, const Vec2& a, const Vec2& b, const Vec2& center, double arc_radius,
             double sweep, double radius) {
  // quarter turns with a rounding are as many pieces, not one more
  const int pieces = std::max(1, static_cast<int>(std::ceil(std::abs(sweep) / kMostArcSweep)));
  Site s;
  s.kind = SiteKind::arc;
  s.radius = radius;
  s.center = center;
  s.arc_radius = arc_radius;
  s.sweep = sweep / pieces;
  Vec2 start = a;
  for (int k = 1; k <= pieces; ++k) {
    s.a = start;
    // turned from the arc's own start, not the piece's: errors do not add up from piece to piece
    s.b = k == pieces ? b : Vec2(center + turned(a - center, sweep * k / pieces));
    sites.push_back(s);
    start = s.b;
  }
}

Vec2 direction_at_start(const Site& site) {
  return site.kind == SiteKind::arc ? tangent(site, site.a) : Vec2((site.b - site.a).normalized());
}

Vec2 direction_at_end(const Site& site) {
  return site.kind == SiteKind::arc ? tangent(site, site.b) : Vec2((site.b - site.a).normalized());
}

Vec2 right_normal(const Site& site, const Vec2& p) {
  if (site.kind == SiteKind::segment) return -perp((site.b - site.a).normalized());
  const Vec2 radial = (p - site.center).normalized();
  return site.sweep > 0 ? radial : Vec2(-radial);
}

double curvature(const Site& site) {
  if (site.kind != SiteKind::arc) return 0.0;
  return site.sweep > 0 ? 1.0 / site.arc_radius : -1.0 / site.arc_radius;
}

double length(const Site& site) {
  return site.kind == SiteKind::arc ? site.arc_radius * std::abs(site.sweep) : (site.b - site.a).norm();
}

Vec2 point_along(const Site& site, double fraction) {
  // the end is met up to rounding only: where pieces are to join, b is to be taken itself
  if (site.kind == SiteKind::arc) return site.center + turned(site.a - site.center, site.sweep * fraction);
  return site.a + fraction * (site.b - site.a);
}

bool in_sector(const Site& arc, const Vec2& direction) {
  const Vec2 from = arc.a - arc.center, to = arc.b - arc.center;
  const double turn = arc.sweep > 0 ? 1.0 : -1.0;
  // the crosses alone would take no direction at all, and the opposite one of a flat arc by rounding
  return turn * cross(from, direction) >= 0.0 && turn * cross(direction, to) >= 0.0 &&
         direction.dot(from + to) > 0.0;
}

/// Pseudo-normals are not exchanged: they mean nothing until the outline is finished.
Site reversed(const Site& site) {
  Site s = site;
  std::swap(s.a, s.b);
  s.sweep = -s.sweep;
  return s;
}

Box core_bounds(const Site& site) {
  Box box;
  box.add(site.a);
  box.add(site.b);
  if (site.kind != SiteKind::arc) return box;
  // along an axis an arc is extreme at an end, or where its circle is
  for (int k = 0; k < 4; ++k) {
    const Vec2 axis = unit_at(k * kQuarterTurn);
    if (in_sector(site, axis)) box.add(Vec2(site.center + site.arc_radius * axis));
  }
  return box;
}

double farthest_from_origin(const Site& site) {
  // along a circle the distance from the origin is greatest behind the centre and falls to both sides: an
  // arc without that place is farthest at an end, and one about the origin (no direction) everywhere
  const double ends = std::max(site.a.norm(), site.b.norm());
  if (site.kind != SiteKind::arc || !in_sector(site, site.center)) return ends;
  return std::max(ends, site.center.norm() + site.arc_radius);
}

}  // namespace brink
