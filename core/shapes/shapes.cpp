#include "brink/core/shapes/shapes.h"

#include <numbers>

#include "brink/core/base/error.h"
#include "brink/core/base/limits.h"
#include "brink/core/shapes/biarc.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/loops.h"
#include "brink/core/shapes/measure.h"
#include "brink/core/shapes/polygon.h"
#include "brink/core/shapes/polygon_union.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

constexpr double whole_turn = 2 * std::numbers::pi;
/// An arc's places may be rounded by this part of its radius: more would be another curve.
constexpr double kMostRounded = 1e-6;

/// A solid of straight sides, measured. Several loops are several parts, or holes.
/// @pre the loops have the solid on their left.
Shape solid_of(const std::vector<std::vector<Vec2>>& loops, double radius) {
  Outline outline;
  outline.solid = true;
  for (const auto& vertices : loops) add_loop(outline, segments_through(vertices, true, radius), true);
  return finish_shape(std::move(outline));
}

/// What has no inside: one chain or ring of sites, measured. `deviation` [m]: of a curve that was fitted.
/// Also of a single point site.
Shape wire_of(const std::vector<Site>& sites, bool closed, double deviation = 0.0) {
  Outline outline;
  outline.curve_deviation = deviation;
  add_loop(outline, sites, closed);
  return finish_shape(std::move(outline));
}

/// A union is at least as large as its largest part and at most as large as all of them.
/// @throws BadInput otherwise: pieces of the boundary were kept or dropped wrongly.
void require_plausible_area(double area, const std::vector<std::vector<Vec2>>& parts) {
  double largest = 0.0, sum = 0.0;
  for (const auto& part : parts) {
    largest = std::max(largest, signed_area(part));
    sum += signed_area(part);
  }
  // 1e-9: room for the weld, 1e-12 of the extent, and for roundings
  if (area < largest - 1e-9 * sum || area > sum * (1 + 1e-9))
    throw BadInput("polygons: the union came out with area " + text(area) + " m^2 where the parts have " +
                   text(sum) + "; move parts that nearly coincide apart or together");
}

}  // namespace

Shape make_point(const Vec2& p, double radius) {
  require_finite("point", p);
  require_radius(radius);
  return wire_of({point_site(p, radius)}, false);
}

Shape make_disc(double radius) {
  require_positive("radius", radius);
  return make_point(Vec2::Zero(), radius);
}

Shape make_segment(const Vec2& a, const Vec2& b, double radius) {
  require_finite("segment", a);
  require_finite("segment", b);
  require_radius(radius);
  if (a == b)
    throw BadInput("segment: both ends are " + text(a) + "; they must differ (a point site has one place)");
  return wire_of({segment_site(a, b, radius)}, false);
}

Shape make_capsule(double length, double radius) {
  require_positive("length", length);
  require_positive("radius", radius);
  return make_segment({-length / 2, 0}, {length / 2, 0}, radius);
}

Shape make_box(double width, double height, double radius) {
  require_positive("width", width);
  require_positive("height", height);
  require_radius(radius);
  // counter-clockwise from the lower left corner
  const double x = width / 2, y = height / 2;
  return solid_of({{Vec2(-x, -y), Vec2(x, -y), Vec2(x, y), Vec2(-x, y)}}, radius);
}

Shape make_polygon(std::vector<Vec2> vertices, double radius) {
  require_radius(radius);
  return solid_of({checked_polygon(vertices, "polygon")}, radius);
}

Shape make_polygons(const std::vector<std::vector<Vec2>>& polygons) {
  if (polygons.empty()) throw BadInput("polygons: the list is empty; at least one polygon is needed");
  // each counter-clockwise, as the union wants them
  std::vector<std::vector<Vec2>> parts;
  for (std::size_t k = 0; k < polygons.size(); ++k)
    parts.push_back(checked_polygon(polygons[k], "polygons[" + std::to_string(k) + "]"));
  // alone it is simple already, and keeps vertices that are collinear
  if (parts.size() == 1) return solid_of(parts, 0.0);
  // the one check from outside: the union's area is told by its own sites, the bounds by the parts
  Shape shape = solid_of(union_of_polygons(parts), 0.0);
  require_plausible_area(shape.measure.size, parts);
  return shape;
}

Shape make_chain(const std::vector<Vec2>& vertices, bool closed, double radius) {
  for (std::size_t k = 0; k < vertices.size(); ++k)
    require_finite(("chain: vertex " + std::to_string(k)).c_str(), vertices[k]);
  require_radius(radius);
  const std::vector<Vec2> kept = without_repeats(vertices, closed);
  const std::size_t least = closed ? 3 : 2;
  if (kept.size() < least)
    throw BadInput("chain: has " + std::to_string(kept.size()) + " distinct vertices; a" +
                   (closed ? " closed" : "n open") + " chain needs at least " + std::to_string(least));
  return wire_of(segments_through(kept, closed, radius), closed);
}

Shape make_arc(const Vec2& center, double arc_radius, double from, double to, double radius) {
  require_finite("arc center", center);
  require_positive("arc radius", arc_radius);
  require_radius(radius);
  if (!std::isfinite(from) || !std::isfinite(to) || from == to)
    throw BadInput("arc: runs from " + text(from) + " to " + text(to) +
                   " rad; angles must be finite and differ");
  const double rounded = kEpsilon * (center.lpNorm<Eigen::Infinity>() + arc_radius);
  if (!(rounded <= kMostRounded * arc_radius))
    throw BadInput("arc: about " + text(center) + " its places are rounded by " + text(rounded) +
                   " m; allowed: a millionth of its radius, " + text(kMostRounded * arc_radius) +
                   " m (give it near the origin, and a position)");
  double sweep = to - from;
  // whole turns until it is past `from`; 0 then means that the two are whole turns apart
  if (sweep < 0.0) sweep += whole_turn * std::ceil(-sweep / whole_turn);
  // 1e-15: an angle that was given in degrees may be short of the whole turn by a rounding
  const bool whole = sweep == 0.0 || sweep >= whole_turn * (1 - 1e-15);
  if (whole) sweep = whole_turn;
  // on the axis itself where `from` is whole quarter turns
  const Vec2 a = center + arc_radius * unit_at(from);
  // a closed loop ends where it starts bit for bit
  const Vec2 b = whole ? a : Vec2(center + arc_radius * unit_at(from + sweep));
  std::vector<Site> sites;
  add_arc(sites, a, b, center, arc_radius, sweep, radius);
  return wire_of(sites, whole);
}

Shape make_bezier(const std::array<Vec2, 4>& control, double curve_tolerance, double radius) {
  for (const Vec2& p : control) require_finite("bezier", p);
  require_positive("curve_tolerance", curve_tolerance);
  require_radius(radius);
  const CubicBezier curve(control);
  if (!(curve.speed_bound() > 0.0))
    throw BadInput("bezier: all four control points are " + text(control[0]) + "; some must differ");
  std::vector<Site> sites;
  const double deviation = fit_arcs(curve, control[0], control[3], curve_tolerance, radius, sites);
  // fit_arcs() leaves out what is shorter than the tolerance and comes back to its start
  if (sites.empty())
    throw BadInput("bezier: the whole curve is shorter than curve_tolerance, " + text(curve_tolerance));
  return wire_of(sites, false, deviation);
}

Shape make_disc_container(double radius) {
  require_positive("radius", radius);
  Outline outline;
  outline.solid = true;
  std::vector<Site> sites;
  const Vec2 start(radius, 0);
  // counter-clockwise as a disc first; as_container() turns it round
  add_arc(sites, start, start, Vec2::Zero(), radius, whole_turn, 0.0);
  add_loop(outline, sites, true);
  return finish_shape(as_container(std::move(outline)));
}

Shape make_capsule_container(double length, double radius) {
  require_positive("length", length);
  require_positive("radius", radius);
  Outline outline;
  outline.solid = true;
  std::vector<Site> sites;
  const Vec2 right(length / 2, 0), left(-length / 2, 0), up(0, radius);
  // counter-clockwise, as the disc's is, from the lower left
  sites.push_back(segment_site(left - up, right - up, 0.0));
  add_arc(sites, right - up, right + up, right, radius, whole_turn / 2, 0.0);
  sites.push_back(segment_site(right + up, left + up, 0.0));
  add_arc(sites, left + up, left - up, left, radius, whole_turn / 2, 0.0);
  add_loop(outline, sites, true);
  return finish_shape(as_container(std::move(outline)));
}

Shape centered(Shape shape) {
  Pose shift;
  shift.position = -shape.measure.centroid;
  shape.outline = transformed(shape.outline, shift);
  // By definition: a sum over the moved sites would only come near it. The second moment is about the centroid,
  // and stays.
  shape.measure.centroid = Vec2::Zero();
  return shape;
}

}  // namespace brink
