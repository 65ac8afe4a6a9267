/// The gap of two outlines in three parts, each of which may lower what was found before:
///
///   samples    every vertex and arc of each against the sites of the other: exact where the two are apart, and
///              the depth of vertices that are inside
///   crossings  of sites, which bars of a plus sign have with no vertex inside
///   edges      outlines that touch to rounding may share an inside along edges that coincide, which neither shows
#include "brink/core/query/outline_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "brink/core/query/closest_point.h"
#include "brink/core/query/site_crossing.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/outline_crossing.h"

namespace brink {

namespace {

/// Of two outlines' sizes: what is farther off than another by that is so without roundings.
constexpr double kRounding = 1e-9;

/// One outline's samples against the other's sites, in a frame in which both stand near the origin.
struct Side {
  const Outline& samples_of;
  const Outline& sites_of;
  Frame samples_at, sites_at;
  bool samples_are_a;

  double rounding() const { return kRounding * (samples_of.bounding_radius + sites_of.bounding_radius); }
};

/// Keeps the least gap. `on_sites` and `out` are the sites' surface point and its normal.
void keep_least(const Side& side, int sample, int site, double gap, const Vec2& on_sites, const Vec2& out,
                OutlineGap& least) {
  if (!(gap < least.gap)) return;
  // OutlineGap's normal points from b into a: with b's samples on a's sites it is the reverse of `out`
  const Vec2 on_sample = on_sites + gap * out;
  least = side.samples_are_a ? OutlineGap{gap, on_sample, on_sites, out, sample, true, site}
                             : OutlineGap{gap, on_sites, on_sample, -out, sample, false, site};
}

/// Lower bounds of gaps, by what is known of other places: a place outside of an outline is not nearer to it than its box, nor than
/// another place by more than the way from there. So most samples need no look at all sites, once one is near.
class Outside {
 public:
  explicit Outside(const Side& side) : side_(side) {}

  /// True of a place p whose gap from the sites, less `radius`, is above 0 and what is the least so far.
  bool is_above(const OutlineGap& least, const Vec2& p, double radius) const {
    const double above = std::max(0.0, least.gap) + radius + side_.rounding();
    return gap_ - (p - place_).norm() > above || beyond_box(p) > above;
  }
  void note(const Vec2& p, double gap) { place_ = p, gap_ = gap; }

 private:
  double beyond_box(const Vec2& p) const {
    if (side_.sites_of.container) return 0.0;
    const Vec2 q = side_.sites_at.to_local(p);
    const Box& box = side_.sites_of.bounds;
    return (box.low - q).cwiseMax(q - box.high).cwiseMax(0.0).norm();
  }

  const Side& side_;
  Vec2 place_ = Vec2::Zero();
  double gap_ = -std::numeric_limits<double>::infinity();  ///< of the last place that was looked at [m]
};

/// A vertex counts in all directions: against the other's closest point, thickness taken off.
void look_at_vertex(const Side& side, int i, Outside& outside, OutlineGap& least) {
  const Sample& sample = side.samples_of.samples[static_cast<std::size_t>(i)];
  const Vec2 p = side.samples_at.to_world(sample.p);
  if (outside.is_above(least, p, sample.radius)) return;
  const SurfacePoint on = closest_point_at(side.sites_at, side.sites_of, p);
  outside.note(p, on.gap);
  keep_least(side, i, on.site, on.gap - sample.radius, on.point, on.normal, least);
}

/// What is no farther out than this part of the outline's size is upon it, but for roundings.
constexpr double kUpon = 1e-14;

/// Of an arc's radius: what a distance from its centre is told to.
constexpr double kRoundings = 4.0 * std::numeric_limits<double>::epsilon();

/// True of an arc that a solid bulges out in: it lies to the left, so the arc turns to the left.
bool bulges(const Site& arc) { return arc.solid && arc.sweep > 0.0; }

/// True of a place of the sites' outline that is in the solid of the samples as deep as an arc of it says, or upon it.
bool is_inside(const Side& side, const Vec2& place, double gap) {
  const double depth = closest_point_at(side.samples_at, side.samples_of, side.sites_at.to_world(place)).gap;
  return depth <= 0.5 * gap + kUpon * side.samples_of.bounding_radius;
}

/// An arc counts for the nearest point of every site that its sector sees beyond its circle.
void look_at_arc(const Side& side, int i, OutlineGap& least) {
  const Sample& sample = side.samples_of.samples[static_cast<std::size_t>(i)];
  const Site& arc = side.samples_of.sites[static_cast<std::size_t>(sample.arc_site)];
  const Frame &from = side.samples_at, &to = side.sites_at;
  const Vec2 center = to.to_local(from.to_world(sample.p));
  for (std::size_t k = 0; k < side.sites_of.sites.size(); ++k) {
    const Site& site = side.sites_of.sites[k];
    const Nearest nearest = nearest_on(site, center);
    // nearer the centre it is on the arc's concave side, where samples of the site's outline come nearest, or in a solid that
    // bulges there; upon the arc it is on neither side
    const bool nearer = nearest.distance < arc.arc_radius * (1.0 - kRoundings);
    if (nearer && !bulges(arc)) continue;
    const Vec2 toward = (center - nearest.point) / nearest.distance;
    if (!in_sector(arc, from.direction_to_local(to.direction_to_world(-toward)))) continue;
    const double gap = nearest.distance - site.radius - sample.radius;
    if (nearer && !(nearest.distance > 0.0 && is_inside(side, nearest.point, gap))) continue;
    keep_least(side, i, static_cast<int>(k), gap, to.to_world(nearest.point + site.radius * toward),
               to.direction_to_world(toward), least);
  }
}

/// Every sample of the one side; cost: samples times sites at most.
void look_at_samples(const Side& side, OutlineGap& least) {
  Outside outside(side);
  for (int i = 0; i < static_cast<int>(side.samples_of.samples.size()); ++i)
    if (side.samples_of.samples[static_cast<std::size_t>(i)].arc_site < 0)
      look_at_vertex(side, i, outside, least);
    else
      look_at_arc(side, i, least);
}

/// `depth` is that of the cores; thickness adds to it. The two surface points lie on either side of the
/// crossing, so that point_a = point_b + gap * normal as it is for samples.
void keep_crossing(double depth, const Vec2& point, const Vec2& normal, double thickness, OutlineGap& least) {
  const double gap = -depth - thickness;
  if (!(gap < least.gap)) return;
  least = {gap, point + 0.5 * gap * normal, point - 0.5 * gap * normal, normal};
}

/// The site placed in a's frame; pseudo-normals are not turned, as crossings do not ask for them.
Site moved(Site site, const Frame& frame) {
  site.a = frame.to_world(site.a);
  site.b = frame.to_world(site.b);
  site.center = frame.to_world(site.center);
  return site;
}

/// What holds the core, with a little room; an arc's circle as a whole.
Box around(const Site& site, double room) {
  Box box;
  if (site.kind == SiteKind::arc) {
    box.add(site.center);
    return box.grown(site.arc_radius + room);
  }
  box.add(site.a);
  box.add(site.b);
  return box.grown(room);
}

/// `b` stands at `frame`, seen from a. Sites cross only where their boxes meet.
void look_at_crossings(const Outline& a, const Outline& b, const Frame& frame, OutlineGap& least) {
  const double room = kRounding * (a.bounding_radius + b.bounding_radius);
  const Box all = a.bounds.grown(room);
  std::vector<Box> boxes;  // of a's
  for (const Site& placed : b.sites) {
    if (placed.kind == SiteKind::point) continue;
    const Site t = moved(placed, frame);
    const Box box = around(t, room);
    if (!box.overlaps(all)) continue;
    if (boxes.empty())
      for (const Site& s : a.sites) boxes.push_back(around(s, 0.0));
    for (std::size_t k = 0; k < a.sites.size(); ++k) {
      const Site& s = a.sites[k];
      if (s.kind == SiteKind::point || !box.overlaps(boxes[k])) continue;
      const SiteCrossing c = site_crossing(s, t);
      if (c.depth >= 0.0) keep_crossing(c.depth, c.point, c.normal, s.radius + t.radius, least);
    }
  }
}

/// Of the lesser outline's size: two that are further apart, or deeper in each other, have told so by a sample
/// or a crossing. Those between may share an inside along edges that coincide.
constexpr double kSeemsToTouch = 1e-6;

/// Asked near a gap of 0 alone, since deepest_crossing() looks at all pairs of segments.
void look_below_common_edges(const Outline& a, const Outline& b, const Pose& pose, OutlineGap& least) {
  if (std::abs(least.gap) > kSeemsToTouch * std::min(a.bounding_radius, b.bounding_radius)) return;
  // in a's frame, as all answers before to_world()
  const OutlineCrossing shared = deepest_crossing(a, Pose(), b, pose);
  if (shared.depth > 0.0) keep_crossing(shared.depth, shared.point, shared.normal, 0.0, least);
}

OutlineGap to_world(OutlineGap gap, const Frame& frame) {
  gap.point_a = frame.to_world(gap.point_a);
  gap.point_b = frame.to_world(gap.point_b);
  gap.normal = frame.direction_to_world(gap.normal);
  return gap;
}

/// Every sample of `a` is farther from `b` than its own radius.
bool samples_clear(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b,
                   double margin) {
  const Frame from(pose_a), to(pose_b);
  return std::all_of(a.samples.begin(), a.samples.end(), [&](const Sample& sample) {
    return gap_by_brute_force(b, to.to_local(from.to_world(sample.p))) > sample.radius + margin;
  });
}

}  // namespace

OutlineGap outline_gap(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b) {
  // seen from a: far away, nothing of what is between them is lost
  const Pose from_a{Frame(pose_a).to_local(pose_b.position), pose_b.angle - pose_a.angle};
  OutlineGap least;
  least.gap = std::numeric_limits<double>::infinity();
  // samples first: where a crossing or a common edge is no deeper, the features are a sample's
  const Frame of_a{Pose()}, of_b(from_a);
  look_at_samples({a, b, of_a, of_b, true}, least);
  look_at_samples({b, a, of_b, of_a, false}, least);
  look_at_crossings(a, b, of_b, least);
  look_below_common_edges(a, b, from_a, least);
  return to_world(least, Frame(pose_a));
}

bool surely_apart(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b, double margin) {
  // Clear samples say nothing of segments that cross with no vertex inside.
  return samples_clear(a, pose_a, b, pose_b, margin) && samples_clear(b, pose_b, a, pose_a, margin) &&
         deepest_crossing(a, pose_a, b, pose_b).depth == 0.0;
}

}  // namespace brink
