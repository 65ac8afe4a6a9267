// Worlds in which nothing is in general position, looked at from outside and under two policies.
#include <gtest/gtest.h>

#include "aligned_worlds.h"
#include "random_worlds_checks.h"

namespace brink {
namespace {

// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
TEST(AlignedWorlds, NothingPassesAndPoliciesAgree) {
  const std::uint64_t first = worlds::from_environment("BRINK_SEED", 500),
                      count = worlds::from_environment("BRINK_WORLDS", 200);
  aligned::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k)
    EXPECT_TRUE(aligned::run(first + k, tally)) << "seed " << first + k;
  std::cout << tally;
}

// Right on the end of a wire, flush in a corner of a wall and a block.
TEST(AlignedWorlds, ThatOnceFailedAreSound) {
  aligned::Tally tally;
  for (const std::uint64_t seed : {30, 34, 989}) EXPECT_TRUE(aligned::run(seed, tally)) << "seed " << seed;
}

}  // namespace
}  // namespace brink
