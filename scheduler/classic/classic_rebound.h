#pragma once
/// Resolving the contacts that particles have stored, as both policies of the classic detector do.

#include <vector>

#include "brink/scheduler/classic/depth_detector.h"
#include "brink/scheduler/kernel/kernel.h"

namespace brink {

/// True if any contact of the sight approaches.
bool any_approaches(const DepthSight& sight);

/// Resolves the contacts of one moment at the kernel's present time, until none approaches or each has had
/// its turn several times. Contacts of one owner's particles with one site of another are one *patch*: those
/// of them that approach, as the bodies move by then, rebound together at their mean place and normal, so
/// that a box that lands flat does not begin to rock. The next patch is picked by the option `order`. False
/// on a halt.
bool resolve_all(Kernel& kernel, const std::vector<DepthContact>& contacts);

/// Moves apart what overlaps, by the depth of the deepest particle.
void push_all_apart(Kernel& kernel, const std::vector<DepthOverlap>& overlaps);

}  // namespace brink
