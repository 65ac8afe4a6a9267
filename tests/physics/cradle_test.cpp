/// Newton's cradle and the disc that meets two: collisions in a row, one at a time.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/worlds.h"

namespace brink::cradle_test {
namespace {

using testing::Events;

/// n discs of radius 1/2 in a row along x, `gap` apart; the first comes from a distance with speed v.
World cradle(int n, double gap, double v) {
  World world;
  const Shape disc = make_disc(0.5);
  for (int i = 0; i < n; ++i)
    testing::add(
        world, testing::body(disc, {i * (1.0 + gap) - (i == 0 ? 0.25 : 0.0), 0.0}, {i == 0 ? v : 0.0, 0.0}));
  return world;
}

class Cradle : public ::testing::TestWithParam<std::pair<int, double>> {};

// Equal masses, e = 1: each collision hands the whole velocity on, so n-1 collisions and only the last moves.
TEST_P(Cradle, ElasticRowHandsTheVelocityToTheLast) {
  const auto [n, gap] = GetParam();
  const double v = 1.7;
  Simulator simulator(cradle(n, gap, v), {});
  Events events;
  const RunSummary summary = simulator.run(testing::until(3.0), &events);
  ASSERT_EQ(summary.termination, Termination::reached_end) << summary.why;
  EXPECT_EQ(events.collisions().size(), static_cast<std::size_t>(n - 1));
  for (int i = 0; i < n; ++i)
    EXPECT_NEAR(simulator.state(i).twist.velocity.x(), i == n - 1 ? v : 0.0, 1e-14) << "disc " << i;
}

INSTANTIATE_TEST_SUITE_P(RowsWithAndWithoutGaps, Cradle,
                         ::testing::Values(std::pair{2, 0.01}, std::pair{5, 0.01}, std::pair{20, 0.001},
                                           std::pair{3, 0.0}, std::pair{5, 0.0}, std::pair{10, 0.0}));

// Disc v = (1, 0) on two touching equal discs at +-30 degrees, upper first (index order): the first collision
// leaves v0 = (1/4, -sqrt3/4), the second (-1/8, -sqrt3/8); speeds sqrt3/2 and sqrt3/4; energy is kept.
TEST(DiscOnTwo, UpperFirstOneAtATimeGivesTheClosedForm) {
  World world;
  const Shape disc = make_disc(0.5);
  const double c = std::cos(M_PI / 6.0), s = std::sin(M_PI / 6.0);
  testing::add(world, testing::body(disc, {-0.5, 0.0}, {1.0, 0.0}));
  testing::add(world, testing::body(disc, {c, s}, {0.0, 0.0}));
  testing::add(world, testing::body(disc, {c, -s}, {0.0, 0.0}));
  Simulator simulator(world, {});
  Events events;
  ASSERT_EQ(simulator.run(testing::until(2.0), &events).termination, Termination::reached_end);
  ASSERT_EQ(events.collisions().size(), 2U);
  EXPECT_EQ(events.collisions()[0].contact.other_body, 1);
  const Vec2 v0 = simulator.state(0).twist.velocity;
  EXPECT_NEAR(v0.x(), -1.0 / 8.0, 1e-14);
  EXPECT_NEAR(v0.y(), -std::sqrt(3.0) / 8.0, 1e-14);
  EXPECT_NEAR(simulator.state(1).twist.velocity.norm(), std::sqrt(3.0) / 2.0, 1e-14);
  EXPECT_NEAR(simulator.state(2).twist.velocity.norm(), std::sqrt(3.0) / 4.0, 1e-14);
  double energy = 0.0;
  for (int i = 0; i < 3; ++i) energy += 0.5 * simulator.state(i).twist.velocity.squaredNorm();
  EXPECT_NEAR(energy, 0.5, 1e-14);
}

}  // namespace
}  // namespace brink::cradle_test
