#include "brink/scheduler/islands/wire_side.h"

#include <algorithm>

#include "brink/core/shapes/distance.h"
#include "brink/scheduler/islands/tolerances.h"
#include "brink/scheduler/resolve/wedge.h"

namespace brink::islands {

namespace {

/// Sees where the wire leads, to which `out` points, from those ends of a straight site that lie between the ends of an edge
/// of the carrier, `off` from both: the edge, which goes on beyond, lies on the other side.
void see_wire(const Half& half, const Site& edge, const Site& site, const Vec2& out, double off,
              Sides& sides) {
  const auto to_carrier = [&](const Vec2& p) {
    return half.carrier_frame.to_local(half.other_frame.to_world(p));
  };
  for (const Vec2& end : {site.a, site.b}) {
    const Vec2 beside = nearest_on(edge, to_carrier(end)).point;
    if (std::min((beside - edge.a).norm(), (beside - edge.b).norm()) < off) continue;
    for (const Site& next : half.other.sites)
      if (&next != &site && next.kind != SiteKind::point && (next.a == end || next.b == end))
        walk(
            next, next.a == end, edge, to_carrier, [&](const Vec2& p) { return out.dot(p - end); }, sides);
  }
}

/// True of two corners at one place if all edges of the one lie between the two of the other, or beyond them by no more than
/// `beyond` (sine).
bool lie_between(const Wedge& inner, const Wedge& outer, double beyond) {
  if (outer.edges.size() != 2) return false;
  const Vec2 &from = outer.edges[0], &to = outer.edges[1];
  const double turn = cross(from, to) > 0.0 ? 1.0 : -1.0;
  return std::all_of(inner.edges.begin(), inner.edges.end(), [&](const Vec2& e) {
    return turn * cross(from, e) >= -beyond && turn * cross(e, to) >= -beyond && e.dot(from + to) > 0.0;
  });
}

/// Of two corners, each of two edges.
bool is_within(const Wedge& inner, const Wedge& outer) {
  return inner.edges.size() == 2 && lie_between(inner, outer, kAlongLine);
}

/// Sine: an arc's end may lead across what the arc lies along.
constexpr double kAlong = 1e-4;

/// True if one of the sample's edges leads to the side to which n points: edges that all lie along its line tell none, nor does an
/// arc that bends back before it is farther there than roundings.
bool leads_before(const Half& half, const Sample& sample, const Vec2& n, double rounding) {
  const Vec2 to = half.carrier_frame.direction_to_local(half.other_frame.direction_to_world(n));
  return std::any_of(half.carrier.sites.begin(), half.carrier.sites.end(), [&](const Site& edge) {
    if (edge.kind == SiteKind::point || (edge.a != sample.p && edge.b != sample.p)) return false;
    const double rise = to.dot(leads_from(sample.p, edge));
    const bool bends_back = edge.kind == SiteKind::arc && to.dot(edge.center - sample.p) < 0.0;
    return rise > kAlongLine && (!bends_back || 0.5 * rise * rise * edge.arc_radius > rounding);
  });
}

}  // namespace

SideOfWire side_of_wire(const Half& half, const Sample& sample, const Site& site, const Vec2& q,
                        const Vec2& out, double height) {
  const double told = kAlongLine * half.carrier.bounding_radius;
  const auto to_other = [&](const Vec2& p) {
    return half.other_frame.to_local(half.carrier_frame.to_world(p));
  };
  // of an arc's site the way to its circle: an edge that lies in its hollow, or has it in its own, is on one side of the
  // circle, whichever side of the tangent it leads to
  const auto above_at = [&](const Vec2& p) {
    if (site.kind == SiteKind::segment) return height + out.dot(p - q);
    const double beyond = beyond_circle(site, p, p - site.center);
    return out.dot(q - site.center) > 0.0 ? beyond : -beyond;
  };
  const auto above = [&](const Vec2& p) { return above_at(to_other(p)); };
  Sides of_edges, of_wire;
  for (const Site& edge : half.carrier.sites) {
    if (edge.kind == SiteKind::point || (edge.a != sample.p && edge.b != sample.p)) continue;
    walk(edge, edge.a == sample.p, site, to_other, above, of_edges);
    if (edge.kind == SiteKind::segment && site.kind == SiteKind::segment)
      see_wire(half, edge, site, out, told, of_wire);
  }
  const bool both_sides = of_edges.most > told && -of_edges.least > told;
  const bool flush = of_edges.least <= of_edges.most && !both_sides;
  of_edges.see(height);
  const auto by_edges = [&] { return of_edges.most > -of_edges.least; };
  if (!both_sides && of_edges.tells(told)) return {by_edges()};
  if (flush && of_wire.tells(told)) return {of_wire.most < -of_wire.least};
  // along an arc the centre is in the hollow, whichever side the edges are on
  const double hardly = site.kind == SiteKind::arc ? 0.0 : kOneCorner * half.carrier.bounding_radius;
  if (flush && of_edges.tells(hardly)) return {by_edges(), SideTold::hardly};
  const double of_centre = above_at(centre(half));
  return {of_centre >= 0.0, std::abs(of_centre) > told ? SideTold::hardly : SideTold::not_at_all};
}

OnWire on_wire(const Half& half, const Sample& sample, std::size_t j, const Vec2& q, double tie) {
  const Site& site = half.other.sites[j];
  if (half.other.solid || site.kind == SiteKind::point || site.radius + sample.radius > 0.0) return {};
  const Vec2& end = nearer_end(site, q);
  if (!((q - end).norm() <= tie)) return {};
  const Wedge of_sample = wedge_of(half, sample);
  if (of_sample.edges.empty()) return {};
  const Wedge of_wire = wedge_at(half.other, end);
  const auto has_before = [&](const Vec2& n) {
    return parts(n, of_sample, of_wire) && leads_before(half, sample, n, tie);
  };
  const Vec2 across = perp(leads_from(end, site));
  for (const Vec2& n : {across, Vec2(-across)})
    if (has_before(n)) return {OnCorner::this_side, n};
  const bool by_another = std::any_of(of_wire.normals.begin(), of_wire.normals.end(), has_before);
  // The corner of a solid fills the hollow that it is in. Of two corners of wire that are as wide, each in the other, either does.
  const bool is_hollow = is_within(of_wire, of_sample) && !is_within(of_sample, of_wire);
  // what only a side of the sample's own corner parts lies on that: it has the contact, if the wire leads away from there
  // what leads between two pieces, or along one, may be in their hollow
  const auto lies_on = [&](const Vec2& n) {
    return parts(-n, of_sample, of_wire) && std::any_of(of_wire.edges.begin(), of_wire.edges.end(),
                                                        [&](const Vec2& e) { return n.dot(e) > kAlong; });
  };
  const bool by_own = !lie_between(of_sample, of_wire, kAlong) &&
                      std::any_of(of_sample.normals.begin(), of_sample.normals.end(), lies_on);
  const bool elsewhere = by_another || by_own || (!half.carrier.solid && is_hollow);
  return {elsewhere ? OnCorner::other_side : OnCorner::nowhere, Vec2::Zero()};
}

void turn_to_side(const Half& half, const Vec2& q, const Vec2& normal, NearFeature& f) {
  const Site& site = half.other.sites[f.site];
  const Vec2& end = nearer_end(site, q);
  const Vec2 world = half.other_frame.direction_to_world(normal);
  f.gap = normal.dot(q - end);
  f.normal = half.on_a ? world : Vec2(-world);
  f.upon_corner = true;
}

bool is_through_joint(const Outline& outline, const Site& site, const Nearest& nearest, const Vec2& q,
                      const Vec2& out) {
  const Vec2& end = nearest.foot == Foot::start ? site.a : site.b;
  const auto ends_there = [&](const Site& s) {
    const Foot foot = nearest_on(s, q).foot;
    return (foot == Foot::start && s.a == end) || (foot == Foot::end && s.b == end);
  };
  return std::any_of(outline.sites.begin(), outline.sites.end(), [&](const Site& s) {
    return &s != &site && s.kind != SiteKind::point && ends_there(s) &&
           out.dot(leads_from(end, site) + leads_from(end, s)) > 0.0;
  });
}

}  // namespace brink::islands
