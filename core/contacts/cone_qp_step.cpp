/// One step as rows of the convex problem, three a contact: the normal with no bound, the tangent and the
/// turning with the bounds that friction and rolling resistance have been given. Unknown is the change u = w - v
/// of the velocities in the step. After it y of a normal row is gap / h + v_n, and y of the others the slip, all
/// relative to a support that moves.
#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/core/contacts/cone_qp.h"
#include "brink/core/contacts/island_units.h"
#include "brink/core/contacts/qp_pivots.h"

namespace brink {

namespace {

constexpr int kMostSteps = 80;
/// Of a contact, at most.
constexpr int kRowsEach = 3;
/// Bounds on friction below this part of the step's largest impulse are none.
constexpr double kNoFriction = 1e-12;
/// Of products, in units of the step (residuals: a hundredth of their roots): where the search ends if rounding hinders, in what was
/// asked for; and what will do.
constexpr double kNearly = 100.0, kEnough = 1e-10;
/// An undecided step whose equations miss by more, in units of the step, is solved by pivots.
constexpr double kFarOff = 1e-7;
/// Nothing changes by so many units of the step's speed: what has more room, or slips faster, is taken to
/// have no more. (A short step's unit is small beside what else moves, and roundings of that would be large
/// beside it.)
constexpr double kFar = 1e8;
/// Nor are forces expected, or held by friction, of more than so many units of the step's impulse. What fits between two sides
/// to a rounding is pressed by both as much as one likes, and friction that took its bound from that would raise it from
/// step to step.
constexpr double kMostForce = 1e6;

/// The step's rows, in w - v: so that what is held keeps its velocity.
class StepRows {
 public:
  explicit StepRows(const StepProblem& given) : given_(given), units_(given.mass) {
    units_.set_speed(speed());
    for (int k = 0; k < static_cast<int>(given.mass.size()); ++k) {
      problem_.mass.push_back(units_.scaled_mass(k));
      // with u = w - v: M u = h f + J^T x, and a row's y = J u + (J v + gap / h - that of the support)
      problem_.force.push_back(units_.scaled_force(k, given.duration * given.force[k]));
    }
    problem_.rows.reserve(kRowsEach * given.contacts.size());
    sources_.reserve(kRowsEach * given.contacts.size());
    for (int k = 0; k < static_cast<int>(given.contacts.size()); ++k) add_contact(k);
  }

  const QpProblem& problem() const { return problem_; }
  const IslandUnits& units() const { return units_; }

  /// Impulses of the step, from the force of each row. Rows that were left out have none.
  template <class Force>
  std::vector<ContactLoad> loads(Force&& force) const {
    std::vector<ContactLoad> loads(given_.contacts.size());
    for (std::size_t r = 0; r < sources_.size(); ++r)
      loads[sources_[r].contact].*sources_[r].load =
          force(static_cast<int>(r)) * units_.force() * sources_[r].unit;
    return loads;
  }

 private:
  struct Source {
    int contact;
    double ContactLoad::*load;
    double unit;  ///< [m] of torques
  };

  /// Relative velocity before the step along one direction of a contact.
  double before(const LastingContact& c, const Vec3& on_body, const Vec3& on_other) const {
    return on_body.dot(given_.velocity[c.body]) +
           (c.other < 0 ? 0.0 : on_other.dot(given_.velocity[c.other]));
  }
  /// v_n that the contact may still lose.
  double room(const StepContact& s) const {
    const LastingContact& c = s.contact;
    return s.gap / given_.duration + before(c, c.normal_on_body, c.normal_on_other) - s.support_velocity[0];
  }
  /// Of the changes that forces and contacts ask for.
  double speed() const {
    double most = given_.duration * units_.largest(given_.force) / units_.mass();
    // Negative room has to be made by the step; room that is there asks for nothing.
    for (const StepContact& s : given_.contacts) most = std::max(most, -room(s));
    return most;
  }

  void add_contact(int k) {
    const StepContact& s = given_.contacts[k];
    const LastingContact& c = s.contact;
    // Turning as the speed at one unit of length, so that the row is of order 1 like the others.
    const Vec3 turn(0.0, 0.0, units_.length());
    add_row({k, &ContactLoad::normal, 1.0}, c.normal_on_body, c.normal_on_other, room(s), kNone);
    add_row({k, &ContactLoad::tangential, 1.0}, c.tangent_on_body, c.tangent_on_other,
            before(c, c.tangent_on_body, c.tangent_on_other) - s.support_velocity[1], s.friction_bound);
    add_row({k, &ContactLoad::rolling, units_.length()}, turn, -turn,
            before(c, turn, -turn) - units_.length() * s.support_velocity[2],
            s.rolling_bound / units_.length());
  }

  /// May leave the row out.
  void add_row(const Source& source, const Vec3& on_body, const Vec3& on_other, double speed, double bound) {
    const LastingContact& c = given_.contacts[source.contact].contact;
    QpRow row;
    row.name = kRowsEach * source.contact + (source.load == &ContactLoad::normal       ? 0
                                             : source.load == &ContactLoad::tangential ? 1
                                                                                       : 2);
    row.body = c.body;
    row.on_body = units_.scaled_row(c.body, on_body);
    row.other = c.other;
    if (c.other >= 0) row.on_other = units_.scaled_row(c.other, on_other);
    row.offset = std::clamp(speed / units_.speed(), -kFar, kFar);
    const double expected =
        given_.contacts[source.contact].expected.*source.load / (units_.force() * source.unit);
    row.expected = std::clamp(expected, -kMostForce, kMostForce);
    row.bound = bound / units_.force();
    if (source.load != &ContactLoad::normal) row.bound = std::min(row.bound, kMostForce);
    // A row's pairs (bound - x, bound + x) begin at its bound, which must not be 0. So contacts without
    // friction have no tangential row, and without rolling resistance none that turns.
    if (row.bound <= kNoFriction) return;
    if (row.on_body.isZero(0.0) && row.on_other.isZero(0.0)) return;  // between what is held
    sources_.push_back(source);
    // Sources and rows are in step: a row's index names its source.
    problem_.rows.push_back(row);
  }

  static constexpr double kNone = std::numeric_limits<double>::infinity();

  const StepProblem& given_;
  IslandUnits units_;
  QpProblem problem_;
  std::vector<Source> sources_;  ///< of each row
};

/// What the equations of rows and of bodies miss at most. Infinity where the search has come to what is no number.
double residual(const InteriorPoint& solver) {
  const double of_rows = solver.row_residual(), of_bodies = solver.body_residual();
  return std::isfinite(of_rows + of_bodies + solver.energy()) ? std::max(of_rows, of_bodies)
                                                              : std::numeric_limits<double>::infinity();
}

/// True where complementarity holds to `part` on the mean and the equations to a hundredth of its root.
bool solved(const InteriorPoint& solver, double part) {
  // Products go by force times speed and residuals by speed, all of order 1 in the step's
  // units: hence the root.
  return solver.mean_product() <= part && residual(solver) <= 0.01 * std::sqrt(part);
}

}  // namespace

StepResult ConeQp::step(const StepProblem& problem, const GoOn& go_on, StepSearch how) {
  const StepRows rows(problem);
  const double enough = std::max(kEnough, kNearly * how.product);
  const auto sure = [&] {
    return solved(solver_, how.product) || (solver_.hindered() && solved(solver_, kNearly * how.product));
  };
  int steps = 0;
  const auto search = [&] {
    const int before = solver_.steps();
    while (!sure() && solver_.steps() < kMostSteps && solver_.step(go_on)) continue;
    steps += solver_.steps() - before;
  };
  const bool same_unit = rows.units().speed() == unit_;
  unit_ = rows.units().speed();
  bool goes_on = same_unit && how.from != StepSearch::From::nothing;
  if (goes_on && how.from == StepSearch::From::halfway) goes_on = solver_.begin_again(rows.problem(), go_on);
  if (goes_on) search();
  // what has changed by too much for that is searched for from its beginning
  if (!goes_on || (!solver_.stopped() && !solved(solver_, enough))) {
    if (!solver_.begin(rows.problem(), go_on))
      return {StepResult::Status::stopped, problem.velocity,
              std::vector<ContactLoad>(problem.contacts.size())};
    search();
  }

  StepResult result;
  // Whether the search ended by itself or by rounding, what was found is judged by one measure.
  if (solved(solver_, enough)) result.status = StepResult::Status::solved;
  if (solver_.stopped()) result.status = StepResult::Status::stopped;
  result.factorisations = steps;
  const auto tell = [&](auto&& velocity, auto&& force) {
    for (int k = 0; k < static_cast<int>(problem.mass.size()); ++k)
      result.velocity.push_back(problem.velocity[k] + rows.units().speed_of(k, velocity(k)));
    result.loads = rows.loads(force);
  };
  // nearly solved will do for most: of many contacts that search takes far less time
  if (result.status == StepResult::Status::undecided && !(residual(solver_) <= kFarOff))
    if (const auto exact = solve_by_pivots(rows.problem(), go_on)) {
      tell([&](int k) { return exact->velocity[k]; }, [&](int r) { return exact->force[r]; });
      result.status = StepResult::Status::solved;
      result.residual = exact->residual;
      return result;
    }
  tell([&](int k) { return solver_.velocity(k); }, [&](int r) { return solver_.force(r); });
  result.residual = residual(solver_);
  return result;
}

}  // namespace brink
