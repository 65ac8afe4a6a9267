// Who is due soon: everybody in the queue once, in time, while it is of use; and whether telling is worth it.
#include <gtest/gtest.h>

#include <set>

#include "brink/scheduler/policies/body_clocks/due_soon.h"
#include "brink/scheduler/policies/body_clocks/worth_telling.h"
#include "tests/support/seeded_random.h"

namespace brink::due_soon_test {
namespace {

TEST(DueSoon, TellsEverybodyOnceBeforeTheirTime) {
  SeededRandom random(4);
  const int n = 3000;
  EventQueue queue;
  queue.reset(n, 0.0);
  for (int k = 0; k < n; ++k) queue.update(k, random.uniform(1.0, 2.0));
  DueSoon soon;
  std::set<int> told;
  int missed = 0, served = 0;
  for (; served < n; ++served) {
    if (soon.is_time(queue.time()))
      soon.look(queue, [&](const EventQueue::Entry& e) {
        EXPECT_GE(e.time, queue.time());
        EXPECT_TRUE(told.insert(e.body).second) << "told twice";
        return true;
      });
    missed += told.count(queue.body()) ? 0 : 1;
    queue.update(queue.body(), 5.0);
  }
  EXPECT_LT(missed, n / 20);  // the first, and where the span was not chosen yet
}

TEST(DueSoon, RestsWhereItIsOfNoUse) {
  SeededRandom random(4);
  const int n = 20000;
  EventQueue queue;
  queue.reset(n, 0.0);
  for (int k = 0; k < n; ++k) queue.update(k, random.uniform(1.0, 2.0));
  DueSoon soon;
  int told = 0;
  for (int served = 0; served < n; ++served) {
    if (soon.is_time(queue.time()))
      soon.look(queue, [&](const EventQueue::Entry&) {
        ++told;
        return false;
      });
    queue.update(queue.body(), 5.0);
  }
  EXPECT_LT(told, n / 10);
}

/// How many of 100 rounds are with telling, where a round with it takes so long, and one without a second.
int told_rounds(double with) {
  WorthTelling worth;
  WorthTelling::Clock::time_point now;
  int told = 0;
  bool telling = true;
  for (int round = 0; round < 100; ++round) {
    now += std::chrono::milliseconds(telling ? static_cast<int>(1000.0 * with) : 1000);
    worth.end_round(now);
    telling = worth.asked();
    told += telling ? 1 : 0;
  }
  return told;
}

TEST(WorthTelling, DoesWhatTakesLessNearlyAlways) {
  EXPECT_GT(told_rounds(0.6), 85);
  EXPECT_LT(told_rounds(1.3), 12);
}

}  // namespace
}  // namespace brink::due_soon_test
