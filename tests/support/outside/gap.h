#pragma once
/// The signed gap of two placed shapes: > 0 how far they are apart, < 0 how deep they are in each other, by
/// the plainest way there is: all pairs of pieces, and every corner against every inside.

#include "tests/support/outside/shape.h"

namespace brink::outside {

inline bool in_sector(const Piece& arc, const Vec& d) {
  const Real length = norm(d);
  return norm(d - arc.middle * length) <= length * arc.half_chord;
}

inline Real to_segment(const Vec& p, const Vec& a, const Vec& b) {
  const Vec d = b - a;
  const Real along = dot(p - a, d), square = dot(d, d);
  if (along <= 0) return norm(p - a);
  if (along >= square) return norm(p - b);
  return std::abs(wedge(d, p - a)) / std::sqrt(square);
}

/// Distance of a point to a piece's core.
inline Real to_core(const Vec& p, const Piece& c) {
  if (c.kind == Piece::Kind::point) return norm(p - c.a);
  if (c.kind == Piece::Kind::segment) return to_segment(p, c.a, c.b);
  const Vec w = p - c.center;
  if (in_sector(c, w)) return std::abs(norm(w) - c.circle);
  return std::min(norm(p - c.a), norm(p - c.b));
}

/// Least distance of the ends of either to the other.
inline Real of_ends(const Piece& s, const Piece& t) {
  return std::min({to_core(s.a, t), to_core(s.b, t), to_core(t.a, s), to_core(t.b, s)});
}

/// Two segments: a crossing is as deep as the end that has the shortest way back, straight over the other's
/// line (two flush edges that cross by 1e-13 at their ends have 1e-13 to go, not the way along them).
inline Real segment_to_segment(const Piece& s, const Piece& t) {
  const Vec d = s.b - s.a, e = t.b - t.a;
  const bool t_parted = (wedge(d, t.a - s.a) < 0) != (wedge(d, t.b - s.a) < 0);
  const bool s_parted = (wedge(e, s.a - t.a) < 0) != (wedge(e, s.b - t.a) < 0);
  if (!t_parted || !s_parted) return of_ends(s, t);
  const Real over_s = std::min(std::abs(wedge(d, t.a - s.a)), std::abs(wedge(d, t.b - s.a))) / norm(d);
  const Real over_t = std::min(std::abs(wedge(e, s.a - t.a)), std::abs(wedge(e, s.b - t.a))) / norm(e);
  return -std::min(over_s, over_t);
}

/// A segment and an arc: where they cross, the way out is over an end, or back over the arc's bulge.
inline Real segment_to_arc(const Piece& s, const Piece& arc) {
  const Real ends = of_ends(s, arc);
  const Vec d = s.b - s.a;
  const Real length = norm(d);
  const Vec u = d * (1 / length);
  const Real along = dot(arc.center - s.a, u);
  const Vec off = s.a + u * along - arc.center;
  const Real distance = norm(off);
  if (distance < arc.circle) {
    const Real half_chord = std::sqrt((arc.circle - distance) * (arc.circle + distance));
    for (const Real x : {along - half_chord, along + half_chord})
      if (x >= 0 && x <= length && in_sector(arc, off + u * (x - along)))
        return -std::min(ends, arc.circle - distance);
  }
  const bool abreast = along >= 0 && along <= length && distance > 0 && in_sector(arc, off);
  return abreast ? std::min(ends, std::abs(distance - arc.circle)) : ends;
}

inline Real arc_to_arc(const Piece& s, const Piece& t) {
  Real best = of_ends(s, t);
  const Vec d = t.center - s.center;
  const Real distance = norm(d);
  if (distance == 0) return best;
  const Vec u = d * (1 / distance);
  const Real x = (distance + (s.circle - t.circle) * (s.circle + t.circle) / distance) / 2;
  if (std::abs(x) < s.circle) {
    const Real y = std::sqrt((s.circle - x) * (s.circle + x));
    const Real lens = std::min(s.circle + t.circle - distance, distance - std::abs(s.circle - t.circle));
    for (const Real side : {-y, y}) {
      const Vec p = u * x + left_of(u) * side;
      if (in_sector(s, p) && in_sector(t, p - d)) return -std::min(best, lens);
    }
  }
  for (const Real on_s : {Real(-1), Real(1)})
    for (const Real on_t : {Real(-1), Real(1)})
      if (in_sector(s, u * on_s) && in_sector(t, u * on_t))
        best = std::min(best, std::abs(distance + on_t * t.circle - on_s * s.circle));
  return best;
}

/// Gap of two pieces, thickness and all.
inline Real gap(const Piece& s, const Piece& t) {
  using Kind = Piece::Kind;
  Real cores = 0;
  if (s.kind == Kind::point || t.kind == Kind::point)
    cores = s.kind == Kind::point ? to_core(s.a, t) : to_core(t.a, s);
  else if (s.kind == Kind::segment)
    cores = t.kind == Kind::segment ? segment_to_segment(s, t) : segment_to_arc(s, t);
  else
    cores = t.kind == Kind::segment ? segment_to_arc(t, s) : arc_to_arc(s, t);
  return cores - s.thickness - t.thickness;
}

using Pieces = std::vector<Piece>;

inline Pieces placed(const Shape& shape, Real angle, const Vec& at) {
  const Turn turn(angle);
  Pieces pieces;
  pieces.reserve(shape.pieces.size());
  for (const Piece& p : shape.pieces) pieces.push_back(moved(p, turn, at));
  return pieces;
}

/// Even-odd: the polygon of the chords, and the slices between chords and arcs.
inline bool within_loops(const Pieces& pieces, const Vec& p) {
  bool inside = false;
  for (const Piece& c : pieces) {
    if ((c.a.y > p.y) != (c.b.y > p.y)) {
      const Real side = wedge(c.b - c.a, p - c.a);
      if ((c.b.y > c.a.y) == (side > 0)) inside = !inside;
    }
    if (c.kind != Piece::Kind::arc || norm(p - c.center) >= c.circle) continue;
    const Real of_middle = wedge(c.b - c.a, c.center + c.middle * c.circle - c.a);
    if ((wedge(c.b - c.a, p - c.a) > 0) == (of_middle > 0)) inside = !inside;
  }
  return inside;
}

/// True if p lies in what the pieces bound.
inline bool in_solid(const Shape& shape, const Pieces& pieces, const Vec& p) {
  return shape.solid && within_loops(pieces, p) != shape.container;
}

/// How deep the corners of `others` are in the solid: <= 0, 0 if nowhere.
inline Real corners_in(const Shape& shape, const Pieces& pieces, const Pieces& others) {
  if (!shape.solid) return 0;
  Real deepest = 0;
  for (const Piece& o : others)
    for (const Vec& p : {o.a, o.b}) {
      if (!in_solid(shape, pieces, p)) continue;
      Real back = kNever;
      for (const Piece& c : pieces) back = std::min(back, to_core(p, c) + c.thickness);
      deepest = std::min(deepest, -back - o.thickness);
    }
  return deepest;
}

/// Signed gap of two shapes. `a` stands at `offset` from b's origin: only what lies between them matters.
inline Real gap(const Shape& a, Real angle_a, const Vec& offset, const Shape& b, Real angle_b) {
  const Pieces of_a = placed(a, angle_a, offset), of_b = placed(b, angle_b, {});
  Real least = kNever;
  for (const Piece& s : of_a)
    for (const Piece& t : of_b) least = std::min(least, gap(s, t));
  const Real deep = std::min(corners_in(a, of_a, of_b), corners_in(b, of_b, of_a));
  return deep < 0 ? std::min(least, deep) : least;
}
inline Real gap(const Shape& a, const Place& pa, const Shape& b, const Place& pb) {
  return gap(a, pa.angle, pa.at - pb.at, b, pb.angle);
}

/// A quick lower bound of |gap| where the boundaries are apart: the nearest piece of `a` to b's disc about
/// its origin. Says nothing about insides.
inline Real boundaries_apart(const Shape& a, Real angle_a, const Vec& offset, Real reach_b) {
  const Turn back(-angle_a);
  const Vec p = back(-offset);  // b's origin in a's frame
  Real least = kNever;
  for (const Piece& s : a.pieces) least = std::min(least, to_core(p, s) - s.thickness);
  return least - reach_b;
}

}  // namespace brink::outside
