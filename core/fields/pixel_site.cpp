#include "brink/core/fields/pixel_site.h"

#include <algorithm>
#include <cmath>

namespace brink::detail {

namespace {

/// Cuts sites to one window, in double precision, so that the ends of a long one are not large numbers when
/// they are rounded to single precision.
class Cutter {
 public:
  explicit Cutter(const PixelGrid& grid) : grid_(grid), center_(grid.center()) {}

  PixelSite cut(const Site& site, const Frame& frame) const {
    PixelSite s = whole(site, frame);
    if (s.kind == SiteKind::segment) cut_segment(s);
    if (s.kind == SiteKind::arc) cut_arc(s);
    return s;
  }

 private:
  /// The site uncut. Pseudo-normals are only turned: of them the direction counts.
  PixelSite whole(const Site& site, const Frame& frame) const {
    const auto point = [&](const Vec2& p) { return Vec2((frame.to_world(p) - center_) / grid_.pixel); };
    PixelSite s;
    s.kind = site.kind;
    s.solid = site.solid;
    s.a = point(site.a);
    s.b = site.kind == SiteKind::point ? s.a : point(site.b);
    s.center = site.kind == SiteKind::arc ? point(site.center) : s.a;
    s.pseudo_a = frame.direction_to_world(site.pseudo_a);
    s.pseudo_b = frame.direction_to_world(site.pseudo_b);
    s.arc_radius = site.kind == SiteKind::arc ? site.arc_radius / grid_.pixel : 0.0;
    s.sweep = site.sweep;
    s.radius = site.radius / grid_.pixel;
    return s;
  }

  /// Keeps the part of a segment on which feet of points of the window lie (the foot's parameter is linear in
  /// the point, so its extremes are at corners); a segment beyond whose end the whole window lies becomes
  /// that end.
  void cut_segment(PixelSite& s) const {
    const Vec2 d = s.b - s.a;
    const double length2 = d.squaredNorm();
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec2& corner : corners_of(grid_)) {
      const double t = (corner - s.a).dot(d) / length2;
      low = std::min(low, t);
      high = std::max(high, t);
    }
    // all points of the window have their feet at the start, or all at the end
    if (!(high > 0.0)) return make_point(s, s.a, s.pseudo_a);
    if (!(low < 1.0)) return make_point(s, s.b, s.pseudo_b);
    // A new end is no vertex: beside it the side is that of the segment, so that its pseudo-normal is
    // the segment's outward normal.
    const Vec2 a = s.a, outward = -perp(d).normalized();
    if (low > 0.0) {
      s.a = a + low * d;
      s.pseudo_a = outward;
    }
    if (high < 1.0) {
      s.b = a + high * d;
      s.pseudo_b = outward;
    }
    // shorter than a millionth of a pixel: its direction would be rounding
    if ((s.b - s.a).squaredNorm() < 1e-12) make_point(s, s.a, s.pseudo_a);
  }

  /// Shrinks the site to one place; `pseudo` tells its side there.
  static void make_point(PixelSite& s, const Vec2& p, const Vec2& pseudo) {
    s.kind = SiteKind::point;
    s.a = s.b = s.center = p;
    s.pseudo_a = s.pseudo_b = pseudo;
  }

  /// Keeps the part of an arc that the window sees from the arc's centre, where that is less than a quarter
  /// turn (then the nearer end of what is kept is the nearer end of the arc wherever both are seen).
  void cut_arc(PixelSite& s) const {
    const double turn = s.sweep > 0 ? 1.0 : -1.0;
    const Vec2 from = s.a - s.center;
    const Vec2 view = -s.center;  // towards the window's centre
    double low = 0.0, high = 0.0;
    // Angles are about the arc's centre, measured from the direction to the window's and
    // in the arc's sense of turning.
    for (const Vec2& corner : corners_of(grid_)) {
      const Vec2 w = corner - s.center;
      const double angle = turn * std::atan2(cross(view, w), view.dot(w));
      low = std::min(low, angle);
      high = std::max(high, angle);
    }
    // 1.5 < pi / 2: low and high lie in (-1.5, 1.5), and an arc of a quarter turn that begins at an
    // angle up to pi and runs past it comes to -pi / 2 at most: nothing need be wrapped. The centre must
    // lie outside the window's circle, as from within it there is no bounded view.
    if (!(high - low < 1.5) || !(view.norm() > grid_.half_diagonal())) return;
    const double start = turn * std::atan2(cross(view, from), view.dot(from)),
                 end = start + std::abs(s.sweep);
    const double first = std::max(start, low), last = std::min(end, high);
    // Nothing of it is seen, or nearly: nearest are ends, and the whole arc has them.
    if (!(last - first > 1e-9)) return;
    const auto at = [&](double angle) {
      const Vec2 unit = view.normalized();
      return Vec2(s.center + s.arc_radius * (std::cos(angle) * unit + std::sin(angle) * turn * perp(unit)));
    };
    // as of a segment: what was no end has the arc's own outward normal there
    if (first > start) {
      s.a = at(first);
      s.pseudo_a = turn * (s.a - s.center).normalized();
    }
    if (last < end) {
      s.b = at(last);
      s.pseudo_b = turn * (s.b - s.center).normalized();
    }
    s.sweep = turn * (last - first);
  }

  const PixelGrid& grid_;
  Vec2 center_;
};

}  // namespace

std::array<Vec2, 4> corners_of(const PixelGrid& grid) {
  const Vec2 half = 0.5 * Vec2(grid.width, grid.height);
  // no order is promised: whoever asks takes a least or a most over all four
  return {Vec2(-half), Vec2(half.x(), -half.y()), Vec2(-half.x(), half.y()), half};
}

PixelSite pixel_site(const Site& site, const Frame& frame, const PixelGrid& grid) {
  return Cutter(grid).cut(site, frame);
}

}  // namespace brink::detail
