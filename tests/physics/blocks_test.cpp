/// Galperin's billiard: a block between a wall and a block 100^n times as heavy meets them as many times in
/// all as pi has digits: 3, 31, 314 ... (Galperin 2003, "Playing pool with pi").
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/worlds.h"

namespace brink::blocks_test {
namespace {

/// On a line: the wall at x = 0, the light block at rest at 1, the heavy one coming from 2 with speed 1.
World blocks(int n, const Shape& shape) {
  World world;
  for (const auto& [x, v, mass] : {std::tuple{1.0, 0.0, 1.0}, std::tuple{2.0, -1.0, std::pow(100.0, n)}}) {
    Body body = testing::body(shape, {x, 0.0}, {v, 0.0}, mass);
    body.lock_y = body.lock_angle = true;
    testing::add(world, body);
  }
  testing::add(world, testing::site(make_segment({0.0, -1.0}, {0.0, 1.0})));
  return world;
}

class Galperin : public ::testing::TestWithParam<int> {};

constexpr std::uint64_t kDigits[] = {3, 31, 314, 3141, 31415};

// In coordinates scaled by the roots of the masses it is a straight ray in a wedge of angle atan(10^-n), and
// meets its sides floor(pi / angle) times. At 10 s all is over: both recede. Energy is kept.
TEST_P(Galperin, CollisionsSpellPi) {
  const int n = GetParam();
  for (const Shape& shape : {make_disc(0.1), make_box(0.2, 0.2)}) {
    if (n > 2 && shape.outline.sites.size() > 1) continue;  // boxes: a taste, they search more
    Simulator simulator(blocks(n, shape), {});
    const RunSummary summary = simulator.run(testing::until(10.0));
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    EXPECT_EQ(summary.collisions, kDigits[n]) << shape.outline.sites.size() << " sites";
    EXPECT_GE(simulator.state(1).twist.velocity.x(), simulator.state(0).twist.velocity.x());
    EXPECT_GE(simulator.state(0).twist.velocity.x(), 0.0);
    EXPECT_NEAR(summary.energy_final / summary.energy_initial, 1.0, 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(DigitsOfPi, Galperin, ::testing::Range(0, 5));

}  // namespace
}  // namespace brink::blocks_test
