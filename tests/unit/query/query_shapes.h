#pragma once
/// Shapes of every kind, where they stand, and distances to them that share no code with the queries.

#include <algorithm>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/core/shapes/shapes.h"
#include "tests/support/outside/gap.h"

namespace brink {

struct NamedOutline {
  std::string name;
  Outline outline;
};

/// Solids, containers, wires; sharp, rounded and thin; straight and curved.
inline std::vector<NamedOutline> query_outlines() {
  const std::vector<Vec2> notched{{0, 0}, {2, 0}, {2, 1.5}, {1.1, 0.3}, {0.9, 1.5}, {0, 1}};
  const char* const egg = "M 0 0 C 1 -1 2 -1 2 0 S 0.5 1.5 0 0 Z";
  const char* const washer =
      "M 1 0 A 1 1 0 1 1 -1 0 A 1 1 0 1 1 1 0 Z M 0.5 0 A 0.5 0.5 0 1 0 -0.5 0 A 0.5 0.5 0 1 0 0.5 0 Z";
  return {{"point", make_point({0.2, 0.1}).outline},
          {"disc", make_disc(0.7).outline},
          {"box", make_box(1.5, 0.6).outline},
          {"rounded box", make_box(1.0, 0.6, 0.2).outline},
          {"thin wall", make_box(2.0, 1e-9).outline},
          {"notched", make_polygon(notched).outline},
          {"capsule", make_capsule(1.2, 0.3).outline},
          {"chain", make_chain({{-1, 0}, {0, 0.5}, {0.4, -0.6}, {1, 0}}).outline},
          {"thick chain", make_chain({{-1, 0}, {0, 0.5}, {0.4, -0.6}, {1, 0}}, false, 0.15).outline},
          {"ring", make_chain({{-1, -1}, {1, -1}, {0, 1}}, true).outline},
          {"arc", make_arc({0.1, 0}, 0.8, 0.3, 4.0).outline},
          {"thick arc", make_arc({0.1, 0}, 0.8, 0.3, 4.0, 0.25).outline},
          {"very thick arc", make_arc({0.1, 0}, 0.3, 0.3, 1.8, 0.5).outline},
          {"flat arc", make_arc({0, -1e5}, 1e5, 1.57079, 1.57081).outline},
          {"curve", make_bezier({Vec2(-1, 0), Vec2(0, 2), Vec2(0, -2), Vec2(1, 0)}, 1e-3).outline},
          {"egg", make_path(egg, 1.0, 1e-3).outline},
          {"washer", make_path(washer, 1.0, 1e-3).outline},
          {"round room", make_disc_container(1.5).outline},
          {"room", as_container(make_box(3.0, 2.0).outline)},
          {"notched room", as_container(make_polygon(notched).outline)},
          {"lesser arc", make_arc({0, 0.1}, 0.55, 1.0, 5.0).outline}};
}

/// The outline itself is told to this [m]: the ends of its arcs lie a rounding of the radius off their circles.
inline double looseness(const Outline& outline) {
  double radius = 0.0;
  for (const Site& site : outline.sites) radius = std::max(radius, site.arc_radius);
  return 4e-16 * radius;
}

inline Vec2 anywhere(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

/// A shape placed in extended precision, thickness and all.
class OutsideView {
 public:
  OutsideView(const Outline& outline, const Pose& pose)
      : shape_(outside::shape_of(outline)),
        pieces_(outside::placed(shape_, pose.angle, outside::vec(pose.position))) {}

  /// To the surface from outside, or from the inside of a solid's core [m], >= 0; < 0 within the thickness.
  outside::Real to_pieces(const outside::Vec& p) const {
    outside::Real least = outside::kNever;
    for (const outside::Piece& piece : pieces_)
      least = std::min(least, outside::to_core(p, piece) - piece.thickness);
    return least;
  }
  /// In what the cores bound.
  bool within(const outside::Vec& p) const { return outside::in_solid(shape_, pieces_, p); }
  /// The nearest core's distance and thickness give the signed gap.
  outside::Real gap(const outside::Vec& p) const {
    if (!within(p)) return to_pieces(p);
    return -to_pieces(p) - 2 * pieces_[0].thickness;
  }

 private:
  outside::Shape shape_;
  outside::Pieces pieces_;
};

}  // namespace brink
