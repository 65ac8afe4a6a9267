#include "brink/core/shapes/outline.h"

#include <algorithm>
#include <map>
#include <numbers>

#include "brink/core/base/elementary.h"
#include "brink/core/base/error.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

/// How faults name a site: by its place in the outline, from 0.
std::string name_of(int k) { return "outline: site " + std::to_string(k); }

/// @throws BadInput on an arc whose numbers contradict each other, or that turns by more than a site may.
void check_arc(const Site& s, int k) {
  if (!(s.center.allFinite() && std::isfinite(s.arc_radius) && s.arc_radius > 0.0))
    throw BadInput(name_of(k) + " is an arc of radius " + text(s.arc_radius) + "; it must be > 0 and finite");
  // 1e-15: what add_arc() has split may be a rounding of its own more
  if (!(std::abs(s.sweep) > 0.0 && std::abs(s.sweep) <= kMostArcSweep * (1 + 1e-15)))
    throw BadInput(name_of(k) + " turns by " + text(s.sweep) +
                   " rad; an arc site turns by at most a quarter turn");
  if (!is_arc_fit(s))
    throw BadInput(name_of(k) + " is an arc whose ends lie " + text(arc_misfit(s)) + " m off its circle");
}

/// @throws BadInput on a site to which no distance can be told.
void check_site(const Site& s, int k) {
  if (!(s.a.allFinite() && s.b.allFinite()))
    throw BadInput(name_of(k) + " runs from " + text(s.a) + " to " + text(s.b) +
                   "; coordinates must be finite");
  if (!(std::isfinite(s.radius) && s.radius >= 0.0))
    throw BadInput(name_of(k) + " has radius " + text(s.radius) + "; it must be >= 0 and finite");
  if (s.kind == SiteKind::point) return;
  if (!((s.b - s.a).squaredNorm() > 0.0))
    throw BadInput(name_of(k) + " at " + text(s.a) + " has no length (too small to square counts as none)");
  if (s.kind == SiteKind::arc) check_arc(s, k);
}

/// @throws BadInput if the loop does not begin at `expected_first`, where the one before has ended, or does not
/// join up.
void check_loop(const Outline& outline, const Loop& loop, int expected_first) {
  const auto& sites = outline.sites;
  if (loop.first != expected_first || loop.count < 1 ||
      loop.first + loop.count > static_cast<int>(sites.size()))
    throw BadInput("outline: a loop covers sites " + std::to_string(loop.first) + " .. " +
                   std::to_string(loop.first + loop.count - 1) + "; loops must cover all sites in order");
  for (int k = loop.first; k + 1 < loop.first + loop.count; ++k)
    // bit for bit: what two neighbours compute from their common vertex is then the same
    if (sites[k].b != sites[k + 1].a)
      throw BadInput(name_of(k) + " ends at " + text(sites[k].b) + " but the next starts at " +
                     text(sites[k + 1].a));
  const Vec2 &start = sites[loop.first].a, &end = sites[loop.first + loop.count - 1].b;
  if (loop.closed && start != end)
    throw BadInput("outline: a closed loop starts at " + text(start) + " but ends at " + text(end));
  if (outline.solid && !loop.closed)
    throw BadInput("outline: a solid outline has an open chain from " + text(start) + " to " + text(end));
}

/// Sites one by one, then how they make loops, then what a solid asks besides.
void check(const Outline& outline) {
  for (std::size_t k = 0; k < outline.sites.size(); ++k) check_site(outline.sites[k], static_cast<int>(k));
  int next = 0;
  for (const Loop& loop : outline.loops) {
    check_loop(outline, loop, next);
    next += loop.count;
  }
  if (next != static_cast<int>(outline.sites.size()) || next == 0)
    throw BadInput("outline: loops cover " + std::to_string(next) + " of " +
                   std::to_string(outline.sites.size()) +
                   " sites; there must be at least one, and each must be in a loop");
  if (!outline.solid) return;
  for (const Site& s : outline.sites)
    // gap_by_brute_force() takes the site of the least distance - radius; inside, the nearest surface
    // is that of the least distance + radius, which is sure to be the same site if radii are equal
    if (s.kind == SiteKind::point || s.radius != outline.sites[0].radius)
      throw BadInput("outline: the sites of a solid must be segments and arcs that share one radius");
}

/// Outward pseudo-normal where `in` hands over to `out`. At a cusp the two normals cancel; what is left of
/// the limit is the tangent, outward at a needle's tip and inward at the end of a slot, which the curvatures
/// tell apart.
Vec2 pseudo_normal(const Site& in, const Site& out) {
  const Vec2 arrive = direction_at_end(in), leave = direction_at_start(out);
  const Vec2 sum = -perp(arrive) - perp(leave);
  // |sum| is about the angle between the two sides of a tip [rad]
  if (sum.norm() > 1e-9) return sum;
  // with x along `arrive`, `in` is y = k_in x^2 / 2 and `out` is y = -k_out x^2 / 2 behind the vertex, to
  // second order. The solid is above `in` and below `out`: the needle between them where k_in + k_out < 0
  const bool slot = curvature(in) + curvature(out) > 0.0;
  return slot ? leave : arrive;
}

/// @pre every loop is closed: the last site hands over to the first.
void set_pseudo_normals(Outline& outline) {
  for (const Loop& loop : outline.loops)
    for (int k = 0; k < loop.count; ++k) {
      Site& in = outline.sites[loop.first + k];
      Site& out = outline.sites[loop.first + (k + 1) % loop.count];
      in.pseudo_b = out.pseudo_a = pseudo_normal(in, out);
    }
}

/// The boundary turns right there by more than roundings make of a straight joint, and the solid is to its left.
/// kStraight is in [rad]: the cross product of unit vectors is the sine of the turn.
bool is_notch(const Site& before, const Site& after) {
  constexpr double kStraight = 1e-9;
  return cross(direction_at_end(before), direction_at_start(after)) < -kStraight;
}

/// Notes straight joints, at sites and samples. Not where more than two sites meet.
void note_straight_joints(Outline& outline) {
  std::map<std::pair<double, double>, int> ends;  // at each straight joint; most outlines have none
  const auto each_joint = [&](auto&& visit) {
    for (const Loop& loop : outline.loops)
      for (int k = 0; k + (loop.closed ? 0 : 1) < loop.count; ++k)
        if (Site& in = outline.sites[loop.first + k], &out = outline.sites[loop.first + (k + 1) % loop.count];
            &in != &out && go_on_straight(in, out))
          visit(in, out);
  };
  each_joint([&](const Site&, const Site& out) { ends[{out.a.x(), out.a.y()}] = 0; });
  if (ends.empty()) return;
  for (const Site& s : outline.sites)
    for (const Vec2& end : {s.a, s.b})
      if (const auto joint = ends.find({end.x(), end.y()}); joint != ends.end()) ++joint->second;
  const auto is_joint = [&](const Vec2& p) {
    const auto joint = ends.find({p.x(), p.y()});
    return joint != ends.end() && joint->second == 2;
  };
  each_joint([&](Site& in, Site& out) { in.straight_b = out.straight_a = is_joint(out.a); });
  for (Sample& s : outline.samples)
    if (s.arc_site < 0 && is_joint(s.p)) s.hollow = true;
}

/// One sample a corner: where a union pinches, each of the corners that meet there has its own.
void add_corner_samples(Outline& outline, const Loop& loop) {
  for (int k = 0; k < loop.count; ++k) {
    const Site& after = outline.sites[loop.first + k];
    const int before = loop.first + (k + loop.count - 1) % loop.count;
    outline.samples.push_back({after.a, std::max(after.radius, outline.sites[before].radius), -1, before,
                               loop.first + k, is_notch(outline.sites[before], after)});
  }
}

/// One sample a vertex of a wire, however often it comes back to it, in order of first meeting.
void add_vertex_samples(Outline& outline, const Loop& loop) {
  // by place: sites that meet there share it bit for bit, and the thickest of them counts
  std::map<std::pair<double, double>, std::size_t> known;
  const auto add = [&](const Vec2& p, double radius) {
    const auto [place, is_new] = known.try_emplace({p.x(), p.y()}, outline.samples.size());
    if (is_new)
      outline.samples.push_back({p, radius, -1});
    else
      outline.samples[place->second].radius = std::max(outline.samples[place->second].radius, radius);
  };
  for (int k = loop.first; k < loop.first + loop.count; ++k) {
    add(outline.sites[k].a, outline.sites[k].radius);
    if (!loop.closed) add(outline.sites[k].b, outline.sites[k].radius);
  }
}

/// One sample an arc that can be touched from its convex side. Of a solid that is an arc that turns to the left.
void add_arc_samples(Outline& outline, const Loop& loop) {
  for (int k = loop.first; k < loop.first + loop.count; ++k) {
    const Site& s = outline.sites[k];
    const bool convex_side_is_free = !s.solid || s.sweep > 0.0;
    if (s.kind == SiteKind::arc && convex_side_is_free)
      outline.samples.push_back({s.center, s.arc_radius + s.radius, k});
  }
}

/// The loop keeps its place among the sites. Pseudo-normals are unset afterwards: finish_outline() is to follow.
void reverse_loop(std::vector<Site>& sites, const Loop& loop) {
  std::reverse(sites.begin() + loop.first, sites.begin() + loop.first + loop.count);
  for (int k = loop.first; k < loop.first + loop.count; ++k) sites[k] = reversed(sites[k]);
}

/// Outward normals of the sides; none if the outline is anything but one convex polygon.
std::vector<Vec2> facets_of(const Outline& outline) {
  if (!outline.solid || outline.container || outline.loops.size() != 1) return {};
  std::vector<Vec2> facets;
  double turned = 0.0;
  for (std::size_t k = 0; k < outline.sites.size(); ++k) {
    const Site &site = outline.sites[k], &next = outline.sites[(k + 1) % outline.sites.size()];
    if (site.kind != SiteKind::segment || next.kind != SiteKind::segment) return {};
    const Vec2 along = site.b - site.a, then = next.b - next.a;
    // a straight joint is allowed: it leaves the polygon convex
    if (!(cross(along, then) >= 0.0)) return {};
    turned += angle_of(cross(along, then), along.dot(then));
    facets.push_back(-perp(along).normalized());
  }
  // a pentagram turns left at every vertex too, but its normals go twice round
  constexpr double once_round = 6.283185307179586;
  return turned < 1.5 * once_round ? facets : std::vector<Vec2>{};
}

}  // namespace

void finish_outline(Outline& outline) {
  // All that is derived is made anew, so that it can be called again after sites have moved.
  // first: what follows relies on loops that join up and on sites with a length
  check(outline);
  outline.samples.clear();
  outline.bounds = Box();
  outline.bounding_radius = outline.magnitude = 0.0;
  for (Site& s : outline.sites) {
    s.solid = outline.solid;
    s.pseudo_a = s.pseudo_b = Vec2::Zero();
    s.straight_a = s.straight_b = s.covered = false;
    outline.bounds.add(core_bounds(s).grown(s.radius));
    outline.bounding_radius = std::max(outline.bounding_radius, farthest_from_origin(s) + s.radius);
    if (s.kind == SiteKind::arc)
      outline.magnitude = std::max(outline.magnitude, s.center.norm() + s.arc_radius);
  }
  outline.magnitude = std::max(outline.magnitude, outline.bounding_radius);
  if (outline.solid) set_pseudo_normals(outline);
  for (const Loop& loop : outline.loops) {
    if (outline.solid)
      add_corner_samples(outline, loop);
    else
      add_vertex_samples(outline, loop);
    add_arc_samples(outline, loop);
  }
  note_straight_joints(outline);
  outline.hull = outline.container ? Hull() : hull_of(outline.sites);
  outline.facets = facets_of(outline);
}

bool go_on_straight(const Site& in, const Site& out) {
  if (in.kind != SiteKind::segment || out.kind != SiteKind::segment || in.radius != out.radius) return false;
  constexpr double kStraight = 1e-12, kRounding = 4e-16;
  const Vec2 a = in.b - in.a, b = out.b - out.a;
  const double places =
      kRounding * (in.a.lpNorm<1>() + in.b.lpNorm<1>() + out.a.lpNorm<1>() + out.b.lpNorm<1>());
  return a.dot(b) > 0.0 &&
         std::abs(cross(a, b)) <= kStraight * a.norm() * b.norm() + places * (a.norm() + b.norm());
}

double side_of_outline(const Outline& outline, const Site& site, const Nearest& nearest, const Vec2& q) {
  if (site.solid && is_beyond(outline, nearest.distance)) return outline.container ? -1.0 : 1.0;
  return side_of(site, nearest, q);
}

double gap_by_brute_force(const Outline& outline, const Vec2& q, int* site) {
  double least = std::numeric_limits<double>::infinity();
  int nearest_site = 0;
  Nearest nearest;
  for (std::size_t k = 0; k < outline.sites.size(); ++k) {
    const Nearest n = nearest_on(outline.sites[k], q);
    const double unsigned_gap = n.distance - outline.sites[k].radius;
    // without signs: a side that is not the nearest may be seen from behind by a q that is outside.
    // The first counts as it is: of a q too far to have a distance all are equally near
    if (k > 0 && !(unsigned_gap < least)) continue;
    least = unsigned_gap;
    nearest_site = static_cast<int>(k);
    nearest = n;
  }
  if (site) *site = nearest_site;
  const Site& s = outline.sites[nearest_site];
  // inside a thick solid the surface is the radius beyond the core: there both count negative
  return side_of_outline(outline, s, nearest, q) * nearest.distance - s.radius;
}

/// The end is looked for where the sweep takes the start: being on the circle somewhere is not enough.
double arc_misfit(const Site& s) {
  return std::max(std::abs((s.a - s.center).norm() - s.arc_radius), (point_along(s, 1.0) - s.b).norm());
}

bool is_arc_fit(const Site& s) { return arc_misfit(s) <= 1e-9 * (s.arc_radius + s.center.norm()); }

Outline as_container(Outline outline) {
  if (!outline.solid)
    throw BadInput("container: the outline has no inside; it must be a solid shape with closed loops");
  if (outline.container) throw BadInput("container: the outline is one already");
  // travelled the other way, the solid on the left is what was free
  for (const Loop& loop : outline.loops) reverse_loop(outline.sites, loop);
  outline.container = true;
  finish_outline(outline);
  return outline;
}

Outline transformed(const Outline& outline, const Pose& pose) {
  const Frame frame(pose);
  Outline moved = outline;
  // a vertex that two sites share is moved twice by the same arithmetic: they still join bit for bit
  for (Site& s : moved.sites) {
    s.a = frame.to_world(s.a);
    s.b = frame.to_world(s.b);
    // radius and sweep are the same after a rigid motion
    if (s.kind == SiteKind::arc) s.center = frame.to_world(s.center);
  }
  finish_outline(moved);
  return moved;
}

}  // namespace brink
