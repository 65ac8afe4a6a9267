/// Both laws work in contact space: two numbers of relative velocity, two of impulse, and the symmetric
/// matrix k between them. Derivations, and where the laws end, are in docs/impulses.md.
#include "brink/core/contacts/impulse.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

/// The contact seen by impulses: relative velocity of the two contact points in (normal, tangent) axes, and
/// the symmetric 2x2 matrix that maps an impulse to its change (the inverse of the effective mass).
struct ContactSpace {
  RealVec n, t;
  Real vn = 0, vt = 0;             ///< relative velocity, body minus other
  Real knn = 0, knt = 0, ktt = 0;  ///< velocity change per unit impulse [1/kg]
};

/// Whether impulses along the tangent are asked for: without friction k_nt and k_tt are not.
enum class Along { normal, both };

/// Inverse masses in x and y differ where a body is held in one of them: M^-1 is diagonal in the world's
/// axes, not in the contact's, so that k_nt need not vanish even where the arm does.
void add_side(ContactSpace& c, const ImpulseSide& side, Along along) {
  if (side.inverse_mass_x == 0.0 && side.inverse_mass_y == 0.0 && side.inverse_inertia == 0.0) return;
  const auto moved = [&](const RealVec& u, const RealVec& v) {
    return side.inverse_mass_x * (u.x() * v.x()) + side.inverse_mass_y * (u.y() * v.y());
  };
  const double turn = side.inverse_inertia;
  const Real rn = extended::cross(side.arm, c.n);
  c.knn += moved(c.n, c.n) + turn * (rn * rn);
  if (along == Along::normal) return;
  const Real rt = extended::cross(side.arm, c.t);
  c.knt += moved(c.n, c.t) + turn * (rn * rt);
  c.ktt += moved(c.t, c.t) + turn * (rt * rt);
}

ContactSpace contact_space(const ImpulseSide& body, const ImpulseSide& other, const RealVec& normal,
                           Along along) {
  ContactSpace c;
  c.n = normal;
  c.t = extended::perp(normal);
  const RealVec v = body.twist.at(body.arm) - other.twist.at(other.arm);
  c.vn = v.dot(c.n);
  if (along == Along::both) c.vt = v.dot(c.t);
  add_side(c, body, along);
  add_side(c, other, along);
  return c;
}

/// One side's twist after an impulse at its arm; a held coordinate keeps its velocity.
ExtendedTwist pushed(const ImpulseSide& side, const RealVec& impulse) {
  ExtendedTwist after = side.twist;
  if (side.inverse_mass_x != 0.0) after.velocity.x() += side.inverse_mass_x * impulse.x();
  if (side.inverse_mass_y != 0.0) after.velocity.y() += side.inverse_mass_y * impulse.y();
  if (side.inverse_inertia != 0.0) after.omega += side.inverse_inertia * extended::cross(side.arm, impulse);
  return after;
}

/// What a collision gains, as a part of what it turns over, that is a rounding of two doubles.
constexpr double kNoGain = 1e-24;

/// Less friction, where as much as is asked for would make the collision gain energy, which Newton's restitution with Coulomb's
/// friction may (Kane & Levinson 1985). With v_n' = -e v_n met whatever friction does, the gain is
///
///   W(p_t) = -(1 - e^2) v_n^2 / (2 k_nn) + p_t (v_t - k_nt v_n / k_nn) + p_t^2 det / (2 k_nn),
///
/// none at p_t = 0, and so none up to its root on the side of `pt`. In between p_n stays large enough for the cone, as it is at
/// both ends. Source: Brach 1989, "Rigid body collisions", J. Appl. Mech. 56. @pre determinant > 0, |et| <= 1
Real without_gain(const ContactSpace& c, Real determinant, const Material& material, Real pt) {
  const Real e = material.restitution;
  const Real lost = (Real(1) - e * e) * c.vn * c.vn / (Real(2) * c.knn),
             bends = determinant / (Real(2) * c.knn);
  const Real side = pt < 0.0 ? -1.0 : 1.0, most = side * pt;
  const Real slope = side * (c.vt - c.knt * c.vn / c.knn);
  const Real turned_over = lost + most * (abs(slope) + most * bends);
  if (most * (slope + most * bends) - lost <= kNoGain * turned_over) return pt;
  const Real root = sqrt(slope * slope + Real(4) * bends * lost);
  // whichever of the two takes no difference
  return side * (slope > 0.0 ? Real(2) * lost / (slope + root) : (root - slope) / (Real(2) * bends));
}

ImpulseResult apply(ImpulseKind kind, const ContactSpace& c, const ImpulseSide& body,
                    const ImpulseSide& other, Real pn, Real pt) {
  // Only what is told of the impulse is rounded to double; the twists, from which motions start, are not.
  const RealVec impulse = pt == 0 ? RealVec(pn * c.n) : RealVec(pn * c.n + pt * c.t);
  return {kind, static_cast<double>(pn), static_cast<double>(pt), pushed(body, impulse),
          pushed(other, -impulse)};
}

}  // namespace

ImpulseResult resolve_impulse(const ImpulseSide& body, const ImpulseSide& other, const RealVec& normal,
                              const Material& material) {
  const Along along = material.friction == 0.0 ? Along::normal : Along::both;
  const ContactSpace c = contact_space(body, other, normal, along);
  if (c.vn >= 0.0) return {ImpulseKind::separating, 0.0, 0.0, body.twist, other.twist};
  // k_nn sums inverse masses times squares: it is 0 only where neither side can move along the normal.
  if (!(c.knn > 0.0)) return {ImpulseKind::jam, 0.0, 0.0, body.twist, other.twist};

  // Wanted changes of the relative velocity: -(1 + e) vn along the normal, -(1 + et) vt along the tangent.
  const Real dn = -(Real(1) + material.restitution) * c.vn;
  const Real frictionless = dn / c.knn;
  if (material.friction == 0.0) return apply(ImpulseKind::slip, c, body, other, frictionless, 0);

  // Sticking: both components are met at once; a 2x2 solve.
  const Real dt = -(Real(1) + material.tangential_restitution) * c.vt;
  const Real determinant = c.knn * c.ktt - c.knt * c.knt;
  const auto rub = [&](ImpulseKind kind, Real pn, Real pt) {
    const Real kept = without_gain(c, determinant, material, pt);
    if (kept == pt) return apply(kind, c, body, other, pn, pt);
    return apply(ImpulseKind::bounded, c, body, other, (dn - c.knt * kept) / c.knn, kept);
  };
  // The determinant is >= 0 (Cauchy-Schwarz), and 0 where everything that yields does so along one
  // direction: a body that can only slide along x, hit on a slanted side. There v_n' = -e v_n alone
  // settles the motion, and friction could change nothing but p_n.
  if (determinant > 1e-14 * c.knn * c.ktt) {
    const Real pn = (c.ktt * dn - c.knt * dt) / determinant;
    const Real pt = (c.knn * dt - c.knt * dn) / determinant;
    if (pn >= 0.0 && abs(pt) <= material.friction * pn) return rub(ImpulseKind::stick, pn, pt);
  } else {  // no tangential freedom apart from the normal's: nothing to stick with
    return apply(ImpulseKind::slip, c, body, other, frictionless, 0);
  }

  // Sliding at the bound: pt = s mu pn with s = +-1, knn pn + knt pt = dn. The sign that opposes the sliding
  // at the end: it slides still in the first direction (slip), or has come to rest on the way and slid off
  // the other way (reverse).
  const Real opposing = c.vt > 0.0 ? -1.0 : 1.0;
  // The second sign needs no test: as a function of pt / pn between -mu and mu, what is left of the
  // wanted change is a quotient of linear functions, hence monotone, and its zero, the sticking
  // solution, lies outside. So where one sign overshoots, the other one opposes the sliding at the end
  // (as long as both denominators are > 0).
  for (const Real s : {opposing, -opposing}) {
    const Real denominator = c.knn + s * material.friction * c.knt;
    if (denominator <= 0.0)
      continue;  // the wedge of Painleve's paradox: friction would push faster than it yields
    const Real pn = dn / denominator, pt = s * material.friction * pn;
    const Real wanted = c.ktt * pt + c.knt * pn - dt;  // what is left of the wanted tangential change
    if (s * wanted <= 0.0 || s != opposing)
      return rub(s == opposing ? ImpulseKind::slip : ImpulseKind::reverse, pn, pt);
  }
  // Friction against the sliding overshoots, and the other sign lies in Painleve's wedge. Not both signs
  // do: the two denominators add up to 2 k_nn > 0.
  return apply(ImpulseKind::slip, c, body, other, frictionless, 0);
}

ImpulseResult resolve_reflection(const ImpulseSide& body, const ImpulseSide& other, const RealVec& normal,
                                 const Material& material) {
  const ContactSpace c = contact_space(body, other, normal, Along::both);
  if (c.vn >= 0.0) return {ImpulseKind::separating, 0.0, 0.0, body.twist, other.twist};
  if (!(c.knn > 0.0)) return {ImpulseKind::jam, 0.0, 0.0, body.twist, other.twist};
  // Mirror: the relative velocity's normal part turns round. The impulse that does so is shared between
  // linear and angular parts by the inertia; `slip` scales the tangential rest, `spin` the angular rebound.
  // Each direction is taken for itself: with k_nt != 0 and slip != 1 the normal's mirror
  // is missed by k_nt pt.
  const Real pn = -2.0 * c.vn / c.knn;
  const Real pt = c.ktt > 0.0 ? (material.slip - 1.0) * c.vt / c.ktt : Real(0);
  ImpulseResult result = apply(ImpulseKind::slip, c, body, other, pn, pt);
  result.body.omega = body.twist.omega + material.spin * (result.body.omega - body.twist.omega);
  result.other.omega = other.twist.omega + material.spin * (result.other.omega - other.twist.omega);
  return result;
}

}  // namespace brink
