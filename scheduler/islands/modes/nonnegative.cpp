#include "brink/scheduler/islands/modes/nonnegative.h"

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <vector>

namespace brink {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A column joins if it reduces the residual by more than this part of |b|.
constexpr double kJoins = 1e-14;

/// Least squares over the columns that have joined; 0 elsewhere.
VectorXd solve_joined(const MatrixXd& A, const VectorXd& b, const std::vector<bool>& joined) {
  std::vector<Index> columns;
  for (Index j = 0; j < A.cols(); ++j)
    if (joined[j]) columns.push_back(j);
  MatrixXd part(A.rows(), static_cast<Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) part.col(i) = A.col(columns[i]);
  const VectorXd some = part.completeOrthogonalDecomposition().solve(b);
  VectorXd x = VectorXd::Zero(A.cols());
  for (std::size_t i = 0; i < columns.size(); ++i) x[columns[i]] = some[i];
  return x;
}

/// The unjoined column that reduces the residual most; -1: none does.
Index steepest(const MatrixXd& A, const VectorXd& left, const std::vector<bool>& joined, double least) {
  Index best = -1;
  for (Index j = 0; j < A.cols(); ++j) {
    if (joined[j]) continue;
    if (const double w = A.col(j).dot(left); w > least) best = j, least = w;
  }
  return best;
}

/// From x towards z as far as nothing becomes negative; what comes to 0 leaves.
void go_towards(VectorXd& x, const VectorXd& z, std::vector<bool>& joined) {
  double part = 1.0;
  Index first = -1;
  for (Index j = 0; j < x.size(); ++j)
    if (joined[j] && z[j] <= 0.0)
      if (const double p = x[j] / (x[j] - z[j]); first < 0 || p < part) part = p, first = j;
  x += part * (z - x);
  for (Index j = 0; j < x.size(); ++j)
    if (joined[j] && (j == first || x[j] <= 0.0)) {
      x[j] = 0.0;
      joined[j] = false;
    }
}

}  // namespace

NonNegativeFit fit_nonnegative(const MatrixXd& A, const VectorXd& b) {
  NonNegativeFit fit;
  fit.x = VectorXd::Zero(A.cols());
  std::vector<bool> joined(A.cols(), false);
  const Index most = 3 * A.cols() + 10;
  double least_residual = b.norm();
  for (Index round = 0; round < most; ++round) {
    const Index next = steepest(A, b - A * fit.x, joined, kJoins * b.norm());
    if (next < 0) break;
    const NonNegativeFit before = fit;
    joined[next] = true;
    for (Index inner = 0; inner <= A.cols(); ++inner) {
      const VectorXd z = solve_joined(A, b, joined);
      bool inside = true;
      for (Index j = 0; j < z.size(); ++j) inside = inside && (!joined[j] || z[j] > 0.0);
      if (inside) {
        fit.x = z;
        break;
      }
      go_towards(fit.x, z, joined);
    }
    const double residual = (A * fit.x - b).norm();
    if (!(residual < least_residual)) {  // rounding: it does not get any better
      fit = before;
      break;
    }
    least_residual = residual;
  }
  fit.residual = (A * fit.x - b).norm();
  return fit;
}

}  // namespace brink
