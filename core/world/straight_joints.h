#pragma once
/// Floors and walls of several sites that go on straight into each other, or lie against each other.

#include <memory>
#include <vector>

#include "brink/core/world/world.h"

namespace brink {

/// The outline of each fixed site, with the joints noted (Site::straight_a, Sample::hollow) at which sides of sites that stand
/// still, or move as one by the same motion, go on straight into each other, to `tolerance` [m]: nothing that slides along them runs against the next; and the sides of
/// solids that are covered by others' (Site::covered). Sites that have neither keep their outline. Cost: a sort of the sites' sides.
std::vector<std::shared_ptr<const Outline>> with_straight_joints(const World& world, double tolerance);

}  // namespace brink
