#pragma once
/// Whether a scene can start.

#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink {

/// Refuses a scene in which bodies overlap at the start, at the place of the body that is deepest in another.
/// @pre the simulator is at the start. @throws SceneFaults, as Simulator::start_fault() says it.
void require_start(const Scene& scene, const Simulator& simulator);

}  // namespace brink
