#include "brink/core/contacts/qp_pivots.h"

#include <algorithm>
#include <cmath>

#include "brink/core/contacts/lcp.h"

namespace brink {

namespace {

/// A dense tableau of more takes too long.
constexpr std::size_t kMostUnknowns = 200;

using Real3 = Eigen::Matrix<Real, 3, 1>;

/// The rows of the problem as one complementarity problem. Unknowns are scaled so that one unit of a force changes its own y by
/// one, with light bodies and heavy ones.
class Pivots {
 public:
  explicit Pivots(const QpProblem& problem) : problem_(problem) {
    for (std::size_t r = 0; r < problem.rows.size(); ++r) {
      scale_.push_back(1 / yields(problem.rows[r], problem.rows[r]));
      if (std::isfinite(problem.rows[r].bound)) bounded_.push_back(r);
    }
  }

  std::size_t unknowns() const { return problem_.rows.size() + bounded_.size(); }

  /// x of each row. False: none was found.
  bool solve(const GoOn& go_on, std::vector<Real>& x) const {
    const auto n = static_cast<Eigen::Index>(problem_.rows.size()),
               all = static_cast<Eigen::Index>(unknowns());
    RealMatrix A = RealMatrix::Zero(all, all);
    RealVector q = RealVector::Zero(all);
    for (Eigen::Index i = 0; i < n; ++i) {
      const QpRow& row = problem_.rows[i];
      q[i] = static_cast<Real>(row.offset) +
             seen(row, free(row.body), row.other < 0 ? Real3::Zero() : free(row.other));
      for (Eigen::Index j = 0; j < n; ++j) {
        const Real yield = yields(row, problem_.rows[j]);
        A(i, j) = scale_[j] * yield;
        // s counts from the lower bound
        if (std::isfinite(problem_.rows[j].bound)) q[i] -= yield * static_cast<Real>(problem_.rows[j].bound);
      }
    }
    for (std::size_t k = 0; k < bounded_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(bounded_[k]), z = n + static_cast<Eigen::Index>(k);
      A(i, z) = 1;
      A(z, i) = -1;
      q[z] = 2 * static_cast<Real>(problem_.rows[i].bound) / scale_[i];
    }
    const LcpAnswer found = solve_lcp_by_lemke(A, q, go_on);
    if (found.status != LcpAnswer::Status::solved) return false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double bound = problem_.rows[i].bound;
      x.push_back(scale_[i] * found.z[i] - (std::isfinite(bound) ? static_cast<Real>(bound) : Real(0)));
    }
    return true;
  }

  /// u of each body under these forces.
  std::vector<Real3> velocities(const std::vector<Real>& x) const {
    std::vector<Real3> u;
    for (int k = 0; k < static_cast<int>(problem_.mass.size()); ++k) u.push_back(free(k));
    for (std::size_t r = 0; r < x.size(); ++r) {
      const QpRow& row = problem_.rows[r];
      u[row.body] += x[r] * eased(row.body, row.on_body);
      if (row.other >= 0) u[row.other] += x[r] * eased(row.other, row.on_other);
    }
    return u;
  }

  static Real seen(const QpRow& row, const Real3& of_body, const Real3& of_other) {
    const Real y = row.on_body.cast<Real>().dot(of_body);
    return row.other < 0 ? y : y + row.on_other.cast<Real>().dot(of_other);
  }

 private:
  /// M^-1 applied.
  Real3 eased(int body, const Vec3& by) const {
    return by.cast<Real>().cwiseQuotient(problem_.mass[body].cast<Real>());
  }
  /// u of a body that no row pushes.
  Real3 free(int body) const { return eased(body, problem_.force[body]); }
  /// What a unit of force in row `by` makes of y in row `of`.
  Real yields(const QpRow& of, const QpRow& by) const {
    Real y = 0;
    const auto add = [&](int body, const Vec3& row) {
      if (body < 0) return;
      if (body == by.body) y += row.cast<Real>().dot(eased(body, by.on_body));
      if (body == by.other) y += row.cast<Real>().dot(eased(body, by.on_other));
    };
    add(of.body, of.on_body);
    add(of.other, of.on_other);
    return y;
  }

  const QpProblem& problem_;
  std::vector<Real> scale_;           ///< force of one unit
  std::vector<std::size_t> bounded_;  ///< rows with a bound
};

/// Pivots do not end where something is no number.
bool is_finite(const QpProblem& problem) {
  return std::all_of(problem.force.begin(), problem.force.end(),
                     [](const Vec3& f) { return f.allFinite(); }) &&
         std::all_of(problem.rows.begin(), problem.rows.end(), [](const QpRow& r) {
           return std::isfinite(r.offset) && r.on_body.allFinite() && r.on_other.allFinite();
         });
}

/// What the row misses of its law.
double missed(const QpRow& row, double y, double x) {
  if (!std::isfinite(row.bound)) return std::max({-y, -x, std::min(x, y)});
  const double room = y > 0.0 ? row.bound + x : row.bound - x;  // to where x stays as y slips
  return std::max(std::abs(x) - row.bound, std::min(std::abs(y), room));
}

}  // namespace

std::optional<QpSolution> solve_by_pivots(const QpProblem& problem, const GoOn& go_on) {
  if (!is_finite(problem)) return std::nullopt;
  const Pivots pivots(problem);
  if (pivots.unknowns() > kMostUnknowns) return std::nullopt;
  std::vector<Real> x;
  if (!pivots.solve(go_on, x)) return std::nullopt;
  QpSolution solution;
  for (const Real& f : x) solution.force.push_back(static_cast<double>(f));
  for (const auto& u : pivots.velocities(x)) solution.velocity.push_back(u.cast<double>());
  for (std::size_t r = 0; r < x.size(); ++r) {
    const QpRow& row = problem.rows[r];
    const double y = row.offset + row.on_body.dot(solution.velocity[row.body]) +
                     (row.other < 0 ? 0.0 : row.on_other.dot(solution.velocity[row.other]));
    solution.residual = std::max(solution.residual, missed(row, y, solution.force[r]));
  }
  return solution;
}

}  // namespace brink
