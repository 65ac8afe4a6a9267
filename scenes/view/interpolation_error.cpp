#include "brink/scenes/view/interpolation_error.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/limits.h"

namespace brink {
namespace {

/// Where the cubic through (t0, a, va) and (t1, b, vb) is at t.
double cubic_at(double t0, double a, double va, double t1, double b, double vb, double t) {
  const double h = t1 - t0, s = t - t0, slope = (b - a) / h;
  const double c2 = (3 * slope - 2 * va - vb) / h, c3 = (va + vb - 2 * slope) / (h * h);
  return a + s * (va + s * (c2 + s * c3));
}

}  // namespace

double interpolation_error(const World& world, std::span<const double> times,
                           const std::array<std::vector<double>, 6>& states,
                           std::span<const std::vector<double>> events, bool bends) {
  const std::size_t count = world.bodies.size();
  double worst = 0.0, farthest = 0.0;
  for (const int c : {0, 1})
    for (const double x : states[c]) farthest = std::max(farthest, std::abs(x));
  for (std::size_t body = 0; body < count; ++body) {
    auto next = events[body].begin();
    for (std::size_t k = 1; k + 1 < times.size(); ++k) {
      const double before = times[k - 1], after = times[k + 1];
      // Frames at one time, of a run that was gone on with: no cubic.
      if (!(before < times[k] && times[k] < after)) continue;
      while (next != events[body].end() && *next < before) ++next;
      if (next != events[body].end() && *next <= after) continue;
      const auto off = [&](int c) {
        const auto at = [&](std::size_t frame, int column) { return states[column][frame * count + body]; };
        return at(k, c) - cubic_at(before, at(k - 1, c), at(k - 1, c + 3), after, at(k + 1, c),
                                   at(k + 1, c + 3), times[k]);
      };
      const double reach = world.bodies[body].outline->bounding_radius;
      worst = std::max(worst, std::hypot(off(0), off(1)) + reach * std::abs(off(2)));
    }
  }
  return std::max(worst / (bends ? 2.0 : 16.0), 16.0 * kEpsilon * farthest);
}

}  // namespace brink
