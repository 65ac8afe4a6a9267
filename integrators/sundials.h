#pragma once
/// The adaptive integrators of SUNDIALS (Hindmarsh et al. 2005; Gardner et al. 2022), one solver a component.
///
/// The solver runs in its one-step mode: its steps follow from start(), the forces and the tolerances, and
/// are never clipped by what was asked. Only a break of the forces stops a step, exactly there; the solver
/// begins afresh behind it. The state vector of a body is x, y, angle, vx, vy, omega. Tolerances hold a
/// component: |error| of one step
/// <= tolerance |value| + absolute_tolerance in the weighted root-mean-square norm.

#include "brink/integrators/integrator.h"

namespace brink {

/// ARKODE's ERKStep with the method of Dormand & Prince (1980), order 5 with 4. Dense output: quintic Hermite
/// through pose, twist and acceleration at both ends, error O(h^6), so it is finer than the step itself, and
/// C2.
std::unique_ptr<Integrator> make_erk(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options,
                                     WorkCounters* work);

/// CVODE's Adams-Moulton methods, orders 1 to 12, with fixed-point iteration. For smooth forces and tight
/// tolerances. Dense output: CVODE's own polynomial, and the cubic that makes it meet the accepted states at
/// both ends.
std::unique_ptr<Integrator> make_adams(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options,
                                       WorkCounters* work);

/// CVODE's backward differentiation formulas, orders 1 to 5, with Newton iteration on a dense
/// difference-quotient Jacobian. For stiff forces. Dense output as for make_adams.
std::unique_ptr<Integrator> make_bdf(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options,
                                     WorkCounters* work);

}  // namespace brink
