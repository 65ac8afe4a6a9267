#pragma once
/// Every shape that a scene can name, as an outline with its measure. One function a shape; all throw
/// BadInput naming the parameter, its value and what is allowed.

#include <array>
#include <string_view>
#include <vector>

#include "brink/core/shapes/outline.h"

namespace brink {

/// Area (or length, for wires without thickness), centroid and second moment at unit density, by Green's
/// theorem on segments and arcs.
struct Measure {
  double size = 0.0;             ///< area [m^2]; a wire without thickness: length [m]
  Vec2 centroid = Vec2::Zero();  ///< in the shape's frame [m]
  double second_moment = 0.0;    ///< about the centroid, at unit density [m^4]; wires: [m^3]
};

/// An outline in the frame in which its coordinates were given, and its measure there.
struct Shape {
  Outline outline;
  Measure measure;
};

Shape make_disc(double radius);
/// Width along x, height along y; `radius` rounds outward (Minkowski sum with a disc).
Shape make_box(double width, double height, double radius = 0.0);
/// A simple polygon, any orientation, need not be convex.
Shape make_polygon(std::vector<Vec2> vertices, double radius = 0.0);
/// The union of simple polygons: shared and overlapping edges vanish (parts may also be apart).
Shape make_polygons(const std::vector<std::vector<Vec2>>& polygons);
/// A segment of the given length along x, centred, with a radius.
Shape make_capsule(double length, double radius);
/// A wire through the vertices; closed means a ring, hollow: not solid.
Shape make_chain(const std::vector<Vec2>& vertices, bool closed = false, double radius = 0.0);
/// SVG path data (M L H V C S Q T A Z, absolute and relative), y downward as in SVG turned upward, times
/// `scale`. All subpaths closed: solid (even-odd); else wires. Curves become arcs within `curve_tolerance`
/// [m] (biarcs).
Shape make_path(std::string_view d, double scale, double curve_tolerance);

Shape make_point(const Vec2& p, double radius = 0.0);
Shape make_segment(const Vec2& a, const Vec2& b, double radius = 0.0);
/// From angle `from` counter-clockwise to `to` [rad]; a span of 2 pi or more is the whole circle. Not solid.
Shape make_arc(const Vec2& center, double arc_radius, double from, double to, double radius = 0.0);
/// A cubic Bezier curve as arcs within `curve_tolerance` [m].
Shape make_bezier(const std::array<Vec2, 4>& control, double curve_tolerance, double radius = 0.0);

/// The circle as a container: free inside, solid outside.
Shape make_disc_container(double radius);

/// The shape shifted so that its centroid is the origin; its measure with it.
Shape centered(Shape shape);

}  // namespace brink
