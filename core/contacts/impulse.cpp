#include "brink/core/contacts/impulse.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

/// The contact seen by impulses: relative velocity of the two contact points in (normal, tangent) axes, and the
/// symmetric 2x2 matrix that maps an impulse to its change (the inverse of the effective mass).
struct ContactSpace {
  Vec2 n, t;
  double vn, vt;          ///< relative velocity, body minus other
  double knn, knt, ktt;   ///< velocity change per unit impulse [1/kg]
};

void add_side(ContactSpace& c, const ImpulseSide& side) {
  const double rn = cross(side.arm, c.n), rt = cross(side.arm, c.t);
  const auto dot_m = [&](const Vec2& a, const Vec2& b) {
    return side.inverse_mass_x * a.x() * b.x() + side.inverse_mass_y * a.y() * b.y();
  };
  c.knn += dot_m(c.n, c.n) + side.inverse_inertia * rn * rn;
  c.knt += dot_m(c.n, c.t) + side.inverse_inertia * rn * rt;
  c.ktt += dot_m(c.t, c.t) + side.inverse_inertia * rt * rt;
}

ContactSpace contact_space(const ImpulseSide& body, const ImpulseSide& other, const Vec2& normal) {
  ContactSpace c{normal, perp(normal), 0, 0, 0, 0, 0};
  const Vec2 v = body.twist.at(body.arm) - other.twist.at(other.arm);
  c.vn = v.dot(c.n);
  c.vt = v.dot(c.t);
  add_side(c, body);
  add_side(c, other);
  return c;
}

Twist pushed(const ImpulseSide& side, const Vec2& impulse) {
  return {side.twist.velocity +
              Vec2(side.inverse_mass_x * impulse.x(), side.inverse_mass_y * impulse.y()),
          side.twist.omega + side.inverse_inertia * cross(side.arm, impulse)};
}

ImpulseResult apply(ImpulseKind kind, const ContactSpace& c, const ImpulseSide& body, const ImpulseSide& other,
                    double pn, double pt) {
  const Vec2 impulse = pn * c.n + pt * c.t;
  return {kind, pn, pt, pushed(body, impulse), pushed(other, -impulse)};
}

}  // namespace

ImpulseResult resolve_impulse(const ImpulseSide& body, const ImpulseSide& other, const Vec2& normal,
                              const Material& material) {
  const ContactSpace c = contact_space(body, other, normal);
  if (c.vn >= 0.0) return {ImpulseKind::separating, 0.0, 0.0, body.twist, other.twist};
  if (!(c.knn > 0.0)) return {ImpulseKind::jam, 0.0, 0.0, body.twist, other.twist};

  // Wanted changes of the relative velocity: -(1 + e) vn along the normal, -(1 + et) vt along the tangent.
  const double dn = -(1.0 + material.restitution) * c.vn;
  const double frictionless = dn / c.knn;
  if (material.friction == 0.0) return apply(ImpulseKind::slip, c, body, other, frictionless, 0.0);

  // Sticking: both components are met at once; a 2x2 solve.
  const double dt = -(1.0 + material.tangential_restitution) * c.vt;
  const double determinant = c.knn * c.ktt - c.knt * c.knt;
  if (determinant > 1e-14 * c.knn * c.ktt) {
    const double pn = (c.ktt * dn - c.knt * dt) / determinant;
    const double pt = (c.knn * dt - c.knt * dn) / determinant;
    if (pn >= 0.0 && std::abs(pt) <= material.friction * pn) return apply(ImpulseKind::stick, c, body, other, pn, pt);
  } else {  // no tangential freedom apart from the normal's: nothing to stick with
    return apply(ImpulseKind::slip, c, body, other, frictionless, 0.0);
  }

  // Sliding at the bound: pt = s mu pn with s = +-1, knn pn + knt pt = dn. The sign that opposes the sliding at the end:
  // it slides still in the first direction (slip), or has come to rest on the way and slid off the other way (reverse).
  const double opposing = c.vt > 0.0 ? -1.0 : 1.0;
  for (const double s : {opposing, -opposing}) {
    const double denominator = c.knn + s * material.friction * c.knt;
    if (denominator <= 0.0) continue;  // the wedge of Painleve's paradox: friction would push faster than it yields
    const double pn = dn / denominator, pt = s * material.friction * pn;
    const double wanted = c.ktt * pt + c.knt * pn - dt;  // what is left of the wanted tangential change
    if (s * wanted <= 0.0 || s != opposing)
      return apply(s == opposing ? ImpulseKind::slip : ImpulseKind::reverse, c, body, other, pn, pt);
  }
  return apply(ImpulseKind::slip, c, body, other, frictionless, 0.0);
}

ImpulseResult resolve_reflection(const ImpulseSide& body, const ImpulseSide& other, const Vec2& normal,
                                 const Material& material) {
  const ContactSpace c = contact_space(body, other, normal);
  if (c.vn >= 0.0) return {ImpulseKind::separating, 0.0, 0.0, body.twist, other.twist};
  if (!(c.knn > 0.0)) return {ImpulseKind::jam, 0.0, 0.0, body.twist, other.twist};
  // Mirror: the relative velocity's normal part turns round. The impulse that does so is shared between linear and
  // angular parts by the inertia; `slip` scales the tangential rest, `spin` the angular rebound.
  const double pn = -2.0 * c.vn / c.knn;
  const double pt = c.ktt > 0.0 ? (material.slip - 1.0) * c.vt / c.ktt : 0.0;
  ImpulseResult result = apply(ImpulseKind::slip, c, body, other, pn, pt);
  result.body.omega = body.twist.omega + material.spin * (result.body.omega - body.twist.omega);
  result.other.omega = other.twist.omega + material.spin * (result.other.omega - other.twist.omega);
  return result;
}

}  // namespace brink
