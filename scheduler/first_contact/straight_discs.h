#pragma once
/// First contact of two discs that go straight at each other, far from every case in which roundings decide: most
/// collisions of a gas.

#include "brink/scheduler/first_contact/closed_forms.h"

namespace brink {

/// What discs_meet() tells, where neither disc is accelerated, they begin apart, and neither their rate nor their places are
/// near a rounding. False: not here, ask discs_meet(). Its bounds are the same or narrower ones. Cost: three roots, two
/// divisions, and sixteen gaps side by side, once or twice.
bool straight_discs_meet(const DiscMover& a, const DiscMover& b, double from, double to,
                         const SearchLimits& limits, DiscContact& contact);

}  // namespace brink
