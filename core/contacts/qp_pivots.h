#pragma once
/// A small convex quadratic program of bodies in the plane, solved exactly: for what rounding keeps from an interior point, as
/// masses a million times apart that press on each other.

#include <optional>
#include <vector>

#include "brink/core/base/go_on.h"
#include "brink/core/contacts/interior_point.h"

namespace brink {

struct QpSolution {
  std::vector<Vec3> velocity;  ///< u of each body
  std::vector<double> force;   ///< x of each row
  double residual =
      0.0;  ///< largest y, or product of what should not both be there, that rounding to double leaves
};

/// By Lemke's method in extended precision, over the rows: with x = s - bound for those that have one,
///
///   0 <= x _|_ y >= 0,    0 <= s _|_ y + z >= 0,   0 <= z _|_ 2 bound - s >= 0
///
/// which is monotone, so that it ends with a solution or with the proof that there is none. Forces that are not unique are some
/// of those that go with the one u. Nothing: no solution, too many rows, or it was stopped. Cost: that of a dense
/// solve_lcp_by_lemke() of one number a row, and another for each bound.
std::optional<QpSolution> solve_by_pivots(const QpProblem& problem, const GoOn& go_on = {});

}  // namespace brink
