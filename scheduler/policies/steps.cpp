#include "brink/scheduler/policies/steps.h"

#include <cmath>

#include "brink/scheduler/policies/tolerances.h"

namespace brink {

double step_end(double from, double step) {
  // At the end of a step, from / step can be a rounding less than a whole number: without kSameStep the
  // next step would be next to nothing.
  const double end = (std::floor(from / step + kSameStep) + 1.0) * step;
  return end > from ? end : from + step;
}

void push_apart(Kernel& kernel, const PairKey& pair, const Vec2& way) {
  // along either axis; 0 where the body is locked in it
  const auto mobility = [&](int k) {
    const Body& b = kernel.world().bodies[k];
    return Vec2(b.inverse_mass_x(), b.inverse_mass_y());
  };
  const double length = way.norm();
  if (!(length > 0.0)) return;
  const Vec2 a = mobility(pair.body), b = pair.with_site() ? Vec2(0.0, 0.0) : mobility(pair.other_body);
  const Vec2 normal = way / length;
  const double yield = normal.cwiseAbs2().dot(a + b);
  // both are held along the way: the overlap stays
  if (!(yield > 0.0)) return;
  // Body and other move by push a and -push b, axis by axis: against each other by normal . (a + b) push
  // along the normal, which is all of the way.
  const Vec2 push = way / yield;
  kernel.displace(pair.body, push.cwiseProduct(a));
  if (!pair.with_site()) kernel.displace(pair.other_body, -push.cwiseProduct(b));
}

}  // namespace brink
