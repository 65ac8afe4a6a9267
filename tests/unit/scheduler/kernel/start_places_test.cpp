// Bodies that the scene places a hair across a wire are moved to just before it, and nobody else is.
#include <gtest/gtest.h>

#include "tests/support/worlds.h"

namespace brink::start_places_test {
namespace {

using namespace testing;

World on_a_wire(double height, double angle = 0.0) {
  World world;
  world.gravity = {0.0, -9.81};
  add(world, body(make_box(1.0, 1.0), {0.0, height}, {0.3, 0.0}, 1.0, angle));
  add(world, site(make_segment({-5.0, 0.0}, {5.0, 0.0})));
  return world;
}

RunSummary ran(const World& world, double end = 0.2) { return Simulator(world, {}).run(until(end)); }

TEST(StartPlaces, ABoxAcrossAWireIsMovedToJustBeforeIt) {
  for (const double deep : {1e-13, 1e-11, 1e-9, 9e-7}) {
    const World world = on_a_wire(0.5 - deep);
    const Simulator simulator(world, {});
    // by a thousandth of the contact tolerance more: of 1e-10 of the box's diameter
    EXPECT_NEAR(simulator.state(0).pose.position.y(), 0.5 + 1.414e-13, 2e-15) << deep;
    EXPECT_EQ(simulator.state(0).pose.position.x(), 0.0);
    const RunSummary s = ran(world);
    EXPECT_TRUE(s.sound()) << deep << ": " << s.why;
    EXPECT_EQ(s.moved_at_start, 1);
    EXPECT_NEAR(s.moved_by, deep, 2e-13);
  }
}

TEST(StartPlaces, WhatStandsAtTheWireOrBeforeItStays) {
  for (const double height : {0.5, 0.5 + 1e-12, 0.7}) {
    const Simulator simulator(on_a_wire(height), {});
    EXPECT_EQ(simulator.state(0).pose.position, Vec2(0.0, height));
    EXPECT_EQ(ran(on_a_wire(height)).moved_at_start, 0);
  }
}

TEST(StartPlaces, FromBelowItIsMovedDown) {
  World world = on_a_wire(-0.5 + 1e-9);
  world.gravity.y() = 9.81;
  EXPECT_LT(Simulator(world, {}).state(0).pose.position.y(), -0.5);
  EXPECT_TRUE(ran(world).sound());
}

TEST(StartPlaces, ATipAcrossAnArcOfWireIsMovedTowardsItsBody) {
  World world;
  world.gravity = {0.0, -9.81};
  const double half = std::sqrt(0.5);
  add(world, body(make_box(1.0, 1.0), {0.0, half - 1e-9}, {0.0, 0.0}, 1.0, 0.25 * 3.14159265358979323846));
  add(world, site(make_arc({0.0, 2.0}, 2.0, 3.5, 6.0)));
  EXPECT_GT(Simulator(world, {}).state(0).pose.position.y(), half);
  EXPECT_EQ(ran(world).moved_at_start, 1);
}

TEST(StartPlaces, ALockHoldsTheBodyWhereItIs) {
  World world = on_a_wire(0.5 - 1e-9);
  world.bodies[0].lock_y = true;
  EXPECT_EQ(Simulator(world, {}).state(0).pose.position, Vec2(0.0, 0.5 - 1e-9));
}

TEST(StartPlaces, WhatIsDeeperThanAFilesDigitsIsRefused) {
  EXPECT_NE(Simulator(on_a_wire(0.5 - 1e-5), {}).start_fault(), "");
}

// Wires in wires: a roof that hangs on a short wire by its ridge is where it belongs.
TEST(StartPlaces, EdgesThatGoAlongAWireOrAwayFromItAreNotAcross) {
  World world;
  world.gravity = {0.0, -9.81};
  add(world,
      body(make_chain({{-1.0, 0.0}, {1.0, 0.0}, {1.0, -1.0}, {-1.0, -1.0}}, true), {0.0, 0.5}, {0.0, 0.0}));
  add(world, site(make_segment({-0.5, 0.0}, {0.5, 0.0})));
  const Vec2 before = world.bodies[0].initial.pose.position;
  EXPECT_EQ(Simulator(world, {}).state(0).pose.position, before);
}

}  // namespace
}  // namespace brink::start_places_test
