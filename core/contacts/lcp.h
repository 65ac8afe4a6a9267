#pragma once
/// The linear complementarity problem, solved exactly: find z >= 0 with w = A z + q >= 0 and z.w = 0.

#include "brink/core/base/extended.h"

namespace brink {

using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

struct LcpAnswer {
  enum class Status {
    solved,
    none,    ///< no solution: for a positive semidefinite A, no z >= 0 with A z + q >= 0 exists
    capped,  ///< the most pivots were made
  };
  Status status = Status::solved;
  RealVector z;
  int pivots = 0;
};

/// Lemke's method (Cottle, Pang & Stone, "The Linear Complementarity Problem", algorithm 4.4.5) with
/// lexicographic ratio tests, so that ties (symmetric or redundant contacts) cannot make it cycle. For a
/// symmetric positive semidefinite A it ends with a solution, or with the proof that there is none. Where z
/// is not unique, A z is. Cost: O(n^2) a pivot, about n pivots. @pre A is n x n with a positive diagonal, q
/// has n entries.
LcpAnswer solve_lcp(const RealMatrix& A, const RealVector& q);

}  // namespace brink
