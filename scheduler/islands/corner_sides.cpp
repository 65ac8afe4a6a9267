#include "brink/scheduler/islands/corner_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/core/shapes/distance.h"
#include "brink/scheduler/islands/tolerances.h"
#include "brink/scheduler/resolve/wedge.h"

namespace brink::islands {

namespace {

/// True if the two segments have a point in common that is inside both.
bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 && cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

double distance_to(const Site& segment, const Vec2& q) { return nearest_on(segment, q).distance; }

double distance_to_line(const Site& segment, const Vec2& q) {
  const Vec2 along = segment.b - segment.a;
  return std::abs(cross(along, Vec2(q - segment.a))) / along.norm();
}

}  // namespace

double before_next_side(const Half& half, const Sample& sample, const Site& site, const Vec2& q,
                        double upon) {
  const Vec2& end = nearer_end(site, q);
  double before = -std::numeric_limits<double>::infinity();
  for (const Site& next : half.other.sites) {
    if (&next == &site || next.kind != SiteKind::segment || (next.a != end && next.b != end)) continue;
    const Vec2 on = next.a == end ? Vec2(next.b - next.a) : Vec2(next.a - next.b), out = outward(next);
    if (outward(site).dot(on) >= 0.0) continue;
    const double height = out.dot(q - end);
    const Wedge corner = std::abs(height) > upon || sample.radius > 0.0 ? Wedge() : wedge_of(half, sample);
    if (corner.edges.empty()) {
      before = std::max(before, height);
    } else {
      if (std::all_of(corner.edges.begin(), corner.edges.end(),
                      [&](const Vec2& e) { return out.dot(e) > -kAlongLine; }))
        before = std::max({before, height, 0.0});
    }
  }
  return before;
}

bool goes_over(const Half& half, const Sample& sample, const Site& site, const Nearest& nearest,
               const Vec2& q, double upon) {
  if (!site.solid || site.kind != SiteKind::segment || !half.carrier.solid || nearest.foot != Foot::interior)
    return false;
  const Vec2& end = nearer_end(site, q);
  return sample.radius + site.radius == 0.0 && (nearest.point - end).norm() <= upon &&
         before_next_side(half, sample, site, q, upon) >= 0.0;
}

OnCorner on_corner(const Half& half, const Sample& sample, std::size_t j, const Vec2& q, double tie) {
  const Outline& outline = half.other;
  const Site& site = outline.sites[j];
  if (!site.solid || site.kind != SiteKind::segment) return OnCorner::nowhere;
  const Vec2& end = nearer_end(site, q);
  if (!((q - end).norm() <= tie)) return OnCorner::nowhere;
  // Both sides are equally near there, and roundings alone would choose between them, in every step anew.
  // Where the owner's centre lies is no matter of roundings.
  const Vec2 to_centre = centre(half) - q;
  const Wedge of_sample = wedge_of(half, sample), of_corner = wedge_at(outline, end);
  const auto parts_them = [&](const Site& side) {
    return !of_sample.edges.empty() && parts(outward(side), of_sample, of_corner);
  };
  const bool by_this = parts_them(site);
  const bool by_own = std::any_of(of_sample.normals.begin(), of_sample.normals.end(),
                                  [&](const Vec2& n) { return parts(-n, of_sample, of_corner); });
  OnCorner where = OnCorner::nowhere;
  for (std::size_t k = 0; k < outline.sites.size(); ++k) {
    const Site& next = outline.sites[k];
    if (k == j || next.kind != SiteKind::segment || (next.a != end && next.b != end) || next.covered)
      continue;
    const Vec2 on = next.a == end ? Vec2(next.b - next.a) : Vec2(next.a - next.b);
    if (outward(site).dot(on) > kStraightJoint * on.norm()) continue;  // a hollow corner has both its sides
    const bool by_next = parts_them(next);
    const double more = by_next != by_this ? (by_next ? 1.0 : -1.0)
                                           : outward(next).dot(to_centre) - outward(site).dot(to_centre);
    if (by_this && by_next) return OnCorner::either_side;
    // what only a side of the sample's own corner parts lies on that: it has the contact
    if (!by_this && !by_next && by_own) return OnCorner::other_side;
    // a tie goes to the site that comes first, so that exactly one of the two has the sample
    if (more > 0.0 || (more == 0.0 && k < j)) return OnCorner::other_side;
    where = OnCorner::this_side;
  }
  return where;
}

bool has_hollow_corner(const Outline& outline, std::size_t j, const Vec2& end) {
  return std::any_of(outline.sites.begin(), outline.sites.end(), [&](const Site& next) {
    if (&next == &outline.sites[j] || next.kind != SiteKind::segment || (next.a != end && next.b != end))
      return false;
    const Vec2 on = next.a == end ? Vec2(next.b - next.a) : Vec2(next.a - next.b);
    return outward(outline.sites[j]).dot(on) > kStraightJoint * on.norm();
  });
}

bool has_no_way_by(const Half& half, int i, std::size_t j, const Vec2& q) {
  const Site& site = half.other.sites[j];
  const Vec2& corner = nearer_end(site, q);
  const Wedge of_sample = wedge_of(half, half.carrier.samples[i]);
  const Wedge of_corner = wedge_at(half.other, corner);
  // a wire has sides, but no inside that would overlap: in a hollow corner what is beyond the end is in the other side
  if (!half.carrier.solid) return has_hollow_corner(half.other, j, corner);
  if (of_sample.edges.empty()) return false;
  return std::none_of(of_corner.normals.begin(), of_corner.normals.end(), [&](const Vec2& n) {
    return n.dot(outward(site)) < 1.0 - kOneSide && parts(n, of_sample, of_corner);
  });
}

double through_corner(const Half& half, const Sample& sample, const Site& site, const Vec2& q) {
  const bool straight = site.kind == SiteKind::segment && sample.radius + site.radius == 0.0;
  if (!straight || sample.arc_site >= 0) return 0.0;
  const Vec2& corner = nearer_end(site, q);
  // nobody passes through a hollow corner: who is behind one of its sides is said to be so by that
  if (half.carrier.solid && site.solid &&
      has_hollow_corner(half.other, static_cast<std::size_t>(&site - half.other.sites.data()), corner))
    return 0.0;
  const auto to_other = [&](const Vec2& p) {
    return half.other_frame.to_local(half.carrier_frame.to_world(p));
  };
  const auto ends_at = [](const Site& s, const Vec2& p) {
    return s.kind == SiteKind::segment && (s.a == p || s.b == p);
  };
  bool through = false;
  double back = 0.0;
  for (const Site& s : half.carrier.sites) {
    if (!ends_at(s, sample.p) || s.radius > 0.0) continue;
    const Vec2 from = to_other(s.a), to = to_other(s.b);
    for (const Site& o : half.other.sites) {
      if (!ends_at(o, corner) || o.radius > 0.0 || !cross_each_other(from, to, o.a, o.b)) continue;
      Site there = s;
      there.a = from;
      there.b = to;
      // Where they cross both must be nearer to these two corners than to their other ends: those that lie along each other may
      // cross there, by a rounding, and a tip that is through somewhere else is said to be so by itself.
      const Vec2 &end = s.a == sample.p ? from : to, &far_end = s.a == sample.p ? to : from,
                 &far_corner = o.a == corner ? o.b : o.a;
      const double end_off = distance_to_line(o, end), corner_off = distance_to_line(there, corner);
      if (end_off > distance_to_line(o, far_end) || corner_off > distance_to_line(there, far_corner))
        continue;
      through = true;
      back = std::max(back, std::min(distance_to(o, end), distance_to(there, corner)));
    }
  }
  if (!through) return 0.0;
  // a wire has no side on which it must not be: the vertex that is through goes back
  if (!site.solid || !half.carrier.solid) return back;
  // By the side that leaves the least to go back, of those that could part the two.
  const Wedge of_sample = wedge_of(half, sample);
  const Wedge of_corner = wedge_at(half.other, corner);
  double depth = std::numeric_limits<double>::infinity();
  const auto try_side = [&](const Vec2& n) {
    if (parts(n, of_sample, of_corner)) depth = std::min(depth, -n.dot(q - corner));
  };
  for (const Vec2& n : of_corner.normals) try_side(n);
  for (const Vec2& n : of_sample.normals) try_side(-n);
  return std::isfinite(depth) ? std::max(0.0, depth) : 0.0;
}

}  // namespace brink::islands
