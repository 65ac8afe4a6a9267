// Where a scheduler of single collisions comes to an end.
#include "brink/scheduler/kernel/endings.h"

#include <gtest/gtest.h>

namespace brink {
namespace {

Outcome collision(int body, int other, double closing = 1.0) {
  Outcome o;
  o.pair = {body, other, -1, {}};
  o.contact.sample = o.contact.site = 0;
  o.contact.closing_speed = closing;
  o.rest = 1.0;
  return o;
}

TEST(Endings, TheLimitIsTold) {
  Endings endings(1e-10, 3);
  EXPECT_FALSE(endings.collided(collision(0, 1), 1.0, BounceLoss::none, 1));
  EXPECT_FALSE(endings.collided(collision(0, 1), 2.0, BounceLoss::none, 2));
  const auto ending = endings.collided(collision(0, 1), 3.0, BounceLoss::none, 3);
  ASSERT_TRUE(ending);
  EXPECT_EQ(ending->kind, Ending::Kind::limit);
  EXPECT_EQ(ending->count, 3U);
}

// Collisions of one instant without end: first they are to be taken together, and if that does not help the
// group is endless. A later instant begins anew.
TEST(Endings, AGroupCollapsesAndThenIsEndless) {
  Endings endings(1e-10, 0);
  std::optional<Ending> ending;
  std::uint64_t n = 0;
  while (!ending) ending = endings.collided(collision(0, 1), 5.0, BounceLoss::none, ++n);
  EXPECT_EQ(ending->kind, Ending::Kind::group);
  EXPECT_TRUE(endings.collapsed(5.0));
  EXPECT_FALSE(endings.collapsed(5.1));
  EXPECT_GT(n, 2000U);
  ending.reset();
  while (!ending) ending = endings.collided(collision(0, 1), 5.0, BounceLoss::none, ++n);
  EXPECT_EQ(ending->kind, Ending::Kind::endless_group);
  EXPECT_FALSE(endings.collided(collision(0, 1), 6.0, BounceLoss::none, ++n));
}

TEST(Endings, BouncesThatShrinkEndAtTheirLimit) {
  Endings endings(1e-10, 0);
  double t = 0.0, flight = 1e-6;
  std::optional<Ending> ending;
  for (int k = 0; k < 200 && !ending; ++k, t += flight, flight *= 0.5) {
    Outcome o = collision(0, 1, 5.0 * flight);
    o.rest = flight;
    ending = endings.collided(o, t, BounceLoss::some, k + 1);
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
    o.rest = flight;
    EXPECT_FALSE(endings.collided(o, t, BounceLoss::some, k + 1));
  }
}

TEST(Endings, GoOnFromWhatWasSaved) {
  Endings endings(1e-10, 0), again(1e-10, 0);
  for (int k = 0; k < 1500; ++k) endings.collided(collision(k % 7, 8), 5.0, BounceLoss::none, k);
  again.restore(endings.saved());
  std::uint64_t n = 1500, m = 1500;
  while (!endings.collided(collision(0, 1), 5.0, BounceLoss::none, ++n)) continue;
  while (!again.collided(collision(0, 1), 5.0, BounceLoss::none, ++m)) continue;
  EXPECT_EQ(n, m);
}

}  // namespace
}  // namespace brink
