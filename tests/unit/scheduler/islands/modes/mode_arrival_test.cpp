#include "brink/scheduler/islands/modes/mode_arrival.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/scheduler/islands/modes/mode_scenes.h"

namespace brink {
namespace {

PolynomialPiece piece(double end, std::initializer_list<Vec3> c) {
  PolynomialPiece p;
  p.end = end;
  p.degree = static_cast<int>(c.size()) - 1;
  std::copy(c.begin(), c.end(), p.c.begin());
  return p;
}

Arrival arrival_of(const ModeScene& s, const PolynomialPiece& p) {
  return first_arrival(s.problem, std::vector(s.problem.contacts.size(), MotionMode::open), {p}, 0.0, p.end,
                       1e-13);
}

// The tip of a bar that turns dips under the floor and is out again, many times before the end: gaps at the ends say
// nothing.
TEST(FirstArrival, TipThatTurnsUnderTheFloorAndOutAgainArrivesTheFirstTime) {
  const double l = 0.5, omega = 20.0;
  for (const double height : {0.45, 0.499, 0.4999999}) {
    ModeScene s;
    s.add_body(1, 1, {});
    s.add(point_on_line({l, 0}, {0, 0}, {0, 1}), 0, s.add_still(), 0.0);
    const Arrival a = arrival_of(s, piece(4.0, {{0, height, 0}, {0, 0, omega}}));
    ASSERT_TRUE(a.found) << height;
    EXPECT_NEAR(a.time, (std::numbers::pi + std::asin(height / l)) / omega, 1e-9) << height;
    EXPECT_FALSE(arrival_of(s, piece(4.0, {{0, l * (1 + 1e-9), 0}, {0, 0, omega}})).found);
  }
}

TEST(FirstArrival, PlacesBesideTheSegmentAreNoContact) {
  ModeScene s;
  s.add_body(1, 1, {});
  SmoothContact c = point_on_line({0, 0}, {0, 0}, {0, 1}, 0.1);
  c.range = {HalfPlane{{1, 0}, 0.0}, HalfPlane{{-1, 0}, -1.0}};  // from 0 to 1
  s.add(c, 0, s.add_still(), 0.0);
  EXPECT_FALSE(arrival_of(s, piece(2.0, {{1.5, 1, 0}, {0, -1, 0}})).found);
  const Arrival a =
      arrival_of(s, piece(3.0, {{1.5, 0.05, 0}, {-0.5, 0, 0}}));  // from the side, below its height
  ASSERT_TRUE(a.found);
  EXPECT_NEAR(a.time, 1.0, 1e-12);
  EXPECT_NEAR(arrival_of(s, piece(3.0, {{0.5, 1, 0}, {0, -1, 0}})).time, 0.9, 1e-12);
}

TEST(FirstArrival, WhatLiftsFromRestIsNoArrival) {
  ModeScene s;
  s.add_body(1, 1, {});
  s.add(point_on_line({0, 0}, {0, 0}, {0, 1}), 0, s.add_still(), 0.0);
  EXPECT_FALSE(arrival_of(s, piece(1.0, {{0, 0, 0}, {1, 0, 0}, {0, 1e-3, 0}})).found);
  const Arrival back = arrival_of(s, piece(1.0, {{0, 0, 0}, {1, 1, 0}, {0, -2, 0}}));  // up and down again
  ASSERT_TRUE(back.found);
  EXPECT_NEAR(back.time, 0.5, 1e-12);
}

TEST(FirstArrival, DiscInABowlMeetsItFromInside) {
  ModeScene s;
  s.add_body(1, 1, {});
  s.add(in_bowl(0.5, 2.0), 0, s.add_still(), 0.0);
  const Arrival a = arrival_of(s, piece(4.0, {{0.3, 0.2, 0}, {1, 0.5, 0}}));
  ASSERT_TRUE(a.found);
  const double b = 0.3 + 0.1, c = 0.09 + 0.04 - 2.25;  // |x0 + v t| = 1.5
  EXPECT_NEAR(a.time, (-b + std::sqrt(b * b - 1.25 * c)) / 1.25, 1e-12);
}

}  // namespace
}  // namespace brink
