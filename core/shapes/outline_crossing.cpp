#include "brink/core/shapes/outline_crossing.h"

#include <algorithm>

#include "brink/core/base/limits.h"
#include "brink/core/shapes/distance.h"

namespace brink {

namespace {

struct Segment {
  Vec2 a, b;
};

/// How far the nearer end of the two reaches through the other, or 0 where they do not cross.
double reach_through(const Segment& s, const Segment& t, Vec2& point) {
  const Vec2 ds = s.b - s.a, dt = t.b - t.a;
  const double ls = ds.norm(), lt = dt.norm();
  // far from the origin two ends may be rounded to one place
  if (ls == 0.0 || lt == 0.0) return 0.0;
  // signed distances of t's ends from the line of s, and the reverse: the two
  // cross if both pairs have two signs. An end on the other's line is no
  // crossing; deepest_crossing() looks below edges for what that hides
  const double ta = cross(ds, t.a - s.a) / ls, tb = cross(ds, t.b - s.a) / ls;
  const double sa = cross(dt, s.a - t.a) / lt, sb = cross(dt, s.b - t.a) / lt;
  if (ta * tb >= 0.0 || sa * sb >= 0.0) return 0.0;
  point = s.a + ds * (sa / (sa - sb));
  return std::min({std::abs(ta), std::abs(tb), std::abs(sa), std::abs(sb)});
}

/// What holds an outline where it stands, its arcs as whole circles [m]; all of the plane, where it is solid outside.
Box box_of(const Outline& outline, const Frame& frame) {
  if (outline.container) return {Vec2::Constant(-kForever), Vec2::Constant(kForever)};
  Box box;
  for (const Site& site : outline.sites) {
    const bool arc = site.kind == SiteKind::arc;
    for (const Vec2& p : {arc ? site.center : site.a, arc ? site.center : site.b})
      box.add(Box{frame.to_world(p), frame.to_world(p)}.grown(arc ? site.arc_radius : 0.0));
  }
  return box;
}

/// The outline's straight sides that lead through the box, where it stands [m].
std::vector<Segment> segments(const Outline& outline, const Frame& frame, const Box& box) {
  std::vector<Segment> some;
  for (const Site& site : outline.sites) {
    if (site.kind != SiteKind::segment) continue;
    const Segment s{frame.to_world(site.a), frame.to_world(site.b)};
    if (Box{s.a.cwiseMin(s.b), s.a.cwiseMax(s.b)}.overlaps(box)) some.push_back(s);
  }
  return some;
}

/// This part of a solid's size is looked below its edges: more than the
/// roundings of a depth, by which neighbours whose edges coincide would be
/// in each other. An overlap along an edge is seen if it is thicker.
constexpr double kBelow = 1e-7;
/// A vertex that is further than this part of the size from all edges lies on none.
constexpr double kSeemsToTouch = 1e-6;

/// An outline where it stands.
struct PlacedSolid {
  PlacedSolid(const Outline& o, const Frame& f) : outline(o), frame(f) {}

  /// > 0: that deep inside [m].
  double depth_of(const Vec2& p) const { return -gap_by_brute_force(outline, frame.to_local(p)); }

  const Outline& outline;
  Frame frame;
};

/// A solid without thickness.
bool is_sharp_solid(const Outline& o) {
  return o.solid &&
         std::all_of(o.sites.begin(), o.sites.end(), [](const Site& s) { return s.radius == 0.0; });
}

/// Fractions of s at which others' ends lie on it, and its own ends, ascending. Where nothing crosses s,
/// what two solids share borders on all of it between two cuts, or on nothing of it: the middle tells.
std::vector<double> cuts(const Segment& s, const std::vector<Segment>& others, double tolerance) {
  const Vec2 d = s.b - s.a;
  const double length2 = d.squaredNorm();
  std::vector<double> at{0.0, 1.0};
  for (const Segment& t : others) {
    const double along = d.dot(t.a - s.a) / length2;
    if (along > 0.0 && along < 1.0 && (s.a + along * d - t.a).norm() <= tolerance) at.push_back(along);
  }
  std::sort(at.begin(), at.end());
  return at;
}

/// The deepest place in both, going in from p along n by twice as much each time.
OutlineCrossing look_below(const PlacedSolid& a, const PlacedSolid& b, const Vec2& p, const Vec2& n,
                           double below) {
  OutlineCrossing deepest;
  // doubling comes through the lesser of the two in some two dozen looks. In
  // convex shapes the depth along n is a concave function that starts at 0:
  // what is found, if anything, is at least half of its maximum
  for (;; below *= 2.0) {
    const Vec2 q = p + below * n;
    // below its own edge it is in a as a rule, so b is asked first
    const double in_b = b.depth_of(q);
    if (!(in_b > deepest.depth)) return deepest;
    const double depth = std::min(a.depth_of(q), in_b);
    if (!(depth > deepest.depth)) return deepest;
    deepest = {depth, q, -n};
  }
}

/// The deepest place in both that is found below these edges of a.
OutlineCrossing shared_below_edges(const PlacedSolid& a, const std::vector<Segment>& edges,
                                   const PlacedSolid& b, const std::vector<Segment>& of_b) {
  const double size = std::min(a.outline.bounding_radius, b.outline.bounding_radius);
  OutlineCrossing deepest;
  for (const Segment& s : edges) {
    // placed far from the origin, as in reach_through()
    if ((s.b - s.a).isZero(0.0)) continue;
    const std::vector<double> at = cuts(s, of_b, kBelow * size);
    for (std::size_t k = 1; k < at.size(); ++k) {
      const Vec2 middle = s.a + 0.5 * (at[k - 1] + at[k]) * (s.b - s.a);
      const OutlineCrossing c = look_below(a, b, middle, perp((s.b - s.a).normalized()), kBelow * size);
      if (c.depth > deepest.depth) deepest = c;
    }
  }
  return deepest;
}

/// In a's frame, where b stands at `frame`. All that two share, and all places where they cross, are in what holds both: of
/// most near pairs that is a few edges.
OutlineCrossing crossing_seen_from(const Outline& a, const Outline& b, const Frame& frame, double gap) {
  OutlineCrossing deepest;
  const double size = std::min(a.bounding_radius, b.bounding_radius), below = kBelow * size;
  const Box box_a = box_of(a, {}).grown(below), box_b = box_of(b, frame).grown(below);
  if (!box_a.overlaps(box_b)) return deepest;
  const Box shared{box_a.low.cwiseMax(box_b.low), box_a.high.cwiseMin(box_b.high)};
  const std::vector<Segment> of_a = segments(a, {}, shared), of_b = segments(b, frame, shared);
  for (const Segment& s : of_a)
    for (const Segment& t : of_b) {
      Vec2 point = Vec2::Zero();
      const double depth = reach_through(s, t, point);
      if (depth > deepest.depth) deepest = {depth, point, perp((t.b - t.a).normalized())};
    }
  // edges that coincide may cross by a rounding
  const bool is_clear = deepest.depth > below;
  // wires share no inside; of a thick outline, a vertex on an edge's core is a sample that tells
  if (is_clear || gap > kSeemsToTouch * size || !is_sharp_solid(a) || !is_sharp_solid(b)) return deepest;
  const PlacedSolid solid_a(a, {}), solid_b(b, frame);
  // from both: what they share may border on edges of one
  // alone, as where a diamond has its corners on a box
  const OutlineCrossing below_a = shared_below_edges(solid_a, of_a, solid_b, of_b);
  const OutlineCrossing below_b = shared_below_edges(solid_b, of_b, solid_a, of_a);
  for (const OutlineCrossing& c : {below_a, below_b})
    if (c.depth > deepest.depth) deepest = c;
  return deepest;
}

}  // namespace

OutlineCrossing deepest_crossing(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b,
                                 double gap) {
  const Frame of_a(pose_a);
  const Frame seen(Pose{of_a.to_local(pose_b.position), pose_b.angle - pose_a.angle});
  OutlineCrossing deepest = crossing_seen_from(a, b, seen, gap);
  deepest.point = of_a.to_world(deepest.point);
  deepest.normal = of_a.direction_to_world(deepest.normal);
  return deepest;
}

}  // namespace brink
