// Contacts of one instant, taken together.
#include "brink/scheduler/kernel/group_response.h"

#include <gtest/gtest.h>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::group_response_test {
namespace {

using namespace testing;

// Newton's cradle: a disc hits a row of three that touch. By reflections the last one leaves with all the
// speed; by Newton's law at every contact at once, momentum is kept and nothing approaches.
TEST(GroupResponse, ARowIsTakenWhole) {
  for (const GroupLaw law : {GroupLaw::reflections, GroupLaw::complementarity, GroupLaw::collapsed}) {
    World world;
    world.materials[0].restitution = 1.0;
    add(world, body(make_disc(0.5), {0.0, 0.0}, {2.0, 0.0}));
    for (int k = 0; k < 3; ++k) add(world, body(make_disc(0.5), {3.0 + k, 0.0}, {0.0, 0.0}));
    KernelParts parts(world, {});
    const Certificate c = meeting(parts);
    parts.run.set_time(c.time);
    std::vector<int> changed;
    const auto group = parts.groups.resolve(kDiscs, c.contact, law, changed);
    ASSERT_TRUE(group);
    EXPECT_FALSE(group->endless);
    ASSERT_EQ(group->collisions.size(), 3U);
    double momentum = 0.0;
    std::vector<double> speeds;
    for (int k = 0; k < 4; ++k)
      speeds.push_back(parts.trajectories.body(k).motion.twist(c.time).velocity.x());
    for (int k = 0; k < 4; ++k) momentum += speeds[k];
    for (int k = 1; k < 4; ++k) EXPECT_GE(speeds[k], speeds[k - 1] - 1e-12);
    EXPECT_NEAR(momentum, 2.0, 1e-12);
    if (law == GroupLaw::reflections) {
      EXPECT_NEAR(speeds[3], 2.0, 1e-12);
    }
  }
}

// Where every contact loses, endless rebounds with losses come to no rebound at all.
TEST(GroupResponse, ACollapsedGroupThatLosesDoesNotRebound) {
  KernelParts parts(two_discs(0.9), {});
  const Certificate c = meeting(parts);
  parts.run.set_time(c.time);
  std::vector<int> changed;
  ASSERT_TRUE(parts.groups.resolve(kDiscs, c.contact, GroupLaw::collapsed, changed));
  EXPECT_NEAR(parts.trajectories.body(0).motion.twist(2.0).velocity.x(), 1.0, 1e-12);
  EXPECT_NEAR(parts.trajectories.body(1).motion.twist(2.0).velocity.x(), 1.0, 1e-12);
}

}  // namespace
}  // namespace brink::group_response_test
