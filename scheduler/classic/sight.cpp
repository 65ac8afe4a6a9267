#include "brink/scheduler/classic/sight.h"

#include <algorithm>
#include <utility>

namespace brink {

Sight::Sight(Kernel& kernel) : kernel_(kernel), detector_(kernel.world(), kernel.options(), &drawn_) {}

DepthSight Sight::look(double from, double t) {
  std::vector<OwnerMoment> owners;
  double fastest = 0.0;
  for (int k = 0; k < kernel_.owner_count(); ++k) {
    const Motion& motion = kernel_.motion_of(k);
    // A motion that has begun since the last look knows no earlier moment than its beginning.
    const double before = std::clamp(from, std::min(motion.begin(), t), t);
    owners.push_back({motion.state(t), motion.state(before)});
    const Outline& outline = kernel_.outline_of(k);
    // the farthest point from the centre, which turning moves fastest; of a container its hole's
    const double reach = outline.container ? outline.bounds.extent().norm() : outline.bounding_radius;
    for (const Twist& twist : {owners.back().now.twist, owners.back().before.twist})
      fastest = std::max(fastest, twist.velocity.norm() + std::abs(twist.omega) * reach);
  }
  // two owners come nearer at twice the fastest speed at most; as much again for what accelerates
  DepthSight seen = detector_.look(owners, 4.0 * fastest * std::max(t - from, kernel_.options().step));
  kernel_.note_pictures(std::exchange(drawn_, {}));
  return seen;
}

}  // namespace brink
