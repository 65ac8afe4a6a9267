// Random programs in random worlds: bodies put elsewhere, pushed, let through each other, at random times and
// at events.
#include <gtest/gtest.h>

#include "doors_checks.h"

namespace brink::doors_test {
namespace {

using worlds::from_environment;

// No wall and no body is passed but where a filter says so, a push changes momentum and energy by what it
// says, by geometry and physics that share no code with Brink's (support/outside); every exact policy, kills
// after doors and at checkpoints, and runs that are broken off give one list of events and one state after
// every door. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for the scenes
// that fail.
TEST(Doors, AreSoundAndTheSameInEveryWay) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1), count = from_environment("BRINK_WORLDS", 40);
  worlds::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k)
    if (!doors::examine_seed(first + k, tally)) ADD_FAILURE() << "seed " << first + k;
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << tally;
  if (count < 40) return;  // too few to say what most do
  EXPECT_GT(tally.reached_end, static_cast<long>(count) / 4);
  EXPECT_LT(tally.refused, static_cast<long>(count) / 10);
}

}  // namespace
}  // namespace brink::doors_test
