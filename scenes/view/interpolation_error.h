#pragma once
/// How exact a replay is between the states that a run file has.

#include <array>
#include <span>
#include <vector>

#include "brink/core/world/world.h"

namespace brink {

/// How far the cubics through recorded states are off the motions between them [m], at the worst place that the states
/// themselves tell of: every second state is left out, and the cubic over it is held against it. A cubic is off by the
/// fourth power of the time between two states, so it is a sixteenth of that with all of them; where motions have bends that
/// no event tells of, as while contacts last, half of it. Turning counts as the way of
/// what is farthest from the centre. Where accelerations are constant nothing is left but rounding: no less is told than
/// sixteen roundings of the farthest place.
///
/// `states`: columns x, y, angle, vx, vy, omega, of frames times bodies, bodies within a frame by id; `times`: of frames [s], in
/// order; `events`: of every body, in order [s]: across them nothing is held against anything.
double interpolation_error(const World& world, std::span<const double> times,
                           const std::array<std::vector<double>, 6>& states,
                           std::span<const std::vector<double>> events, bool bends);

}  // namespace brink
