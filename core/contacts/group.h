#pragma once
/// Contacts of one instant taken together: Newton's impact law for all of them at once, and generalized
/// reflections.
///
/// Both conserve momentum and never gain energy; neither depends on how the contacts are numbered, but for
/// friction. Source: Smith, Kaufman, Vouga, Tamstorf & Grinspun 2012, "Reflections on simultaneous impact",
/// whose desiderata they differ in: `together` is symmetric but may keep touching bodies together that ought
/// to part (a cradle of equal discs spreads out); `reflections` breaks away (the last disc of the cradle
/// leaves alone) and is symmetric too.

#include <optional>
#include <vector>

#include "brink/core/base/extended.h"
#include "brink/core/base/go_on.h"
#include "brink/core/world/world.h"

namespace brink {

struct GroupBody {
  ExtendedTwist twist;
  double inverse_mass_x = 0.0, inverse_mass_y = 0.0, inverse_inertia = 0.0;  ///< 0: held
};

/// A contact between two bodies of the group, or a body and something immovable.
struct GroupContact {
  int body = 0;                                    ///< index into the group's bodies
  int other = -1;                                  ///< likewise, or -1: immovable
  RealVec normal = RealVec::Zero();                ///< unit, into `body`
  RealVec arm = RealVec::Zero();                   ///< contact point minus the body's centre of mass [m]
  RealVec other_arm = RealVec::Zero();             ///< minus the other's; immovable: of no meaning
  RealVec other_point_velocity = RealVec::Zero();  ///< of the immovable's contact point [m/s]
  Material material;
};

struct GroupResult {
  enum class Status {
    resolved,
    endless,  ///< reflections went on past their cap; the contacts were taken inelastically
    jam,      ///< no finite answer: something is squeezed between what cannot move
    stopped,  ///< was asked to stop: nothing was found
  };
  Status status = Status::resolved;
  std::vector<ExtendedTwist> twists;     ///< after
  std::vector<Real> normal, tangential;  ///< impulses on each contact's `body` [N s]; normal >= 0
  int reflections = 0;                   ///< sets of contacts that were reflected
  Real lost = 0;                         ///< by the normal impulses [J], >= 0 but for rounding
};

/// Newton's law at every contact at once, v_n' >= -e v_n, with impulses >= 0 only where it holds with
/// equality: a linear complementarity problem, solved exactly. With one restitution e in the group, energy is
/// never gained, and kept for e = 1. With several it may be gained: then the least of them holds for all.
///
/// Friction comes after the normal impulses, one contact at a time in the order given: the tangential impulse
/// that ends sliding (or reverses it by the tangential restitution), bounded by friction * normal impulse.
/// A contact by itself is resolved as by resolve_impulse(). Of several each can only take energy; a contact that approaches again because of another's friction is left for the
/// next group of the same instant. (A law that couples friction with Newton's restitution for all contacts
/// can gain energy.)
///
/// Cost: about k^3 for k contacts that push, in extended precision: 500 bodies take a second or so.
/// @pre contacts lie on bodies of the group; those that part are welcome.
GroupResult resolve_together(const std::vector<GroupBody>& bodies, const std::vector<GroupContact>& contacts,
                             const GoOn& go_on = {});

/// Generalized reflections: the contacts that approach are stopped together (a complementarity problem as
/// above with e = 0) and the impulses given twice, which mirrors the motion in the boundary of what is
/// allowed and keeps energy; again, until none approaches. With restitution e the outcome is e times that and
/// (1 - e) times the inelastic one of all contacts; e is the least of the group's. Friction as above.
///
/// Past ten thousand of them (a body that rattles in a hole of its own size) Newton's law at all contacts is
/// taken, if nothing approaches after it; else the inelastic one, and the result says `endless`.
GroupResult resolve_reflections(const std::vector<GroupBody>& bodies,
                                const std::vector<GroupContact>& contacts, const GoOn& go_on = {});

/// Without a rebound, and friction of all contacts coupled with their normal impulses: nothing approaches afterwards,
/// whatever friction does, so that the instant ends. It never gains energy, of each impulse p.v' <= 0. Restitution and
/// tangential restitution are not looked at. Nothing: no solution was found, or there are too many contacts for it.
/// Sources: Stewart & Trinkle 1996, "An implicit time-stepping scheme for rigid body dynamics with inelastic collisions and
/// Coulomb friction"; Anitescu & Potra 1997. Cost: about (4 k)^3 for k contacts, in extended precision.
std::optional<GroupResult> resolve_plastic(const std::vector<GroupBody>& bodies,
                                           const std::vector<GroupContact>& contacts, const GoOn& go_on = {});

}  // namespace brink
