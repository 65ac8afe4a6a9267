/// Bounds below gaps: where they are exact, what tells them, and that nothing that crosses is said to be apart. Random
/// placings of every two shapes are in outline_gap_test.
#include "brink/core/query/gap_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brink/core/shapes/shapes.h"

namespace brink::gap_bound_test {
namespace {

TEST(GapBound, OfTwoDiscsIsTheirGap) {
  const Outline a = make_disc(0.5).outline, b = make_disc(0.25).outline;
  EXPECT_NEAR(gap_at_least(a, {{0, 0}, 1}, b, {{3, 4}, 2}, 9.0), 4.25, 1e-15);
  EXPECT_NEAR(gap_at_least(a, {{0, 0}, 1}, b, {{0.3, 0.4}, 2}, 9.0), -0.25, 1e-15);
}

// Their discs overlap, and the line between the two is parallel to their long sides.
TEST(GapBound, OfTwoLongBarsIsToldByALine) {
  const Outline bar = make_box(10.0, 0.2).outline;
  const double bound = gap_at_least(bar, {{0, 0}, 0}, bar, {{1.0, 0.5}, 0}, 0.29);
  EXPECT_GT(bound, 0.28);
  EXPECT_LE(bound, 0.3 + 1e-15);
}

// A box on a floor, turned with it, lifted and sunk by what a watch must tell from nothing.
TEST(GapBound, OfWhatTouchesAlongASideIsTheGap) {
  const Outline box = make_box(0.6, 0.4).outline, floor = make_box(20.0, 1.0).outline;
  for (const double gap : {1e-9, 1e-13, 0.0, -1e-13, -1e-9})
    for (const double turn : {0.0, 0.3, 2.0}) {
      const Vec2 up(-std::sin(turn), std::cos(turn)), along(std::cos(turn), std::sin(turn));
      const Pose on{(0.5 + 0.2 + gap) * up + 3.0 * along, turn};
      EXPECT_NEAR(gap_at_least(box, on, floor, {{0, 0}, turn}, 1e-6), gap, 1e-14) << turn;
      EXPECT_NEAR(gap_at_least(floor, {{0, 0}, turn}, box, on, 1e-6), gap, 1e-14) << turn;
    }
}

TEST(GapBound, OfABodyInAContainerIsToldByItsCentre) {
  const Outline room = as_container(make_box(4.0, 2.0).outline), body = make_box(0.6, 0.8).outline;
  EXPECT_NEAR(gap_at_least(body, {{1.0, 0.0}, 0.3}, room, {}, 0.0), 0.5, 1e-14);
  EXPECT_NEAR(gap_at_least(room, {}, body, {{1.0, 0.0}, 0.3}, 0.0), 0.5, 1e-14);
}

// Wires have no inside, and no vertex of either is at the other.
TEST(GapBound, OfWhatCrossesIsNotAboveNothing) {
  const Outline wire = make_segment({-1.0, 0.0}, {1.0, 0.0}).outline;
  for (const double angle : {0.2, 0.7, M_PI / 2})
    for (const double far : {0.0, 1e6})
      EXPECT_LE(gap_at_least(wire, {{far, 0.0}, 0.0}, wire, {{far, 0.1}, angle}, 0.0), 1e-15);
}

}  // namespace
}  // namespace brink::gap_bound_test
