#pragma once
/// Outlines that cross without a vertex of one inside the other: what two-sided sampling of a gap cannot see.

#include <optional>

#include "brink/scheduler/first_contact.h"

namespace brink {

/// The deepest crossing of two sharp segments at time t, or nothing. Its gap is minus the distance by which the nearer
/// end reaches through. Arcs are taken by their chords. Cost: all pairs of sites.
std::optional<FeatureContact> crossing_of(const Mover& a, const Mover& b, double t);

}  // namespace brink
