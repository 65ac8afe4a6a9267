// First contact against a slow reference on random flights of every kind of outline and motion.
#include <gtest/gtest.h>

#include "first_contact_checks.h"

namespace brink::first_contact_test {
namespace {

// Every answer is compared with distances and speed bounds that share no code with the search. BRINK_SEED
// moves the seeds, BRINK_FLIGHTS their number.
TEST(FirstContactFuzz, RandomFlightsAgreeWithTheSlowReference) {
  const char* given = std::getenv("BRINK_SEED");
  const char* many = std::getenv("BRINK_FLIGHTS");
  const std::uint64_t first = given ? std::strtoull(given, nullptr, 10) : 1;
  const std::uint64_t count = many ? std::strtoull(many, nullptr, 10) : 10000;
  flights::Checker checker;
  for (std::uint64_t k = 0; k < count; ++k) checker.check(first + k);
  std::cout << "seeds " << first << " .. " << first + count - 1 << "\n" << checker.tally;
  EXPECT_EQ(checker.tally.failures(), 0);
  EXPECT_GT(checker.tally.contacts, static_cast<long>(count) / 4);
  if (count >= 10000) {
    EXPECT_GT(checker.tally.partings, static_cast<long>(count) / 100);
    EXPECT_GT(checker.tally.far_rebounds, static_cast<long>(count) / 100);
  }
  // a near miss may be so near that the reference cannot tell in reasonable time
  EXPECT_LE(checker.tally.given_up, static_cast<long>(count) / 1000);
}

// The same of what comes dead on to a tip or a joint.
TEST(FirstContactFuzz, AimedFlightsAgreeWithTheSlowReference) {
  const char* given = std::getenv("BRINK_SEED");
  const char* many = std::getenv("BRINK_FLIGHTS");
  const std::uint64_t first = given ? std::strtoull(given, nullptr, 10) : 1;
  const std::uint64_t count = (many ? std::strtoull(many, nullptr, 10) : 10000) / 4;
  flights::Checker checker;
  for (std::uint64_t k = 0; k < count; ++k) checker.check_aimed(first + k);
  std::cout << "aimed, seeds " << first << " .. " << first + count - 1 << "\n" << checker.tally;
  EXPECT_EQ(checker.tally.failures(), 0);
  EXPECT_GT(checker.tally.contacts, static_cast<long>(count) / 4);
}

// Flights in which the search once made no headway behind the far side of a sharp tip, took an approach in
// closed form for a leaving one, met a corner to within a rounding, let two tips that came upon each other pass
// through, or stepped over what a disc that reaches over an arc's chord met at its other end; crept towards the
// ends of an arc; passed between two wires where they join. The last slides along a side at depth 0: no crossing.
// A bare point that came upon a joint of two arcs went in.
// The others were false alarms of these checks: a point on the inflection of an S, pressed on the arc that comes next, and a
// box that touches an arc with both ends of a side.
TEST(FirstContactFuzz, FlightsThatOnceFailedAgree) {
  flights::Checker checker;
  for (const std::uint64_t seed :
       {1031187,  1054535,  1062042,  1064138,   1067637,   1085544,   2004568,   2085429,   4348259, 3124736,
        3186176,  4343553,  4370944,  4388614,   4396536,   4523187,   8627200,   8886280,   8967424, 9528091,
        40026617, 90739491, 99641989, 201054083, 201265152, 230358025, 230595952, 230789554, 1396985})
    checker.check(seed);
  // corners that went for the end of an arc through the arc itself
  for (const std::uint64_t seed : {5001521, 5004713, 5010156}) checker.check_aimed(seed);
  // a corner that comes straight upon a tip later, and through a side of it before; a bare point that goes by a tip; a
  // corner at the joint of two arcs; a wire's end at a tip thinner than rounding; a wire's end at a solid's tip, at speed
  for (const std::uint64_t seed : {5036482, 5074060, 5090775, 5090800, 5027073}) checker.check_aimed(seed);
  EXPECT_EQ(checker.tally.failures(), 0);
}

}  // namespace
}  // namespace brink::first_contact_test
