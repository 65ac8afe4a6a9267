// Who has collided within one instant, few or many.
#include "brink/scheduler/resolve/instant_bodies.h"

#include <gtest/gtest.h>

namespace brink::instant_bodies_test {
namespace {

PairKey pair_of(int a, int b) { return {a, b, -1, {}}; }

TEST(InstantBodies, AreListedAsTheyCame) {
  InstantBodies bodies;
  EXPECT_EQ(bodies.count(), 0U);
  bodies.add(pair_of(4, 7));
  EXPECT_EQ(bodies.list(), (std::vector<int>{4, 7}));
  bodies.add(pair_of(2, 4));
  bodies.add({9, -1, 3, {}});  // a site is no body
  EXPECT_EQ(bodies.list(), (std::vector<int>{4, 7, 2, 4, 9}));
  EXPECT_EQ(bodies.count(), 5U);
  bodies.clear();
  EXPECT_EQ(bodies.count(), 0U);
  bodies.add({9, -1, 3, {}});
  EXPECT_EQ(bodies.list(), std::vector<int>{9});
}

TEST(InstantBodies, AreOnesOfEachOnceTheyAreMany) {
  InstantBodies bodies;
  for (int k = 0; k < 3000; ++k) bodies.add(pair_of(k % 5, k % 5 + 1));
  EXPECT_TRUE(bodies.often());
  EXPECT_EQ(bodies.list(), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  InstantBodies restored;
  restored.add(pair_of(8, 9));  // forgotten
  restored.restore(bodies.list(), bodies.often());
  EXPECT_EQ(restored.list(), bodies.list());
  restored.restore({3, 3, 1}, false);
  restored.add(pair_of(1, 2));
  EXPECT_EQ(restored.list(), (std::vector<int>{3, 3, 1, 1, 2}));
}

}  // namespace
}  // namespace brink::instant_bodies_test
