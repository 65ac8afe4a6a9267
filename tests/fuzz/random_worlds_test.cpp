// Random worlds such as people write, looked at from outside, and run in every way that must give the same
// bits.
#include <gtest/gtest.h>

#include "random_worlds_checks.h"

namespace brink {
namespace {

using worlds::from_environment;

// Overlaps, sides, laws and energy are checked by geometry that shares no code with Brink's
// (support/outside); four policies, four skips, two detectors and three resumes must give one event list.
// BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for the scenes that fail.
TEST(RandomWorlds, AreSoundAndTheSameInEveryWay) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1),
                      count = from_environment("BRINK_WORLDS", 100);
  worlds::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k)
    if (!worlds::examine_seed(first + k, {}, tally)) ADD_FAILURE() << "seed " << first + k;
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << tally;
  if (count < 100) return;  // too few to say what most do
  EXPECT_GT(tally.reached_end, static_cast<long>(count) / 4);
  EXPECT_LT(tally.refused, static_cast<long>(count) / 10);
}

}  // namespace
}  // namespace brink
