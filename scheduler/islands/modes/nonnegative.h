#pragma once
/// Least squares with unknowns >= 0.

#include "brink/core/base/plain_double.h"

namespace brink {

struct NonNegativeFit {
  PlainVector x;          ///< >= 0
  double residual = 0.0;  ///< |A x - b|
};

/// The x >= 0 with |A x - b| least. Columns may depend on each other: then some x of those. Source: Lawson & Hanson
/// 1974, "Solving least squares problems", chapter 23. Cost: a few factorisations of A; meant for tens of columns.
/// @pre columns have length one, or zero.
NonNegativeFit fit_nonnegative(const PlainMatrix& A, const PlainVector& b);

}  // namespace brink
