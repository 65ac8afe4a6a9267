#include "brink/scheduler/islands/outline_half.h"

#include <algorithm>

#include "brink/core/shapes/curve_site.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink::islands {

Wedge wedge_of(const Half& half, const Sample& sample) {
  return turned(wedge_at(half.carrier, sample.p), [&](const Vec2& d) {
    return half.other_frame.direction_to_local(half.carrier_frame.direction_to_world(d));
  });
}

Vec2 centre(const Half& half) {
  return half.other_frame.to_local(half.carrier_frame.to_world(half.carrier.bounds.center()));
}

Vec2 outward(const Site& site) {
  const Vec2 d = site.b - site.a;
  return Vec2(d.y(), -d.x()) / d.norm();
}

bool has_direction(const Nearest& nearest, const Vec2& q, double least) {
  return (q - nearest.point).norm() > least;
}

Vec2 direction(const Site& site, const Nearest& nearest, const Vec2& q, double least) {
  const Vec2 way = q - nearest.point;
  const bool told = has_direction(nearest, q, least);
  if (told && nearest.foot == Foot::interior && site.kind == SiteKind::segment) {
    const Vec2 d = site.b - site.a;  // its own normal: that of a short way has lost digits
    return perp(d) * ((cross(d, q - site.a) < 0.0 ? -1.0 : 1.0) / d.norm());
  }
  if (told) return way.normalized();
  // of a solid outwards; of a wire, right upon its end, one of the two
  if (site.kind == SiteKind::segment && (site.solid || nearest.foot != Foot::interior)) return outward(site);
  if (site.solid && nearest.foot != Foot::interior)
    return (nearest.foot == Foot::start ? site.pseudo_a : site.pseudo_b).normalized();
  return normal_at(site, nearest, q);
}

bool is_beyond_hollow_end(const Site& site, const Nearest& nearest, double side) {
  return side < 0.0 && site.solid && site.kind == SiteKind::segment && nearest.foot != Foot::interior;
}

const Vec2& nearer_end(const Site& site, const Vec2& q) {
  return (q - site.a).squaredNorm() < (q - site.b).squaredNorm() ? site.a : site.b;
}

double beyond_ends(const Site& site, const Vec2& q) {
  const Vec2 d = site.b - site.a;
  const double length = d.norm(), along = d.dot(q - site.a) / length;
  return std::max({0.0, -along, along - length});
}

bool is_behind(const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& out, const Vec2& at) {
  if (site.kind == SiteKind::segment) return out.dot(q - nearest.point) < 0.0;
  if (site.kind == SiteKind::point || site.solid) return side_of(site, nearest, q) < 0.0;
  const bool was_outside = out.dot(at - site.center) > 0.0;
  return ((q - site.center).norm() > site.arc_radius) != was_outside;
}

Vec2 leads_from(const Vec2& end, const Site& site) {
  return site.a == end ? direction_at_start(site) : Vec2(-direction_at_end(site));
}

bool joins_smoothly(const Vec2& end, const Site& one, const Site& other) {
  return leads_from(end, one).dot(leads_from(end, other)) <= -1.0 + kSmoothJoint;
}

bool ends_at(const Outline& outline, const Site& site, const Nearest& nearest) {
  if (site.kind == SiteKind::point || nearest.foot == Foot::interior) return false;
  const Vec2& end = nearest.foot == Foot::start ? site.a : site.b;
  return std::none_of(outline.sites.begin(), outline.sites.end(), [&](const Site& s) {
    return &s != &site && s.kind != SiteKind::point && (s.a == end || s.b == end) &&
           joins_smoothly(end, site, s);
  });
}

std::array<Half, 2> halves(const OutlineAt& a, const OutlineAt& b) {
  const Frame of_a((a.position - b.position).cast<double>(), a.of_angle), of_b(Vec2::Zero(), b.of_angle);
  return {Half{*a.outline, *b.outline, of_a, of_b, true}, Half{*b.outline, *a.outline, of_b, of_a, false}};
}

}  // namespace brink::islands
