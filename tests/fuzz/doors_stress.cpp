// Random programs in random worlds by the thousand, by hand (ctest -L stress). Seeds are printed; BRINK_SEED
// and BRINK_WORLDS repeat any of them, BRINK_KEEP names a folder for the scenes that fail.
#include <gtest/gtest.h>

#include "doors_checks.h"

namespace brink::doors_stress {
namespace {

using worlds::from_environment;

// As in doors_test.cpp.
TEST(DoorsStress, AreSoundAndTheSameInEveryWay) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1000001),
                      count = from_environment("BRINK_WORLDS", 1000);
  worlds::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k) {
    doors::examine_seed(first + k, tally);
    if ((k + 1) % 100 == 0)
      std::cout << "seeds " << first << " .. " << first + k << ": " << tally << std::flush;
  }
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << tally;
  EXPECT_EQ(tally.wrong, 0);
}

}  // namespace
}  // namespace brink::doors_stress
