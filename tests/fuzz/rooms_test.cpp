// Elastic bodies in rooms of wires, near and far: nobody leaves.
#include <gtest/gtest.h>

#include "random_worlds_checks.h"
#include "rooms.h"

namespace brink::rooms_test {
namespace {

using worlds::from_environment;

// A body that keeps its energy hits its walls for ever; the walls are wires, so the side that it is on is all
// that holds it. BRINK_SEED moves the seeds.
TEST(RoomsOfWires, NobodyLeaves) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1), count = from_environment("BRINK_ROOMS", 30);
  const std::uint64_t hits = from_environment("BRINK_HITS", 500);
  rooms::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k) rooms::stay(first + k, hits, tally);
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << tally;
  EXPECT_EQ(tally.escaped, 0);
  EXPECT_EQ(tally.energy_lost, 0);
  EXPECT_EQ(tally.ended, 0);
  EXPECT_LT(tally.refused, tally.rooms / 10 + 1);
}

// There a pair is seen now in doubles, now in extended precision.
TEST(RoomsOfWires, NobodyLeavesWhereThePrecisionChanges) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1), count = from_environment("BRINK_ROOMS", 30);
  const std::uint64_t hits = from_environment("BRINK_HITS", 500);
  rooms::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k) rooms::stay(first + k, hits, tally, rooms::Away::coarse);
  std::cout << "seeds " << first << " .. " << first + count - 1 << ": " << tally;
  EXPECT_EQ(tally.escaped + tally.energy_lost + tally.ended, 0);
  EXPECT_LT(tally.refused, tally.rooms / 3 + 1);
}

// 80301: at a place where doubles are just too coarse, a needle met a wire nearer than doubles tell, a moment later
// places were seen in doubles again, and its corner was on the other side.
TEST(RoomsOfWires, ThoseThatOnceWereLeftHold) {
  rooms::Tally tally;
  rooms::stay(80301, 10000, tally);
  EXPECT_EQ(tally.escaped + tally.energy_lost + tally.ended + tally.refused, 0);
}

}  // namespace
}  // namespace brink::rooms_test
