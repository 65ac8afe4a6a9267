// Bodies that start at, a hair off or a hair inside a wall or each other: nothing goes through, and every policy, skip,
// detector and resume has the same bits.
#include <gtest/gtest.h>

#include "starts.h"

namespace brink {
namespace {

using worlds::from_environment;

// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
TEST(Starts, AtTheTouchAreSound) {
  const std::uint64_t first = from_environment("BRINK_SEED", 1), number = from_environment("BRINK_WORLDS", 200);
  worlds::Tally tally;
  for (std::uint64_t seed = first; seed < first + number; ++seed) {
    const std::string text = starts::Maker(seed).make();
    worlds::count(seed, text, tally, [&](const std::string& name) { return starts::examine(text, name); });
  }
  std::cout << "seeds " << first << " .. " << first + number - 1 << ": " << tally;
  EXPECT_EQ(tally.wrong, 0);
}

}  // namespace
}  // namespace brink
