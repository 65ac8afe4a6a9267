#pragma once
/// The impulse law: Newton restitution with Coulomb friction, in closed form in the plane.

#include "brink/core/base/extended.h"
#include "brink/core/world/world.h"

namespace brink {

/// One side of a collision.
struct ImpulseSide {
  ExtendedTwist twist;
  RealVec arm = RealVec::Zero();  ///< contact point minus centre of mass [m]
  double inverse_mass_x = 0.0, inverse_mass_y = 0.0, inverse_inertia = 0.0;  ///< 0: held
};

enum class ImpulseKind {
  separating,  ///< was not approaching: nothing done
  stick,       ///< no sliding at the end (or full tangential restitution within the cone)
  slip,        ///< friction at its bound throughout
  reverse,     ///< sliding stopped and started the other way before the end
  bounded,     ///< less friction than that: as much as gains no energy
  jam,         ///< no finite answer (both sides held)
};

struct ImpulseResult {
  ImpulseKind kind = ImpulseKind::separating;
  double normal = 0.0;        ///< impulse along the normal, on the body [N s], >= 0
  double tangential = 0.0;    ///< along perp(normal) [N s]
  ExtendedTwist body, other;  ///< twists after
};

/// Resolves one collision at one point; `normal` points into `body`. Restitution is met exactly at every
/// speed: v_n' = -e v_n. Without tangential restitution the tangential impulse is the one that ends sliding,
/// bounded by friction * normal impulse; with it, the tangential velocity is reversed by that factor, within
/// the same bound. No collision gains energy: friction is less where it would.
ImpulseResult resolve_impulse(const ImpulseSide& body, const ImpulseSide& other, const RealVec& normal,
                              const Material& material);

/// The classic cheap rebound: the point velocity is mirrored about the normal, v - 2 (n.v) n, and shared
/// between linear and angular parts, scaled by the material's slip and spin. Not exact; see docs.
ImpulseResult resolve_reflection(const ImpulseSide& body, const ImpulseSide& other, const RealVec& normal,
                                 const Material& material);

}  // namespace brink
