#include "brink/core/query/site_crossing.h"

#include <algorithm>
#include <array>

#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"

namespace brink {

namespace {

/// The two points, maybe, in which a site's line or circle meets an arc's circle.
struct CommonPoints {
  std::array<Vec2, 2> points{Vec2::Zero(), Vec2::Zero()};
  double bulge = -1.0;  ///< how far one reaches over the other [m]; < 0: they do not meet
};

/// The bulge is the cap of the circle beyond the line: of its two caps the one without the centre.
CommonPoints line_and_circle(const Site& line, const Site& arc) {
  const Vec2 u = (line.b - line.a).normalized(), w = arc.center - line.a;
  // Distance of the line from the centre; the cap is r - height high.
  const double height = std::abs(cross(u, w)), r = arc.arc_radius;
  if (height > r) return {};
  const double half = std::sqrt((r - height) * (r + height));
  const Vec2 foot = line.a + u.dot(w) * u;
  return {{foot - half * u, foot + half * u}, r - height};
}

/// The bulge is the width of the lens that the discs share, or, where one is nearly within the other, how
/// far it looks out. Circles about one centre do not cross.
CommonPoints two_circles(const Site& s, const Site& t) {
  // Seen from the lesser circle: along the greater one's radius the roundings of both ends would be as large as its own.
  if (s.arc_radius > t.arc_radius) return two_circles(t, s);
  const Vec2 w = t.center - s.center;
  const double d = w.norm(), r = s.arc_radius, q = t.arc_radius;
  const double bulge = std::min(r + q - d, d - std::abs(r - q));
  if (bulge < 0.0 || d == 0.0) return {};
  // from r^2 - along^2 = q^2 - (d - along)^2: both points are so far along the line of the centres
  const double along = 0.5 * (d + (r - q) * (r + q) / d);
  const double half = std::sqrt(std::max(0.0, (r - along) * (r + along)));
  const Vec2 u = w / d, foot = s.center + along * u;
  return {{foot - half * perp(u), foot + half * perp(u)}, bulge};
}

/// Abreast of the core of an arc or a segment, as far as its line or circle goes.
bool abreast(const Site& site, const Vec2& p) {
  if (site.kind == SiteKind::arc) return in_sector(site, p - site.center);
  const Vec2 d = site.b - site.a;
  return d.dot(p - site.a) >= 0.0 && d.dot(p - site.b) <= 0.0;
}

/// The points in which two cores cross, two at most.
struct Crossings {
  std::array<Vec2, 2> points{Vec2::Zero(), Vec2::Zero()};
  int count = 0;
};

/// Lines and circles go on beyond the ends: a crossing is where both sites themselves are.
Crossings on_both(const Site& s, const Site& t, const CommonPoints& common) {
  Crossings on;
  if (common.bulge < 0.0) return on;
  for (const Vec2& p : common.points)
    if (abreast(s, p) && abreast(t, p)) on.points[static_cast<std::size_t>(on.count++)] = p;
  return on;
}

/// How far along the site a place on its line or circle is: grows from a to b.
double along(const Site& site, const Vec2& p) {
  const Vec2 from = site.a - site.center, w = p - site.center;
  if (site.kind == SiteKind::arc)
    return (site.sweep > 0.0 ? 1.0 : -1.0) * std::atan2(cross(from, w), from.dot(w));
  return (site.b - site.a).dot(p - site.a);
}

/// The places of s that may be farthest from t: its ends, and where its line or circle goes the way of t's.
struct Turns {
  std::array<Vec2, 4> places;
  int count = 2;
};

Turns turns(const Site& s, const Site& t) {
  Turns all{{s.a, s.b, s.a, s.a}};
  const auto add = [&](const Vec2& p) {
    if (abreast(s, p)) all.places[static_cast<std::size_t>(all.count++)] = p;
  };
  const Vec2 d = (t.b - t.a).normalized();
  if (s.kind == SiteKind::arc) {
    const Vec2 way = t.kind == SiteKind::arc ? t.center - s.center : perp(d);
    const double far = way.norm();
    for (const double r : {s.arc_radius, -s.arc_radius})
      if (far > 0.0) add(s.center + r * (way / far));
  } else if (t.kind == SiteKind::arc) {
    const Vec2 e = (s.b - s.a).normalized();
    add(s.a + e.dot(t.center - s.a) * e);
  }
  return all;
}

/// Each crossing takes s to the other side of t. How far it reaches there at least, of the two sides [m]: where t was on one
/// before, all that is on the other has to come back. @pre there is one.
double reach_through(const Site& s, const Site& t, const Crossings& crossings) {
  std::array<double, 2> reach{};
  const Turns all = turns(s, t);
  for (int k = 0; k < all.count; ++k) {
    const Vec2& p = all.places[static_cast<std::size_t>(k)];
    const auto passed = [&](int i) {
      return along(s, crossings.points[static_cast<std::size_t>(i)]) < along(s, p);
    };
    const bool odd = passed(0) != (crossings.count > 1 && passed(1));
    double& side = reach[odd ? 1 : 0];
    side = std::max(side, nearest_on(t, p).distance);
  }
  return std::min(reach[0], reach[1]);
}

/// How far the nearest end of either reaches over the other's line.
SiteCrossing two_segments(const Site& s, const Site& t) {
  const Vec2 ds = (s.b - s.a).normalized(), dt = (t.b - t.a).normalized();
  const double ta = cross(ds, t.a - s.a), tb = cross(ds, t.b - s.a);
  const double sa = cross(dt, s.a - t.a), sb = cross(dt, s.b - t.a);
  // signed distances of t's ends from the line of s, and the reverse: they cross if both pairs have two
  // signs. An end on the other's line does not cross it
  if (ta * tb >= 0.0 || sa * sb >= 0.0) return {};
  // sa and sb have two signs, so that sa / (sa - sb) is the fraction of s at which it meets the line of t.
  return {std::min({std::abs(ta), std::abs(tb), std::abs(sa), std::abs(sb)}),
          s.a + (s.b - s.a) * (sa / (sa - sb)), -perp(dt)};
}

/// At least one of the two is an arc.
SiteCrossing with_arc(const Site& s, const Site& t) {
  const bool s_is_arc = s.kind == SiteKind::arc, t_is_arc = t.kind == SiteKind::arc;
  const CommonPoints common =
      s_is_arc && t_is_arc ? two_circles(s, t) : line_and_circle(s_is_arc ? t : s, s_is_arc ? s : t);
  const Crossings crossings = on_both(s, t, common);
  if (crossings.count == 0) return {};
  // depth and bulge belong to the pair: of two crossings the first tells as much
  const Vec2& p = crossings.points[0];
  return {std::min({common.bulge, reach_through(s, t, crossings), reach_through(t, s, crossings)}), p,
          right_normal(t, p)};
}

}  // namespace

SiteCrossing site_crossing(const Site& s, const Site& t) {
  const bool segments = s.kind == SiteKind::segment && t.kind == SiteKind::segment;
  return segments ? two_segments(s, t) : with_arc(s, t);
}

}  // namespace brink
