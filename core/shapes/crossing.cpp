#include "brink/core/shapes/crossing.h"

#include <algorithm>

#include "brink/core/base/error.h"
#include "brink/core/shapes/box_sweep.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

using Points = std::vector<Vec2>;

/// Parallel lines add nothing: where two segments overlap, an end of one lies on the other.
/// Of lines that are nearly parallel the point may be anywhere, or not finite: add_meeting_points() drops it then.
void add_line_line(const Site& s, const Site& t, Points& points) {
  const Vec2 d = s.b - s.a, e = t.b - t.a;
  const double turn = cross(d, e);
  if (turn != 0.0) points.push_back(s.a + d * (cross(t.a - s.a, e) / turn));
}

/// Points on the line through `foot` along unit `u`, at +- the half chord of a circle whose centre is
/// `offset` away. A near miss within the tolerance is tangent.
void add_chord(const Vec2& foot, const Vec2& u, double offset, double r, double tolerance, Points& points) {
  if (std::abs(offset) > r + tolerance) return;
  // as a product: near tangency r^2 - offset^2 would lose all digits; below 0 within the tolerance is 0
  const double half = std::sqrt(std::max(0.0, (r - offset) * (r + offset)));
  points.push_back(foot - half * u);
  if (half > 0.0) points.push_back(foot + half * u);
}

/// Where the line meets the circle: about the foot of the centre on the line.
void add_line_circle(const Site& line, const Site& arc, double tolerance, Points& points) {
  const Vec2 u = (line.b - line.a).normalized();
  const Vec2 foot = line.a + u * u.dot(arc.center - line.a);
  add_chord(foot, u, cross(u, arc.center - line.a), arc.arc_radius, tolerance, points);
}

/// Circles about one centre add nothing, for the same reason as parallel lines.
void add_circle_circle(const Site& s, const Site& t, double tolerance, Points& points) {
  const Vec2 w = t.center - s.center;
  const double d = w.norm(), r = s.arc_radius, q = t.arc_radius;
  if (d == 0.0 || d > r + q + tolerance || d < std::abs(r - q) - tolerance) return;
  // from r^2 - along^2 = q^2 - (d - along)^2; beyond r the two are tangent within the tolerance
  // the common chord stands across the line of centres, `along` from the first one
  const double along = (d + (r - q) * (r + q) / d) / 2;
  const Vec2 u = w / d;
  const double clamped = std::clamp(along, -r, r);
  add_chord(s.center + u * clamped, perp(u), clamped, r, tolerance, points);
}

/// Whether p, on both sites, is where `in` hands over to `out`. Arcs that join smoothly stay within any
/// tolerance of each other for a while, and cannot meet again as each turns by at most a quarter.
bool is_hand_over_of(const Site& in, const Site& out, const Vec2& p) {
  if (in.b != out.a) return false;
  // two sites that make a loop do meet again, at the other joint: they are held to the distance
  if (direction_at_end(in).dot(direction_at_start(out)) > 1 - 1e-6 && out.b != in.a) return true;
  // at a corner of angle x the two are within the tolerance of each other for tolerance / x: a thousandth
  // of the shorter one lets needles of 1e-9 rad pass, if their sides are as long as the outline
  return (p - in.b).norm() <= 1e-3 * std::min(length(in), length(out));
}

/// In either order: two sites that make a loop hand over twice.
bool is_hand_over(const Site& s, const Site& t, const Vec2& p) {
  return is_hand_over_of(s, t, p) || is_hand_over_of(t, s, p);
}

/// @throws BadInput, naming the lower site first.
[[noreturn]] void report(const std::string& what, int i, int j, const Vec2& p) {
  throw BadInput(what + ": sides " + std::to_string(std::min(i, j)) + " and " +
                 std::to_string(std::max(i, j)) + " (from 0) cross or touch at " + text(p) +
                 "; the outline must not meet itself");
}

}  // namespace

void add_meeting_points(const Site& s, const Site& t, double tolerance, Points& points) {
  Points candidates{s.a, s.b, t.a, t.b};
  const bool s_is_arc = s.kind == SiteKind::arc, t_is_arc = t.kind == SiteKind::arc;
  if (s_is_arc && t_is_arc)
    add_circle_circle(s, t, tolerance, candidates);
  else if (s_is_arc || t_is_arc)
    add_line_circle(s_is_arc ? t : s, s_is_arc ? s : t, tolerance, candidates);
  else
    add_line_line(s, t, candidates);
  // candidates are on the lines and circles; those count that are on both cores
  for (const Vec2& p : candidates)
    if (nearest_on(s, p).distance <= tolerance && nearest_on(t, p).distance <= tolerance) points.push_back(p);
}

void require_simple(const Outline& outline, const std::string& what) {
  // [m]; union_of_polygons() welds vertices at the same share of the extent
  const double tolerance = 1e-12 * outline.bounds.extent().norm();
  std::vector<Box> boxes;
  for (const Site& s : outline.sites) boxes.push_back(core_bounds(s).grown(tolerance));
  Points points;
  for_overlapping(boxes, [&](int i, int j) {
    const Site &s = outline.sites[i], &t = outline.sites[j];
    points.clear();
    add_meeting_points(s, t, tolerance, points);
    for (const Vec2& p : points)
      if (!is_hand_over(s, t, p)) report(what, i, j, p);
  });
}

}  // namespace brink
