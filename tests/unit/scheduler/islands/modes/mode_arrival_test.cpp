#include "brink/scheduler/islands/modes/mode_arrival.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/scheduler/islands/modes/mode_scenes.h"

namespace brink::mode_arrival_test {
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

// An arc whose back is towards the side comes under its end to the last bit of the clock: that is no arrival.
TEST(FirstArrival, WhatFacesAwayDoesNotArriveAtTheEndOfTheRange) {
  ModeScene s;
  s.add_body(1, 1, {});
  SmoothContact c = point_on_line({0, 0}, {0, 0}, {0, 1}, 0.1);
  c.range = {HalfPlane{{1, 0}, 0.0}, HalfPlane{{-1, 0}, -1.0}};     // from 0 to 1
  c.sector = {HalfPlane{{0, 1}, 0.0}, HalfPlane{{0.6, 0.8}, 0.0}};  // upwards
  s.add(c, 0, s.add_still(), 0.0);
  EXPECT_FALSE(arrival_of(s, piece(3.0, {{1.5, 0.05, 0}, {-0.5, 0, 0}})).found);
  // half a turn later it faces the side
  const Arrival a = arrival_of(s, piece(3.0, {{0.5, 0.05, 0}, {0, 0, 1}}));
  ASSERT_TRUE(a.found);
  EXPECT_NEAR(a.time, 0.5 * std::numbers::pi + std::asin(0.6), 1e-12);
}

// A wire has no inside that would tell on which side a point is that has come to it to the last bit.
TEST(FirstArrival, AWireIsMetBeforeItsGapIsNone) {
  ModeScene s;
  s.add_body(1, 1, {});
  s.add(point_on_line({0, 0}, {0, 0}, {0, 1}), 0, s.add_still(), 0.0);
  s.problem.contacts[0].closes_at = 1e-3;
  const Arrival a = arrival_of(s, piece(2.0, {{0, 1, 0}, {0, -1, 0}}));
  ASSERT_TRUE(a.found);
  EXPECT_NEAR(a.time, 1.0 - 1e-3, 1e-12);
  EXPECT_GE(1.0 - a.time, 1e-3 - 1e-15);
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

// A quarter of a ring that turns comes under a disc that stands still, in the way of where the ring is: what is out
// of range now is in range later.
TEST(FirstArrival, ArcOfASpinningOwnerTurnsUnderWhatStands) {
  ModeScene s;
  s.add_body(1, 1, {});
  SmoothContact c;
  c.kind = SmoothContact::Kind::circle;
  c.radius = 2.0;
  c.sample_radius = 0.5;
  c.range = {HalfPlane{{1, 0}, 0.0}, HalfPlane{{0, 1}, 0.0}};  // the first quadrant of the ring's own frame
  const double omega = 1.0;
  s.add(c, 0, s.add_support(Motion::ballistic(0.0, {{}, {{0, 0}, omega}}, {})), 0.0);
  // to the right and below, a tenth within the ring's radius: met when the quadrant's lower edge is gone past
  const Arrival a = arrival_of(s, piece(8.0, {{2.4 * std::cos(1.0), -2.4 * std::sin(1.0), 0}}));
  ASSERT_TRUE(a.found);
  EXPECT_NEAR(a.time, 2.0 * std::numbers::pi - 1.0 - std::numbers::pi / 2.0, 1e-9);
}

// A point that hovers within the slack, for longer than steps can be made so short, and comes down at the end: it is
// not told to stay open.
TEST(FirstArrival, WhatHoversForLongIsNotTakenForOpen) {
  ModeScene s;
  s.add_body(1, 1, {});
  s.add(point_on_line({0, 0}, {0, 0}, {0, 1}), 0, s.add_still(), 0.0);
  // turning fast about itself bends every bound, and moves nothing
  s.problem.contacts[0].shape.sample = {1e-3, 0};
  const double down = 0.5;
  PolynomialPiece p = piece(1.0, {{0, 2e-3, 0}, {0, 0, 1e5}, {0, -down, 0}});
  Arrival a = first_arrival(s.problem, {MotionMode::open}, {p}, 0.0, 1.0, 1e-13);
  EXPECT_TRUE(a.found || a.time < 1.0);
  // gone on with from there as often as need be, it is found
  for (int n = 0; n < 10000 && !a.found && a.time < 1.0; ++n)
    a = first_arrival(s.problem, {MotionMode::open}, {p}, a.time, 1.0, 1e-13);
  ASSERT_TRUE(a.found);
  EXPECT_NEAR(a.time, std::sqrt((2e-3 - 1e-3) / down), 1e-4);
}

}  // namespace
}  // namespace brink::mode_arrival_test
