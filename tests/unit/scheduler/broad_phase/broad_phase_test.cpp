// The grid against brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "brink/core/base/random.h"
#include "brink/scheduler/broad_phase/broad_phase.h"

namespace brink::broad_phase_test {
namespace {

// A few boxes are swept, many lie in cells, which are counted, or sorted where a box far away makes many of them: each way
// names just the pairs that brute force names, each once, large and endless boxes among them.
TEST(BroadPhase, GridFindsThePairsOfBruteForce) {
  Random r(6);
  for (int round = 0; round < 100; ++round) {
    std::vector<Box> boxes;
    const int n = 2 + static_cast<int>(r.below(120)) + (round % 5 == 0 ? 600 : 0);
    for (int i = 0; i < n; ++i) {
      const Vec2 low(r.uniform(-10, 10), r.uniform(-10, 10));
      const double size = i % 17 == 0 ? 15.0 : i % 5 == 0 ? 0.0 : 1.0;
      boxes.push_back({low, low + size * Vec2(r.uniform(), r.uniform())});
    }
    if (round % 3 == 0) boxes.push_back({Vec2::Constant(-INFINITY), Vec2::Constant(INFINITY)});
    if (round % 10 == 0) boxes.push_back({Vec2::Constant(1e6), Vec2::Constant(1e6 + 1.0)});
    std::vector<std::pair<int, int>> expected;
    for (int i = 0; i < static_cast<int>(boxes.size()); ++i)
      for (int j = i + 1; j < static_cast<int>(boxes.size()); ++j)
        if (boxes[i].overlaps(boxes[j])) expected.emplace_back(i, j);
    ASSERT_EQ(overlapping_pairs(boxes), expected) << "round " << round << " of seed 6";
  }
}

}  // namespace
}  // namespace brink::broad_phase_test
