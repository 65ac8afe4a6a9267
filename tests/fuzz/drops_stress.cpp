// A thousand drops and more, by hand (ctest -L stress): BRINK_SEED and BRINK_DROPS say which and how many,
// BRINK_KEEP names a folder for the scenes that fail.
#include <gtest/gtest.h>

#include "drops.h"

namespace brink::drops_stress {
namespace {

using worlds::from_environment;

// As in drops_test.cpp.
TEST(DropsStress, NothingFallsThrough) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1001),
                      count = from_environment("BRINK_DROPS", 1000);
  drops::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k) {
    drops::fall(first + k, tally);
    if ((k + 1) % 200 == 0)
      std::cout << "seeds " << first << " .. " << first + k << ": " << tally << std::flush;
  }
  EXPECT_EQ(tally.wrong, 0);
}

}  // namespace
}  // namespace brink::drops_stress
