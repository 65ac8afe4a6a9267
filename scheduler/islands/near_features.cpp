#include "brink/scheduler/islands/near_features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/scheduler/islands/arc_ends.h"
#include "brink/scheduler/islands/corner_sides.h"
#include "brink/scheduler/islands/outline_half.h"
#include "brink/scheduler/islands/tolerances.h"
#include "brink/scheduler/islands/wire_side.h"

namespace brink::islands {

namespace {

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

/// True if the sample is clear of the other's box, a quick look.
/// False says little: the box may be near where the outline is not.
bool out_of_reach(const Half& half, const Sample& sample, double reach) {
  // a container is solid beyond its bounds: nothing is clear of it there
  if (half.other.container) return false;
  const Vec2 q = half.other_frame.to_local(half.carrier_frame.to_world(sample.p));
  return !half.other.bounds.grown(reach + sample.radius).contains(q);
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

}  // namespace

}  // namespace brink::islands

namespace brink {

bool go_on_smoothly(const Site& one, const Site& other) {
  const auto meet_at = [&](const Vec2& end) { return islands::joins_smoothly(end, one, other); };
  return ((one.a == other.a || one.a == other.b) && meet_at(one.a)) ||
         ((one.b == other.a || one.b == other.b) && meet_at(one.b));
}

OutlineAt::OutlineAt(const Outline& of, const ExtendedState& state)
    : outline(&of),
      position(state.position),
      of_angle(sine_cosine(state.seen_from(Vec2::Zero()).pose.angle)) {}

std::vector<NearFeature> near_features(const Outline& a, const ExtendedState& state_a, const Outline& b,
                                       const ExtendedState& state_b, double reach, double tolerance) {
  using namespace islands;
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
  using namespace islands;
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
