#pragma once
/// Pairs of boxes that overlap.

#include <algorithm>
#include <numeric>
#include <vector>

#include "brink/core/base/geometry.h"

namespace brink {

/// Calls meet(i, j) for every two of the boxes that overlap, once each, by a sweep over their left edges.
/// Cost: n log n, and pairs that overlap along x.
template <class Meet>
void for_overlapping(const std::vector<Box>& boxes, Meet&& meet) {
  std::vector<int> by_left(boxes.size());
  std::iota(by_left.begin(), by_left.end(), 0);
  std::stable_sort(by_left.begin(), by_left.end(),
                   [&](int p, int q) { return boxes[p].low.x() < boxes[q].low.x(); });
  for (std::size_t i = 0; i < by_left.size(); ++i) {
    const Box& box = boxes[by_left[i]];
    // from the first box that begins beyond this one on, none overlaps it
    for (std::size_t j = i + 1; j < by_left.size() && boxes[by_left[j]].low.x() <= box.high.x(); ++j)
      if (box.overlaps(boxes[by_left[j]])) meet(by_left[i], by_left[j]);
  }
}

}  // namespace brink
