#include "brink/scheduler/kernel/held_bodies.h"

#include <algorithm>

namespace brink {

/// One that is hit halfway has had half of the step's change by then.
ExtendedTwist HeldBodies::come_to(int k, double now, ExtendedTwist at_end) const {
  const HeldStep& step = at(k).step;
  if (!(now < step.end)) return at_end;
  const Real left = (step.end - std::max(now, step.start)) / (step.end - step.start);
  const ExtendedTwist before(step.before);
  at_end.velocity += left * (before.velocity - at_end.velocity);
  at_end.omega += left * (before.omega - at_end.omega);
  return at_end;
}

}  // namespace brink
