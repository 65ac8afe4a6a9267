// Bodies that start at, a hair off or a hair inside a wall or each other: nothing goes through, and every policy, skip,
// detector and resume has the same bits.
#include <gtest/gtest.h>

#include "starts.h"

namespace brink::starts_test {
namespace {

using worlds::from_environment;

// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
TEST(Starts, AtTheTouchAreSound) {
  worlds::Tally tally;
  starts::examine_all(from_environment("BRINK_SEED", 1), from_environment("BRINK_WORLDS", 100), tally);
  EXPECT_EQ(tally.wrong, 0);
}

// In grooves, and under two ends of a wire. BRINK_SEED moves the seeds, BRINK_WORLDS their number.
TEST(Starts, BetweenTwoPlacesAreSound) {
  worlds::Tally tally;
  starts::examine_all(from_environment("BRINK_SEED", 1), from_environment("BRINK_WORLDS", 60), tally,
                      starts::between_two_places);
  EXPECT_EQ(tally.wrong, 0);
}

// Discs and corners in a wall by more than the tolerance that went through; corners across a wire; islands that found
// no step; a level that jumped where a motion began; a chain's end beyond another chain's side from its centre; a corner
// beside a wall just where that has its origin; a disc that two ends of a chain touch, of which it leaves one slower than the
// other; a corner on a wire that an island let sink through it; the end of a capsule that comes round; what is
// moved out of a wall as it starts, by more than impulses at its points are known to; a disc in a groove that dips into one
// side by less than a touching distance, and into the other next; a hop of twenty roundings of its place.
TEST(Starts, ThatOnceFailedAreSound) {
  worlds::Tally tally;
  for (const std::uint64_t seed :
       {5155, 5159, 5205, 5276,  5351,  5448,   5452,     5623,     5738,      5746,      5823,
        6178, 6199, 6369, 11522, 20752, 251132, 21000591, 23000453, 991002714, 997000063, 997001020})
    starts::examine_all(seed, 1, tally);
  starts::examine_all(21001112, 1, tally, starts::between_two_places);
  EXPECT_EQ(tally.wrong, 0);
}

}  // namespace
}  // namespace brink::starts_test
