#pragma once
/// Exact distance from a point to a site, in double precision. Everything that Brink says about contact rests
/// here.

#include "brink/core/shapes/site.h"

namespace brink {

/// Where on a site's core the nearest point lies.
enum class Foot : std::uint8_t { start, end, interior };

/// The nearest point of a site's core (its radius left out).
struct Nearest {
  double distance = 0.0;  ///< to the core [m], >= 0
  Foot foot = Foot::interior;
  Vec2 point = Vec2::Zero();
};

/// |q - centre| - arc_radius for w = q - centre, signed: > 0 outside the circle.
///
/// Written as (|q - c|^2 - |e - c|^2) / (|q - c| + R) for the end e that is nearer, it rounds relative to the
/// distance from that end, not to the radius: flat arcs keep their digits, and tangent arcs are told apart
/// close to where they join.
inline double beyond_circle(const Site& arc, const Vec2& q, const Vec2& w) {
  const Vec2& end = w.dot(arc.a - arc.b) > 0.0 ? arc.a : arc.b;
  return (q - end).dot(w + (end - arc.center)) / (w.norm() + arc.arc_radius);
}

/// Nearest point of the core of `site` to `q`; ~10 flops and a square root. A point on an arc's centre is
/// answered with the arc's start (every point of the arc is equally near).
inline Nearest nearest_on(const Site& site, const Vec2& q) {
  switch (site.kind) {
    case SiteKind::segment: {
      const Vec2 d = site.b - site.a;
      const Vec2 w = q - site.a;
      const double along = w.dot(d), length2 = d.squaredNorm();
      if (along <= 0.0) return {w.norm(), Foot::start, site.a};
      if (along >= length2) return {(q - site.b).norm(), Foot::end, site.b};
      const double offset = cross(d, w) / std::sqrt(length2);
      return {std::abs(offset), Foot::interior, site.a + d * (along / length2)};
    }
    case SiteKind::arc: {
      const Vec2 w = q - site.center;
      const Vec2 from = site.a - site.center, to = site.b - site.center;
      // inside the sector: counter-clockwise of its first edge and clockwise of its last (sweep <= pi/2)
      const double turn = site.sweep > 0 ? 1.0 : -1.0;
      if (turn * cross(from, w) > 0.0 && turn * cross(w, to) > 0.0) {
        const double rho = w.norm();
        const double beyond = beyond_circle(site, q, w);
        return {std::abs(beyond), Foot::interior, q - w * (beyond / rho)};
      }
      const double da = (q - site.a).squaredNorm(), db = (q - site.b).squaredNorm();
      return da <= db ? Nearest{std::sqrt(da), Foot::start, site.a}
                      : Nearest{std::sqrt(db), Foot::end, site.b};
    }
    case SiteKind::point:
      break;
  }
  return {(q - site.a).norm(), Foot::start, site.a};
}

/// -1 if q, whose nearest point on the solid `site` is `nearest`, is inside the solid, else +1. Sites that
/// are not solid: +1.
///
/// Side of the core where the foot is interior, pseudo-normal where it is a vertex (Baerentzen & Aanaes
/// 2005).
inline double side_of(const Site& site, const Nearest& nearest, const Vec2& q) {
  if (!site.solid || site.kind == SiteKind::point) return 1.0;
  if (nearest.foot != Foot::interior) {
    const Vec2& pseudo = nearest.foot == Foot::start ? site.pseudo_a : site.pseudo_b;
    return (q - nearest.point).dot(pseudo) < 0.0 ? -1.0 : 1.0;
  }
  if (site.kind == SiteKind::segment) return cross(site.b - site.a, q - site.a) > 0.0 ? -1.0 : 1.0;
  const bool within = beyond_circle(site, q, q - site.center) < 0.0;
  return within == (site.sweep > 0) ? -1.0 : 1.0;
}

/// Outward unit normal at the core: from the nearest point to q when outside, the reverse inside. Where q
/// lies on the core: the site's own left/right normal (solid: outward), for a point site (1, 0).
Vec2 normal_at(const Site& site, const Nearest& nearest, const Vec2& q);

}  // namespace brink
