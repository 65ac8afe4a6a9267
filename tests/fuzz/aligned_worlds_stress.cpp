// A thousand aligned worlds and more, by hand (ctest -L stress): BRINK_SEED and BRINK_WORLDS say which and how many.
#include <gtest/gtest.h>

#include "aligned_worlds.h"
#include "random_worlds_checks.h"

namespace brink::aligned_worlds_stress {
namespace {

// As in aligned_worlds_test.cpp.
TEST(AlignedWorldsStress, NothingPassesAndPoliciesAgree) {
  const std::uint64_t first = worlds::from_environment("BRINK_SEED", 0),
                      count = worlds::from_environment("BRINK_WORLDS", 1000);
  aligned::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k) aligned::run(first + k, tally);
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << tally;
  EXPECT_EQ(tally.failed + tally.overlaps + tally.different, 0);
}

}  // namespace
}  // namespace brink::aligned_worlds_stress
