// The queue of bodies by time against a sorted list.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "brink/scheduler/events/event_queue.h"
#include "tests/support/seeded_random.h"

namespace brink::event_queue_test {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

TEST(EventQueue, KnowsTheFirstAndTheSecond) {
  SeededRandom random(11);
  for (const std::size_t n : {1, 2, 3, 7, 100}) {
    EventQueue queue;
    queue.reset(n, 0.0);
    std::vector<double> times(n, 0.0);
    for (int step = 0; step < 3000; ++step) {
      const int k = static_cast<int>(random.below(n));
      times[k] = random.below(10) ? static_cast<double>(random.below(50)) : kForever;  // ties, and never
      queue.update(k, times[k]);
      std::vector<std::pair<double, int>> all;
      for (std::size_t b = 0; b < n; ++b) all.emplace_back(times[b], static_cast<int>(b));
      std::sort(all.begin(), all.end());
      ASSERT_EQ(queue.time(), all[0].first);
      ASSERT_EQ(queue.body(), all[0].second);
      ASSERT_EQ(queue.second().time, n > 1 ? all[1].first : kForever);
      if (n > 1) {
        ASSERT_EQ(queue.second().body, all[1].second);
      }
    }
  }
}

TEST(EventQueue, VisitsThoseThatAreDueByATime) {
  SeededRandom random(12);
  for (const std::size_t n : {1, 5, 16, 333}) {
    EventQueue queue;
    queue.reset(n, 0.0);
    std::vector<double> times(n);
    for (std::size_t k = 0; k < n; ++k) {
      times[k] = static_cast<double>(random.below(20));
      queue.update(static_cast<int>(k), times[k]);
    }
    for (const double until : {0.0, 7.0, 20.0}) {
      std::vector<int> seen;
      queue.visit_until(until, [&](const EventQueue::Entry& e) {
        EXPECT_EQ(e.time, times[e.body]);
        seen.push_back(e.body);
      });
      std::sort(seen.begin(), seen.end());
      std::vector<int> due;
      for (std::size_t k = 0; k < n; ++k)
        if (times[k] <= until) due.push_back(static_cast<int>(k));
      EXPECT_EQ(seen, due);
    }
  }
}

// As collisions do: the first is given a later time when the second is known, before another or after it.
TEST(EventQueue, TheFirstIsServedByWhomItHasMet) {
  SeededRandom random(12);
  for (const std::size_t n : {1, 5, 64, 300}) {
    EventQueue queue;
    queue.reset(n, 0.0);
    std::vector<double> times(n, 0.0);
    const auto update = [&](int k) {
      times[k] += static_cast<double>(random.below(5));
      queue.update(k, times[k]);
    };
    for (int step = 0; step < 3000; ++step) {
      const int first = queue.body(), other = static_cast<int>(random.below(n));
      const bool asks = random.below(3) > 0, first_comes_first = random.below(2) > 0;
      if (asks) queue.second();
      if (first_comes_first) update(first);
      update(other);
      if (!first_comes_first) update(first);
      const auto least = std::min_element(times.begin(), times.end());
      ASSERT_EQ(queue.time(), *least);
      ASSERT_EQ(queue.body(), least - times.begin());
    }
  }
}

}  // namespace
}  // namespace brink::event_queue_test
