// Knots between which a cubic is off by no more than was asked for.
#include "brink/scheduler/kernel/knot_teller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace brink::knot_teller_test {
namespace {

/// x = t^4 for 2 s: of a cubic over h the error is h^4 / 16 at its middle.
Motion quartic() {
  PolynomialPiece p;
  p.begin = p.origin = 0.0;
  p.end = 2.0;
  p.degree = 4;
  p.c[4] = Vec3(1.0, 0.0, 0.0);
  const auto track = std::make_shared<Track>();
  track->pieces.push_back(p);
  return Motion::dense(track);
}

TEST(KnotTeller, TellsNobodyByItself) { EXPECT_FALSE(KnotTeller()); }

TEST(KnotTeller, ACubicBetweenItsKnotsIsOffByNoMoreThanTheTolerance) {
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    std::vector<Knot> knots;
    const KnotTeller teller([&](const Knot& k) { knots.push_back(k); }, tolerance);
    EXPECT_TRUE(teller);
    teller.bends(5, 1.5, quartic(), 0.0);
    double before = 0.0;
    for (const Knot& k : knots) {
      EXPECT_EQ(k.body, 5);
      EXPECT_NEAR(k.pose.position.x(), std::pow(k.time, 4), 1e-14);
      EXPECT_NEAR(k.before.velocity.x(), 4.0 * std::pow(k.time, 3), 1e-13);
      EXPECT_LE(std::pow(k.time - before, 4) / 16.0, tolerance * (1.0 + 1e-12));
      before = k.time;
    }
    EXPECT_LT(before, 1.5);  // of the end itself tells who asks
    EXPECT_LE(std::pow(1.5 - before, 4) / 16.0, tolerance * (1.0 + 1e-12));
    EXPECT_LE(static_cast<double>(knots.size()), 1.5 / std::pow(16.0 * tolerance, 0.25) + 1.0);
  }
}

TEST(KnotTeller, AFlightHasNoKnotsButWhereItEnds) {
  std::vector<Knot> knots;
  const KnotTeller teller([&](const Knot& k) { knots.push_back(k); }, 1e-9);
  BodyState start;
  start.twist.velocity = {3.0, 0.0};
  const Motion flight = Motion::ballistic(0.0, start, {{0.0, -10.0}, 0.0});
  teller.bends(0, 1.0, flight, 0.5);
  EXPECT_TRUE(knots.empty());
  BodyState after = flight.state(1.0);
  after.twist.velocity = {0.0, 7.0};
  teller.begins_anew(0, 1.0, flight, after);
  ASSERT_EQ(knots.size(), 1U);
  EXPECT_EQ(knots[0].before.velocity, Vec2(3.0, -10.0));
  EXPECT_EQ(knots[0].after.velocity, Vec2(0.0, 7.0));
}

}  // namespace
}  // namespace brink::knot_teller_test
