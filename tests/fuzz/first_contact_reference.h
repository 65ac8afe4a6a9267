#pragma once
/// A slow reference for first contact that shares no code with the scheduler: exact distances of all pairs of
/// sites, and steps by a bound on the speed.
///
/// The distance of two curves is the least over finitely many pairs of points: ends against curves, points on
/// a line through a centre, crossings. It changes no faster than any point of one body moves against any of
/// the other (V), so from t the pair stays apart until t + distance / V. What falls freely is followed farther by a line
/// between the two: corners about one stay ahead of those about the other along it for as long as their speeds and the
/// greatest acceleration of any point tell; and inside a hollow arc, within its circle. Each pair of sites is stepped alone
/// until it touches, leaves the window, or is later than the earliest contact found.

#include <algorithm>
#include <array>
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
  // no site sweeps more than a quarter turn: the middle of its chord is well away from the centre
  const Vec2 chord = 0.5 * (site.a + site.b) - site.center;
  curve.half_cosine = chord.norm() / site.arc_radius;
  curve.middle = turn(chord / chord.norm());
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

/// A point of a body in free fall, as it is now, from b's place; its speed [m/s] and what turning bends its path [m/s^2] are
/// bounds over the flight.
struct Falling {
  Vec2 at, velocity;
  double speed, bend;
};

/// What a site lies in: everything within `radius` of a polygon of corners.
struct Cover {
  std::array<Falling, 3> corners;
  int count;
  double radius;

  double least(const Vec2& along) const {
    double best = kNever;
    for (int k = 0; k < count; ++k) best = std::min(best, corners[k].at.dot(along));
    return best - radius;
  }
};

/// For how long `gap` > 0 stays so that opens at a rate which falls by `bend` at most.
inline double stays_open_for(double gap, double opens, double bend) {
  // gap + opens s - bend s^2 / 2 = 0, the root written without cancellation
  const double root = std::sqrt(opens * opens + 2.0 * bend * gap);
  if (opens > 0.0) return bend > 0.0 ? (opens + root) / bend : kNever;
  return root - opens > 0.0 ? 2.0 * gap / (root - opens) : kNever;
}

/// The unit direction along which all of p is farthest ahead of all of q, as far as lines through two corners and
/// across two of the same polygon tell; zero: along none.
inline Vec2 parting_direction(const Cover& p, const Cover& q) {
  Vec2 best = Vec2::Zero();
  double most = 0.0;
  const auto try_along = [&](const Vec2& d) {
    const double length = d.norm();
    if (length == 0.0) return;
    const Vec2 n = d / length;
    if (const double ahead = p.least(n) + q.least(-n); ahead > most) {
      most = ahead;
      best = n;
    }
  };
  for (int i = 0; i < p.count; ++i)
    for (int j = 0; j < q.count; ++j) try_along(p.corners[i].at - q.corners[j].at);
  for (const Cover* c : {&p, &q})
    for (int i = 0; i < c->count; ++i) {
      const Vec2 edge = c->corners[(i + 1) % c->count].at - c->corners[i].at, across(-edge.y(), edge.x());
      try_along(across);
      try_along(-across);
    }
  return best;
}

/// How long all of p stays more than `tiny` ahead of all of q along a line that is fixed now; 0: none is. `pull`: of one
/// body's acceleration against the other's.
inline double ahead_for(const Cover& p, const Cover& q, double pull, double tiny) {
  const Vec2 n = parting_direction(p, q);
  if (n.isZero(0.0)) return 0.0;
  double lasts = kNever;
  for (int i = 0; i < p.count; ++i)
    for (int j = 0; j < q.count; ++j) {
      const Falling &x = p.corners[i], &y = q.corners[j];
      const double gap = n.dot(x.at - y.at) - p.radius - q.radius - tiny;
      if (!(gap > 0.0)) return 0.0;
      lasts = std::min(lasts, stays_open_for(gap, n.dot(x.velocity - y.velocity), pull + x.bend + y.bend));
    }
  return lasts;
}

/// How long all of p stays in the circle, by more than `tiny`; 0: it is not.
inline double inside_for(const Cover& p, const Falling& center, double circle, double pull, double tiny) {
  const double room = circle - p.radius - tiny;
  if (!(room > 0.0)) return 0.0;
  double lasts = kNever;
  for (int i = 0; i < p.count; ++i) {
    const Falling& x = p.corners[i];
    const Vec2 off = x.at - center.at;
    const double gap = (room - off.norm()) * (room + off.norm());
    if (!(gap > 0.0)) return 0.0;
    // the square of the distance from the centre: its second derivative is 2 (v^2 + off . a)
    const double speed = x.speed + center.speed,
                 bend = 2.0 * (speed * speed + circle * (pull + x.bend + center.bend));
    lasts = std::min(lasts, stays_open_for(gap, -2.0 * off.dot(x.velocity - center.velocity), bend));
  }
  return lasts;
}

/// Two bodies of a flight.
struct Pair {
  const Outline *a, *b;
  const Motion *motion_a, *motion_b;
  double relative_speed;  ///< bound on the speed of a's origin against b's [m/s]
  double spin_a, spin_b;  ///< bounds on |omega| [rad/s]

  bool falls_freely() const { return motion_a->is_ballistic() && motion_b->is_ballistic(); }

  /// How long a site of a stays more than `tiny` away from one of b after t, as lines between the two tell, and circles
  /// of hollow arcs; 0: they tell nothing. @pre falls_freely().
  double apart_for(const Site& sa, const Site& sb, double t, double tiny) const {
    const BodyState now_a = motion_a->state(t), now_b = motion_b->state(t);
    const Acceleration pull_a = motion_a->acceleration(), pull_b = motion_b->acceleration();
    const double pull = (pull_a.linear - pull_b.linear).norm();
    const Vec2 offset = now_a.pose.position - now_b.pose.position,
               drift = now_a.twist.velocity - now_b.twist.velocity;
    const Curve ca = placed(sa, Turn(now_a.pose.angle), offset),
                cb = placed(sb, Turn(now_b.pose.angle), Vec2::Zero());
    const auto of_a = [&](const Vec2& x) -> Falling {
      const Vec2 arm = x - offset;
      return {x, drift + now_a.twist.omega * Vec2(-arm.y(), arm.x()), relative_speed + spin_a * arm.norm(),
              (std::abs(pull_a.angular) + spin_a * spin_a) * arm.norm()};
    };
    const auto of_b = [&](const Vec2& x) -> Falling {
      return {x, now_b.twist.omega * Vec2(-x.y(), x.x()), spin_b * x.norm(),
              (std::abs(pull_b.angular) + spin_b * spin_b) * x.norm()};
    };
    const std::vector<Cover> covers_a = covers(ca, sa.radius, of_a), covers_b = covers(cb, sb.radius, of_b);
    double lasts = 0.0;
    for (const Cover& p : covers_a)
      for (const Cover& q : covers_b) lasts = std::max(lasts, ahead_for(p, q, pull, tiny));
    if (ca.kind == SiteKind::arc)
      for (const Cover& q : covers_b)
        lasts = std::max(lasts, inside_for(q, of_a(ca.center), ca.circle - sa.radius, pull, tiny));
    if (cb.kind == SiteKind::arc)
      for (const Cover& p : covers_a)
        lasts = std::max(lasts, inside_for(p, of_b(cb.center), cb.circle - sb.radius, pull, tiny));
    return (1.0 - 1e-9) * lasts;
  }

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
  /// A curve lies between its ends, an arc in the triangle of its ends and its tangents there, and in its circle.
  template <class Fall>
  static std::vector<Cover> covers(const Curve& c, double radius, const Fall& falling) {
    if (c.kind == SiteKind::point) return {{{falling(c.a)}, 1, radius}};
    if (c.kind == SiteKind::segment) return {{{falling(c.a), falling(c.b)}, 2, radius}};
    const Vec2 tip = c.center + c.circle / c.half_cosine * c.middle;
    return {{{falling(c.a), falling(c.b), falling(tip)}, 3, radius},
            {{falling(c.center)}, 1, radius + c.circle}};
  }
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
  const bool free = pair.falls_freely();
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
      double next = item.speed > 0.0 ? t + distance / item.speed : kNever;
      if (free && next <= end)
        next = std::max(next, t + pair.apart_for(pair.a->sites[item.i], pair.b->sites[item.j], t, tiny));
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
