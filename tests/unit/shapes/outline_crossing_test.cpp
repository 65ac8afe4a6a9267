/// Solids in each other that no vertex tells of.
#include "brink/core/shapes/outline_crossing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/shapes/shapes.h"

namespace brink::outline_crossing_test {
namespace {

double depth(const Outline& a, const Pose& pose_a, const Outline& b, const Pose& pose_b) {
  const double there = deepest_crossing(a, pose_a, b, pose_b).depth;
  EXPECT_EQ(there > 0.0, deepest_crossing(b, pose_b, a, pose_a).depth > 0.0);
  return there;
}

// Boxes of one height, moved along their common edges; one on itself; one whose corners lie on the other's
// edges. At any angle of the whole.
TEST(OutlineCrossing, EdgesThatCoincideAreSeen) {
  const Outline box = make_box(1.0, 1.0).outline, wide = make_box(2.0, 1.0).outline;
  const Outline diamond = make_polygon({{0.5, 0.0}, {0.0, 0.5}, {-0.5, 0.0}, {0.0, -0.5}}).outline;
  for (const double turn : {0.0, 0.3, 2.0}) {
    const auto at = [&](double x, double y) {
      return Pose{Vec2(std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y),
                  turn};
    };
    for (const double x : {0.999, 0.7, 0.5, 0.1, 1e-5}) {
      EXPECT_GT(depth(box, at(0, 0), box, at(x, 0)), 0.1 * (1.0 - x)) << x << " at " << turn;
      EXPECT_GT(depth(box, at(0, 0), wide, at(x, 0)), 0.1) << x << " at " << turn;
    }
    EXPECT_GT(depth(box, at(1, 2), box, at(1, 2)), 0.1) << turn;
    EXPECT_GT(depth(box, at(0, 0), diamond, at(0, 0)), 0.1) << turn;
  }
}

TEST(OutlineCrossing, NeighboursThatTouchAreNone) {
  const Outline box = make_box(1.0, 1.0).outline, wide = make_box(2.0, 1.0).outline;
  const Outline room = as_container(make_box(3.0, 1.0).outline);
  for (const double along : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(depth(box, {{1.0, along}, 0.0}, box, {}), 0.0) << along;
    EXPECT_EQ(depth(box, {{along, 1.0}, 0.0}, wide, {}), 0.0) << along;
    EXPECT_EQ(depth(box, {{along, 0.0}, 0.0}, room, {}), 0.0) << along;
  }
  EXPECT_GT(depth(box, {{1.2, 0.0}, 0.0}, room, {}), 0.05);  // in the wall
}

}  // namespace
}  // namespace brink::outline_crossing_test
