// Searches of pairs on the motions that bodies have.
#include "brink/scheduler/kernel/contact_search.h"

#include <gtest/gtest.h>

#include "tests/unit/scheduler/kernel/parts.h"

namespace brink::contact_search_test {
namespace {

using namespace testing;

TEST(ContactSearch, PairsNameTheLowerBodyFirst) {
  KernelParts parts(two_discs(), {});
  EXPECT_EQ(parts.search.pair_of(1, 0), kDiscs);
  EXPECT_EQ(parts.search.pair_of(2, 1), kWall);
  EXPECT_FALSE(parts.search.pair_of(1, 1));
  EXPECT_FALSE(parts.search.pair_of(2, 2));
  EXPECT_EQ(parts.search.name_of(kWall), "'body1' on 'site0'");
}

TEST(ContactSearch, FindsTheMeetingAndSpeaksOfItsVersions) {
  KernelParts parts(two_discs(), {});
  parts.trajectories.body(1).version = 7;
  const Certificate c = meeting(parts);
  EXPECT_NEAR(c.time, 1.0, 1e-15);
  EXPECT_EQ(c.kind, Certificate::Kind::contact);
  EXPECT_EQ(c.version_body, 0U);
  EXPECT_EQ(c.version_other, 7U);
  EXPECT_DOUBLE_EQ(c.contact.closing_speed, 2.0);
  EXPECT_FALSE(
      parts.search.search(kDiscs, parts.trajectories.body(0), &parts.trajectories.body(1), 0.0, 0.9));
  EXPECT_EQ(parts.run.work().certificates_issued, 1U);
}

TEST(ContactSearch, GapsTouchesAndCrossingsAreThoseOfATime) {
  KernelParts parts(two_discs(), {});
  EXPECT_NEAR(parts.search.gap(kDiscs, 0.5), 1.0, 1e-15);
  EXPECT_NEAR(parts.search.gap(kDiscs, 1.5), -1.0, 1e-15);
  EXPECT_TRUE(parts.search.touching(kDiscs, 0.0, 0.5).empty());
  EXPECT_EQ(parts.search.touching(kDiscs, 0.0, 1.5).size(), 1U);
}

// In a plane that repeats every 6 m, disc 1 is met behind disc 0 too: its image stands at -3.
TEST(ContactSearch, AnImageIsWhereItsPeriodsPutIt) {
  World world = two_discs();
  world.sites.clear();
  world.periods.size = {6.0, 0.0};
  world.bodies[0].initial.twist.velocity.x() = -2.0;
  KernelParts parts(world, {});
  const PairKey image{0, 1, -1, {-1, 0}};
  const auto c =
      parts.search.search(image, parts.trajectories.body(0), &parts.trajectories.body(1), 0.0, 10.0);
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->time, 1.0, 1e-15);
  EXPECT_NEAR(static_cast<double>(parts.search.other_state(image, 0.0).position.x()), -3.0, 1e-15);
}

}  // namespace
}  // namespace brink::contact_search_test
