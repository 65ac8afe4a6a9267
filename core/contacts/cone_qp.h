#pragma once
/// Contacts that last, all of an island at once: forces that hold it at rest, or the proof that none do; and one
/// implicit step of its motion.

#include <vector>

#include "brink/core/base/geometry.h"
#include "brink/core/contacts/interior_point.h"

namespace brink {

/// One contact of the island. Its relative velocity, body minus other, is linear in both bodies' velocities
/// (x, y [m/s], angle [rad/s]): along the normal on_body[0] . w(body) + on_other[0] . w(other), and so along
/// the tangent and in turning.
struct LastingContact {
  int body = 0;    ///< index into the island's bodies; the normal points into it
  int other = -1;  ///< likewise, or -1: a support that does not yield
  Vec3 normal_on_body = Vec3::Zero(), normal_on_other = Vec3::Zero();  ///< v_n > 0: parting
  Vec3 tangent_on_body = Vec3::Zero(),
       tangent_on_other = Vec3::Zero();  ///< v_t along the normal turned by +90 degrees
  double friction = 0.0;                 ///< Coulomb, >= 0
  double rolling_resistance = 0.0;       ///< largest torque for a normal force of 1 [m], >= 0
};

/// A contact at a point. `normal` is a unit vector into `body`; arms are the point minus the centre of mass
/// [m] (of `other`: of no meaning where that is -1).
LastingContact contact_at(int body, int other, const Vec2& normal, const Vec2& arm, const Vec2& other_arm);

/// Of one contact on its `body`, the opposite on its `other`: forces [N], [N m] or impulses [N s], [N m s].
/// 0 between what is held on both sides, whatever would be there.
struct ContactLoad {
  double normal = 0.0;      ///< >= 0
  double tangential = 0.0;  ///< along the normal turned by +90 degrees
  double rolling = 0.0;     ///< torque
};

struct RestProblem {
  std::vector<Vec3> mass;   ///< of each body: mass, mass [kg], inertia [kg m^2], > 0; infinity: held
  std::vector<Vec3> force;  ///< on each body, of all but contacts [N], [N m]
  std::vector<LastingContact> contacts;
  /// Of each contact, as far as they are known: makes the search shorter. Empty: nothing is.
  std::vector<ContactLoad> expected;
  double near = 0.01;  ///< to which part of the largest force they may be known, about
};

struct RestResult {
  enum class Status {
    rests,      ///< `loads` are admissible and balance the forces
    moves,      ///< no admissible loads do: `acceleration` is the proof
    undecided,  ///< rounding ended the search before either was sure
    stopped,    ///< GoOn said no
  };
  Status status = Status::undecided;
  /// w: the accelerations [m/s^2], [rad/s^2] with w.M w / 2 - f.w least, subject to v_n +- mu v_t >= 0. (Not
  /// how it will move: sliding, w lifts at a rate of mu.) 0 where it rests.
  std::vector<Vec3> acceleration;
  std::vector<ContactLoad> loads;
  double residual = 0.0;  ///< largest acceleration, in units of the largest force / largest mass
  double imbalance =
      0.0;  ///< largest force that loads leave over, as a part of what the body weighs and carries
  int factorisations = 0;
};

struct StepContact {
  LastingContact contact;                ///< friction and rolling resistance are not looked at, but these:
  double gap = 0.0;                      ///< at the step's start [m]
  double friction_bound = 0.0;           ///< largest tangential impulse [N s], >= 0
  double rolling_bound = 0.0;            ///< largest rolling impulse [N m s], >= 0
  ContactLoad expected;                  ///< impulses, as far as they are known: makes the search shorter
  Vec3 support_velocity = Vec3::Zero();  ///< of a support that moves: along normal, tangent [m/s], in turning
};

struct StepProblem {
  double duration = 0.0;       ///< h [s], > 0
  std::vector<Vec3> mass;      ///< as above
  std::vector<Vec3> velocity;  ///< v, before
  std::vector<Vec3> force;     ///< as above
  std::vector<StepContact> contacts;
};

struct StepResult {
  enum class Status {
    solved,
    undecided,  ///< rounding ended the search; what is told is the best that was found
    stopped,    ///< GoOn said no
  };
  Status status = Status::undecided;
  std::vector<Vec3> velocity;      ///< w, after
  std::vector<ContactLoad> loads;  ///< impulses
  double residual = 0.0;           ///< largest of what the equations miss, in units of the step's speed
  int factorisations = 0;
};

/// From where a step is searched for, and how far.
struct StepSearch {
  enum class From {
    nothing,
    /// where the last search was halfway: its problem was the same but for gaps and bounds, which have changed little, and
    /// contacts that have been added behind the others
    halfway,
    end,  ///< where the last search ended, of this very problem
  };
  From from = From::nothing;
  /// It ends where products of forces and the speeds of opening or slip that go with them, one of which should be 0, are so
  /// small on the mean, in units of the step: velocities are off by some roots of that.
  double product = 1e-16;
};

/// Keeps what it finds out about a graph of contacts for the next problem on the same graph: results do not
/// depend on it. Cost: about 10 to 25 factorisations, each of about (bodies)^1.5 in the plane.
class ConeQp {
 public:
  /// Do contact forces within their friction cones, p >= 0, |q| <= mu p, |torque| <= r p, balance the forces?
  ///
  /// They do if and only if w = 0 in: minimise w.M w / 2 - f.w subject to v_n +- mu v_t +- r omega >= 0. Its
  /// multipliers are the forces. A w that is not 0 proves the contrary, as it has f.w > 0 and no admissible
  /// force does work against it. Sources: Moreau 1973, on the convex cones of friction; Acary & Brogliato 2008,
  /// "Numerical methods for nonsmooth dynamical systems".
  ///
  /// Where forces are not unique (four legs), some well inside their cones are told. Rest is accepted when w is
  /// below 1e-8 in the unit of `residual`. Where it is not 0, the search ends once it is known to the root of `proved`, relative to
  /// itself and by the kinetic energy of what is off; so coarse an answer is a proof still.
  RestResult rest_forces(const RestProblem& problem, const GoOn& go_on = {}, double proved = 1e-18);

  /// One step with friction bounds that are given (Tresca):
  ///
  ///   M (w - v) = h f + Jn^T p + Jt^T q,   0 <= p _|_ gap / h + Jn w >= 0,   |q| <= b, q = -b sign(Jt w).
  ///
  /// It is convex and always has one answer w. Gaps that are linearised stay >= 0 whatever the bounds; with
  /// b = mu p of a step before it is Coulomb's law to first order. Sources: Moreau 1988, "Unilateral contact and
  /// dry friction in finite freedom dynamics"; Acary & Brogliato 2008.
  ///
  /// Where masses of one island are spread over 1e6 and more, rounding ends some searches (2.6 % of random problems at 1e6); where
  /// that misses the equations by more than 1e-7, up to some dozen contacts are solved by pivots (solve_by_pivots).
  StepResult step(const StepProblem& problem, const GoOn& go_on = {}, StepSearch search = {});

 private:
  InteriorPoint solver_;
  double unit_ = 0.0;  ///< of speed, in the last step
};

}  // namespace brink
