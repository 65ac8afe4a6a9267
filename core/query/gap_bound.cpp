#include "brink/core/query/gap_bound.h"

#include <algorithm>
#include <array>
#include <limits>

#include "brink/core/base/limits.h"

namespace brink {

namespace {

/// Outlines of more sites are not looked at from the other's centre: an exact look by a site index costs less.
constexpr std::size_t kMostSites = 64;
/// Lines that are tried: two polygons are parted by the third as a rule, if any line parts them.
constexpr int kMostLines = 8;
/// Hulls of more corners are not held against each other, side by side.
constexpr std::size_t kMostCorners = 16;
/// Of the distance of two hulls: a line that can be better by no more than this is the last.
constexpr double kGoodLine = 0.05;

struct Standing {
  Standing(const Outline& o, const Pose& pose, const Vec2& base)
      : outline(o), frame(Pose{pose.position - base, pose.angle}) {}
  const Outline& outline;
  Frame frame;
};

/// How far b's origin is from a's sites, less the disc that holds b.
double seen_from_centre(const Standing& a, const Standing& b) {
  if (b.outline.container || a.outline.sites.size() > kMostSites) return -kForever;
  return gap_by_brute_force(a.outline, a.frame.to_local(b.frame.origin)) - b.outline.bounding_radius;
}

/// The outline's place that is furthest along u, in the frame in which it was placed.
Vec2 support(const Standing& placed, const Vec2& u) {
  const Vec2 local = placed.frame.direction_to_local(u);
  const Sample* furthest = &placed.outline.samples.front();  // also where no number is one
  double most = -kForever;
  for (const Sample& s : placed.outline.samples)
    if (const double along = s.p.dot(local) + s.radius; along > most) {
      most = along;
      furthest = &s;
    }
  return placed.frame.to_world(furthest->p) + furthest->radius * u;
}

/// The place of the way from p to q that is nearest to the origin.
Vec2 nearest_to_origin(const Vec2& p, const Vec2& q) {
  const Vec2 way = q - p;
  const double length2 = way.squaredNorm();
  return length2 > 0.0 ? Vec2(p + std::clamp(-p.dot(way) / length2, 0.0, 1.0) * way) : p;
}

/// By Gilbert's method on the difference of the two: x is a place of its hull, and comes nearer to the origin.
double parted_by_lines(const Standing& a, const Standing& b, double enough) {
  const auto middle = [](const Standing& p) { return p.frame.to_world(p.outline.bounds.center()); };
  Vec2 x = middle(b) - middle(a);
  double best = -kForever;
  for (int k = 0; k < kMostLines; ++k) {
    const double distance = x.norm();
    if (!(distance > 0.0)) return best;  // the hulls overlap
    const Vec2 u = x / distance;
    const Vec2 lowest = support(b, -u) - support(a, u);
    best = std::max(best, lowest.dot(u));
    if (best > enough || (k > 0 && distance - best <= kGoodLine * distance)) return best;
    // the first x is any place, not one of the hull
    x = k == 0 ? lowest : nearest_to_origin(x, lowest);
    // nor can any line be better than the hulls' own distance
    if (x.norm() <= enough) return best;
  }
  return best;
}

/// How far the corners of s's hull are beyond that side of t's hull from which they are farthest.
double beyond_a_side(const Standing& s, const Standing& t) {
  const Hull &corners = s.outline.hull, &sides = t.outline.hull;
  std::array<Vec2, kMostCorners> seen;
  const std::size_t n = corners.corners.size();
  for (std::size_t i = 0; i < n; ++i) seen[i] = t.frame.to_local(s.frame.to_world(corners.corners[i]));
  double best = -kForever;
  for (std::size_t k = 0; k < sides.normals.size(); ++k) {
    double nearest = kForever;
    for (std::size_t i = 0; i < n; ++i)
      nearest = std::min(nearest, sides.normals[k].dot(seen[i] - sides.corners[k]));
    best = std::max(best, nearest);
  }
  return best - corners.thickness - sides.thickness;
}

/// Of what touches along a side this is the gap, to rounding.
double parted_by_sides(const Standing& a, const Standing& b) {
  const auto suits = [](const Outline& o) {
    return !o.hull.corners.empty() && o.hull.corners.size() <= kMostCorners;
  };
  if (!suits(a.outline) || !suits(b.outline)) return -kForever;
  return std::max(beyond_a_side(a, b), beyond_a_side(b, a));
}

}  // namespace

double gap_at_least(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b,
                    double enough) {
  const bool held_by_discs = !a.container && !b.container;
  double least = held_by_discs
                     ? (pose_b.position - pose_a.position).norm() - a.bounding_radius - b.bounding_radius
                     : -kForever;
  // two discs are as far apart as those that hold them
  if (least > enough || (is_centred_disc(a) && is_centred_disc(b))) return least;
  const Standing placed_a(a, pose_a, pose_a.position), placed_b(b, pose_b, pose_a.position);
  for (const auto& [other, one] : {std::pair(&placed_a, &placed_b), std::pair(&placed_b, &placed_a)}) {
    least = std::max(least, seen_from_centre(*other, *one));
    if (least > enough || (is_centred_disc(one->outline) && least > -kForever)) return least;
  }
  if (!held_by_discs) return least;
  least = std::max(least, parted_by_lines(placed_a, placed_b, enough));
  return least > enough ? least : std::max(least, parted_by_sides(placed_a, placed_b));
}

}  // namespace brink
