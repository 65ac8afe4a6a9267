#pragma once
/// Sites written far from their own origin, brought near it.

#include "brink/core/world/world.h"

namespace brink {

/// The same site with its frame moved to a round place near its outline, if that is far from its origin, as
/// where walls are written in the world's coordinates: in a frame nearby, distances to it keep their digits.
/// Every coordinate is moved without rounding; where that cannot be done, and where the site is turned, it
/// stays as it is. Cost: that of the outline.
FixedSite recentred(const FixedSite& site);

}  // namespace brink
