#pragma once
/// A slow reference for first contact that shares no code with the scheduler: exact distances of all pairs of
/// sites, and steps by a bound on the speed.
///
/// The distance of two curves is the least over finitely many pairs of points: ends against curves, points on
/// a line through a centre, crossings. It changes no faster than any point of one body moves against any of
/// the other (V), so from t the pair stays apart until t + distance / V. Each pair of sites is stepped alone
/// until it touches, leaves the window, or is later than the earliest contact found.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "brink/core/shapes/outline.h"
#include "brink/integrators/motion.h"

namespace brink::reference {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A site's core where it is now.
struct Curve {
  SiteKind kind = SiteKind::point;
  Vec2 a = Vec2::Zero(), b = Vec2::Zero();  ///< ends
  Vec2 center = Vec2::Zero(),
       middle = Vec2::Zero();              ///< arcs: centre, unit direction to the middle of the arc
  double circle = 0.0, half_cosine = 0.0;  ///< arcs: radius, cosine of half the sweep
};

struct Turn {
  double c = 1.0, s = 0.0;
  explicit Turn(double angle) : c(std::cos(angle)), s(std::sin(angle)) {}
  Vec2 operator()(const Vec2& p) const { return {c * p.x() - s * p.y(), s * p.x() + c * p.y()}; }
};

inline Curve placed(const Site& site, const Turn& turn, const Vec2& shift) {
  Curve curve;
  curve.kind = site.kind;
  curve.a = turn(site.a) + shift;
  curve.b = turn(site.b) + shift;
  if (site.kind != SiteKind::arc) return curve;
  curve.center = turn(site.center) + shift;
  curve.circle = site.arc_radius;
  curve.half_cosine = std::cos(0.5 * site.sweep);
  const double from = std::atan2(site.a.y() - site.center.y(), site.a.x() - site.center.x());
  curve.middle = turn(Vec2(std::cos(from + 0.5 * site.sweep), std::sin(from + 0.5 * site.sweep)));
  return curve;
}

inline bool in_sector(const Curve& arc, const Vec2& d) {
  return d.dot(arc.middle) >= d.norm() * arc.half_cosine;
}

inline double point_to_segment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double s = std::clamp((p - a).dot(d) / d.dot(d), 0.0, 1.0);
  if (s <= 0.0) return (p - a).norm();
  if (s >= 1.0) return (p - b).norm();
  return std::abs(d.x() * (p.y() - a.y()) - d.y() * (p.x() - a.x())) / d.norm();
}

inline double point_to_curve(const Vec2& p, const Curve& c) {
  if (c.kind == SiteKind::point) return (p - c.a).norm();
  if (c.kind == SiteKind::segment) return point_to_segment(p, c.a, c.b);
  double best = std::min((p - c.a).norm(), (p - c.b).norm());
  const Vec2 w = p - c.center;
  if (in_sector(c, w)) best = std::min(best, std::abs(w.norm() - c.circle));
  return best;
}

inline bool segments_cross(const Curve& s, const Curve& t) {
  const Vec2 d = s.b - s.a, e = t.b - t.a;
  const auto turn = [](const Vec2& u, const Vec2& v) { return u.x() * v.y() - u.y() * v.x(); };
  const double t1 = turn(d, t.a - s.a), t2 = turn(d, t.b - s.a);
  const double s1 = turn(e, s.a - t.a), s2 = turn(e, s.b - t.a);
  return (t1 < 0.0) != (t2 < 0.0) && (s1 < 0.0) != (s2 < 0.0);
}

inline double segment_to_arc(const Curve& s, const Curve& arc) {
  const Vec2 d = s.b - s.a;
  const double length = d.norm();
  const Vec2 u = d / length;
  const double along = (arc.center - s.a).dot(u);
  const Vec2 foot = s.a + along * u, off = foot - arc.center;
  const double distance = off.norm();
  if (distance < arc.circle) {
    const double half_chord = std::sqrt((arc.circle - distance) * (arc.circle + distance));
    for (const double x : {along - half_chord, along + half_chord})
      if (x >= 0.0 && x <= length && in_sector(arc, s.a + x * u - arc.center)) return 0.0;
  }
  const bool abreast = along >= 0.0 && along <= length && distance > 0.0 && in_sector(arc, off);
  return abreast ? std::abs(distance - arc.circle) : kNever;
}

inline double arc_to_arc(const Curve& s, const Curve& t) {
  const Vec2 d = t.center - s.center;
  const double distance = d.norm();
  if (distance == 0.0) return kNever;  // then ends decide
  const Vec2 u = d / distance, v(-u.y(), u.x());
  const double x = 0.5 * (distance + (s.circle - t.circle) * (s.circle + t.circle) / distance);
  if (std::abs(x) < s.circle) {
    const double y = std::sqrt((s.circle - x) * (s.circle + x));
    for (const double side : {-y, y}) {
      const Vec2 p = s.center + x * u + side * v;
      if (in_sector(s, p - s.center) && in_sector(t, p - t.center)) return 0.0;
    }
  }
  double best = kNever;
  for (const double on_s : {-1.0, 1.0})
    for (const double on_t : {-1.0, 1.0})
      if (in_sector(s, on_s * u) && in_sector(t, on_t * u))
        best = std::min(best, std::abs(distance + on_t * t.circle - on_s * s.circle));
  return best;
}

/// Distance of two cores: 0 where they cross.
inline double core_distance(const Curve& s, const Curve& t) {
  double best = std::min(
      {point_to_curve(s.a, t), point_to_curve(s.b, t), point_to_curve(t.a, s), point_to_curve(t.b, s)});
  if (s.kind == SiteKind::point || t.kind == SiteKind::point) return best;
  if (s.kind == SiteKind::segment && t.kind == SiteKind::segment) return segments_cross(s, t) ? 0.0 : best;
  if (s.kind == SiteKind::segment) return std::min(best, segment_to_arc(s, t));
  if (t.kind == SiteKind::segment) return std::min(best, segment_to_arc(t, s));
  return std::min(best, arc_to_arc(s, t));
}

/// Greatest distance of a site's core from the frame's origin: an upper bound.
inline double reach_of(const Site& site) {
  const double ends = std::max(site.a.norm(), site.b.norm());
  return site.kind == SiteKind::arc ? std::max(ends, site.center.norm() + site.arc_radius) : ends;
}

/// How fast a body can be over the window of a flight: |velocity - drift| and |omega| (drift: of both bodies
/// alike).
struct SpeedBound {
  double linear = 0.0, spin = 0.0;
};

/// Two bodies of a flight.
struct Pair {
  const Outline *a, *b;
  const Motion *motion_a, *motion_b;
  double relative_speed;  ///< bound on the speed of a's origin against b's [m/s]
  double spin_a, spin_b;  ///< bounds on |omega| [rad/s]

  /// Of a site of a, shifted, and one of b.
  double site_distance(const Site& sa, const Site& sb, double t, const Vec2& shift_a) const {
    const Pose pa = motion_a->pose(t), pb = motion_b->pose(t);
    return core_distance(placed(sa, Turn(pa.angle), pa.position - pb.position + shift_a),
                         placed(sb, Turn(pb.angle), Vec2::Zero())) -
           sa.radius - sb.radius;
  }

  double site_distance(std::size_t i, std::size_t j, double t) const {
    return site_distance(a->sites[i], b->sites[j], t, Vec2::Zero());
  }

  /// Least distance of the two outlines at time t, a shifted; <= 0 where boundaries touch or cross.
  double distance(double t, const Vec2& shift_a = Vec2::Zero()) const {
    const Pose pa = motion_a->pose(t), pb = motion_b->pose(t);
    const Turn ta(pa.angle), tb(pb.angle);
    const Vec2 offset = pa.position - pb.position + shift_a;
    std::vector<Curve> of_b;
    of_b.reserve(b->sites.size());
    for (const Site& s : b->sites) of_b.push_back(placed(s, tb, Vec2::Zero()));
    double best = kNever;
    for (const Site& s : a->sites) {
      const Curve c = placed(s, ta, offset);
      for (std::size_t j = 0; j < of_b.size(); ++j)
        best = std::min(best, core_distance(c, of_b[j]) - s.radius - b->sites[j].radius);
    }
    return best;
  }

  /// True if one outline is a bare point: it has no extent to cross the other's boundary with, only a path.
  bool has_bare_point() const { return is_bare_point(*a) || is_bare_point(*b); }

  /// How many sites of the other outline the bare point crosses between t0 and t1, its path taken as
  /// straight.
  int crossings(double t0, double t1) const {
    const bool of_a = is_bare_point(*a);
    const Outline& other = of_a ? *b : *a;
    Curve path;
    path.kind = SiteKind::segment;
    path.a = point_in_other(of_a, t0);
    path.b = point_in_other(of_a, t1);
    if (path.a == path.b) return 0;
    return static_cast<int>(std::count_if(other.sites.begin(), other.sites.end(), [&](const Site& site) {
      return core_distance(path, placed(site, Turn(0.0), Vec2::Zero())) == 0.0;
    }));
  }

  /// True if the bare point is within the loops of the other outline at time t, by the parity of crossings of
  /// a straight way out: of three ways, what most say. @pre the other is solid.
  bool bare_point_enclosed(double t) const {
    const bool of_a = is_bare_point(*a);
    const Outline& other = of_a ? *b : *a;
    int odd = 0;
    for (const double angle : {0.3, 2.1, 4.4}) {
      Curve path;
      path.kind = SiteKind::segment;
      path.a = point_in_other(of_a, t);
      path.b =
          path.a + 4.0 * (other.bounding_radius + path.a.norm()) * Vec2(std::cos(angle), std::sin(angle));
      int crossed = 0;
      for (const Site& site : other.sites)
        crossed += times_crossed(path, placed(site, Turn(0.0), Vec2::Zero()));
      odd += crossed % 2;
    }
    return odd >= 2;
  }

 private:
  /// How often a straight path meets a site's core.
  static int times_crossed(const Curve& path, const Curve& site) {
    if (site.kind != SiteKind::arc) return core_distance(path, site) == 0.0 ? 1 : 0;
    const Vec2 d = (path.b - path.a).normalized(), w = site.center - path.a;
    const double along = w.dot(d), off2 = w.squaredNorm() - along * along;
    const double half2 = site.circle * site.circle - off2;
    if (half2 <= 0.0) return 0;
    int count = 0;
    for (const double x : {along - std::sqrt(half2), along + std::sqrt(half2)})
      count += x > 0.0 && in_sector(site, path.a + x * d - site.center);
    return count;
  }
  static bool is_bare_point(const Outline& o) { return o.is_point() && o.sites[0].radius == 0.0; }
  Vec2 point_in_other(bool of_a, double t) const {
    const Pose p = (of_a ? motion_a : motion_b)->pose(t), o = (of_a ? motion_b : motion_a)->pose(t);
    return Turn(-o.angle)(Turn(p.angle)((of_a ? a : b)->sites[0].a) + (p.position - o.position));
  }
};

struct FirstTouch {
  double time = kNever;  ///< a time at which the distance is <= tiny, none before; kNever: apart to the end
  std::size_t i = 0, j = 0;
  double least = kNever;  ///< least distance seen
  long evaluations = 0;
  bool given_up = false;  ///< too many evaluations: no answer
};

/// First time in [from, to] at which the distance is at most `tiny`.
inline FirstTouch first_touch(const Pair& pair, double from, double to, double tiny, long cap = 400000) {
  struct Item {
    double distance, speed;
    std::size_t i, j;
  };
  std::vector<Item> items;
  FirstTouch found;
  for (std::size_t i = 0; i < pair.a->sites.size(); ++i)
    for (std::size_t j = 0; j < pair.b->sites.size(); ++j) {
      const double speed = pair.relative_speed + pair.spin_a * reach_of(pair.a->sites[i]) +
                           pair.spin_b * reach_of(pair.b->sites[j]);
      items.push_back({pair.site_distance(i, j, from), speed * (1.0 + 1e-12), i, j});
    }
  std::sort(items.begin(), items.end(), [](const Item& x, const Item& y) { return x.distance < y.distance; });
  double end = to;
  for (const Item& item : items) {
    double t = from, distance = item.distance;
    for (long n = 0;; ++n) {
      ++found.evaluations;
      found.least = std::min(found.least, distance);
      if (distance <= tiny) {
        if (t < found.time) {
          found.time = end = t;
          found.i = item.i;
          found.j = item.j;
        }
        break;
      }
      const double next = item.speed > 0.0 ? t + distance / item.speed : kNever;
      if (next > end) break;
      t = std::max(next, std::nextafter(t, kNever));
      if (t > end) break;
      if (found.evaluations > cap) {
        found.given_up = true;
        break;
      }
      distance = pair.site_distance(item.i, item.j, t);
    }
  }
  return found;
}

}  // namespace brink::reference
