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

// Two boxes that turn and meet: in instalments or at once it is the same contact; as far as the answer is needed a search does
// not stop, and beyond that it does.
TEST(ContactSearch, StopsBeyondWhatIsNeeded) {
  World world;
  add(world, body(make_box(2.0, 1.0), {-2.0, 0.125}, {1.5, 0.0}));
  add(world, body(make_box(1.5, 1.5), {2.0, -0.125}, {-1.0, 0.0625}));
  world.bodies[0].initial.twist.omega = 1.5;
  world.bodies[1].initial.twist.omega = -0.75;
  KernelParts parts(world, {});
  const auto search = [&](double from, const Instalment& instalment) {
    return parts.search.search({0, 1, -1, {}}, parts.trajectories.body(0), &parts.trajectories.body(1), from,
                               4.0, instalment);
  };
  const auto at_once = search(0.0, {});
  ASSERT_TRUE(at_once);
  ASSERT_EQ(at_once->kind, Certificate::Kind::contact);
  const auto same = [&](const Certificate& c) {
    return c.kind == Certificate::Kind::contact && c.time == at_once->time &&
           c.contact.sample == at_once->contact.sample && c.contact.site == at_once->contact.site &&
           c.contact.point == at_once->contact.point && c.contact.normal == at_once->contact.normal;
  };
  const auto first = search(0.0, {1});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->kind, Certificate::Kind::undecided);
  EXPECT_LT(first->time, at_once->time);
  const auto needed_to_the_end = search(0.0, {1, 4.0});
  ASSERT_TRUE(needed_to_the_end);
  EXPECT_TRUE(same(*needed_to_the_end));
  // no further than one step beyond
  const double needed = 0.5 * (first->time + at_once->time);
  const auto second = search(0.0, {1, needed});
  ASSERT_TRUE(second);
  EXPECT_EQ(second->kind, Certificate::Kind::undecided);
  EXPECT_GT(second->time, needed);
  EXPECT_LT(second->time, at_once->time);
  int instalments = 1;
  for (double from = first->time; instalments < 1000; ++instalments) {
    const auto next = search(from, {1});
    ASSERT_TRUE(next);
    from = next->time;
    if (next->kind != Certificate::Kind::contact) continue;
    EXPECT_TRUE(same(*next));
    break;
  }
  EXPECT_GT(instalments, 3);
  EXPECT_LT(instalments, 1000);
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
