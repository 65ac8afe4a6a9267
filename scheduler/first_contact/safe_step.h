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

/// The step of a gap that is within `band` of its level, `above` it by so much and not met: one that leads to
/// half of what there is, or back to the middle of the band from outside, never onto the level. A gap that
/// rises from next to nothing, and not so far, is followed to its highest; one at its level that hardly
/// rises or falls may sink by `allowed` > 0, less than any contact needs.
inline double band_step(double above, double rate, double curvature, double band, double allowed) {
  if (rate > 0.0) {
    if (curvature <= 0.0) return std::numeric_limits<double>::infinity();
    const double square = rate * rate + 2.0 * curvature * (above - 0.5 * band);
    if (square > curvature * band) return (rate + std::sqrt(square)) / curvature;
    if (above <= 4.0 * allowed && rate * rate >= curvature * allowed) return rate / curvature;
  }
  return safe_step(above > 2.0 * allowed ? 0.5 * std::min(above, band) : allowed, rate, curvature);
}

}  // namespace brink
