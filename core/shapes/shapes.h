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

/// One point site with a radius.
Shape make_disc(double radius);
/// Width along x, height along y; `radius` rounds outward (Minkowski sum with a disc).
Shape make_box(double width, double height, double radius = 0.0);
/// A simple polygon, any orientation (clockwise is turned round), need not be convex. Exact repeats of a
/// vertex by the next are merged silently; sides that cross or touch, no area, or NaN are refused. `radius`
/// rounds outward; the measure is that of the Minkowski sum, exact for reflex corners and filled notches too.
Shape make_polygon(std::vector<Vec2> vertices, double radius = 0.0);
/// The union of simple polygons: shared and overlapping edges vanish, vertices given keep their bits; parts
/// may be apart, and the union may have holes. Vertices and edges within 1e-12 of the extent of each other
/// are one.
Shape make_polygons(const std::vector<std::vector<Vec2>>& polygons);
/// A segment of the given length along x, centred, with a radius: length + 2 radius from end to end.
Shape make_capsule(double length, double radius);
/// A wire through the vertices; closed means a ring, hollow: not solid. It may cross itself. Without a radius
/// its measure is by length; with one, by the area within `radius` of it, overlaps counted once (cost: pairs
/// of sites).
Shape make_chain(const std::vector<Vec2>& vertices, bool closed = false, double radius = 0.0);
/// SVG path data (M L H V C S Q T A Z, absolute and relative), y downward as in SVG turned upward, times
/// `scale`. Subpaths are all closed (by Z, or by ending where they began): solid (even-odd), and they must
/// not cross or touch; or all open: wires. Circular arcs stay exact; other curves become arcs within
/// `curve_tolerance` [m] (biarcs), at least 1e-10 of their size.
/// @throws BadInput naming the character at which the data is wrong, or the subpaths of which one is closed and one open.
Shape make_path(std::string_view d, double scale, double curve_tolerance);

Shape make_point(const Vec2& p, double radius = 0.0);
Shape make_segment(const Vec2& a, const Vec2& b, double radius = 0.0);
/// From angle `from` counter-clockwise to `to` [rad]; to < from goes on past the full turn to it; a span of 2
/// pi or more is the whole circle. Not solid: felt from both sides.
Shape make_arc(const Vec2& center, double arc_radius, double from, double to, double radius = 0.0);
/// A cubic Bezier curve as arcs within `curve_tolerance` [m], at least 1e-10 of its size. Not solid.
Shape make_bezier(const std::array<Vec2, 4>& control, double curve_tolerance, double radius = 0.0);

/// The circle as a container: free inside, solid outside; four clockwise quarter arcs. Measure: of the free
/// disc.
Shape make_disc_container(double radius);
/// The capsule as a container: two straight sides and four quarter arcs. Measure: of the free inside.
Shape make_capsule_container(double length, double radius);

/// The shape shifted so that its centroid is the origin; its measure with it.
Shape centered(Shape shape);

}  // namespace brink
