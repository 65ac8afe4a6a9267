// Layer forces: a line for each force, as wide as the force is large.
#include <gmock/gmock.h>

#include "brink/core/shapes/shapes.h"
#include "brink/scenes/draw/draw.h"

namespace brink::forces_test {
namespace {

/// Two discs of radius 1 at (0, 0) and (4, 0), 50 pixels a metre: world (x, y) lies at column 50 (x + 1), row
/// 50 (1.5 - y).
struct TwoDiscs {
  World world;
  std::vector<BodyState> states{{}, {}};
  DrawOptions options;

  TwoDiscs() {
    Body disc;
    disc.outline = std::make_shared<const Outline>(make_disc(1.0).outline);
    world.bodies = {disc, disc};
    states[1].pose.position = {4.0, 0.0};
    options.size = {300, 150};
    options.caption = false;
    options.margin = 0.0;
    options.view = Box{{-1.0, -1.5}, {5.0, 1.5}};
    options.layer = parse_layer("forces");
  }
  Picture draw() const { return draw_scene(world, states, {}, options); }
};

bool is_red(std::uint32_t pixel) {
  const int red = (pixel >> 16) & 0xff, green = (pixel >> 8) & 0xff, blue = pixel & 0xff;
  return red > green + 60 && red > blue + 60;
}

/// Red pixels of a column.
int red_in(const Picture& picture, int column) {
  int count = 0;
  for (int row = 0; row < picture.height; ++row) count += is_red(picture.at(column, row));
  return count;
}

TEST(ForcesLayer, LinesGoFromTheCentreToTheContactAndNoFurther) {
  TwoDiscs two;
  two.options.forces = {{0, {1.0, 0.0}, 8.0}};
  const Picture picture = two.draw();
  EXPECT_TRUE(is_red(picture.at(75, 75)));    // (0.5, 0)
  EXPECT_FALSE(is_red(picture.at(40, 75)));   // (-0.2, 0): behind the centre
  EXPECT_FALSE(is_red(picture.at(110, 75)));  // (1.2, 0): beyond the contact
  EXPECT_EQ(red_in(picture, 250), 0);         // the other disc carries nothing
}

// 8 N to 2 N are 4 to 1; two at one place press as one.
TEST(ForcesLayer, WidthsAreAsTheForces) {
  TwoDiscs two;
  two.options.forces = {{0, {1.0, 0.0}, 8.0}, {1, {-1.0, 0.0}, 2.0}};
  const Picture four = two.draw();
  EXPECT_GE(red_in(four, 75), 10);
  EXPECT_NEAR(red_in(four, 75), 4.0 * red_in(four, 225), 4.0);
  two.options.forces.push_back({1, {-1.0, 1e-9}, 6.0});
  const Picture equal = two.draw();
  EXPECT_EQ(red_in(equal, 75), red_in(equal, 225));
}

// At one corner the floor and a wall press: neither force is the sum of both.
TEST(ForcesLayer, WhatPressesAlongTwoLinesAreTwoForces) {
  TwoDiscs two;
  two.options.forces = {
      {0, {1.0, 0.0}, 8.0}, {1, {-1.0, 0.0}, 6.0, {1.0, 0.0}}, {1, {-1.0, 0.0}, 8.0, {0.0, 1.0}}};
  const Picture picture = two.draw();
  EXPECT_EQ(red_in(picture, 75), red_in(picture, 225));
}

TEST(ForcesLayer, WithoutForcesNothingIsRed) {
  const Picture picture = TwoDiscs().draw();
  for (int column = 0; column < picture.width; ++column) EXPECT_EQ(red_in(picture, column), 0);
}

TEST(ForcesLayer, WhatCannotBeDrawnIsRefused) {
  for (const DrawnForce& force :
       {DrawnForce{2, {1, 0}, 1.0}, DrawnForce{-1, {1, 0}, 1.0}, DrawnForce{0, {NAN, 0}, 1.0},
        DrawnForce{0, {1, 0}, -1.0}, DrawnForce{0, {1, 0}, INFINITY}}) {
    TwoDiscs two;
    two.options.forces = {force};
    EXPECT_THROW(two.draw(), BadInput);
  }
}

}  // namespace
}  // namespace brink::forces_test
