#pragma once
/// Fixed-step methods: explicit Euler, semi-implicit Euler, classic Runge-Kutta; cubic Hermite dense output.
///
/// Step n of a segment ends at (segment's start) + n step, whatever was asked; the last step before a break
/// is cut there. The states at step ends are the classic sequences. Between them pose and twist are the cubic
/// Hermite interpolant of the two ends: C1, error O(h^4). For the Euler methods its *second* derivative is
/// not the force (for constant acceleration a it runs from -2a to 4a, and from 4a to -2a): they are
/// baselines, good to O(h).

#include "brink/integrators/integrator.h"

namespace brink {

std::unique_ptr<Integrator> make_euler(std::shared_ptr<Dynamics> dynamics, double step, WorkCounters* work);
std::unique_ptr<Integrator> make_semi_implicit_euler(std::shared_ptr<Dynamics> dynamics, double step,
                                                     WorkCounters* work);
std::unique_ptr<Integrator> make_rk4(std::shared_ptr<Dynamics> dynamics, double step, WorkCounters* work);

}  // namespace brink
