#pragma once
/// A shape as a run file tells it: pieces (points, segments, arcs) with a thickness, and which of them bound
/// an inside. Only the plain numbers are taken; everything about them is computed anew.

#include <algorithm>
#include <vector>

#include "brink/core/shapes/outline.h"
#include "tests/support/outside/plane.h"

namespace brink::outside {

struct Piece {
  enum class Kind { point, segment, arc };
  Kind kind = Kind::point;
  Vec a, b;            ///< ends
  Real thickness = 0;  ///< everything within it of the core belongs to the piece [m]
  Vec center, middle;  ///< arcs: of the circle; unit direction from there to the middle of the arc
  Real circle = 0;     ///< arcs: radius of the circle [m]
  Real half_chord =
      0;  ///< arcs: of the unit circle, from the middle to an end; of a flat arc exact, as its cosine is not
};

struct Shape {
  std::vector<Piece> pieces;
  bool solid = false;      ///< the pieces bound an inside (even-odd)
  bool container = false;  ///< solid outside of the pieces instead
  Real reach = 0;          ///< no point of a piece is further from the origin [m]
  Real width = 0;          ///< of its box at angle 0, the lesser side; containers: of the room in it [m]
  Real length = 0;         ///< the greater side [m]
};

inline Piece moved(const Piece& p, const Turn& turn, const Vec& by) {
  Piece q = p;
  q.a = turn(p.a) + by;
  q.b = turn(p.b) + by;
  q.center = turn(p.center) + by;
  q.middle = turn(p.middle);
  return q;
}

inline Vec vec(const Vec2& v) { return {v.x(), v.y()}; }

inline Piece piece_of(const Site& site) {
  Piece p;
  p.a = vec(site.a);
  p.b = vec(site.b);
  p.thickness = site.radius;
  if (site.kind == SiteKind::segment) p.kind = Piece::Kind::segment;
  if (site.kind != SiteKind::arc) return p;
  p.kind = Piece::Kind::arc;
  p.center = vec(site.center);
  p.circle = site.arc_radius;
  p.half_chord = 2 * std::sin(std::abs(Real(0.25) * site.sweep));
  const Vec from = p.a - p.center;
  p.middle = Turn(Real(0.5) * site.sweep)(from) * (1 / norm(from));
  return p;
}

inline Shape shape_of(const Outline& outline) {
  Shape s;
  s.solid = outline.solid && !outline.is_point();
  s.container = outline.container;
  Vec low{kNever, kNever}, high{-kNever, -kNever};
  const auto add = [&](const Vec& p, Real r) {
    s.reach = std::max(s.reach, norm(p) + r);
    low = {std::min(low.x, p.x - r), std::min(low.y, p.y - r)};
    high = {std::max(high.x, p.x + r), std::max(high.y, p.y + r)};
  };
  for (const Site& site : outline.sites) {
    const Piece p = piece_of(site);
    add(p.a, p.thickness);
    add(p.b, p.thickness);
    if (p.kind == Piece::Kind::arc) add(p.center + p.middle * p.circle, p.thickness);
    if (p.kind == Piece::Kind::arc) s.reach = std::max(s.reach, norm(p.center) + p.circle + p.thickness);
    s.pieces.push_back(p);
  }
  s.width = std::min(high.x - low.x, high.y - low.y);
  s.length = std::max(high.x - low.x, high.y - low.y);
  return s;
}

}  // namespace brink::outside
