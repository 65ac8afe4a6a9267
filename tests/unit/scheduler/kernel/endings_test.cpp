// Where a scheduler of single collisions comes to an end.
#include "brink/scheduler/kernel/endings.h"

#include <gtest/gtest.h>

namespace brink::endings_test {
namespace {

Outcome collision(int body, int other, double closing = 1.0) {
  Outcome o;
  o.pair = {body, other, -1, {}};
  o.contact.sample = o.contact.site = 0;
  o.contact.closing_speed = closing;
  o.since_last = 1.0;
  return o;
}

TEST(Endings, TheLimitIsTold) {
  Endings endings(1e-10, 3);
  EXPECT_FALSE(endings.at_limit(2));
  EXPECT_TRUE(endings.at_limit(3));
  EXPECT_TRUE(endings.at_limit(4));
  endings.set_limit(0);
  EXPECT_FALSE(endings.at_limit(1000000));
}

// Between the collisions time goes on by no more than the clock can just tell, for ever: they are to be taken together, and if that
// does not help they are endless. What comes after a flight begins a new count, and so do bounces that come apart again.
TEST(Endings, CollisionsBetweenWhichTimeHardlyGoesOnAreEndless) {
  for (const bool with_flights : {false, true}) {
    Endings endings(1e-10, 0);
    std::optional<Ending> ending;
    double now = 5.0;
    int n = 0;
    bool together = false;
    for (; !ending && n < 50000; ++n) {
      now += 1e-13;
      Outcome o = collision(0, 1);
      o.since_last = with_flights && n % 1000 == 0 ? 1e-3 : 1e-13;
      ending = endings.collided(o, now, BounceLoss::none);
      // a run that is gone on with counts on
      Endings other(1e-10, 0);
      other.restore(endings.saved());
      endings = other;
      if (ending && ending->kind == Ending::Kind::group && !together) together = true, ending.reset();
      EXPECT_EQ(endings.collapsed(now), together);
    }
    EXPECT_EQ(ending.has_value(), !with_flights) << n;
    EXPECT_EQ(together, !with_flights);
    EXPECT_TRUE(with_flights || ending->kind == Ending::Kind::endless_group);
  }
}

// Collisions of one instant without end: first they are to be taken together, and if that does not help the
// group is endless. A later instant begins anew.
TEST(Endings, AGroupCollapsesAndThenIsEndless) {
  Endings endings(1e-10, 0);
  std::optional<Ending> ending;
  std::uint64_t n = 0;
  for (; !ending; ++n) ending = endings.collided(collision(0, 1), 5.0, BounceLoss::none);
  EXPECT_EQ(ending->kind, Ending::Kind::group);
  EXPECT_TRUE(endings.collapsed(5.0));
  EXPECT_FALSE(endings.collapsed(5.1));
  EXPECT_GT(n, 2000U);
  ending.reset();
  for (; !ending; ++n) ending = endings.collided(collision(0, 1), 5.0, BounceLoss::none);
  EXPECT_EQ(ending->kind, Ending::Kind::endless_group);
  EXPECT_FALSE(endings.collided(collision(0, 1), 6.0, BounceLoss::none));
}

TEST(Endings, BouncesThatShrinkEndAtTheirLimit) {
  Endings endings(1e-10, 0);
  double t = 0.0, flight = 1e-6;
  std::optional<Ending> ending;
  for (int k = 0; k < 200 && !ending; ++k, t += flight, flight *= 0.5) {
    Outcome o = collision(0, 1, 5.0 * flight);
    o.since_last = flight;
    ending = endings.collided(o, t, BounceLoss::some);
  }
  ASSERT_TRUE(ending);
  EXPECT_EQ(ending->kind, Ending::Kind::zeno);
  EXPECT_NEAR(ending->time, 2e-6, 1e-12);
}

TEST(Endings, WhatAPictureShowsIsNoSeries) {
  Endings endings(1e-10, 0);
  double t = 0.0, flight = 1e-6;
  for (int k = 0; k < 30; ++k, t += flight, flight *= 0.5) {
    Outcome o = collision(0, 1, 5.0 * flight);
    o.contact.seen = true;
    o.since_last = flight;
    EXPECT_FALSE(endings.collided(o, t, BounceLoss::some));
  }
}

TEST(Endings, GoOnFromWhatWasSaved) {
  Endings endings(1e-10, 0), again(1e-10, 0);
  for (int k = 0; k < 1500; ++k) endings.collided(collision(k % 7, 8), 5.0, BounceLoss::none);
  again.restore(endings.saved());
  std::uint64_t n = 1500, m = 1500;
  while (!endings.collided(collision(0, 1), 5.0, BounceLoss::none)) ++n;
  while (!again.collided(collision(0, 1), 5.0, BounceLoss::none)) ++m;
  EXPECT_EQ(n, m);
}

}  // namespace
}  // namespace brink::endings_test
