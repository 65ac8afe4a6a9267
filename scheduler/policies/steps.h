#pragma once
/// What policies of fixed steps share.

#include "brink/scheduler/kernel/kernel.h"

namespace brink {

/// The end of the step that holds `from`: whole steps from t = 0, so that a resumed run steps at the same
/// times [s]. > from, as long as steps are longer than a rounding of the clock.
double step_end(double from, double step);

/// Moves the two owners of a pair apart by `way` [m], shared by their inverse masses (a held coordinate does
/// not yield). `way` points into pair.body.
void push_apart(Kernel& kernel, const PairKey& pair, const Vec2& way);

}  // namespace brink
