#pragma once
/// The linear complementarity problem, solved exactly: find z >= 0 with w = A z + q >= 0 and z.w = 0.

#include <Eigen/SparseCore>

#include "brink/core/base/extended.h"
#include "brink/core/base/go_on.h"
#include "brink/core/contacts/cholesky.h"

namespace brink {

using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using SparseRealMatrix = Eigen::SparseMatrix<Real>;

struct LcpAnswer {
  enum class Status {
    solved,
    none,     ///< no solution: for a positive semidefinite A, no z >= 0 with A z + q >= 0 exists
    capped,   ///< the most pivots were made
    stopped,  ///< GoOn said no
  };
  Status status = Status::solved;
  RealVector z;
  int pivots = 0;
};

/// The problem of a symmetric positive semidefinite A with a positive diagonal, by whichever of the two
/// methods below costs less. Where z is not unique, A z is. @pre q has as many entries as A.
LcpAnswer solve_lcp(const SparseRealMatrix& A, const RealVector& q, const GoOn& go_on = {});

/// Lemke's method (Cottle, Pang & Stone, "The Linear Complementarity Problem", algorithm 4.4.5) with
/// lexicographic ratio tests, so that ties (symmetric or redundant contacts) cannot make it cycle. For a
/// positive semidefinite A, or one that is copositive plus, it ends with a solution, or with the proof that there
/// is none; for others (Coulomb's friction) `none` means that it found none. Cost: O(n^2) a pivot, about n pivots,
/// and a dense tableau.
LcpAnswer solve_lcp_by_lemke(const RealMatrix& A, const RealVector& q, const GoOn& go_on = {});

/// The dual active set method (Goldfarb & Idnani 1983): rows join one by one, the most violated first, as
/// long as one is; z stays >= 0, rows whose z comes to 0 leave. Rows that depend on others never join, so
/// that redundant contacts do no harm; each step raises the dual objective, so that it ends. Cost: O(k^2) a
/// step with k rows joined and about k steps, however large n is; A stays sparse.
LcpAnswer solve_lcp_by_active_set(const SparseRealMatrix& A, const RealVector& q, const GoOn& go_on = {});

}  // namespace brink
