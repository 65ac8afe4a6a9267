#include "brink/scheduler/islands/modes/mode_forces.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "brink/scheduler/islands/modes/nonnegative.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

constexpr int kNewtonSteps = 4;

/// Equations (rows) and forces (columns) of the closed contacts, in the mass metric: J M^-1/2 and M^-1/2 G, each
/// row scaled to length one.
/// From J a + bend = 0 with a = f + M^-1 G load: (J M^-1 G) load = -(bend + J f), which is (rows . columns)
/// loads = right.
struct System {
  PlainMatrix rows, columns;
  PlainVector right;        ///< of rows . x = right, x = M^1/2 (a - f)
  double rounding = 0.0;    ///< of all of it
  std::vector<int> of;      ///< contact of each row
  std::vector<bool> along;  ///< true: its tangential row
  PlainVector scale;        ///< rows were multiplied by; columns too
};

/// M^-1/2. 0 where a coordinate is held: a row has nothing there, and nothing is moved along it.
PlainVector root_of(const ModeProblem& problem) {
  PlainVector root(3 * problem.bodies());
  for (int k = 0; k < problem.bodies(); ++k)
    root.segment<3>(3 * k) = problem.inverse_mass[k].cwiseSqrt().cast<PlainDouble>();
  return root;
}

/// Tangential force for mu times the normal one: against the slip.
double friction_sign(MotionMode mode) {
  return mode == MotionMode::slip_plus ? -1.0 : mode == MotionMode::slip_minus ? 1.0 : 0.0;
}

/// Over the coordinates of all bodies: normal_row() . velocities is v_n of contact k, and its transpose is
/// what a normal force of 1 N does to the bodies; likewise the tangent's.
PlainVector normal_row(const ModeProblem& p, const ContactRates& r, std::size_t k) {
  return row_of(p, p.contacts[k], r.normal_on_sample, r.normal_on_site).cast<PlainDouble>();
}
PlainVector tangent_row(const ModeProblem& p, const ContactRates& r, std::size_t k) {
  return row_of(p, p.contacts[k], r.tangent_on_sample, r.tangent_on_site).cast<PlainDouble>();
}

/// One row and one column a normal force, one more where it sticks. With slip the column n -+ mu t is not
/// the row n: the matrix is not symmetric then, and need not be definite (Painleve 1895).
System system_of(const ModeProblem& problem, const ModeMoment& moment, const std::vector<MotionMode>& modes) {
  const PlainVector root = root_of(problem);
  System s;
  std::vector<PlainVector> rows, columns;
  std::vector<PlainDouble> right, scale;
  const auto add = [&](std::size_t k, const PlainVector& row, const PlainVector& column, double bend,
                       bool along) {
    const PlainVector r = row.cwiseProduct(root);
    // The column is scaled as its row is, so that loads are forces divided by the scale (read_forces); a
    // row between what is held on both sides is 0.
    const PlainDouble length = r.norm(), by = length > 0.0 ? 1.0 / length : 0.0;
    rows.push_back(by * r);
    columns.push_back(by * column.cwiseProduct(root));
    // bodies that fall side by side, or along a wall, ask for no force, not for one of roundings, of which redundant contacts
    // would contradict each other
    const PlainVector free = moment.free.cast<PlainDouble>();
    const PlainDouble asked = bend + row.dot(free), parts = std::abs(bend) + most_along(row, free);
    const double none = double(kNoAcceleration) * double(parts);
    right.push_back(std::abs(double(asked)) <= none ? PlainDouble(0.0) : -by * asked);
    s.rounding += double(by) * none;
    scale.push_back(by);
    s.of.push_back(static_cast<int>(k));
    s.along.push_back(along);
  };
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (!is_closed(modes[k])) continue;
    const PlainVector n = normal_row(problem, moment.contacts[k], k),
                      t = tangent_row(problem, moment.contacts[k], k);
    // friction that slips is no unknown: q = -+ mu p joins the normal force's column
    const double sign = friction_sign(modes[k]) * problem.contacts[k].friction;
    add(k, n, n + sign * t, moment.contacts[k].normal_bend, false);
    if (modes[k] == MotionMode::stick) add(k, t, t, moment.contacts[k].tangential_bend, true);
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  s.rows.resize(count, root.size());
  s.columns.resize(root.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    s.rows.row(i) = rows[i].transpose();
    s.columns.col(i) = columns[i];
  }
  s.right = Eigen::Map<const PlainVector>(right.data(), count);
  s.scale = Eigen::Map<const PlainVector>(scale.data(), count);
  return s;
}

/// Forces that the system's columns give.
void read_forces(const ModeProblem& problem, const std::vector<MotionMode>& modes, const System& s,
                 const PlainVector& loads, ModeForces& f) {
  for (Eigen::Index i = 0; i < loads.size(); ++i) {
    const int k = s.of[i];
    const double load(s.scale[i] * loads[i]);
    if (s.along[i]) {
      f.tangential[k] = load;
    } else {
      f.normal[k] = load;
      f.tangential[k] = friction_sign(modes[k]) * problem.contacts[k].friction * load;
    }
  }
}

/// The least room of any force, of the largest.
/// Normal forces may fall to 0; friction that sticks may grow to mu times them. Friction that slips is at
/// its bound by construction and has no room of its own.
void find_margin(const ModeProblem& problem, const std::vector<MotionMode>& modes, ModeForces& f) {
  double largest = 0.0;
  for (std::size_t k = 0; k < modes.size(); ++k)
    largest = std::max({largest, std::abs(f.normal[k]), std::abs(f.tangential[k])});
  f.margin = 1.0;
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (!is_closed(modes[k])) continue;
    double room = f.normal[k];
    if (modes[k] == MotionMode::stick)
      room = std::min(room, problem.contacts[k].friction * f.normal[k] - std::abs(f.tangential[k]));
    // a part of the largest: 1 N is much in one island and a rounding in another
    if (largest > 0.0) room /= largest;
    if (room < f.margin) f.margin = room, f.worst = static_cast<int>(k);
  }
}

/// Redundant contacts: forces within the cones, if there are any.
/// The least-squares forces of a rank-deficient system may pull at one leg of four. What all forces
/// together push with is unique, so it is asked whether it lies in the cone that the contacts' own cones
/// span: two edges (1, +-mu) where it sticks, one where it slips.
void find_admissible(const ModeProblem& problem, const ModeMoment& moment,
                     const std::vector<MotionMode>& modes, const PlainVector& pushed, ModeForces& f) {
  // edges in the mass metric, as `pushed` is
  const PlainVector root = root_of(problem);
  std::vector<PlainVector> edges;
  std::vector<std::pair<int, double>> of;  // contact, tangential part
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (!is_closed(modes[k])) continue;
    const PlainVector n = normal_row(problem, moment.contacts[k], k),
                      t = tangent_row(problem, moment.contacts[k], k);
    const double mu = problem.contacts[k].friction;
    const auto add = [&](double part) {
      edges.push_back((n + part * t).cwiseProduct(root));
      of.emplace_back(static_cast<int>(k), part);
    };
    if (modes[k] != MotionMode::stick) {
      add(friction_sign(modes[k]) * mu);
    } else {
      add(mu);
      add(-mu);
    }
  }
  PlainMatrix cone(pushed.size(), static_cast<Eigen::Index>(edges.size()));
  PlainVector lengths(static_cast<Eigen::Index>(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    // fit_nonnegative() wants columns of length one; an edge between what is held stays 0
    lengths[i] = edges[i].norm();
    cone.col(i) = lengths[i] > 0.0 ? PlainVector(edges[i] / lengths[i]) : edges[i];
  }
  const NonNegativeFit fit = fit_nonnegative(cone, pushed);
  const double left = fit.residual / std::max(double(pushed.norm()), std::numeric_limits<double>::min());
  // it says no more than yes or no: forces that are inside have no room that could be followed to 0
  f.margin = left <= kBalances ? kBalances : -left;
  std::fill(f.normal.begin(), f.normal.end(), 0.0);
  std::fill(f.tangential.begin(), f.tangential.end(), 0.0);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double load(lengths[i] > 0.0 ? fit.x[i] / lengths[i] : 0.0);
    f.normal[of[i].first] += load;
    f.tangential[of[i].first] += of[i].second * load;
  }
}

/// Rows of the closed contacts, and what they are off: gaps, or velocities that must be 0 (a contact that
/// sticks has its tangential one, too).
std::vector<PlainVector> closed_rows(const ModeProblem& problem, const std::vector<ContactRates>& rates,
                                     const std::vector<MotionMode>& modes, bool velocities,
                                     std::vector<double>& off) {
  std::vector<PlainVector> rows;
  off.clear();
  for (std::size_t k = 0; k < modes.size(); ++k) {
    if (!is_closed(modes[k])) continue;
    rows.push_back(normal_row(problem, rates[k], k));
    off.push_back(velocities ? rates[k].normal_velocity : rates[k].gap - problem.contacts[k].kept);
    if (!velocities || modes[k] != MotionMode::stick) continue;
    rows.push_back(tangent_row(problem, rates[k], k));
    off.push_back(rates[k].tangential_velocity);
  }
  return rows;
}

/// M^-1/2 times the shortest y with (J M^-1/2) y = -off: of all corrections the one with the least x.M x.
PlainVector least_change(const ModeProblem& problem, const std::vector<PlainVector>& rows,
                         const std::vector<double>& off) {
  const PlainVector root = root_of(problem);
  PlainMatrix system(static_cast<Eigen::Index>(rows.size()), root.size());
  PlainVector right(system.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const PlainVector row = rows[i].cwiseProduct(root);
    // length one, so that redundancy is told alike of rows of light and heavy bodies
    const PlainDouble length = row.norm(), by = length > 0.0 ? 1.0 / length : 0.0;
    system.row(i) = by * row.transpose();
    right[i] = -by * off[i];
  }
  // Rows may be redundant: of all changes that miss least the shortest. Two that are nearly so, as where two arcs join, and
  // differ by a rounding would have their one place far away.
  Eigen::CompleteOrthogonalDecomposition<PlainMatrix> solver;
  solver.setThreshold(kNearlyRedundant);
  solver.compute(system);
  return solver.solve(right).cwiseProduct(root);
}

}  // namespace

ModeForces forces_in(const ModeProblem& problem, const ModeMoment& moment,
                     const std::vector<MotionMode>& modes, bool with_margin) {
  ModeForces f;
  f.normal.assign(modes.size(), 0.0);
  f.tangential.assign(modes.size(), 0.0);
  f.acceleration = moment.free;
  f.margin = 1.0;
  const System s = system_of(problem, moment, modes);
  if (s.right.size() == 0) return f;
  Eigen::CompleteOrthogonalDecomposition<PlainMatrix> solver;
  // of redundant forces the least, in scaled units
  solver.setThreshold(kRedundant);
  const PlainMatrix matrix = s.rows * s.columns;
  solver.compute(matrix);
  const PlainVector loads = solver.solve(s.right);
  const PlainDouble missed = (matrix * loads - s.right).norm();
  // a singular system may have no solution: contacts that contradict each other, or slip that jams
  f.consistent = loads.allFinite() && missed <= kConsistent * s.right.norm() + s.rounding;
  // unique, though the loads need not be: M^1/2 times what contacts add to the accelerations
  const PlainVector pushed = s.columns * loads;
  f.acceleration += pushed.cwiseProduct(root_of(problem)).cast<double>();
  read_forces(problem, modes, s, loads, f);
  if (!with_margin) return f;
  find_margin(problem, modes, f);
  // redundant: the least forces are some of many
  if (solver.rank() < s.right.size() && f.margin < 0.0) find_admissible(problem, moment, modes, pushed, f);
  return f;
}

std::optional<std::vector<BodyState>> projected(const ModeProblem& problem, double t,
                                                std::vector<BodyState> states,
                                                const std::vector<MotionMode>& modes) {
  std::vector<double> off;
  const auto move = [&](bool velocities) {
    const std::vector<PlainVector> rows =
        closed_rows(problem, rates_at(problem, t, states, modes), modes, velocities, off);
    if (rows.empty()) return;
    const PlainVector change = least_change(problem, rows, off);
    for (int k = 0; k < problem.bodies(); ++k) {
      Vec2& linear = velocities ? states[k].twist.velocity : states[k].pose.position;
      double& angular = velocities ? states[k].twist.omega : states[k].pose.angle;
      linear += change.segment<2>(3 * k).cast<double>();
      angular += double(change[3 * k + 2]);
    }
  };
  // gaps are not linear in places: Newton, to the rounding of places; velocities are linear, once is
  // enough
  for (int i = 0; i < kNewtonSteps; ++i) {
    move(false);
    // what is so far off its contacts was never on them
    if (std::any_of(off.begin(), off.end(),
                    [&](double x) { return !(std::abs(x) <= kOnContact * problem.size); }))
      return std::nullopt;
    if (std::all_of(off.begin(), off.end(),
                    [&](double x) { return std::abs(x) <= kGapIsZero * problem.size; }))
      break;
  }
  move(true);
  return states;
}

}  // namespace brink
