#pragma once
/// A Cholesky factor that grows and shrinks by one row at a time.

#include <vector>

#include "brink/core/base/extended.h"

namespace brink {

using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// L of A = L L^T, A symmetric positive definite. Source: Golub & Van Loan, "Matrix Computations", 6.5.4.
class GrowingCholesky {
 public:
  int size() const { return static_cast<int>(rows_.size()); }
  /// L y = b, in place. Cost: n^2 / 2.
  void solve_lower(RealVector& b) const;
  /// L^T x = y, in place. Cost: n^2 / 2.
  void solve_upper(RealVector& y) const;
  /// One more row and column of A: `y` is L^-1 times the new column, `left` > 0 what y.y leaves of its
  /// diagonal.
  void append(const RealVector& y, Real left);
  /// Row and column k of A go. Cost: (n - k)^2.
  void remove(int k);

 private:
  std::vector<std::vector<Real>> rows_;  ///< row i has i + 1 entries
};

}  // namespace brink
