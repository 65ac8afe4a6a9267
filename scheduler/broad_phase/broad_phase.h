#pragma once
/// Broad phase: which pairs can meet at all before a horizon, from moving bounds.

#include <functional>
#include <utility>
#include <vector>

#include "brink/core/base/periodic.h"
#include "brink/core/shapes/outline.h"
#include "brink/integrators/motion.h"

namespace brink {

/// The box that holds an outline during [from, to]: its path's chord, bulged by acceleration or by speed, whichever is less, grown
/// by its bounding radius; containers hold everything. @pre the motion covers [from, to].
Box swept_box(const Outline& outline, const Motion& motion, double from, double to);

/// The box that holds an outline about a place of its origin, however it has turned.
Box standing_box(const Outline& outline, const Vec2& place);

/// Calls visit(i, j), i < j, once for each two boxes that overlap, until it returns false; true if it never
/// did. One by one, as pairs can be far too many to keep (boxes all in one place). A uniform grid with cells
/// sized to the typical box; boxes of many cells are kept apart and met by everyone. Cost: O(n log n) for
/// boxes of like size, plus n for every large one.
bool each_overlapping(const std::vector<Box>& boxes, const std::function<bool(int i, int j)>& visit);

/// The same pairs, ascending.
std::vector<std::pair<int, int>> overlapping_pairs(const std::vector<Box>& boxes);

/// Box a, and that image of box b which it overlaps.
struct ImagePair {
  int a, b;
  Image image;
  auto operator<=>(const ImagePair&) const = default;
};

/// each_overlapping() in a plane that repeats: pairs with a < b. Costs as many boxes more as reach over the
/// edges of the period. @pre finite boxes along axes that repeat.
bool each_overlapping(const std::vector<Box>& boxes, const Periods& periods,
                      const std::function<bool(const ImagePair&)>& visit);

/// The same pairs, ascending.
std::vector<ImagePair> overlapping_pairs(const std::vector<Box>& boxes, const Periods& periods);

}  // namespace brink
