#include "brink/scheduler/islands/arc_ends.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/core/shapes/curve_site.h"
#include "brink/scheduler/islands/corner_sides.h"
#include "brink/scheduler/islands/tolerances.h"
#include "brink/scheduler/islands/wire_side.h"

namespace brink::islands {

namespace {

/// True if the site's end that is nearest to an arc's centre lies in the arc's hollow; of one on the arc, if the site leads
/// inwards from there, or nothing tells.
bool lies_within(const Half& half, const Site& arc, const Site& site, const Nearest& nearest) {
  const double sunk = kSunkOfRadius * half.carrier.bounding_radius, above = nearest.distance - arc.arc_radius;
  if (std::abs(above) > sunk) return above < 0.0;
  const auto to_carrier = [&](const Vec2& p) {
    return half.carrier_frame.to_local(half.other_frame.to_world(p));
  };
  Sides sides;
  const auto height = [&](const Vec2& p) { return (to_carrier(p) - arc.center).norm() - arc.arc_radius; };
  walk(site, nearest.foot == Foot::start, arc, to_carrier, height, sides);
  return !(sides.tells(sunk) && sides.most > -sides.least);
}

/// True if the site leads into the arc's circle: by the one of its ends that is farther from that.
bool leads_within(const Half& half, const Site& arc, const Site& site) {
  const auto above = [&](const Vec2& p) {
    return (half.carrier_frame.to_local(half.other_frame.to_world(p)) - arc.center).norm() - arc.arc_radius;
  };
  const double a = above(site.a), b = above(site.b);
  return (std::abs(a) > std::abs(b) ? a : b) < 0.0;
}

/// True if the site's curve leads so deep through the circle of a solid's arc, centred at q, that no turn of a step makes the
/// arc's end, which it passes, a place where the arc lies on it from outside.
bool cuts_circle(const Site& arc, const Site& site, const Vec2& q) {
  if (!arc.solid || site.kind != SiteKind::arc) return false;
  const double r = arc.arc_radius, to_centre = (q - site.center).norm(),
               of_site = site.arc_radius + (to_centre > site.arc_radius ? site.radius : -site.radius),
               turn = 2.0 * of_site * r * std::cos(kTurnedInStep), squares = of_site * of_site + r * r;
  return to_centre > of_site ? to_centre < std::sqrt(squares + turn)
                             : to_centre > std::sqrt(std::max(0.0, squares - turn));
}

}  // namespace

ArcEnd end_beside(const Half& half, const Site& arc, const Vec2& towards, const Site& site, const Vec2& out,
                  const Vec2& at) {
  const Vec2 middle = 0.5 * (arc.a + arc.b) - arc.center;
  const Vec2& end = (cross(middle, towards) > 0.0) == (arc.sweep > 0.0) ? arc.b : arc.a;
  const Vec2 q = half.other_frame.to_local(half.carrier_frame.to_world(end));
  const Nearest nearest = nearest_on(site, q);
  const bool behind =
      site.kind != SiteKind::point && nearest.foot == Foot::interior && is_behind(site, nearest, q, out, at);
  if (!behind) return {q, nearest, nearest.distance - site.radius - arc.radius};
  // behind this side it may be before the next one, as a tip is that comes round a corner: it is as far off as that corner
  Sample tip;
  tip.p = end;
  tip.radius = arc.radius;
  const double before = site.solid && site.kind == SiteKind::segment
                            ? before_next_side(half, tip, site, q, 0.0)
                            : -std::numeric_limits<double>::infinity();
  const double off = before >= 0.0 ? (q - nearer_end(site, q)).norm() : -nearest.distance;
  return {q, nearest, off - site.radius - arc.radius};
}

Vec2 facing(const Half& half, const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& towards) {
  if (site.kind != SiteKind::segment || nearest.foot == Foot::interior) return towards;
  const Vec2 across = perp(site.b - site.a);
  const Vec2 way = across.dot(q - site.a) > 0.0 ? Vec2(-across) : across;
  return half.carrier_frame.direction_to_local(half.other_frame.direction_to_world(way)).normalized();
}

std::optional<NearFeature> beside_arc(const Half& half, int i, int j, const Vec2& q, const Vec2& way,
                                      double side, const Nearest& nearest, double reach) {
  const Site &arc = half.carrier.sites[half.carrier.samples[i].arc_site], &site = half.other.sites[j];
  const Vec2 middle = 0.5 * (arc.a + arc.b) - arc.center, towards = facing(half, site, nearest, q, way);
  const double off =
      std::abs(std::atan2(cross(middle, towards), middle.dot(towards))) - 0.5 * std::abs(arc.sweep);
  // where two arcs lie in each other the way from the one's centre to the other's turns by more than they do
  const double swings = site.kind == SiteKind::arc ? reach / (q - site.center).norm() : 0.0;
  if (side < 0.0 || off > kTurnedInStep + swings || cuts_circle(arc, site, q)) return std::nullopt;
  const Vec2 out = half.other_frame.direction_to_local(half.carrier_frame.direction_to_world(-towards));
  const ArcEnd end = end_beside(half, arc, towards, site, out, nearest.point);
  // of a straight site the arc is before what its end is abreast of, wherever that ends
  const bool before = site.kind == SiteKind::segment && end.nearest.foot == Foot::interior;
  // an arc in the hollow of a wider one may come to lie on that, wherever the wider one's end is
  const bool nests = site.kind == SiteKind::arc && (q - site.center).norm() < site.arc_radius &&
                     arc.arc_radius < site.arc_radius;
  const bool within = !arc.solid && !before && !nests && ends_at(half.other, site, nearest) &&
                      lies_within(half, arc, site, nearest);
  if (within) return std::nullopt;
  // who is sunk into a wire's arc from its hollow is on that side of it
  const bool sunk_from_within = end.gap < 0.0 && !arc.solid && leads_within(half, arc, site);
  if (end.gap < -kSunkOfRadius * half.carrier.bounding_radius || sunk_from_within) return std::nullopt;
  NearFeature f;
  f.sample = i;
  f.site = j;
  f.sample_on_a = half.on_a;
  f.gap = end.gap;
  const double least = kOnePoint * (half.carrier.bounding_radius + half.other.bounding_radius);
  const Vec2 away = has_direction(end.nearest, end.q, least) && end.gap > -site.radius - arc.radius
                        ? direction(site, end.nearest, end.q, least)
                        : out;
  f.point = half.other_frame.to_world(end.nearest.point + site.radius * away);
  const Vec2 outward = half.other_frame.direction_to_world(away);
  f.normal = half.on_a ? outward : Vec2(-outward);
  f.beside_arc = true;
  return f;
}

}  // namespace brink::islands
