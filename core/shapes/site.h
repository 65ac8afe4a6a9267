#pragma once
/// A Voronoi site: point, segment or circular arc, with a radius (thickness) >= 0.

#include <cstdint>

#include "brink/core/base/geometry.h"

namespace brink {

enum class SiteKind : std::uint8_t { point, segment, arc };

/// One site of an outline, in the outline's frame [m].
///
/// A site runs from `a` to `b` (a point: a == b). On a solid loop the solid lies to the LEFT of that
/// direction, so the outer loop runs counter-clockwise and holes clockwise. An arc lies on the circle about
/// `center` and turns by `sweep` (> 0 counter-clockwise), at most a quarter turn: longer arcs are split when
/// an outline is built.
struct Site {
  SiteKind kind = SiteKind::point;
  bool solid = false;          ///< part of a closed loop with an inside: distance is signed
  double radius = 0.0;         ///< thickness [m]: the site is everything within `radius` of its core
  Vec2 a = Vec2::Zero();       ///< start
  Vec2 b = Vec2::Zero();       ///< end
  Vec2 center = Vec2::Zero();  ///< arcs: centre of the circle; else unused
  double arc_radius = 0.0;     ///< arcs: radius of the circle [m]
  double sweep = 0.0;          ///< arcs: signed angle from a to b [rad], 0 < |sweep| <= pi/2
  Vec2 pseudo_a =
      Vec2::Zero();  ///< solid sites: sum of the outward unit normals of the two sites that meet at a
  Vec2 pseudo_b = Vec2::Zero();  ///< the same at b (sign of the distance where the nearest point is a vertex)
  /// Segments: another one goes on straight from that end, so that nothing ends there that could be run against.
  bool straight_a = false, straight_b = false;
  bool covered = false;  ///< a solid's side that others lie against all along: nothing comes to it
};

}  // namespace brink
