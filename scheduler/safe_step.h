#pragma once
/// The certified Newton step: how long a gap is sure to stay above zero.

#include <cmath>
#include <limits>

namespace brink {

/// Smallest h > 0 with f + df h - curvature h^2 / 2 = 0, where the left side bounds the gap from below: no
/// contact before t + h. `f` is the gap now (below zero counts as zero), `df` its rate, `curvature` >= 0.
/// Near contact this is Newton's step, from outside. Infinite where the bound never reaches zero.
inline double safe_step(double f, double df, double curvature) {
  if (f < 0.0) f = 0.0;
  if (curvature <= 0.0) return df >= 0.0 ? std::numeric_limits<double>::infinity() : f / -df;
  const double root = std::sqrt(df * df + 2.0 * curvature * f);
  return df >= 0.0 ? (df + root) / curvature : 2.0 * f / (root - df);
}

}  // namespace brink
