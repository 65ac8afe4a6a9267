#pragma once
/// How the surface of a site that moves comes towards what touches it.

#include "brink/scheduler/islands/near_features.h"

namespace brink {

/// How far the surface of b, a site's owner, comes along the contact's normal towards a body that stays where it is [m]: the gap
/// shrinks by as much. The feature goes on as the line or the circle that it is: a round drum that turns about its axis does not
/// come any nearer, though each of its points leaves along a chord. `angle`: the owner's before; `step`: its turn and its way, from
/// where it is before, in world axes.
double advance_of_surface(const NearFeature& f, const Outline& b, double angle, const Frame& step);

}  // namespace brink
