#include "brink/scheduler/islands/modes/nonnegative.h"

#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <vector>

#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

using Eigen::Index;

/// Least squares over the columns that have joined; 0 elsewhere.
PlainVector solve_joined(const PlainMatrix& A, const PlainVector& b, const std::vector<bool>& joined) {
  std::vector<Index> columns;
  for (Index j = 0; j < A.cols(); ++j)
    if (joined[j]) columns.push_back(j);
  PlainMatrix part(A.rows(), static_cast<Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) part.col(i) = A.col(columns[i]);
  // redundant contacts make columns depend on each other: of all that fit this is the shortest
  const PlainVector some = part.completeOrthogonalDecomposition().solve(b);
  PlainVector x = PlainVector::Zero(A.cols());
  for (std::size_t i = 0; i < columns.size(); ++i) x[columns[i]] = some[i];
  return x;
}

/// The unjoined column that reduces the residual most; -1: none does.
/// A column's product with what is left of b is the rate at which half the residual's square falls as its
/// x grows. Where none of those that have not joined has one > 0, the fit is least (Karush, Kuhn and
/// Tucker).
Index steepest(const PlainMatrix& A, const PlainVector& left, const std::vector<bool>& joined,
               PlainDouble least) {
  Index best = -1;
  for (Index j = 0; j < A.cols(); ++j) {
    if (joined[j]) continue;
    if (const PlainDouble w = A.col(j).dot(left); w > least) best = j, least = w;
  }
  return best;
}

/// From x towards z as far as nothing becomes negative; what comes to 0 leaves.
void go_towards(PlainVector& x, const PlainVector& z, std::vector<bool>& joined) {
  PlainDouble part = 1.0;
  Index first = -1;
  for (Index j = 0; j < x.size(); ++j)
    if (joined[j] && z[j] <= 0.0)
      if (const PlainDouble p = x[j] / (x[j] - z[j]); first < 0 || p < part) part = p, first = j;
  x += part * (z - x);
  for (Index j = 0; j < x.size(); ++j)
    // the first leaves by name: roundings may leave its x a little above 0
    if (joined[j] && (j == first || x[j] <= 0.0)) {
      x[j] = 0.0;
      joined[j] = false;
    }
}

}  // namespace

NonNegativeFit fit_nonnegative(const PlainMatrix& A, const PlainVector& b) {
  NonNegativeFit fit;
  fit.x = PlainVector::Zero(A.cols());
  std::vector<bool> joined(A.cols(), false);
  // Each round has a lesser residual, so no set of columns comes twice: the bound is there for roundings.
  const Index most = 3 * A.cols() + 10;
  PlainDouble least_residual = b.norm();
  for (Index round = 0; round < most; ++round) {
    const Index next = steepest(A, b - A * fit.x, joined, kJoins * b.norm());
    if (next < 0) break;
    // a column that joins may drive others out; if in the end nothing is won, this is the answer
    const NonNegativeFit before = fit;
    joined[next] = true;
    // each pass that does not end lets a column go
    for (Index inner = 0; inner <= A.cols(); ++inner) {
      const PlainVector z = solve_joined(A, b, joined);
      bool inside = true;
      for (Index j = 0; j < z.size(); ++j) inside = inside && (!joined[j] || z[j] > 0.0);
      if (inside) {
        fit.x = z;
        break;
      }
      go_towards(fit.x, z, joined);
    }
    const PlainDouble residual = (A * fit.x - b).norm();
    if (!(residual < least_residual)) {  // rounding: it does not get any better
      fit = before;
      break;
    }
    least_residual = residual;
  }
  fit.residual = double((A * fit.x - b).norm());
  return fit;
}

}  // namespace brink
