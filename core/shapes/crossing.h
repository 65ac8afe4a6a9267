#pragma once
/// Where the cores of two sites meet.

#include <vector>

#include "brink/core/shapes/outline.h"

namespace brink {

/// Appends points within `tolerance` [m] of both cores: crossings of the two supporting lines and circles,
/// and ends of one that lie on the other (so both ends of an overlap are found). Points may repeat.
void add_meeting_points(const Site& s, const Site& t, double tolerance, std::vector<Vec2>& points);

/// @throws BadInput if two sites of the outline cross or touch other than where one hands over to the next.
/// `what` names the shape in the message. Cost: O(n log n + pairs whose boxes overlap).
void require_simple(const Outline& outline, const std::string& what);

}  // namespace brink
