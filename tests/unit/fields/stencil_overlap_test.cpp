// Areas of overlap by a stencil count against closed forms.
#include "brink/core/fields/stencil_overlap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "brink/core/shapes/shapes.h"

namespace brink::stencil_overlap_test {
namespace {

StencilOverlap overlap(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b,
                       int resolution = 512) {
  PassRenderer renderer{FieldOptions()};
  return stencil_overlap(renderer, {&a.outline, pose_a, 0}, {&b.outline, pose_b, 1}, resolution);
}

// Two unit discs with centres 1 apart share a lens of 2 pi / 3 - sqrt(3) / 2.
TEST(StencilOverlap, LensOfTwoDiscsHasItsArea) {
  const auto found = overlap(make_disc(1.0), Pose(), make_disc(1.0), {{1.0, 0.0}, 0.0});
  const double lens = 2.0 * std::numbers::pi / 3.0 - std::sqrt(3.0) / 2.0;
  EXPECT_NEAR(found.area, lens, 1e-3);
  EXPECT_LT(std::abs(found.area - lens), found.error);
  EXPECT_LT(found.error, 0.04);  // pixels on 12 m of circles, of 1/512 x sqrt(3) m
}

// A square turned by 45 degrees over its like shares a regular octagon of 2 (sqrt(2) - 1) of the side
// squared.
TEST(StencilOverlap, TurnedSquaresShareAnOctagon) {
  const auto found = overlap(make_box(1, 1), Pose(), make_box(1, 1), {Vec2(0, 0), std::numbers::pi / 4});
  EXPECT_NEAR(found.area, 2.0 * (std::sqrt(2.0) - 1.0), 2e-3);
}

// 1 / (1 / 49) is more than 49 by a rounding: still 49 pixels a side.
TEST(StencilOverlap, WindowIsAsManyPixelsAsAskedFor) {
  for (int resolution = 40; resolution <= 110; ++resolution) {
    const auto found = overlap(make_box(1, 1), Pose(), make_box(1, 1), Pose(), resolution);
    EXPECT_EQ(found.pixels, static_cast<std::size_t>(resolution) * resolution);
    EXPECT_NEAR(found.area, 1.0, 1e-12) << resolution;
  }
}

TEST(StencilOverlap, ContainersAreSolidOutside) {
  const auto found = overlap(make_disc_container(2.0), Pose(), make_box(1, 1), {{2.0, 0.0}, 0.0});
  // beyond the circle of radius 2 in 1.5 .. 2.5 x -.5 .. .5: 2.5 - integral of sqrt(4 - y^2) over the height
  const double inside = 0.5 * std::sqrt(3.75) + 4.0 * std::asin(0.25);
  EXPECT_NEAR(found.area, 2.5 - inside, 2e-3);
}

TEST(StencilOverlap, WhatIsApartOrHasNoInsideOverlapsNothing) {
  EXPECT_EQ(overlap(make_disc(1), Pose(), make_disc(1), {{2.1, 0}, 0}).pixels, 0U);
  EXPECT_EQ(overlap(make_disc(1), Pose(), make_disc(1), {{1.5, 1.5}, 0}).pixels, 0U);
  EXPECT_EQ(overlap(make_chain({{-1, -0.5}, {1, 0.5}}), Pose(), make_box(1, 1), Pose()).pixels, 0U);
}

}  // namespace
}  // namespace brink::stencil_overlap_test
