#include "brink/scheduler/islands/near_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/scheduler/islands/tolerances.h"
#include "brink/scheduler/resolve/wedge.h"

namespace brink {

namespace {

/// One outline that carries the samples, and the other, each in its own frame.
/// Features of a half are told with normals from b into a all the same: `on_a` says which way to turn them.
struct Half {
  const Outline& carrier;
  const Outline& other;
  Frame carrier_frame, other_frame;  ///< from b's position
  bool on_a;
};

/// The sample's corner as it lies in the other's frame.
Wedge wedge_of(const Half& half, const Sample& sample) {
  return turned(wedge_at(half.carrier, sample.p), [&](const Vec2& d) {
    return half.other_frame.direction_to_local(half.carrier_frame.direction_to_world(d));
  });
}

/// The middle of what carries the samples, in the other's frame: a site's own frame may be anywhere.
Vec2 centre(const Half& half) {
  return half.other_frame.to_local(half.carrier_frame.to_world(half.carrier.bounds.center()));
}

/// Of a segment of a solid: to its right.
Vec2 outward(const Site& site) {
  const Vec2 d = site.b - site.a;
  return Vec2(d.y(), -d.x()) / d.norm();
}

/// True if the way from the site to q has a direction: it is longer than `least`.
bool has_direction(const Nearest& nearest, const Vec2& q, double least) {
  return (q - nearest.point).norm() > least;
}

/// Out of the site, in its frame; where the two points are one, the site's own normal.
Vec2 direction(const Site& site, const Nearest& nearest, const Vec2& q, double least) {
  const Vec2 way = q - nearest.point;
  const bool told = has_direction(nearest, q, least);
  if (told && nearest.foot == Foot::interior && site.kind == SiteKind::segment) {
    const Vec2 d = site.b - site.a;  // its own normal: that of a short way has lost digits
    return perp(d) * ((cross(d, q - site.a) < 0.0 ? -1.0 : 1.0) / d.norm());
  }
  if (told) return way.normalized();
  // of a solid outwards; of a wire, right upon its end, one of the two
  if (site.kind == SiteKind::segment && (site.solid || nearest.foot != Foot::interior)) return outward(site);
  if (site.solid && nearest.foot != Foot::interior)
    return (nearest.foot == Foot::start ? site.pseudo_a : site.pseudo_b).normalized();
  return normal_at(site, nearest, q);
}

/// True if what is nearest to an end of a solid's straight side is inside the solid: in a hollow corner, a rounding
/// beyond the other side. How far it is from this side is for this side's own normal to say.
bool is_beyond_hollow_end(const Site& site, const Nearest& nearest, double side) {
  return side < 0.0 && site.solid && site.kind == SiteKind::segment && nearest.foot != Foot::interior;
}

/// The end of a site that is nearer to q.
const Vec2& nearer_end(const Site& site, const Vec2& q) {
  return (q - site.a).squaredNorm() < (q - site.b).squaredNorm() ? site.a : site.b;
}

/// How far q is beyond the ends of a straight site, along it [m].
double beyond_ends(const Site& site, const Vec2& q) {
  const Vec2 d = site.b - site.a;
  const double length = d.norm(), along = d.dot(q - site.a) / length;
  return std::max({0.0, -along, along - length});
}

/// How far a curve leads to either side of a line.
struct Sides {
  double least = std::numeric_limits<double>::infinity(), most = -least;

  void see(double height) {
    least = std::min(least, height);
    most = std::max(most, height);
  }
  /// To one side alone, and by more than `told`.
  bool tells(double told) const { return !(most > told && -least > told) && std::max(most, -least) > told; }
};

/// Sees the height of places along `walked` from an end of it, as far as they are abreast of `beside`. Both map from a
/// site's frame: to where it lies beside `beside`, and to its height.
template <class ToBeside, class Height>
void walk(const Site& walked, bool from_start, const Site& beside, ToBeside&& to_beside, Height&& height,
          Sides& sides) {
  constexpr int kHalvings = 20;
  double part = std::ldexp(1.0, -kHalvings);
  for (int k = 0; k <= kHalvings; ++k, part *= 2.0) {
    const Vec2 p = point_along(walked, from_start ? part : 1.0 - part);
    if (nearest_on(beside, to_beside(p)).foot != Foot::interior) return;
    sides.see(height(p));
  }
}

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

/// On which side of a wire's site a carrier lies.
struct SideOfWire {
  bool before = true;  ///< on that to which a normal points
  SideTold told = SideTold::surely;
};

/// Whether the carrier lies on the side of a wire's site to which `out` points, as told from its vertex at q, `height` on
/// that side of a place of the site: by whichever of the vertex and its edges, as far as they are abreast of the site, is
/// farthest from there, as no edge crosses a wire. A rod that comes to lie flat leads from its upper end down to the wire;
/// round the end of the site an edge may lead anywhere. Where its edges lie along the wire, the wire tells, by where it leads
/// from the site's ends; where nothing does the little that edges lead away; and where they do not, or lead to both sides, the
/// carrier's centre.
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
  if (flush && of_edges.tells(kOneCorner * half.carrier.bounding_radius))
    return {by_edges(), SideTold::hardly};
  const double of_centre = above_at(centre(half));
  return {of_centre >= 0.0, std::abs(of_centre) > told ? SideTold::hardly : SideTold::not_at_all};
}

/// True of q, abreast of the site, on the other side of it than that to which `out` points from `at`, about there on the
/// site. A wire's arc has no inside: of that the side is the one of its circle on which q was.
bool is_behind(const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& out, const Vec2& at) {
  if (site.kind == SiteKind::segment) return out.dot(q - nearest.point) < 0.0;
  if (site.kind == SiteKind::point || site.solid) return side_of(site, nearest, q) < 0.0;
  const bool was_outside = out.dot(at - site.center) > 0.0;
  return ((q - site.center).norm() > site.arc_radius) != was_outside;
}

/// The direction in which a site leads away from that end of it.
Vec2 leads_from(const Vec2& end, const Site& site) {
  return site.a == end ? direction_at_start(site) : Vec2(-direction_at_end(site));
}

/// True if the two, which share that end, go on into each other there.
bool joins_smoothly(const Vec2& end, const Site& one, const Site& other) {
  return leads_from(end, one).dot(leads_from(end, other)) <= -1.0 + kSmoothJoint;
}

/// True if what is nearest is an end of the site from which no other goes on smoothly.
bool ends_at(const Outline& outline, const Site& site, const Nearest& nearest) {
  if (site.kind == SiteKind::point || nearest.foot == Foot::interior) return false;
  const Vec2& end = nearest.foot == Foot::start ? site.a : site.b;
  return std::none_of(outline.sites.begin(), outline.sites.end(), [&](const Site& s) {
    return &s != &site && s.kind != SiteKind::point && (s.a == end || s.b == end) &&
           joins_smoothly(end, site, s);
  });
}

double before_next_side(const Half& half, const Sample& sample, const Site& site, const Vec2& q, double upon);

/// Where an end of an arc lies beside a site of the other.
struct ArcEnd {
  Vec2 q;  ///< in the other's frame
  Nearest nearest;
  double gap = 0.0;  ///< [m]
};

/// The end of a carrier's arc beyond which the direction `towards` points, in the carrier's frame. `out`: to which side of the
/// site, as seen from `at` there, counts as before it.
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

/// To where an arc whose centre is at q would have to face for it to lie on the site, in the carrier's frame: `towards` its
/// nearest place, which is across it; beyond an end of a straight one, across its line.
Vec2 facing(const Half& half, const Site& site, const Nearest& nearest, const Vec2& q, const Vec2& towards) {
  if (site.kind != SiteKind::segment || nearest.foot == Foot::interior) return towards;
  const Vec2 across = perp(site.b - site.a);
  const Vec2 way = across.dot(q - site.a) > 0.0 ? Vec2(-across) : across;
  return half.carrier_frame.direction_to_local(half.other_frame.direction_to_world(way)).normalized();
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

/// The feature of an arc's sample i that looks past site j, if by no more than may be turned in a step: the end of it there, which
/// has a feature of its own, and stands here for the arc that may come to lie on the site. Not of what is behind the site; nor of
/// a wire's arc whose hollow holds the end of one.
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

/// The feature of a sample beyond an end from which another side goes on straight is that of the line, on the side of it on which
/// the sample is, or its owner. Right upon the end it lies on this side as well as on the next.
void put_on_line(const Half& half, const Sample& sample, const Site& site, const Vec2& q, NearFeature& f) {
  const double upon = kOneCorner * (half.carrier.bounding_radius + half.other.bounding_radius);
  Vec2 n = outward(site);
  double height = n.dot(q - site.a);
  const double centred = n.dot(centre(half) - site.a);
  const bool behind = std::abs(height) <= upon ? centred < 0.0 : height < 0.0;
  if (f.thin && std::abs(height) <= upon)
    f.side_told = std::abs(centred) <= kAlongLine * half.carrier.bounding_radius ? SideTold::not_at_all
                                                                                 : SideTold::hardly;
  if (!site.solid && behind) {
    n = -n;
    height = -height;
  }
  const Vec2 world = half.other_frame.direction_to_world(n);
  f.gap = height - site.radius - sample.radius;
  f.normal = half.on_a ? world : Vec2(-world);
  f.point = half.other_frame.to_world(q - (height - site.radius) * n);
  if (beyond_ends(site, q) <= upon) f.at_end = f.goes_on = false;
}

/// Sample i of a half against site j, where it is nearest to it; side: see side_of(). Nothing of an arc that
/// looks elsewhere.
std::optional<NearFeature> feature(const Half& half, int i, int j, const Nearest& nearest, double side,
                                   const Vec2& q, double reach) {
  const Sample& sample = half.carrier.samples[i];
  const Site& site = half.other.sites[j];
  // below this length the way from the core to q has no direction
  const double least = kOnePoint * (half.carrier.bounding_radius + half.other.bounding_radius);
  Vec2 out = direction(site, nearest, q, least);
  // the way from the core leads inwards where q lies inside; what stands in for too short a way leads
  // outwards
  if (side < 0.0 && has_direction(nearest, q, least)) out = -out;
  const bool thin = !site.solid && site.radius + sample.radius == 0.0;
  double distance = side * nearest.distance;
  if (is_beyond_hollow_end(site, nearest, side)) {
    out = outward(site);
    distance = out.dot(q - nearest.point);
  }
  // abreast of the wire by the body's size; at an end only where the way has no direction
  SideTold told = SideTold::surely;
  const double no_side =
      nearest.foot == Foot::interior ? kSunkOfRadius * half.carrier.bounding_radius : least;
  if (thin && site.kind != SiteKind::point && nearest.distance < no_side) {
    // a wire has no inside that would tell: what has sunk by a rounding, or is right on its end, is on the side of its
    // own edges
    const SideOfWire side_of_it = side_of_wire(half, sample, site, q, out, out.dot(q - nearest.point));
    told = side_of_it.told;
    if (!side_of_it.before) out = -out;
    distance = out.dot(q - nearest.point);
  }
  const Vec2 outward = half.other_frame.direction_to_world(out);
  // An arc's sample speaks for its convex side: for what lies in its sector, and not nearer than its
  // circle.
  if (sample.arc_site >= 0) {
    const Vec2 towards = half.carrier_frame.direction_to_local(-outward);
    const Site& arc = half.carrier.sites[sample.arc_site];
    // a wire's other side is outside as well: what is a little nearer touches it from there, but where a side or an arc is
    // nearest between its ends: what lies to both sides of that place is farther, and would be through the arc
    const bool from_outside = arc.solid || (site.kind != SiteKind::point && nearest.foot == Foot::interior);
    const double sunk =
        from_outside ? kSunkOfRadius * half.carrier.bounding_radius : kOnePoint * arc.arc_radius;
    if (nearest.distance < arc.arc_radius - sunk && in_sector(arc, towards)) return std::nullopt;
    if (!in_sector(arc, towards)) return beside_arc(half, i, j, q, towards, side, nearest, reach);
  }
  NearFeature f;
  f.sample = i;
  f.site = j;
  f.sample_on_a = half.on_a;
  // an arc's sample has its circle's radius in its own, so this is the gap of the arc, too
  f.gap = distance - site.radius - sample.radius;
  f.point = half.other_frame.to_world(nearest.point + site.radius * out);
  f.normal = half.on_a ? outward : Vec2(-outward);
  f.thin = thin;
  f.side_told = told;
  // right on the joint of two wires it may be at the ends of both, and passes by neither; not so who is farther off, and
  // that beyond the end
  const double beyond =
      thin && site.kind == SiteKind::segment ? beyond_ends(site, q) : std::numeric_limits<double>::infinity();
  const bool on_end = beyond <= least && (nearest.distance <= least || beyond <= kBeside * nearest.distance);
  f.at_end = site.kind != SiteKind::point && nearest.foot != Foot::interior && !on_end;
  f.goes_on = nearest.foot == Foot::start ? site.straight_a : nearest.foot == Foot::end && site.straight_b;
  if (f.goes_on) put_on_line(half, sample, site, q, f);
  return f;
}

/// True if the nearest point of site j is an end of it, and another site that has that end, too, is nearer: the two
/// make no corner there. A site that rises from there to q's side is a wall ahead, and one that goes on straight may be come to
/// within a step.
bool goes_on_nearer(const Half& half, const Sample& sample, std::size_t j,
                    const std::vector<Nearest>& nearest, const Vec2& q, double tie) {
  const Outline& outline = half.other;
  const Site& site = outline.sites[j];
  if (site.kind == SiteKind::point || nearest[j].foot == Foot::interior) return false;
  const bool at_start = nearest[j].foot == Foot::start;
  if (at_start ? site.straight_a : site.straight_b) return false;
  const Vec2 &end = at_start ? site.a : site.b, on = at_start ? Vec2(site.b - site.a) : Vec2(site.a - site.b);
  const auto rises = [&](std::size_t k) {
    const Site& other = outline.sites[k];
    const bool sided = other.solid && other.kind == SiteKind::segment;  // wherever roundings put q
    return (sided ? outward(other) : direction(other, nearest[k], q, tie)).dot(on) >
           kStraightJoint * on.norm();
  };
  // over the joint with an arc q may come within a step, and be as near as this site bends away from the end
  const auto bends = [&](std::size_t k) {
    return site.kind == SiteKind::arc || outline.sites[k].kind == SiteKind::arc;
  };
  // an arc's centre may be near to what the arc does not face, or has around it
  const auto is_faced = [&](std::size_t k) {
    if (sample.arc_site < 0) return true;
    const Site& arc = half.carrier.sites[sample.arc_site];
    const Vec2 way = half.other_frame.direction_to_world(nearest[k].point - q);
    return nearest[k].distance > arc.arc_radius - kSunkOfRadius * half.carrier.bounding_radius &&
           in_sector(arc, half.carrier_frame.direction_to_local(way));
  };
  // nor does what rolls stay on the one where the two make a low hump
  const auto rolls_over = [&](std::size_t k) {
    return sample.arc_site >= 0 && site.solid && site.kind == SiteKind::segment &&
           outward(site).dot(direction(outline.sites[k], nearest[k], q, tie)) > kOverHump;
  };
  for (std::size_t k = 0; k < nearest.size(); ++k)
    if (k != j && nearest[k].distance < nearest[j].distance - tie &&
        (outline.sites[k].a == end || outline.sites[k].b == end) && !bends(k) && !rises(k) && is_faced(k) &&
        !rolls_over(k))
      return true;
  return false;
}

/// Of a site that goes on smoothly, in a hollow, from one that is as near to q, with an arc on either side of the joint: its
/// normal at that end, on the side of the sample's owner. What comes over the joint in a step meets that, not the end as a
/// point; so does what has sunk by roundings.
std::optional<Vec2> normal_over_joint(const Half& half, const Sample& sample, std::size_t j,
                                      const std::vector<Nearest>& nearest, const Vec2& q, double tie) {
  const Outline& outline = half.other;
  const Site& site = outline.sites[j];
  if (site.kind == SiteKind::point || nearest[j].foot == Foot::interior) return std::nullopt;
  const bool at_start = nearest[j].foot == Foot::start;
  const Vec2& end = at_start ? site.a : site.b;
  const double sunk = kSunkOfRadius * half.carrier.bounding_radius;
  for (std::size_t k = 0; k < nearest.size(); ++k) {
    const Site& other = outline.sites[k];
    if (k == j || other.kind == SiteKind::point || (other.a != end && other.b != end)) continue;
    if (site.kind != SiteKind::arc && other.kind != SiteKind::arc) continue;
    if (!joins_smoothly(end, site, other)) continue;
    // to the right of the site: out of a solid; of a wire it is on the side where the sample is, or was
    Vec2 n = perp(leads_from(end, site)) * (at_start ? -1.0 : 1.0);
    double above = nearest[k].distance;
    if (site.solid) {
      above *= side_of(other, nearest[k], q);
    } else if (above < sunk) {
      if (!side_of_wire(half, sample, other, q, n, n.dot(q - end)).before) n = -n;
      above = n.dot(q - nearest[k].point);
    } else if (n.dot(direction(other, nearest[k], q, tie)) < 0.0) {
      n = -n;
    }
    // over a hump the tangent would be nearer than the site
    if (above > -sunk && n.dot(q - end) >= above - tie) return n;
  }
  return std::nullopt;
}

/// How far q is before the other side at the nearer end of a straight side of a solid, where the two have a convex corner [m];
/// below 0: it is not. At an acute corner what is beside the one is abreast of the other, and behind its line. Upon the other's
/// line, to `upon` [m], roundings say nothing: it is before it if the sample's edges are, or else the two are in each other.
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

/// True of a corner before a straight side of a solid, right at the end of that, to `upon` [m], if it lies upon the next side from
/// there on: whichever of the two roundings have put above the other, it goes over the end.
bool goes_over(const Half& half, const Sample& sample, const Site& site, const Nearest& nearest,
               const Vec2& q, double upon) {
  if (!site.solid || site.kind != SiteKind::segment || !half.carrier.solid || nearest.foot != Foot::interior)
    return false;
  const Vec2& end = nearer_end(site, q);
  return sample.radius + site.radius == 0.0 && (nearest.point - end).norm() <= upon &&
         before_next_side(half, sample, site, q, upon) >= 0.0;
}

/// Where a sample lies that is upon a corner of a solid; either_side: it may go on along this one as well as along the other.
enum class OnCorner { nowhere, this_side, other_side, either_side };

/// Of a sample upon an end of site j, a straight side of a solid, where it has a convex corner with another: on that of
/// the two that parts it from the corner; if neither does, on that which faces the sample's owner more. Corner on corner, each
/// lies on the face below it.
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
    // a tie goes to the site that comes first, so that exactly one of the two has the sample
    if (more > 0.0 || (more == 0.0 && k < j)) return OnCorner::other_side;
    where = OnCorner::this_side;
  }
  return where;
}

/// True if the straight side j of a solid has a hollow corner with another at that end.
bool has_hollow_corner(const Outline& outline, std::size_t j, const Vec2& end) {
  return std::any_of(outline.sites.begin(), outline.sites.end(), [&](const Site& next) {
    if (&next == &outline.sites[j] || next.kind != SiteKind::segment || (next.a != end && next.b != end))
      return false;
    const Vec2 on = next.a == end ? Vec2(next.b - next.a) : Vec2(next.a - next.b);
    return outward(outline.sites[j]).dot(on) > kStraightJoint * on.norm();
  });
}

/// True if sample i, upon the line beyond an end of site j, parts from the corner there by no other of its sides: behind site
/// j the two overlap, be it by a strip of no width (a box right upon another that is as wide).
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

/// The feature of a sample that comes over a smooth joint is that of the tangent there.
void put_on_tangent(const Half& half, const Vec2& q, const Vec2& normal, NearFeature& f) {
  const Site& site = half.other.sites[f.site];
  const Vec2& end = nearer_end(site, q);
  const double height = normal.dot(q - end), radius = half.carrier.samples[f.sample].radius;
  const Vec2 world = half.other_frame.direction_to_world(normal);
  f.gap = height - site.radius - radius;
  f.normal = half.on_a ? world : Vec2(-world);
  f.point = half.other_frame.to_world(q - (height - site.radius) * normal);
  f.over_joint = true;
}

/// Of a sample beside an end of a straight side of a solid: its feature is that of the side's line.
void put_before_line(const Half& half, const Vec2& q, NearFeature& f) {
  const Site& site = half.other.sites[f.site];
  const Vec2 out = outward(site), world = half.other_frame.direction_to_world(out);
  f.gap = out.dot(q - nearer_end(site, q)) - site.radius - half.carrier.samples[f.sample].radius;
  f.normal = half.on_a ? world : Vec2(-world);
}

/// The feature of a sample upon the corner is that of the side on which it lies.
void turn_outward(const Half& half, const Vec2& q, double side, NearFeature& f) {
  const double gap = f.gap;
  put_before_line(half, q, f);
  if (side >= 0.0) f.gap = gap;
}

/// Where a sample lies that is upon an end of a wire's site, or upon its corner with others.
struct OnWire {
  OnCorner where = OnCorner::nowhere;
  Vec2 normal = Vec2::Zero();  ///< of this side, towards the sample's owner
};

/// True of two corners at one place if the edges of the one lie between those of the other.
bool is_within(const Wedge& inner, const Wedge& outer) {
  if (inner.edges.size() != 2 || outer.edges.size() != 2) return false;
  const Vec2 &from = outer.edges[0], &to = outer.edges[1];
  const double turn = cross(from, to) > 0.0 ? 1.0 : -1.0;
  return std::all_of(inner.edges.begin(), inner.edges.end(), [&](const Vec2& e) {
    return turn * cross(from, e) >= -kAlongLine && turn * cross(e, to) >= -kAlongLine &&
           e.dot(from + to) > 0.0;
  });
}

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

/// Of a vertex upon an end of site j of a wire: on that of its sides that parts the two there, if one does. On another site's
/// if one of those does, and none of this: round a corner the vertex meets it no more than a free end. In a hollow corner
/// none parts the two, and each site counts as elsewhere; but the hollow itself meets no side of the corner that is in it.
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
  const bool elsewhere = by_another || (!half.carrier.solid && is_hollow);
  return {elsewhere ? OnCorner::other_side : OnCorner::nowhere, Vec2::Zero()};
}

/// The feature of a vertex upon an end of a wire's site is that of the side on which it lies.
void turn_to_side(const Half& half, const Vec2& q, const Vec2& normal, NearFeature& f) {
  const Site& site = half.other.sites[f.site];
  const Vec2& end = nearer_end(site, q);
  const Vec2 world = half.other_frame.direction_to_world(normal);
  f.gap = normal.dot(q - end);
  f.normal = half.on_a ? world : Vec2(-world);
  f.upon_corner = true;
}

/// Of a sample outside a solid, and behind the end of a piece: which way is out of that piece as the sample sees it, if it may come over
/// the hump to it, a smooth joint or a low corner. `above`: the way from what is nearest. Not of what lies round the outline.
std::optional<Vec2> out_over_hump(const Site& site, const Nearest& nearest, const Vec2& q,
                                  const Vec2& above) {
  if (!site.solid || site.kind == SiteKind::point || nearest.foot == Foot::interior) return std::nullopt;
  if (site.kind == SiteKind::arc && site.sweep < 0.0) return std::nullopt;
  const Vec2 out = site.kind == SiteKind::arc ? Vec2((q - site.center).normalized()) : outward(site);
  return out.dot(above) > kOverHump ? std::optional<Vec2>(out) : std::nullopt;
}

/// The feature of a sample that may come over a hump to the site: that of the circle or line of which the site is a part. Nearer than
/// that it is not, and what it meets until then is another piece.
NearFeature feature_over_hump(const Half& half, int i, std::size_t j, const Vec2& q, const Vec2& out) {
  const Site& site = half.other.sites[j];
  const double height =
      site.kind == SiteKind::arc ? (q - site.center).norm() - site.arc_radius : out.dot(q - site.a);
  const Vec2 world = half.other_frame.direction_to_world(out);
  NearFeature f;
  f.sample = i;
  f.site = static_cast<int>(j);
  f.sample_on_a = half.on_a;
  f.gap = height - site.radius - half.carrier.samples[i].radius;
  f.point = half.other_frame.to_world(q - (height - site.radius) * out);
  f.normal = half.on_a ? world : Vec2(-world);
  f.at_end = f.goes_on = f.over_hump = true;
  return f;
}

/// Adds the features of sample i: sites that face it; and where it lies inside by roundings, those that are
/// nearest. What it is merely behind, beyond a tip, is none.
/// Per site, in this order: upon a corner only the side that faces the owner counts, whatever the distances
/// say; then what is merely behind is left out; then an end at which a joined site is nearer. The corner
/// comes first: there the two sides differ in distance by next to nothing. `bends`: the other has an arc.
void add_features(const Half& half, int i, double reach, double tolerance, bool bends,
                  std::vector<NearFeature>& found) {
  const Vec2 q = half.other_frame.to_local(half.carrier_frame.to_world(half.carrier.samples[i].p));
  const double size = half.carrier.bounding_radius + half.other.bounding_radius;
  const double tie = kOnePoint * size, corner = std::max(kOneCorner * size, kCornerOfTolerance * tolerance);
  std::vector<Nearest> nearest;
  double least = std::numeric_limits<double>::infinity(), least_clear = least;
  std::size_t first = 0;  // that is nearest
  nearest.reserve(half.other.sites.size());
  const auto clear = [&](std::size_t j) {
    return nearest[j].distance - half.other.sites[j].radius - half.carrier.samples[i].radius;
  };
  for (const Site& site : half.other.sites) {
    nearest.push_back(nearest_on(site, q));
    if (nearest.back().distance < least) first = nearest.size() - 1;
    least = std::min(least, nearest.back().distance);
    least_clear = std::min(least_clear, clear(nearest.size() - 1));
  }
  // So far off no gap is within reach, but for what is behind, and tangents over joints with what is not so far.
  const double far_off = reach + corner + kSunkOfRadius * half.carrier.bounding_radius;
  bool outside = false;
  for (std::size_t j = 0; j < nearest.size(); ++j)
    // Outside if any of the nearest says so: at a convex corner a sample beside one face lies behind the
    // other.
    outside =
        outside || (nearest[j].distance <= least + tie && side_of(half.other.sites[j], nearest[j], q) > 0.0);
  if (outside && least_clear > far_off) return;
  const bool bare = half.carrier.samples[i].arc_site < 0;
  const auto is_far = [&](std::size_t j) {
    return nearest[j].distance > std::max(least + tie, corner) && clear(j) > far_off;
  };
  std::vector<std::size_t> near;
  for (std::size_t j = 0; bends && j < nearest.size(); ++j)
    if (!is_far(j)) near.push_back(j);
  // out of what is nearest
  const auto above = [&] {
    const Site& site = half.other.sites[first];
    const Vec2 way = direction(site, nearest[first], q, tie);
    const bool sunk = side_of(site, nearest[first], q) < 0.0 && has_direction(nearest[first], q, tie);
    return sunk ? Vec2(-way) : way;
  };
  const auto joins_near = [&](std::size_t j) {
    const Site& site = half.other.sites[j];
    const Vec2& end = nearest[j].foot == Foot::start ? site.a : site.b;
    return nearest[j].foot != Foot::interior && std::any_of(near.begin(), near.end(), [&](std::size_t k) {
             return half.other.sites[k].a == end || half.other.sites[k].b == end;
           });
  };
  for (std::size_t j = 0; j < nearest.size(); ++j) {
    if (half.other.sites[j].covered || (is_far(j) && !joins_near(j))) continue;
    const double side = side_of(half.other.sites[j], nearest[j], q);
    const OnCorner where = bare ? on_corner(half, half.carrier.samples[i], j, q, corner) : OnCorner::nowhere;
    const OnWire upon = bare ? on_wire(half, half.carrier.samples[i], j, q, kOneCorner * size) : OnWire{};
    if (where == OnCorner::other_side || upon.where == OnCorner::other_side) continue;
    const auto over =
        bare ? normal_over_joint(half, half.carrier.samples[i], j, nearest, q, tie) : std::nullopt;
    if (where == OnCorner::nowhere && !over) {
      // Behind a site and not on it: a feature only if the sample is inside the solid, and then of the
      // sites that are nearest, as those are what it sank through; in a hollow corner through both its sides, and
      // not through both as far.
      const bool sunk_here =
          nearest[j].distance <= least + tie ||
          (nearest[j].distance <= corner && half.other.sites[j].kind == SiteKind::segment &&
           has_hollow_corner(half.other, j, nearer_end(half.other.sites[j], q)));
      if (side < 0.0 && nearest[j].distance > tie && (outside || !sunk_here)) {
        // also of one that has sunk by what contacts may
        if (bare && (outside || least <= corner) && clear(j) <= reach)
          if (const auto out = out_over_hump(half.other.sites[j], nearest[j], q, above()))
            if (const NearFeature f = feature_over_hump(half, i, j, q, *out); f.gap <= reach)
              found.push_back(f);
        continue;
      }
      if (goes_on_nearer(half, half.carrier.samples[i], j, nearest, q, tie)) continue;
    }
    auto f = feature(half, i, static_cast<int>(j), nearest[j], side, q, reach);
    if (f && where != OnCorner::nowhere) {
      turn_outward(half, q, side, *f);
      f->upon_corner = where == OnCorner::this_side;
      f->at_end = f->at_end || where == OnCorner::either_side;
    }
    if (f && over)
      put_on_tangent(half, q, *over, *f);
    else if (f && upon.where == OnCorner::this_side)
      turn_to_side(half, q, upon.normal, *f);
    // also of one that is still on its way there
    const Site& site = half.other.sites[j];
    const bool flush = bare && site.solid && site.kind == SiteKind::segment &&
                       (where != OnCorner::nowhere || nearest[j].foot != Foot::interior) &&
                       beyond_ends(site, q) <= corner;
    if (f && flush && has_no_way_by(half, i, j, q)) {
      f->no_way_by = true;
      // as deep as it is behind the side's line, or before it, however far along that the end is
      put_before_line(half, q, *f);
    }
    if (f && bare && goes_over(half, half.carrier.samples[i], site, nearest[j], q, corner)) f->at_end = true;
    const bool far =
        f && f->goes_on && nearest[j].distance - site.radius - half.carrier.samples[i].radius > reach;
    if (!f || f->gap > reach || far) continue;
    f->one_corner = corner;
    found.push_back(*f);
  }
}

/// Both outlines as carrier and as other, in frames that are seen from b's position.
/// Differences of places are taken in extended precision, before they are rounded to doubles.
std::array<Half, 2> halves(const OutlineAt& a, const OutlineAt& b) {
  const Frame of_a((a.position - b.position).cast<double>(), a.of_angle), of_b(Vec2::Zero(), b.of_angle);
  return {Half{*a.outline, *b.outline, of_a, of_b, true}, Half{*b.outline, *a.outline, of_b, of_a, false}};
}

/// True if the sample is clear of the other's box, a quick look.
/// False says little: the box may be near where the outline is not.
bool out_of_reach(const Half& half, const Sample& sample, double reach) {
  // a container is solid beyond its bounds: nothing is clear of it there
  if (half.other.container) return false;
  const Vec2 q = half.other_frame.to_local(half.carrier_frame.to_world(sample.p));
  return !half.other.bounds.grown(reach + sample.radius).contains(q);
}

/// True of q that is nearest to an end which two pieces of a wire share, beyond both, and that a sample on the side to
/// which `out` points can come to only through the two: it was in their hollow corner.
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

/// True of a bare sample where an arc and the next piece go on into each other, of a wire or in a solid's hollow: all that
/// meets the outline there meets the two up to their ends. The point alone has no side of its own.
bool is_smooth_joint(const Outline& outline, const Sample& sample) {
  if (sample.arc_site >= 0) return false;
  const Site* first = nullptr;
  for (const Site& s : outline.sites) {
    if (s.kind == SiteKind::point || (s.a != sample.p && s.b != sample.p)) continue;
    // of a solid, which lies to the left, an arc that turns right is hollow
    if (outline.solid && !(s.kind == SiteKind::arc && s.sweep < 0.0)) return false;
    if (first && (first->kind == SiteKind::arc || s.kind == SiteKind::arc))
      return joins_smoothly(sample.p, *first, s);
    first = &s;
  }
  return false;
}

/// True if the two segments have a point in common that is inside both.
bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 && cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

double distance_to(const Site& segment, const Vec2& q) { return nearest_on(segment, q).distance; }

/// How deep two convex corners are in each other of which neither vertex is in the other solid [m]: their sides cross
/// beside both. Or two corners of wires, or of a wire and a solid, one vertex of which has gone through a side of the other at its
/// corner. 0: they are not. The site's corner is the one at the end that is nearer to the sample at q.
double through_corner(const Half& half, const Sample& sample, const Site& site, const Vec2& q) {
  const bool straight = site.kind == SiteKind::segment && sample.radius + site.radius == 0.0;
  if (!straight || sample.arc_site >= 0) return 0.0;
  const Vec2& corner = nearer_end(site, q);
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
      through = true;
      // each two by whichever end: those that lie along each other may cross at their other ones, by a rounding
      back = std::max(back, std::min({distance_to(o, from), distance_to(o, to), distance_to(there, o.a),
                                      distance_to(there, o.b)}));
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

}  // namespace

bool go_on_smoothly(const Site& one, const Site& other) {
  const auto meet_at = [&](const Vec2& end) { return joins_smoothly(end, one, other); };
  return ((one.a == other.a || one.a == other.b) && meet_at(one.a)) ||
         ((one.b == other.a || one.b == other.b) && meet_at(one.b));
}

OutlineAt::OutlineAt(const Outline& of, const ExtendedState& state)
    : outline(&of),
      position(state.position),
      of_angle(sine_cosine(state.seen_from(Vec2::Zero()).pose.angle)) {}

std::vector<NearFeature> near_features(const Outline& a, const ExtendedState& state_a, const Outline& b,
                                       const ExtendedState& state_b, double reach, double tolerance) {
  std::vector<NearFeature> found;
  for (const Half& half : halves({a, state_a}, {b, state_b})) {
    // a disc's centre sees all that its surface meets: what the other's samples see is the same once more
    const bool both = half.carrier.is_point() && half.other.is_point();
    if (half.other.is_point() && !(both && half.on_a)) continue;
    const bool bends = std::any_of(half.other.sites.begin(), half.other.sites.end(),
                                   [](const Site& s) { return s.kind == SiteKind::arc; });
    for (int i = 0; i < static_cast<int>(half.carrier.samples.size()); ++i)
      if (const Sample& s = half.carrier.samples[i];
          !s.hollow && !out_of_reach(half, s, reach) && !is_smooth_joint(half.carrier, s))
        add_features(half, i, reach, tolerance, bends, found);
  }
  return found;
}

/// Unlike near_features() it looks for no other site or side: the feature is followed wherever it goes.
/// Abreast of the site the gap is negative once the sample is through; beyond an end it is positive again, but where
/// two corners have passed through each other.
double gap_of(const NearFeature& f, const OutlineAt& a, const OutlineAt& b) {
  const Half half = halves(a, b)[f.sample_on_a ? 0 : 1];
  const Sample& sample = half.carrier.samples[f.sample];
  const Site& site = half.other.sites[f.site];
  const Vec2 q = half.other_frame.to_local(half.carrier_frame.to_world(sample.p));
  const Nearest nearest = nearest_on(site, q);
  // A wire's side, and a solid's too, is the one on which the sample was. Where that was beyond an end, the way from there
  // to it tells no side: what goes round the end comes to be abreast from either. Upon a corner the side has been chosen.
  const bool side_is_known = !f.at_end || f.upon_corner || !site.solid || site.kind != SiteKind::segment;
  const Vec2 out = side_is_known ? half.other_frame.direction_to_local(half.on_a ? f.normal : Vec2(-f.normal))
                                 : outward(site);
  if (sample.arc_site >= 0) {
    // its circle counts where it is that of the arc
    const Site& arc = half.carrier.sites[sample.arc_site];
    const Vec2 towards =
        half.carrier_frame.direction_to_local(half.other_frame.direction_to_world(nearest.point - q));
    if (!in_sector(arc, towards))
      return end_beside(half, arc, facing(half, site, nearest, q, towards), site, out,
                        half.other_frame.to_local(f.point))
          .gap;
  }
  // Beyond a free end nothing is crossed. Where there is no way by, roundings do not make one.
  const bool abreast =
      nearest.foot == Foot::interior || (f.no_way_by && beyond_ends(site, q) <= f.one_corner);
  const bool crossed = abreast ? is_behind(site, nearest, q, out, nearest.point)
                               : f.thin && is_through_joint(half.other, site, nearest, q, out);
  if (!side_is_known && abreast && crossed)
    if (const double before = before_next_side(half, sample, site, q, f.one_corner);
        before >= (f.no_way_by ? f.one_corner : 0.0)) {
      const double through = through_corner(half, sample, site, q);
      return through > 0.0 ? -through : std::min(before, nearest.distance) - site.radius - sample.radius;
    }
  // past the hollow corner at an end, behind the side, is the solid, too
  if (!abreast && site.solid && site.kind == SiteKind::segment &&
      has_hollow_corner(half.other, static_cast<std::size_t>(f.site),
                        nearest.foot == Foot::start ? site.a : site.b))
    if (const double behind_line = outward(site).dot(q - site.a); behind_line < 0.0)
      return behind_line - site.radius - sample.radius;
  if (!abreast && !crossed)
    if (const double through = through_corner(half, sample, site, q); through > 0.0) return -through;
  // beside an end, where there is no way by, the side's line is what counts, however far along that the end is
  const bool beside = abreast && nearest.foot != Foot::interior && site.kind == SiteKind::segment;
  const double before = beside ? out.dot(q - nearest.point) : crossed ? -nearest.distance : nearest.distance;
  return before - site.radius - sample.radius;
}

double gap_of(const NearFeature& f, const Outline& a, const ExtendedState& state_a, const Outline& b,
              const ExtendedState& state_b) {
  return gap_of(f, {a, state_a}, {b, state_b});
}

}  // namespace brink
