#pragma once
/// First contact of two discs that go straight at each other, far from every case in which roundings decide: most
/// collisions of a gas.

#include "brink/scheduler/first_contact/closed_forms.h"

namespace brink {

/// What first_contact() tells, where neither disc is accelerated, they begin apart, and their rate is not near a rounding; so
/// far from the origin, too, that a pair is seen from its own place, in extended precision. False: not here, ask discs_meet(),
/// whose bounds are the same or wider ones. Cost: three roots, two divisions, and sixteen gaps side by side, once or twice;
/// far from the origin twice that.
bool straight_discs_meet(const DiscMover& a, const DiscMover& b, double from, double to,
                         const SearchLimits& limits, DiscContact& contact);

}  // namespace brink
