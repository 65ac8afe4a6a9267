/// An elastic gas run forward, turned round, and run as long again comes back to where it began.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "brink/core/base/random.h"
#include "tests/support/worlds.h"

namespace brink::reversal_test {
namespace {

/// Twelve discs of radius 0.2 on a loose grid in a box of 3 m by 4 m, with velocities of the seed.
World gas(std::uint64_t seed) {
  Random random(seed);
  World world;
  const Shape disc = make_disc(0.2);
  for (int i = 0; i < 12; ++i)
    testing::add(world, testing::body(disc, {0.6 + 0.9 * (i % 3), 0.5 + 1.0 * (i / 3)},
                                      {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)}));
  const Vec2 corners[] = {{0.0, 0.0}, {3.0, 0.0}, {3.0, 4.0}, {0.0, 4.0}};
  for (int i = 0; i < 4; ++i)
    testing::add(world, testing::site(make_segment(corners[i], corners[(i + 1) % 4])));
  return world;
}

// An error grows about 25 times at each collision of a disc with a disc at this size, so 8 in a row make
// 1e-16 m into 2e-5 m. Up to the time of the gas's eighth such collision no disc has had more than a few:
// what comes back is bounded by the count of the disc that had most, both ways.
TEST(Reversal, ElasticGasComesBack) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const World world = gas(seed);
    testing::Events events;
    Simulator look(world, {});
    look.run(testing::until(20.0), &events);
    std::vector<double> times;
    std::vector<int> met(world.bodies.size(), 0);
    for (const Event& e : events.collisions()) {
      if (e.contact.other_body < 0) continue;
      times.push_back(e.contact.time);
      if (times.size() > 8) break;
      ++met[e.contact.body];
      ++met[e.contact.other_body];
    }
    ASSERT_EQ(times.size(), 9U);
    const double turn = 0.5 * (times[7] + times[8]);

    Simulator forward(world, {});
    const RunSummary there = forward.run(testing::until(turn));
    World back = world;
    for (std::size_t k = 0; k < back.bodies.size(); ++k) {
      const BodyState s = forward.state(static_cast<int>(k));
      back.bodies[k].initial = {s.pose, {-s.twist.velocity, -s.twist.omega}};
    }
    Simulator backward(back, {});
    const RunSummary again = backward.run(testing::until(turn));
    EXPECT_EQ(again.collisions, there.collisions) << "seed " << seed;
    const double allowed = 1e-15 * std::pow(25.0, 2 * *std::max_element(met.begin(), met.end()));
    for (std::size_t k = 0; k < back.bodies.size(); ++k) {
      const BodyState s = backward.state(static_cast<int>(k)), start = world.bodies[k].initial;
      EXPECT_LE((s.pose.position - start.pose.position).norm(), std::min(allowed, 1e-9)) << "seed " << seed;
      EXPECT_LE((s.twist.velocity + start.twist.velocity).norm(), std::min(allowed, 1e-9)) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace brink::reversal_test
