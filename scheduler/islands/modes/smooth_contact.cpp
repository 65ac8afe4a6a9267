#include "brink/scheduler/islands/modes/smooth_contact.h"

#include <algorithm>
#include <cmath>

#include "brink/core/shapes/distance.h"
#include "brink/scheduler/islands/outline_half.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

/// Where a contact's parts are and how they move, in world axes.
struct Placing {
  Frame sample_frame, site_frame;
  Vec2 arm;       ///< of the sample's point
  Vec2 rho;       ///< the same point from the site's owner
  Vec2 velocity;  ///< of the sample's point against the site's owner
  double omega_s, omega_t;

  Placing(const SmoothContact& c, const BodyState& s, const BodyState& t)
      : sample_frame(Pose{{0.0, 0.0}, s.pose.angle}),
        site_frame(Pose{{0.0, 0.0}, t.pose.angle}),
        arm(sample_frame.direction_to_world(c.sample)),
        rho(arm + ((s.pose.position - t.pose.position) + c.offset)),
        velocity(s.twist.at(arm) - t.twist.velocity),
        omega_s(s.twist.omega),
        omega_t(t.twist.omega) {}
};

/// Rows of the velocity at the point that touches.
/// With r an arm and n the normal: n.(v + omega x r) = n.v + omega (r x n).
void set_rows(ContactRates& r) {
  const Vec2 t = perp(r.normal);
  r.normal_on_sample = Vec3(r.normal.x(), r.normal.y(), cross(r.arm, r.normal));
  r.normal_on_site = -Vec3(r.normal.x(), r.normal.y(), cross(r.site_arm, r.normal));
  r.tangent_on_sample = Vec3(t.x(), t.y(), cross(r.arm, t));
  r.tangent_on_site = -Vec3(t.x(), t.y(), cross(r.site_arm, t));
}

/// Second derivative: the place from T in T's turning frame has rho'' - alpha_T x rho - 2 omega_T x w +
/// omega_T^2 rho, with rho'' = a_S - a_T + alpha_S x arm - omega_S^2 arm. What holds accelerations is in
/// the rows, the others are the bend.
void look_at_line(const SmoothContact& c, const Placing& at, ContactRates& r) {
  r.normal = at.site_frame.direction_to_world(c.normal);
  const Vec2 t = perp(r.normal);
  r.gap = c.normal.dot(at.site_frame.direction_to_local(at.rho) - c.place) - c.radius - c.sample_radius;
  const Vec2 w = at.velocity - cross(at.omega_t, at.rho);
  r.normal_velocity = r.normal.dot(w);
  // of the points that touch: the sample's surface is at -radius n from its point
  r.tangential_velocity = t.dot(w) - c.sample_radius * (at.omega_s - at.omega_t);
  const Vec2 bend =
      -at.omega_s * at.omega_s * at.arm - 2.0 * cross(at.omega_t, w) + at.omega_t * at.omega_t * at.rho;
  r.normal_bend = r.normal.dot(bend);
  r.tangential_bend = t.dot(bend);
}

/// The centre takes the place of the line: its own acceleration has -omega_T^2 centre, and the normal
/// turns with the way from it.
void look_at_circle(const SmoothContact& c, const Placing& at, ContactRates& r) {
  const double side = c.hollow ? -1.0 : 1.0;
  const Vec2 centre = at.site_frame.direction_to_world(c.place), way = at.rho - centre;
  const double distance = way.norm();
  // for a hollow circle the normal leads to the centre, so the way is side * distance * normal for both
  r.normal = distance > 0.0 ? Vec2(side / distance * way) : Vec2::UnitX();
  const Vec2 t = perp(r.normal);
  r.gap = side * (distance - c.radius) - c.sample_radius;
  const Vec2 u = at.velocity - cross(at.omega_t, centre);
  // The sample's material point moves against its centre with -radius omega_S along t, the site's against
  // the circle's centre with lever omega_T: their difference is v_t.
  const double lever = side * distance - c.sample_radius;  // from the centre to the point that touches
  const double along = t.dot(u), turn = distance > 0.0 ? side * along / distance : 0.0;  // of the normal
  r.normal_velocity = r.normal.dot(u);
  r.tangential_velocity = along - c.sample_radius * at.omega_s - lever * at.omega_t;
  const Vec2 bend = -at.omega_s * at.omega_s * at.arm + at.omega_t * at.omega_t * centre;
  // d(n.u)/dt = n.u' + n'.u with n' = turn t, so that n'.u = turn * along
  r.normal_bend = r.normal.dot(bend) + turn * along;
  // the second part is the rates of t and of the lever: none while the contact stays closed
  r.tangential_bend = t.dot(bend) - r.normal_velocity * (turn + at.omega_t);
}

/// The least of how far the sample's point is inside the site's range, and the touching direction inside the
/// sample's own sector [m].
double range_of(const SmoothContact& c, const Placing& at, const Vec2& normal) {
  const Vec2 q = at.site_frame.direction_to_local(at.rho);
  const Vec2 to_site = at.sample_frame.direction_to_local(-normal);
  double within = std::min(c.range[0].within(q), c.range[1].within(q));
  for (const HalfPlane& edge : c.sector)
    // a direction, times the radius: how far the touching point is inside [m]
    if (!edge.inward.isZero(0.0)) within = std::min(within, c.sample_radius * edge.within(to_site));
  return within;
}

/// A sample that is no farther than this part of an arc's radius from it is upon it.
constexpr double kUponArc = 1e-9;

/// What lies from the place on in that direction (unit).
HalfPlane beyond(const Vec2& place, const Vec2& direction) { return {direction, direction.dot(place)}; }

/// Between two directions from an arc's centre, in the order in which it is travelled.
std::array<HalfPlane, 2> sector_of(const Site& arc, const Vec2& from) {
  // Two half planes bound it, as an arc is at most a quarter turn.
  const double turn = arc.sweep > 0.0 ? 1.0 : -1.0;
  return {beyond(from, turn * perp((arc.a - arc.center).normalized())),
          beyond(from, -turn * perp((arc.b - arc.center).normalized()))};
}

/// The straight or round interior of a site; q: the sample's point, out: the normal, both in its frame.
SmoothContact interior_of(SmoothContact c, const Site& site, const Vec2& q, const Vec2& out) {
  if (site.kind == SiteKind::segment) {
    const Vec2 d = (site.b - site.a).normalized();
    const bool right = site.solid || perp(d).dot(out) < 0.0;  // a solid lies to the left
    c.kind = SmoothContact::Kind::line;
    c.place = site.a;
    c.normal = right ? Vec2(-perp(d)) : perp(d);
    c.radius = site.radius;
    c.range = {beyond(site.a, d), beyond(site.b, -d)};
    return c;
  }
  c.kind = SmoothContact::Kind::circle;
  c.place = site.center;
  // A solid lies to the left, so an arc that turns clockwise has its free side towards the centre. A wire
  // is free on both: the side is the one on which the sample is, and right upon it the one to which the normal points.
  const Vec2 way = q - site.center;
  const double inside = site.arc_radius - way.norm();
  const bool upon = std::abs(inside) <= kUponArc * site.arc_radius;
  c.hollow = site.solid ? site.sweep < 0.0 : upon ? way.dot(out) < 0.0 : inside > 0.0;
  // the thickness lies on both sides of the core
  c.radius = site.arc_radius + (c.hollow ? -site.radius : site.radius);
  c.range = sector_of(site, site.center);
  return c;
}

/// One end of it, or a point.
SmoothContact end_of(SmoothContact c, const Site& site, bool start, const Vec2& q) {
  c.kind = SmoothContact::Kind::circle;
  // a circle of no more than the site's thickness about the end
  c.place = start ? site.a : site.b;
  c.radius = site.radius;
  if (site.kind == SiteKind::segment) {
    const Vec2 d = (site.b - site.a).normalized();
    // beyond the end, where the interior no longer has the nearest point
    c.range[0] = beyond(c.place, start ? Vec2(-d) : d);
  } else if (site.kind == SiteKind::arc) {  // as long as the sample's point is outside the sector
    const HalfPlane edge = sector_of(site, site.center)[start ? 0 : 1];
    // a q inside this edge is over the arc or beyond its other edge: then nothing bounds the range of
    // this end
    if (edge.within(q) < 0.0) c.range[0] = {-edge.inward, -edge.least};
  }
  return c;
}

/// True of a sample beside an end of a straight site for which the side's line goes on there, as far as the two corners lie on each
/// other: there is no way by; or it is right at the end, and the side has been told; or both are round there, whichever side of the end
/// itself roundings have put it.
bool goes_on_beyond_end(const NearFeature& f, const Sample& sample, const Site& site, const Vec2& q) {
  if (site.kind != SiteKind::segment) return false;
  if (f.no_way_by || (f.upon_corner && !f.at_end)) return true;
  const bool is_round = sample.radius + site.radius > 0.0;
  return is_round && nearest_on(site, q).foot != Foot::interior &&
         islands::beyond_ends(site, q) <= f.one_corner;
}

/// The shapes of a site, the present one first.
std::vector<SmoothContact> shapes_of(const SmoothContact& sample, const Site& site, const Vec2& q,
                                     const Vec2& out) {
  if (site.kind == SiteKind::point) return {end_of(sample, site, true, q)};
  const Foot foot = nearest_on(site, q).foot;
  const SmoothContact interior = interior_of(sample, site, q, out), start = end_of(sample, site, true, q),
                      end = end_of(sample, site, false, q);
  if (foot == Foot::interior) return {interior, start, end};
  if (foot == Foot::start) return {start, interior, end};
  return {end, interior, start};
}

}  // namespace

ContactRates rates_of(const SmoothContact& c, const BodyState& sample_owner, const BodyState& site_owner) {
  const Placing at(c, sample_owner, site_owner);
  ContactRates r;
  c.kind == SmoothContact::Kind::line ? look_at_line(c, at, r) : look_at_circle(c, at, r);
  r.arm = at.arm - c.sample_radius * r.normal;
  r.site_arm = at.rho - c.sample_radius * r.normal;
  set_rows(r);
  r.within = range_of(c, at, r.normal);
  return r;
}

std::vector<SmoothContact> smooth_contacts(const NearFeature& f, const Outline& a,
                                           const ExtendedState& state_a, const Outline& b,
                                           const ExtendedState& state_b) {
  const Outline &carrier = f.sample_on_a ? a : b, &other = f.sample_on_a ? b : a;
  const ExtendedState &s = f.sample_on_a ? state_a : state_b, &t = f.sample_on_a ? state_b : state_a;
  const Sample& sample = carrier.samples[f.sample];
  ExtendedState from = s;
  from.position -= t.position;
  // both seen from the site's owner, in extended precision: far from the origin nothing of the gap is lost
  const Frame site_frame(Pose{{0.0, 0.0}, t.seen_from(Vec2::Zero()).pose.angle});
  const Vec2 q = site_frame.to_local(Frame(from.seen_from(Vec2::Zero()).pose).to_world(sample.p));
  const Vec2 out = site_frame.direction_to_local(f.sample_on_a ? f.normal : Vec2(-f.normal));
  SmoothContact c;
  c.sample = sample.p;
  c.sample_radius = sample.radius;
  if (sample.arc_site >= 0) c.sector = sector_of(carrier.sites[sample.arc_site], Vec2::Zero());
  const Site& site = other.sites[f.site];
  std::vector<SmoothContact> shapes = shapes_of(c, site, q, out);
  if (goes_on_beyond_end(f, sample, site, q)) {
    const bool at_start = (q - site.a).squaredNorm() < (q - site.b).squaredNorm();
    SmoothContact line = interior_of(c, site, q, out);
    line.range[at_start ? 0 : 1].least -= 2.0 * f.one_corner;
    // what is round rolls over the end of its own accord
    shapes = sample.radius + site.radius > 0.0 && !f.no_way_by
                 ? std::vector{line, end_of(c, site, at_start, q)}
                 : std::vector{line};
  }
  const SmoothContact& first = shapes.front();
  const double size = carrier.bounding_radius + other.bounding_radius;
  // of two points it is not asked for: nobody meets them
  const bool round = first.kind == SmoothContact::Kind::circle && first.radius + first.sample_radius > 0.0;
  // right at the centre the normal has no direction, and the gap's bend no bound
  if (round && !((q - first.place).norm() > kAtCentre * size)) shapes.clear();
  return shapes;
}

}  // namespace brink
