// Which part of the plane a picture shows when nobody says.
#include "brink/scenes/draw/view.h"

#include <gtest/gtest.h>

#include <numbers>

#include "brink/core/shapes/shapes.h"
#include "brink/scenes/draw/draw.h"

namespace brink::view_test {
namespace {

struct Still {
  World world;
  std::vector<BodyState> bodies;
  std::vector<Pose> sites;

  void body(Shape shape, const Vec2& at) {
    Body b;
    b.name = "body";
    b.outline = std::make_shared<const Outline>(std::move(shape.outline));
    world.bodies.push_back(b);
    bodies.push_back({{at, 0.0}, {}});
  }
  void site(Shape shape, const Pose& pose = {}) {
    FixedSite s;
    s.name = "site";
    s.outline = std::make_shared<const Outline>(std::move(shape.outline));
    world.sites.push_back(s);
    sites.push_back(pose);
  }
  Box view() const { return automatic_view(world, bodies, sites); }
};

TEST(AutomaticView, AnchorsOfSpringsAreSeen) {
  Still still;
  still.body(make_disc(0.1), {0.0, 0.0});
  SpringForce hung;
  hung.at_b = {0.5, 1.2};
  still.world.forces.push_back(hung);
  SpringForce between = hung;  // two bodies: its places are in their frames
  between.body_b = 0;
  between.at_b = {7.0, 7.0};
  still.world.forces.push_back(between);
  const Box view = still.view();
  EXPECT_NEAR((view.low - Vec2(-0.1, -0.1)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((view.high - Vec2(0.5, 1.2)).norm(), 0.0, 1e-12);
}

TEST(AutomaticView, OneDiscIsSeenWhole) {
  Still still;
  still.body(make_disc(0.5), {3.0, 4.0});
  const Box view = still.view();
  EXPECT_NEAR((view.low - Vec2(2.5, 3.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((view.high - Vec2(3.5, 4.5)).norm(), 0.0, 1e-12);
}

TEST(AutomaticView, FloorOfTheScenesSizeIsSeenWhole) {
  // 20 m of floor below a ball 10 m up: twice the height, still a fair picture
  Still still;
  still.body(make_disc(0.5), {0.0, 10.0});
  still.site(make_segment({-10.0, 0.0}, {10.0, 0.0}));
  const Box view = still.view();
  EXPECT_NEAR(view.extent().x(), 20.0, 1e-12);
  EXPECT_NEAR(view.low.y(), 0.0, 1e-12);
  EXPECT_NEAR(view.high.y(), 10.5, 1e-12);
}

TEST(AutomaticView, FloorOfAKilometreIsSeenInPart) {
  Still still;
  still.body(make_disc(0.5), {0.0, 2.0});
  still.site(make_segment({-500.0, 0.0}, {500.0, 0.0}));
  const Box view = still.view();
  EXPECT_NEAR(view.low.y(), 0.0, 1e-12);  // its top is there
  EXPECT_NEAR(view.high.y(), 2.5, 1e-12);
  EXPECT_LT(view.extent().x(), 5.0);  // and the ball is not a speck
}

TEST(AutomaticView, SiteFarAwayIsLeftOut) {
  Still still;
  still.body(make_disc(0.5), {0.0, 0.0});
  still.site(make_disc(0.5), {{1000.0, 0.0}, 0.0});
  EXPECT_NEAR(still.view().extent().x(), 1.0, 1e-12);
}

TEST(AutomaticView, ContainerIsSeenWhole) {
  Still still;
  still.body(make_disc(0.1), {0.5, 0.0});
  still.site(make_disc_container(2.0));
  const Box view = still.view();
  EXPECT_NEAR(view.extent().x(), 4.0,
              1e-9);  // the circle's extreme points lie inside its arcs or at their ends
  EXPECT_NEAR(view.extent().y(), 4.0, 1e-9);
}

TEST(AutomaticView, TurnedArcReachesItsExtremePoint) {
  // a quarter circle of radius 1 from -45 to 45 degrees, turned by 90: its highest point (0, 1) is in its
  // middle
  Still still;
  const double eighth = std::numbers::pi / 4.0;
  still.site(make_arc({0.0, 0.0}, 1.0, -eighth, eighth), {{0.0, 0.0}, std::numbers::pi / 2.0});
  EXPECT_NEAR(still.view().high.y(), 1.0, 1e-12);
}

TEST(AutomaticView, EmptyWorldGivesAnEmptyBox) { EXPECT_TRUE(Still{}.view().empty()); }

TEST(FittedView, PixelsAreSquareAndTheBoxIsInsideWithItsMargin) {
  Box box;
  box.add(Vec2(0.0, 0.0));
  box.add(Vec2(4.0, 1.0));
  const draw::View view = draw::fitted(box, 0.1, 480, 300);
  EXPECT_DOUBLE_EQ(view.scale, 100.0);  // 4 m and twice 10 % of 4 m on 480 pixels
  EXPECT_NEAR(view.window.extent().x() * view.scale, 480.0, 1e-9);
  EXPECT_NEAR(view.window.extent().y() * view.scale, 300.0, 1e-9);
  EXPECT_NEAR((view.to_picture({0.0, 0.5}) - Vec2(40.0, 150.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((view.to_picture({4.0, 1.0}) - Vec2(440.0, 100.0)).norm(), 0.0, 1e-9);  // y upward
}

TEST(FittedView, EmptyAndFlatBoxesStillGiveAView) {
  Box point;
  point.add(Vec2(7.0, 7.0));
  for (const Box& box : {Box{}, point}) {
    const draw::View view = draw::fitted(box, 0.0, 100, 50);
    EXPECT_TRUE(std::isfinite(view.scale));
    EXPECT_GT(view.scale, 0.0);
    EXPECT_TRUE(view.window.contains(box.empty() ? Vec2(0.0, 0.0) : Vec2(7.0, 7.0)));
  }
}

TEST(RoundLength, IsOneTwoOrFiveTimesAPowerOfTenAndNotAbove) {
  EXPECT_DOUBLE_EQ(draw::round_length(1.0), 1.0);
  EXPECT_DOUBLE_EQ(draw::round_length(1.99), 1.0);
  EXPECT_DOUBLE_EQ(draw::round_length(4.9), 2.0);
  EXPECT_DOUBLE_EQ(draw::round_length(99.0), 50.0);
  EXPECT_DOUBLE_EQ(draw::round_length(0.0021), 0.002);
}

}  // namespace
}  // namespace brink::view_test
