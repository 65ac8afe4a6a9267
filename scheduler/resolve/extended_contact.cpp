#include "brink/scheduler/resolve/extended_contact.h"

#include <cmath>

#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/resolve/tolerances.h"

namespace brink {

namespace {

/// A centred disc looks the same at any angle.
ExtendedRotation rotation_of(const Outline& o, Real angle) {
  return is_centred_disc(o) ? ExtendedRotation() : ExtendedRotation(angle);
}

/// The normal or its opposite, whichever is on the side of `with`.
RealVec aligned(const RealVec& n, const RealVec& with) { return n.dot(with) < 0 ? RealVec(-n) : n; }

/// Distance from a site's core along the normal, and that normal, which keeps the side of `out`.
struct Away {
  RealVec normal;
  Real distance;
  /// What the normal turns about: a point that the site carries, so far back along it [m]; 0: the normal is as it was
  /// known and stays so. Of a straight side it turns as that does.
  double back = 0.0;
  bool straight = false;
};

/// From a site of the outline that stands at `origin`, turned by `turned`, to the point p; all in the world [m].
/// `out`: the normal that was known, from the site to p. `least`: points no farther apart than this have no
/// direction.
Away away_from(const Site& site, const ExtendedRotation& turned, const RealVec& origin, const RealVec& p,
               const RealVec& out, Real least) {
  const auto place = [&](const Vec2& local) -> RealVec { return origin + turned * local.cast<Real>(); };
  const auto from_point = [&](const Vec2& local) -> Away {
    const RealVec d = p - place(local);
    const Real length = d.norm();
    // Two points in one place have no direction: the contact's stays.
    if (length <= least) return {out, d.dot(out)};
    const RealVec n = aligned(d / length, out);
    const Real along = d.dot(n);
    return {n, along, along.high()};
  };
  // The foot decides: beside the ends an end is the nearest point, between them the line. Whether it is one or the
  // other can be a rounding, so the known normal has the last word.
  if (site.kind == SiteKind::segment) {
    const RealVec a = place(site.a), w = p - a;
    const RealVec d = turned * RealVec(site.b.cast<Real>() - site.a.cast<Real>());
    const Real along = w.dot(d), length2 = d.squaredNorm();
    if (along <= 0) return from_point(site.a);
    if (along >= length2) return from_point(site.b);
    const RealVec n = aligned(extended::perp(d) / sqrt(length2), out);
    // a contact with an end, seen a rounding inside: its normal is not the segment's
    if (n.dot(out) < kSameDirection) return from_point(2 * along <= length2 ? site.a : site.b);
    return {n, n.dot(w), 0.0, true};
  }
  if (site.kind == SiteKind::arc) {
    const RealVec c = place(site.center), w = p - c;
    const RealVec from = place(site.a) - c, to = place(site.b) - c;
    const Real sense = site.sweep > 0 ? 1 : -1, length = w.norm();
    // within the sector: both signs tell, as an arc turns by a quarter at most
    if (sense * extended::cross(from, w) > 0 && sense * extended::cross(w, to) > 0 && length > least) {
      // `n` has the side of `out`, so seen from inside the circle the distance changes its sign with it.
      // Where the two directions differ, an end of the arc is met, to rounding.
      const RealVec radial = w / length, n = aligned(radial, out);
      const Real side = n.dot(radial);
      if (n.dot(out) >= kSameDirection) return {n, side * (length - site.arc_radius), (side * length).high()};
    }
    // beyond the sector, or where an end is met, the nearer end is the site's point
    return (p - place(site.a)).squaredNorm() <= (p - place(site.b)).squaredNorm() ? from_point(site.a)
                                                                                  : from_point(site.b);
  }
  return from_point(site.a);
}

/// Velocity of the body's point that is there [m/s].
Vec2 velocity_at(const ExtendedState& s, const RealVec& p) {
  return s.twist.rounded().at(RealVec(p - s.position).cast<double>());
}

/// Along n, which points into a: > 0 approaching [m/s].
Real closing_speed(const ExtendedState& a, const ExtendedState& b, const RealVec& point, const RealVec& n) {
  return n.dot(b.twist.at(point - b.position) - a.twist.at(point - a.position));
}

}  // namespace

/// The features are given: nothing is looked for. Places and normals are taken from the states; what comes out far
/// from `like` is another part of the outline, and `like` is returned.
ExtendedContact contact_in(const Outline& a, const Outline& b, const ExtendedState& state_a,
                           const ExtendedState& state_b, const FeatureContact& like) {
  const Outline &carrier = like.sample_on_a ? a : b, &other = like.sample_on_a ? b : a;
  const ExtendedState &s = like.sample_on_a ? state_a : state_b, &t = like.sample_on_a ? state_b : state_a;
  const Sample& sample = carrier.samples[like.sample];
  const Site& site = other.sites[like.site];
  const ExtendedContact known{like.point.cast<Real>(), like.normal.cast<Real>(), like.gap,
                              like.closing_speed};
  const RealVec p = s.position + rotation_of(carrier, s.angle) * sample.p.cast<Real>();
  const RealVec out =
      like.sample_on_a ? known.normal : RealVec(-known.normal);  // from the site to the sample
  // how large the numbers are that p is made of: kNoDirection is a part of it
  const Real size = carrier.bounding_radius + std::max(sample.radius, site.radius);
  const Away away = away_from(site, rotation_of(other, t.angle), t.position, p, out, kNoDirection * size);
  ExtendedContact c;
  c.gap = away.distance - site.radius - sample.radius;
  if (abs(c.gap - known.gap) > kNoDirection * size) return known;  // another feature's neighbourhood
  // on the site's surface, from the sample's core
  c.point = p - away.normal * (c.gap + sample.radius);
  c.normal = like.sample_on_a ? away.normal : RealVec(-away.normal);
  c.closing = closing_speed(state_a, state_b, c.point, c.normal);
  // what follows goes into a moment's change alone: doubles will do
  const Vec2 n = away.normal.cast<double>(), of_sample = velocity_at(s, p);
  if (away.straight) {
    c.turn_rate = t.twist.omega.high();
  } else if (away.back != 0.0) {
    const Vec2 of_pivot = velocity_at(t, p - away.normal * away.back);
    c.turn_rate = perp(n).dot(of_sample - of_pivot) / away.back;
  }
  const double arm = (c.gap + sample.radius).high();
  c.point_rate = of_sample - c.turn_rate * arm * perp(n) + c.closing.high() * n;
  return c;
}

}  // namespace brink
