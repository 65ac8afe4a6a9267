// Bodies of a shape: mass, centre and inertia against textbook values.
#include "brink/core/world/make_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "brink/core/base/error.h"

namespace brink::make_body_test {
namespace {

TEST(MakeBody, MassAndInertiaAreThoseOfTextbooks) {
  const Body disc = make_body(make_disc(0.5), Mass{1.0});
  EXPECT_DOUBLE_EQ(disc.inertia, 0.125);
  const Body heavy = make_body(make_disc(0.5), Density{4.0});
  EXPECT_DOUBLE_EQ(heavy.mass, std::numbers::pi);
  EXPECT_DOUBLE_EQ(heavy.inertia, std::numbers::pi / 8.0);
  const Body box = make_body(make_box(3.0, 4.0), Mass{12.0});
  EXPECT_DOUBLE_EQ(box.inertia, 25.0);
  const Body rod = make_body(make_segment({0.0, 0.0}, {6.0, 0.0}), Mass{2.0});
  EXPECT_DOUBLE_EQ(rod.inertia, 6.0);
}

TEST(MakeBody, StandsWhereItWasDrawnAboutItsCentre) {
  const Body body = make_body(make_polygon({{1.0, 1.0}, {4.0, 1.0}, {1.0, 4.0}}), Density{2.0});
  EXPECT_DOUBLE_EQ(body.mass, 9.0);
  EXPECT_NEAR((body.initial.pose.position - Vec2(2.0, 2.0)).norm(), 0.0, 1e-15);
  Vec2 mean = Vec2::Zero();
  for (const Sample& s : body.outline->samples) mean += s.p / 3.0;
  EXPECT_NEAR(mean.norm(), 0.0, 1e-15);
}

TEST(MakeBody, WhatHasNoMeasureOrMassIsRefused) {
  EXPECT_THROW(make_body(make_point({0.0, 0.0}, 0.0), Mass{1.0}), BadInput);
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_THROW(make_body(make_disc(1.0), Mass{bad}), BadInput);
    EXPECT_THROW(make_body(make_disc(1.0), Density{bad}), BadInput);
  }
}

// A body without an inertia is refused: it has no default.
TEST(MakeBody, InertiaMustBeGiven) {
  World world;
  Body body = make_body(make_disc(1.0), Mass{1.0});
  body.name = "ball";
  body.inertia = Body().inertia;
  world.bodies.push_back(body);
  EXPECT_THROW(world.check(), BadInput);
}

}  // namespace
}  // namespace brink::make_body_test
