#pragma once
/// For how long a formula changes evenly with the time.

#include "brink/core/world/formula.h"

namespace brink {

/// A time > t up to which a part of the formula (see Formula::time_parts) is certain to lie beside a straight
/// line by no more than twice its change, or than a millionth of its size in the minute around: what tries a
/// few points of it has seen it. Cells of a dyadic grid, from 64 s down to 2^-30 s (where it jumps), so a
/// function of t alone. Cost: some microseconds a halving.
double steady_until(const Formula& formula, int part, double t);

}  // namespace brink
