// Bodies that fall on floors of every kind, with every restitution below 1: nothing goes through.
#include <gtest/gtest.h>

#include "drops.h"

namespace brink::drops_test {
namespace {

using worlds::from_environment;

// The flight is followed from outside (support/outside); bounces that shrink to nothing may end as Zeno.
// BRINK_SEED moves the seeds, BRINK_DROPS their number.
TEST(Drops, NothingFallsThrough) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1), count = from_environment("BRINK_DROPS", 150);
  drops::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k) drops::fall(first + k, tally);
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << tally;
  EXPECT_EQ(tally.wrong, 0);
}

// Drops that were once told to meet the floor while they parted from it.
TEST(Drops, ThatOnceFailedAreSound) {
  drops::Tally tally;
  for (const std::uint64_t seed : {1011, 1344, 1477, 1682, 1808, 1843, 1952, 2684, 2715})
    EXPECT_TRUE(drops::fall(seed, tally)) << "drop " << seed;
}

}  // namespace
}  // namespace brink::drops_test
