#include "brink/scheduler/kernel/knot_teller.h"

#include <algorithm>
#include <cmath>

namespace brink {

void KnotTeller::begins_anew(int k, double now, const Motion& before, const BodyState& after) const {
  tell_({now, k, after.pose, before.twist(now), after.twist});
}

/// Each piece is cut so that a cubic is off by no more than the tolerance. A cubic over h that meets both ends with their
/// slopes is off by h^4 / 384 of the largest fourth derivative.
void KnotTeller::bends(int k, double now, const Motion& motion, double radius) const {
  constexpr double kMostCuts = 256.0;
  const Track* track = motion.track();
  if (!track) return;
  for (const PolynomialPiece& p : track->pieces) {
    const double end = std::min(p.end, now), length = end - p.begin;
    if (!(length > 0.0)) continue;
    const double from_origin = std::max(std::abs(p.begin - p.origin), std::abs(end - p.origin));
    double fourth = 0.0, factor = 24.0, span = 1.0;
    for (int n = 4; n <= p.degree; ++n) {
      fourth += factor * span * (p.c[n].head<2>().norm() + radius * std::abs(p.c[n].z()));
      factor *= (n + 1.0) / (n - 3.0);
      span *= from_origin;
    }
    const double share = fourth / (384.0 * tolerance_);
    const double cuts = std::clamp(std::ceil(length * std::sqrt(std::sqrt(share))), 1.0, kMostCuts);
    for (double n = 1.0; n <= cuts; ++n) {
      const double t = n < cuts ? p.begin + length * (n / cuts) : end;
      if (t == now) break;  // who asks tells of it
      const BodyState s = p.state(t);
      tell_({t, k, s.pose, s.twist, s.twist});
    }
  }
}

}  // namespace brink
