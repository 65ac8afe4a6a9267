#pragma once
/// Where bodies begin that are placed a hair across a wire.

#include <vector>

#include "brink/scheduler/kernel/near_pairs.h"

namespace brink {

/// By how far each body must be moved so that no sharp corner of its pairs starts across a wire [m]; empty where none
/// does. A wire has no inside: beyond it a corner would be on the other side. But a corner both of whose edges come
/// back through the wire, by at most kStartOverlap of the world's length, was meant to stand at it: coordinates are
/// written with some digits. It is moved along the wire's normal to just before the wire. Bodies whose locks hold
/// against that stay. Cost: a look at the features of pairs that are near.
std::vector<Vec2> shifts_out_of_wires(const World& world, const Trajectories& trajectories,
                                      const NearPairs& near, ContactSearch& search, double t);

}  // namespace brink
