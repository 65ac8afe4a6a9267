// Pictures of a plane that repeats: what crosses a side of the period is seen on the other one, too.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>

#include "brink/core/shapes/shapes.h"
#include "brink/scenes/draw/draw.h"

namespace brink::periodic_test {
namespace {

constexpr int kWidth = 500, kHeight = 100;

/// A period of 10 m along x, seen from 0 to 10 and -1 to 1: world (x, y) lies at column 50 x, row 50 (1 - y).
struct Ring {
  World world;
  std::vector<BodyState> states;
  std::vector<Pose> sites;
  DrawOptions options;

  Ring() {
    world.periods.size = {10.0, 0.0};
    options.size = {kWidth, kHeight};
    options.caption = options.diagram = false;
    options.margin = 0.0;
    options.view = Box{{0.0, -1.0}, {10.0, 1.0}};
  }
  void add_disc(double radius, const Vec2& at) {
    Body disc;
    disc.outline = std::make_shared<const Outline>(make_disc(radius).outline);
    world.bodies.push_back(disc);
    states.emplace_back().pose.position = at;
  }
  Picture draw(const std::string& layer = "scene") {
    options.layer = parse_layer(layer);
    return draw_scene(world, states, sites, options);
  }
};

double brightness(std::uint32_t pixel) {
  return (0.2126 * ((pixel >> 16) & 0xff) + 0.7152 * ((pixel >> 8) & 0xff) + 0.0722 * (pixel & 0xff)) / 255.0;
}

/// The darkest pixel of a column in rows about y.
double darkest(const Picture& picture, double x, double y) {
  double least = 1.0;
  const int column = static_cast<int>(50.0 * x), row = static_cast<int>(50.0 * (1.0 - y));
  for (int k = std::max(0, row - 6); k <= std::min(kHeight - 1, row + 6); ++k)
    least = std::min(least, brightness(picture.at(column, k)));
  return least;
}
bool has_ink(const Picture& picture, double x, double y) { return darkest(picture, x, y) < 0.8; }

TEST(PeriodicPicture, ASpringOverTheSideIsAsShortAsItIs) {
  Ring ring;
  ring.add_disc(0.1, {9.5, 0.0});
  ring.add_disc(0.1, {10.5, 0.0});
  ring.world.forces.emplace_back(SpringForce{.body_a = 0, .body_b = 1});
  const Picture picture = ring.draw();
  for (const double x : {9.75, 9.9, 0.1, 0.25}) EXPECT_TRUE(has_ink(picture, x, 0.0)) << x;
  for (const double x : {1.0, 3.0, 5.0, 7.0, 9.0}) EXPECT_FALSE(has_ink(picture, x, 0.0)) << x;
}

TEST(PeriodicPicture, ASpringToAnAnchorFollowsItsBodyHome) {
  Ring ring;
  ring.add_disc(0.1, {24.0, 0.0});
  ring.world.forces.emplace_back(SpringForce{.body_a = 0, .at_b = Vec2(23.0, 0.0)});
  const Picture picture = ring.draw();
  EXPECT_TRUE(has_ink(picture, 3.5, 0.0));
  for (const double x : {1.0, 2.5, 5.0, 9.0}) EXPECT_FALSE(has_ink(picture, x, 0.0)) << x;
}

TEST(PeriodicPicture, ATrailGoesOnOnTheOtherSide) {
  Ring ring;
  ring.add_disc(0.1, {31.0, -0.8});
  ring.options.trails = {{{28.5, 0.5}, {29.5, 0.5}, {30.5, 0.5}, {31.0, 0.5}}};
  const Picture picture = ring.draw();
  for (const double x : {8.6, 9.4, 9.9, 0.1, 0.9}) EXPECT_TRUE(has_ink(picture, x, 0.5)) << x;
  for (const double x : {1.2, 4.0, 8.3}) EXPECT_FALSE(has_ink(picture, x, 0.5)) << x;
}

TEST(PeriodicPicture, AContactIsSeenWhereItsBodiesAre) {
  Ring ring;
  ring.add_disc(0.1, {52.0, -0.8});
  ring.options.contacts = {{{52.0, 0.0}, {0.0, 1.0}, 1.0}};
  const Picture picture = ring.draw();
  EXPECT_TRUE(has_ink(picture, 2.0, 0.0));
}

TEST(PeriodicPicture, EdgesOverDepthHaveImages) {
  Ring ring;
  ring.add_disc(0.4, {9.9, 0.0});
  const Picture picture = ring.draw("depth");
  // The image's edge is at x = 0.3, light on what is dark on both of its sides.
  double lightest = 0.0;
  for (int column = 13; column <= 17; ++column)
    lightest = std::max(lightest, brightness(picture.at(column, 50)));
  EXPECT_GT(lightest, 0.3);
  EXPECT_LT(brightness(picture.at(5, 50)), 0.1);
}

TEST(PeriodicPicture, WiresOverColorHaveImages) {
  Ring ring;
  ring.add_disc(0.1, {5.0, 0.8});
  FixedSite wire;
  wire.outline = std::make_shared<const Outline>(make_segment({-0.5, 0.0}, {0.5, 0.0}).outline);
  ring.world.sites = {wire};
  ring.sites = {Pose{{9.5, 0.0}, 0.0}};
  ring.world.sites[0].pose = ring.sites[0];
  ring.sites[0].position.x() = 9.8;
  const Picture picture = ring.draw("color");
  EXPECT_LT(darkest(picture, 9.9, 0.0), 0.35);
  EXPECT_LT(darkest(picture, 0.2, 0.0), 0.35);
}

}  // namespace
}  // namespace brink::periodic_test
