// A thousand elastic bodies, each in a room of wires, for ten thousand hits: by hand (ctest -L stress).
// BRINK_SEED, BRINK_ROOMS and BRINK_HITS say which, how many and how long.
#include <gtest/gtest.h>

#include "random_worlds_checks.h"
#include "rooms.h"

namespace brink::rooms_stress {
namespace {

using worlds::from_environment;

// As in rooms_test.cpp.
TEST(RoomsOfWiresStress, NobodyLeaves) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1001),
                      count = from_environment("BRINK_ROOMS", 1000);
  const std::uint64_t hits = from_environment("BRINK_HITS", 10000);
  rooms::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k) {
    rooms::stay(first + k, hits, tally);
    if ((k + 1) % 50 == 0)
      std::cout << "seeds " << first << " .. " << first + k << ": " << tally << std::flush;
  }
  EXPECT_EQ(tally.escaped + tally.energy_lost + tally.ended, 0);
  EXPECT_LT(tally.refused, tally.rooms / 10 + 1);
}

}  // namespace
}  // namespace brink::rooms_stress
