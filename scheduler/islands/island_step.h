#pragma once
/// One step of an island at the level of velocities: bodies joined by contacts that last move on with constant
/// twists, and no gap closes.
///
///   until no gap is missed along the step
///     v + h a  ->  the nearest twists w (in the mass metric) with  gap + h n.(w - w_other) >= 0  at every
///                  contact, and friction within mu times the normal force
///     look at the gaps along the step; where one is missed (a face that turns, a hollow arc): aim higher
///
/// The ends of sites take part only where they did in the step before, or once they are missed: what slides
/// over the joint of two floors does not feel it.
///
/// Gaps that are convex in the relative place (discs, straight sides that do not turn) lie above their
/// tangents: none is missed. Order 1 in h; gaps exact. Sources: Moreau 1988; Anitescu & Potra 1997; friction of few by
/// a fixed point of given bounds: Haslinger 1983; of many by sweeps (coulomb_sweeps.h).

#include <functional>
#include <vector>

#include "brink/core/base/geometry.h"
#include "brink/core/contacts/cone_qp.h"

namespace brink {

/// A contact of the step, beside its geometry.
struct IslandContact {
  LastingContact rows;
  double gap = 0.0;        ///< at the start, less what it must keep [m]
  double tolerance = 0.0;  ///< by which its gap may be missed along the step [m]
  /// It must keep off a wire without thickness: what starts nearer rises where that costs little.
  bool thin = false;
  double friction = 0.0;
  double rolling_resistance = 0.0;  ///< largest torque for a normal force of 1 [m]
  bool driven = false;              ///< its site moves as it is told, and gives what energy that takes
  /// Of its point there, as the rigid body that it is, where the forces act as the step begins: of this its work comes [m/s].
  Vec2 site_velocity = Vec2::Zero();
  bool at_end = false;  ///< of a site: its tangent bars the way to what passes by, so that is asked for last
  double normal_force = 0.0;      ///< in: of the step before; 0: new. Out: mean over this one [N]
  double tangential_force = 0.0;  ///< likewise
  /// Out: what has moved the bodies, as means over the step [N], [N m]. Those above obey Coulomb's law, as of many this does to
  /// what sweeps leave (StepOutcome::friction_residual).
  ContactLoad gives;
  double force_lasted = 0.0;                              ///< how long the step before was [s]
  double normal_support = 0.0, tangential_support = 0.0;  ///< mean velocity of a site's point [m/s]
  /// The gap is a convex function of where the sample is in the frame of the site's owner: its tangent at the start is
  /// left only by what turns, see falls_below_tangent().
  bool convex = false;
  bool round_site = false;     ///< of a disc about its centre of mass: it looks the same however that turns
  bool sample_on_body = true;  ///< the sample is the body's, the site the other's; or the reverse
  double arm = 0.0;            ///< of the sample from its owner's centre of mass [m]
  double apart = 0.0;          ///< of the sample from the centre of mass of the site's owner [m]
};

struct IslandStep {
  std::vector<Vec2> place;     ///< of centres of mass [m], from anywhere; empty: in a plane that repeats
  std::vector<Vec3> mass;      ///< of each body, infinity: held (RestProblem)
  std::vector<Vec3> velocity;  ///< in: before; out: of the step
  std::vector<Vec3> force;     ///< of all but contacts [N], [N m]
  /// Whose work is what forces give; empty: `force`. Springs act along their lines at the start, which takes no angular momentum, and
  /// give what they have less halfway.
  std::vector<Vec3> spending;
  /// Of each body the first of those that springs join it to, or itself; empty: nobody is joined.
  std::vector<int> joined_to;
  std::vector<IslandContact> contacts;
};

/// The gap of contact k a time into the step [m].
using GapAlong = std::function<double(std::size_t k, double moment)>;

/// That, were the bodies to move with these velocities, which outlive it.
using GapsAlong = std::function<GapAlong(const std::vector<Vec3>& velocity)>;

/// Adds contacts to the step that bodies may come to with these velocities, and that it has not yet.
using ListFarther = std::function<void(const std::vector<Vec3>& velocity)>;

struct StepOutcome {
  bool solved = false;  ///< every gap stays within its tolerance along the step; not where GoOn said no
  /// Where it is not solved: no velocities keep all gaps, as where sites that move close in on a body.
  bool no_room = false;
  int factorisations = 0;
  /// Energy that the step made [J], beyond what sites that move gave: at most 1e-3 of what it turned over. 0 where
  /// none does: all is slowed by as much then.
  double won = 0.0;
  /// By how much friction is beyond its cone or, of many bodies, forces within their cones fail to make the velocities; of
  /// the largest force.
  double friction_residual = 0.0;
};

/// Islands of so many bodies obey Coulomb's law to the digits of the solver, as a rule; larger ones, and those whose bounds go
/// round in a circle, to what sweeps leave (StepOutcome::friction_residual).
inline constexpr std::size_t kFewMembers = 8;

/// Takes a step of h > 0 [s]. What is not solved is to be tried again with a shorter one. `farther` is asked after every
/// solve; what it adds takes part once it is missed. `tolerance`: the way by which places may be off in
/// its energy [m]; a thin contact's, too, where no step keeps its own (its `tolerance` says so then).
StepOutcome take_step(ConeQp& solver, IslandStep& step, double h, double tolerance, const GapsAlong& gaps,
                      const GoOn& go_on = {}, const ListFarther& farther = {});

/// True if the bodies stay at rest under their forces: the contacts' forces are set then. Not where GoOn said no.
bool stays_at_rest(ConeQp& solver, IslandStep& step, const GoOn& go_on = {});

}  // namespace brink
