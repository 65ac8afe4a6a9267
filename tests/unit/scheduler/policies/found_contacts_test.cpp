// Contacts that wait for their turn.
#include <gtest/gtest.h>

#include <map>

#include "brink/scheduler/policies/body_clocks/found_contacts.h"
#include "tests/support/seeded_random.h"

namespace brink::found_contacts_test {
namespace {

TEST(FoundContacts, GivesEachBodyItsOwnUntilItIsForgotten) {
  SeededRandom random(12);
  FoundContacts found(20);
  std::map<int, double> expected;
  for (int step = 0; step < 20000; ++step) {
    const int k = static_cast<int>(random.below(20));
    if (random.below(3) == 0) {
      found.forget(k);
      expected.erase(k);
    } else {
      Certificate c;
      c.time = step;
      found.set(k, c);
      expected[k] = step;
    }
    for (const auto& [body, time] : expected) ASSERT_EQ(found.of(body).time, time) << "step " << step;
  }
}

}  // namespace
}  // namespace brink::found_contacts_test
