#pragma once
// Near features of two outlines at rest, by their poses.

#include <vector>

#include "brink/core/shapes/shapes.h"
#include "brink/scheduler/islands/near_features.h"

namespace brink {

inline std::vector<NearFeature> between(const Outline& a, const Pose& at_a, const Outline& b,
                                        const Pose& at_b, double reach) {
  return near_features(a, BodyState{at_a, {}}, b, BodyState{at_b, {}}, reach);
}

inline Outline wire(const Vec2& a, const Vec2& b) { return make_segment(a, b).outline; }

}  // namespace brink
