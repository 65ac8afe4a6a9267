// Worlds in which nothing is in general position, looked at from outside and under two policies.
#include <gtest/gtest.h>

#include "aligned_worlds.h"
#include "random_worlds_checks.h"

namespace brink::aligned_worlds_test {
namespace {

// BRINK_SEED moves the seeds, BRINK_WORLDS their number.
TEST(AlignedWorlds, NothingPassesAndPoliciesAgree) {
  const std::uint64_t first = worlds::from_environment("BRINK_SEED", 500),
                      count = worlds::from_environment("BRINK_WORLDS", 200);
  aligned::Tally tally;
  for (std::uint64_t k = 0; k < count; ++k)
    EXPECT_TRUE(aligned::run(first + k, tally)) << "seed " << first + k;
  std::cout << tally;
}

// Each led to a fault, or to other events under another policy.
TEST(AlignedWorlds, ThatOnceFailedAreSound) {
  const std::uint64_t seeds[] = {
      30,        34,  // right on the end of a wire
      989,            // flush in a corner of a wall and a block
      83,             // an instant that a horizon ends in
      107,       771,       1371,      100109,    100645,
      101105,  // a corner that passes another, along it or pressed over it
      409,     // the same, held by an island and hit where its step begins
      471,       703,       808,       1189,      100053, 990000680,  // in a slot of its own width
      100606,    101446,                        // a search that is broken off within the touching distance
      101411,                                   // many collisions in one horizon of timewarp
      200405,    201903,    300023,    301063,  // stopped right after a contact, where corners come upon each other
      400091,    404808,    504959,             // a disc in a slot of its own width
      402099,    501011,    502103,             // many collisions under timewarp, drawn by chance
      402536,                                   // pushed towards a wire
      998000147, 998000503, 998000640, 998000997,  // an island right by a joint of wires
      997300351,                        // fits between walls to a rounding, pressed by both beyond measure
      991002349, 991007714, 995000879,  // flush along a wire, whose end is upon a corner
      996502337,                        // rounding of an approach beside one that is in earnest
      996704052,                        // upon a corner, by a place from before the motions
      995000072,                        // into a corner, along a wire that ends there
      997303846,                        // flush past a corner of what turns by no more than a rounding
      604314,                           // a search that stopped, and an order that draws
      601755,    301235,    602346,     // without forces, parting far slower than an island steps
      201361,    301146,    301259,     // sliding off an end within an island's step
      502740,    300025,    700509,    501101,  // a gap that dips between two looks along a step
      500868,    803485,                        // pushed towards a wire
      1600003,                                  // right on the joint of two wires, in an island
      1600916,                                  // in each other when they come to count
      1600929,   1601906,                       // lifted within a step of a microsecond
      201589,                                   // beside the end of a wire by a rounding
      301343,                                   // a corner in another, flush on one side
      200657,     // a corner less deep behind one side of another than behind its other side
      991000181,  // grazing a side for long, and at its end when something else is met
      991001030,  // a corner pressed on a corner, of which a neighbour is left at first, and pressed on later
      991000654, 991001764, 996001089,  // along a side, beyond its end, beside the next side's end
      991007241,                        // a window that ends right after what creeps has met
      1400232,  // an edge slightly inclined, pressed on an end of a face that its tip is just before
  };
  aligned::Tally tally;
  for (const std::uint64_t seed : seeds) EXPECT_TRUE(aligned::run(seed, tally)) << "seed " << seed;
}

}  // namespace
}  // namespace brink::aligned_worlds_test
