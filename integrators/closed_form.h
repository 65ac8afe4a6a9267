#pragma once
/// Motions in closed form: parabolas under constant forces, exponentials under linear drag; no solver at all.

#include "brink/integrators/integrator.h"

namespace brink {

/// True if closed_form can move this component.
bool has_closed_form(const Dynamics& dynamics);

/// One motion from start() to the next break of the forces, to infinity where there is none: a plain parabola
/// or drag motion then. With breaks ahead it is a chain of them, joined at the break times exactly.
/// @pre has_closed_form(*dynamics).
std::unique_ptr<Integrator> make_closed_form(std::shared_ptr<Dynamics> dynamics, WorkCounters* work);

}  // namespace brink
