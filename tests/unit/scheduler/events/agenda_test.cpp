// Certificates leave the agenda in the total order of events.
#include <gtest/gtest.h>

#include <algorithm>

#include "brink/scheduler/events/agenda.h"
#include "tests/support/seeded_random.h"

namespace brink::agenda_test {
namespace {

TEST(Agenda, PopsInTheTotalOrder) {
  SeededRandom r(5);
  Agenda agenda;
  std::vector<Certificate> all;
  for (int i = 0; i < 2000; ++i) {
    Certificate c;
    c.time = static_cast<double>(r.below(50));
    c.pair = {static_cast<int>(r.below(9)), r.below(2) ? static_cast<int>(10 + r.below(9)) : -1, -1};
    if (c.pair.other_body < 0) c.pair.other_site = static_cast<int>(r.below(5));
    c.contact.site = static_cast<int>(r.below(4));
    c.contact.sample = static_cast<int>(r.below(4));
    agenda.insert(c);
    all.push_back(c);
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.order() < b.order(); });
  for (const Certificate& expected : all) EXPECT_EQ(agenda.pop().order(), expected.order());
  EXPECT_TRUE(agenda.empty());
}

}  // namespace
}  // namespace brink::agenda_test
