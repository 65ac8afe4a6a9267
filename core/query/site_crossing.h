#pragma once
/// Where the cores of two sites cross, and how deep. Internal to core/query.

#include "brink/core/shapes/site.h"

namespace brink {

struct SiteCrossing {
  double depth = -1.0;         ///< [m]; < 0: the cores do not meet
  Vec2 point = Vec2::Zero();   ///< where they do
  Vec2 normal = Vec2::Zero();  ///< unit, to the right of t's direction there: out of a solid
};

/// Where the cores of s and t meet, and how deep: the way back is over an end of one (of two segments: straight
/// over the other's line), or over the bulge of an arc, whichever is shortest. @pre both in one frame, neither
/// a point.
SiteCrossing site_crossing(const Site& s, const Site& t);

}  // namespace brink
