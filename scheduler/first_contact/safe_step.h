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

/// The step of a gap within `band` of its level, `above` it by so much, that rises and does not come back so soon; 0 of
/// one that hardly rises, or falls. A gap that rises from next to nothing, and not so far, is followed to its highest.
inline double rising_step(double above, double rate, double curvature, double band, double allowed) {
  if (!(rate > 0.0)) return 0.0;
  if (curvature <= 0.0) return std::numeric_limits<double>::infinity();
  const double square = rate * rate + 2.0 * curvature * (above - 0.5 * band);
  if (square > curvature * band) return (rate + std::sqrt(square)) / curvature;
  return above <= 4.0 * allowed && rate * rate >= curvature * allowed ? rate / curvature : 0.0;
}

/// The step of a gap that is within `band` of its level, `above` it by so much and not met: one that leads to
/// half of what there is, or back to the middle of the band from outside, never onto the level. One at its level that
/// hardly rises or falls may sink by `allowed` > 0, less than any contact needs.
inline double band_step(double above, double rate, double curvature, double band, double allowed) {
  const double rising = rising_step(above, rate, curvature, band, allowed);
  if (rising > 0.0) return rising;
  return safe_step(above > 2.0 * allowed ? 0.5 * std::min(above, band) : allowed, rate, curvature);
}

/// True if that step may lead below the level.
inline bool may_sink(double above, double rate, double curvature, double band, double allowed) {
  return above <= 2.0 * allowed && !(rising_step(above, rate, curvature, band, allowed) > 0.0);
}

}  // namespace brink
