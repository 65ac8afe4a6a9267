#include "brink/core/shapes/thick_boundary.h"

#include <algorithm>
#include <numbers>

#include "brink/core/base/elementary.h"
#include "brink/core/shapes/crossing.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"

namespace brink {

namespace {

/// The site shifted to its right by its radius, travelled the same way: its solid stays on the left. Nothing
/// where a concave arc is too tight to have an offset.
void add_right_offset(const Site& s, std::vector<Site>& pieces) {
  if (s.kind == SiteKind::segment) {
    const Vec2 shift = -s.radius * perp(direction_at_start(s));
    pieces.push_back(segment_site(s.a + shift, s.b + shift, 0.0));
    return;
  }
  const double r = s.sweep > 0 ? s.arc_radius + s.radius : s.arc_radius - s.radius;
  if (!(r > 0.0)) return;
  // the ends move along the arc's own radii, so that the offset arc turns by the same angle
  const double ratio = r / s.arc_radius;
  add_arc(pieces, s.center + ratio * (s.a - s.center), s.center + ratio * (s.b - s.center), s.center, r,
          s.sweep, 0.0);
}

/// As quarter arcs, counter-clockwise: what is within is on their left.
void add_circle(const Vec2& center, double r, std::vector<Site>& pieces) {
  const Vec2 start = center + Vec2(r, 0);
  add_arc(pieces, start, start, center, r, 2 * std::numbers::pi, 0.0);
}

/// Every piece that can be part of the boundary: each place of it is at the radius from a side, or from a vertex.
std::vector<Site> candidates(const Outline& outline) {
  std::vector<Site> pieces;
  for (const Site& s : outline.sites) {
    if (s.kind == SiteKind::point) continue;
    add_right_offset(s, pieces);
    // a solid's left offset is covered: by the solid, or by the thickness of its far side
    if (!s.solid) add_right_offset(reversed(s), pieces);
  }
  for (const Sample& sample : outline.samples)
    if (sample.arc_site < 0) add_circle(sample.p, sample.radius, pieces);
  return pieces;
}

/// Where along the piece p lies, in [0, 1].
double fraction_of(const Site& piece, const Vec2& p) {
  if (piece.kind == SiteKind::segment) {
    const Vec2 d = piece.b - piece.a;
    return std::clamp((p - piece.a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  }
  // the angle from the start, signed as the sweep is where p is on the arc
  const Vec2 from = piece.a - piece.center, w = p - piece.center;
  return std::clamp(angle_of(cross(from, w), from.dot(w)) / piece.sweep, 0.0, 1.0);
}

/// The piece between two fractions of its length.
Site part_of(const Site& piece, double from, double to) {
  Site part = piece;
  part.a = point_along(piece, from);
  part.b = point_along(piece, to);
  part.sweep = piece.sweep * (to - from);
  return part;
}

/// True if an earlier piece runs along the same way at the middle of this one: the boundary is to be counted
/// once.
bool is_repeat(const std::vector<Site>& pieces, const std::vector<Box>& boxes, std::size_t k,
               const Site& part, double tolerance) {
  const Vec2 middle = point_along(part, 0.5);
  for (std::size_t j = 0; j < k; ++j) {
    if (!boxes[j].contains(middle)) continue;
    const Nearest n = nearest_on(pieces[j], middle);
    // at its end the other piece does not run along; what goes on there is a piece of its own
    if (n.distance > tolerance || n.foot != Foot::interior) continue;
    const Site onward = part_of(pieces[j], fraction_of(pieces[j], middle), 1.0);
    const Site own = part_of(part, 0.5, 1.0);
    // to 1.4e-3 rad; what crosses the part at its middle would have cut it there
    if (direction_at_start(onward).dot(direction_at_start(own)) > 0.999999) return true;
  }
  return false;
}

/// Fractions of piece k at which it meets others, and its ends, ascending; a crossing may be found more than once.
std::vector<double> cuts_of(const std::vector<Site>& pieces, const std::vector<Box>& boxes, std::size_t k,
                            double tolerance) {
  // also where another only touches or starts to run along: its ends are among the meeting points
  std::vector<Vec2> points;
  for (std::size_t j = 0; j < pieces.size(); ++j)
    if (j != k && boxes[k].overlaps(boxes[j])) add_meeting_points(pieces[k], pieces[j], tolerance, points);
  std::vector<double> cuts{0.0, 1.0};
  for (const Vec2& p : points) cuts.push_back(fraction_of(pieces[k], p));
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// Tells covered points of candidate pieces from exposed ones.
class Cover {
 public:
  Cover(const Outline& outline, double tolerance) : outline_(outline), tolerance_(tolerance) {
    for (const Site& s : outline.sites) boxes_.push_back(core_bounds(s).grown(s.radius));
  }

  /// False if p is in a site's thickness, or inside the solid, by more than the tolerance.
  bool exposed(const Vec2& p) const {
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      const Site& s = outline_.sites[k];
      // short of the radius by more than the tolerance: every candidate lies on a surface, its own
      if (boxes_[k].contains(p) && nearest_on(s, p).distance < s.radius - tolerance_) return false;
    }
    // inside a solid, beyond the thickness of its sides: cost all sites, so it is asked last
    return !outline_.solid || gap_by_brute_force(outline_, p) >= -tolerance_;
  }

 private:
  const Outline& outline_;
  double tolerance_;
  std::vector<Box> boxes_;
};

}  // namespace

std::vector<Site> thick_boundary(const Outline& outline) {
  const double tolerance = 1e-11 * outline.bounds.extent().norm();
  const Cover cover(outline, tolerance);
  const std::vector<Site> pieces = candidates(outline);
  std::vector<Box> boxes;
  for (const Site& piece : pieces) boxes.push_back(core_bounds(piece).grown(tolerance));
  std::vector<Site> boundary;
  // Earlier pieces are kept where several run along one way: is_repeat() looks at those before k only.
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    // between two cuts a piece is exposed all along or nowhere: it goes under cover only through the
    // surface of another site, which is a candidate too
    const std::vector<double> cuts = cuts_of(pieces, boxes, k, tolerance);
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
      const Site part = part_of(pieces[k], cuts[c], cuts[c + 1]);
      // between two findings of one crossing
      if ((cuts[c + 1] - cuts[c]) * length(pieces[k]) <= tolerance) continue;
      if (cover.exposed(point_along(part, 0.5)) && !is_repeat(pieces, boxes, k, part, tolerance))
        boundary.push_back(part);
    }
  }
  return boundary;
}

}  // namespace brink
