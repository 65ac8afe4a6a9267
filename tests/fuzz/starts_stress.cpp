// Two thousand starts at the touch and more, by hand (ctest -L stress): BRINK_SEED and BRINK_WORLDS say which and how
// many, BRINK_KEEP names a folder for the scenes that fail.
#include <gtest/gtest.h>

#include "starts.h"

namespace brink::starts_stress {
namespace {

using worlds::from_environment;

// As in starts_test.cpp.
TEST(StartsStress, AtTheTouchAreSound) {
  worlds::Tally tally;
  starts::examine_all(from_environment("BRINK_SEED", 10001), from_environment("BRINK_WORLDS", 2000), tally);
  EXPECT_EQ(tally.wrong, 0);
}

TEST(StartsStress, BetweenTwoPlacesAreSound) {
  worlds::Tally tally;
  starts::examine_all(from_environment("BRINK_SEED", 10001), from_environment("BRINK_WORLDS", 2000), tally,
                      starts::between_two_places);
  EXPECT_EQ(tally.wrong, 0);
}

}  // namespace
}  // namespace brink::starts_stress
