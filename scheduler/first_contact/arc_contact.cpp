#include "brink/scheduler/first_contact/arc_contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "brink/core/base/limits.h"
#include "brink/scheduler/first_contact/safe_step.h"

namespace brink {

namespace {

/// Of the length of a direction: what is as near to a line is upon it, but for roundings.
constexpr double kUponLine = 1e-9;

/// A lower bound of the angle of (x, y) from the x axis [rad], by 5 % below it at most. Source: Shafer 1974: for t > 0
/// 3 t / (1 + 2 sqrt(1 + t^2)) < atan t < pi t / (1 + 2 sqrt(1 + t^2)). @pre y > 0
double least_angle(double x, double y) {
  const double quarter = 0.5 * std::numbers::pi, r = std::sqrt(x * x + y * y);
  const auto least = [&](double opposite, double along) { return 3.0 * opposite / (along + 2.0 * r); };
  const auto most = [&](double opposite, double along) {
    return std::numbers::pi * opposite / (along + 2.0 * r);
  };
  if (x < 0.0) return y > -x ? quarter + least(-x, y) : 2.0 * quarter - most(y, -x);
  return y > x ? quarter - most(x, y) : least(y, x);
}

/// How far (>= 0) the direction d, of length 1, lies outside the arc's sector [rad], at least; 0 if and only if inside.
double angle_outside(const Site& arc, const Vec2& d) {
  const Vec2 from = arc.a - arc.center, to = arc.b - arc.center;
  // The two radii are a quarter turn apart at most: their sum does not vanish, and halves the sector.
  const Vec2 middle = from + to;
  const double turn = cross(middle, d);
  const Vec2& end = (turn > 0.0) == (arc.sweep > 0.0) ? to : from;  // on d's side
  const double beyond = turn > 0.0 ? cross(end, d) : cross(d, end);
  if (beyond < -kUponLine * arc.arc_radius) return 0.0;
  if (beyond > kUponLine * arc.arc_radius) return least_angle(end.dot(d), beyond);
  const double off = std::abs(std::atan2(turn, middle.dot(d)));
  return std::max(0.0, off - 0.5 * std::abs(arc.sweep));
}

/// A direction of T's frame, seen from S.
Vec2 to_s(const Placed& s, const Placed& t, const Vec2& d) {
  return s.frame.direction_to_local(t.frame.direction_to_world(d));
}

/// What a step may use of a gap: it leads into the band, never onto the surface.
double short_of(double gap, double band) { return gap > 0.0 ? gap - 0.5 * std::min(gap, band) : 0.0; }
/// Likewise of a distance that may be one from behind.
double held(double gap, double band) { return gap > 0.0 ? short_of(gap, band) : -gap; }

/// True if the arc lies beyond the site, not in it: this pair touches only after its gap has risen to 0
/// again.
bool is_through(double gap, const Site& arc, const Site& site, double band) {
  return gap < -(arc.radius + site.radius) - band;
}

/// Of a circle the point nearest to a line lies straight across from the centre. So the pair is active
/// if that direction is in the arc's sector and the centre is abreast of the segment.
ArcStep against_segment(const Site& arc, const Site& site, const SamplePath& path, const Placed& s,
                        const Placed& t, double band, const RelativeBounds& relative,
                        const PathBounds& bounds, double window) {
  const Vec2 d = site.b - site.a, w = path.q - site.a;
  const double length = d.norm();
  const double offset = cross(d, w) / length;
  const double side =
      site.solid ? -1.0 : (offset < 0.0 ? -1.0 : 1.0);  // a solid is touched from its right only
  ArcStep step;
  step.normal = perp(d) * (side / length);
  step.gap = side * offset - arc.arc_radius - arc.radius - site.radius;
  step.rate = step.normal.dot(path.rate);
  const double along = w.dot(d) / length;
  const double beyond = std::max({0.0, -along, along - length});
  const double outside = angle_outside(arc, to_s(s, t, -step.normal));
  const bool through = is_through(step.gap, arc, site, band);
  step.active = beyond == 0.0 && outside == 0.0 && !through;
  step.point = path.q - step.normal * (side * offset - site.radius);
  // what pulls along the segment does not bend the gap: a wheel falls along a wall that it touches
  step.curvature = acceleration_against(t.frame.direction_to_world(step.normal), relative, bounds, window);
  // While the whole circle is clear of the line, its sector does not matter. A distance from a line has
  // no curvature of its own: only the path's counts.
  if (step.active || step.gap > 0.0)
    step.safe = safe_step(short_of(step.gap, band), step.rate, step.curvature);
  if (!step.active) {
    // The pair is not active for one or more of three reasons, and cannot come to be while any of them
    // lasts: so the longest of their times counts. Directions turn against each other at `spin` at most.
    const double spin = relative.spin_s + relative.spin_t;
    // The foot has to come onto the segment first: how far it is from its end bends as the path alone.
    if (beyond > 0.0) {
      const double leaves = (along < 0.0 ? -path.rate.dot(d) : path.rate.dot(d)) / length;
      step.safe = std::max({step.safe, bounds.speed > 0.0 ? beyond / bounds.speed : kForever,
                            safe_step(beyond, leaves, bounds.acceleration)});
    }
    if (outside > 0.0) {
      // a wire may come to be touched from its other side, in the opposite direction
      const double other = site.solid ? outside : angle_outside(arc, to_s(s, t, step.normal));
      const double stays = bounds.speed > 0.0 ? std::abs(offset) / bounds.speed : kForever;
      // The other direction does not count before the centre has come over the line, which takes `stays`.
      const auto turned = [&](double angle) {
        return spin > 0.0 ? angle / spin : angle > 0.0 ? kForever : 0.0;
      };
      step.safe = std::max({step.safe, turned(std::min(outside, other)), std::min(turned(outside), stays)});
    }
    if (step.gap > 0.0 || through)
      step.safe = std::max(step.safe, bounds.speed > 0.0 ? held(step.gap, band) / bounds.speed : kForever);
  }
  return step;
}

/// One of the two ways in which two arcs touch: outside against outside, or inside the other's hollow.
ArcStep against_arc(const Site& arc, const Site& site, bool hollow, const SamplePath& path, const Placed& s,
                    const Placed& t, double band, const RelativeBounds& relative, const PathBounds& bounds,
                    double window) {
  const Vec2 w = path.q - site.center;
  const double distance = w.norm();
  const double thickness = arc.radius + site.radius;
  ArcStep step;
  const Vec2 u = distance > 0.0 ? Vec2(w / distance) : Vec2(1.0, 0.0);
  const double radial = u.dot(path.rate);
  // From either centre the touching point lies along +-u.
  step.normal = hollow ? Vec2(-u) : u;
  step.gap = hollow ? site.arc_radius - distance - arc.arc_radius - thickness
                    : distance - site.arc_radius - arc.arc_radius - thickness;
  step.rate = hollow ? -radial : radial;
  // active only where both sectors hold the direction: so the worse of the two angles is what must be turned
  const double outside = std::max(angle_outside(arc, to_s(s, t, Vec2(-step.normal))), angle_outside(site, u));
  const bool through = is_through(step.gap, arc, site, band);
  step.active = outside == 0.0 && distance > 0.0 && !through;
  step.point = site.center + u * (site.arc_radius + (hollow ? -site.radius : site.radius));
  // Seen from inside, the gap is R - |w| with w = q - centre. Over a step |w + w' h + w'' h^2 / 2| grows
  // by no more than its last term beyond |w + w' h|, and as sqrt(rho^2 + x) <= rho + x / (2 rho), that
  // is at most rho + rho' h + v^2 h^2 / (2 rho). So the present rho serves for the whole step, however
  // near to the centre the path leads.
  // From outside the distance lies above that from the line across u: only what pulls against u bends it.
  const double outer = acceleration_against(t.frame.direction_to_world(u), relative, bounds, window);
  step.curvature =
      !hollow ? outer : bounds.acceleration + (distance > 0.0 ? bounds.speed * bounds.speed / distance : 0.0);
  // At the very centre rho is 0 and there is no such bound: speed alone holds a hollow's gap there.
  if ((step.active || step.gap > 0.0) && (distance > 0.0 || !hollow))
    step.safe = safe_step(short_of(step.gap, band), step.rate, step.curvature);
  if (step.gap > 0.0 || through)
    step.safe = std::max(step.safe, bounds.speed > 0.0 ? held(step.gap, band) / bounds.speed : kForever);
  if (!step.active && distance > 0.0) {
    // The direction turns at most at speed / (distance / 2) while the centres are still half their distance
    // apart.
    const double turning = 2.0 * bounds.speed / distance + relative.spin_s + relative.spin_t;
    // after that the bound on the turning no longer holds
    const double half_way = bounds.speed > 0.0 ? 0.5 * distance / bounds.speed : kForever;
    step.safe = std::max(step.safe, std::min(half_way, turning > 0.0 ? outside / turning : kForever));
  }
  return step;
}

}  // namespace

ArcStep arc_step(const Site& arc, const Site& site, const SamplePath& path, const Placed& s, const Placed& t,
                 double band, const RelativeBounds& relative, const PathBounds& bounds, double window) {
  ArcStep none;
  none.safe = kForever;
  if (!touches_convex(arc) || site.kind == SiteKind::point) return none;
  if (site.kind == SiteKind::segment)
    return against_segment(arc, site, path, s, t, band, relative, bounds, window);
  // A wider arc in a hollow comes nearest at an end of one of the two, and ends are vertex samples: only
  // a tighter one touches it with its inside.
  ArcStep outer = none, inner = none;
  if (touches_convex(site)) outer = against_arc(arc, site, false, path, s, t, band, relative, bounds, window);
  if (touches_concave(site) && arc.arc_radius < site.arc_radius)
    inner = against_arc(arc, site, true, path, s, t, band, relative, bounds, window);
  // What is told is the nearer of the two ways that count; the step must be safe for both.
  ArcStep& first = outer.active && (!inner.active || outer.gap <= inner.gap) ? outer
                   : inner.active                                            ? inner
                                                                             : outer;
  first.safe = std::min(outer.safe, inner.safe);
  return first;
}

}  // namespace brink
