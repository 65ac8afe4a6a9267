// Helpers: jobs that are posted are done once or not at all, and their owner always learns which.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "brink/core/base/helpers.h"

namespace brink::helpers_test {
namespace {

using Settled = Helpers::Settled;
using Patience = Helpers::Patience;

struct Square final : Helpers::Job {
  void run(int) noexcept override {
    ++times;
    squared = of * of;
  }
  int of = 0, squared = 0, times = 0;
};

// Changed by whoever has it, with no lock of its own: what is posted is seen by the helper, what it did by the owner.
TEST(Helpers, DoEachJobOnceOrNotAtAll) {
  for (const int count : {1, 3}) {
    std::vector<Square> jobs(100);
    Helpers helpers(count);
    for (int round = 0; round < 2000; ++round) {
      for (std::size_t k = 0; k < jobs.size(); k += 1 + round % 7) {
        jobs[k].of = round + static_cast<int>(k);
        jobs[k].times = 0;
        helpers.post(jobs[k]);
      }
      helpers.wake();
      for (std::size_t k = 0; k < jobs.size(); k += 1 + round % 7) {
        const Settled settled = helpers.settle(jobs[k], Patience::endless);
        ASSERT_NE(settled, Settled::late);
        ASSERT_EQ(jobs[k].times, settled == Settled::done ? 1 : 0);
        if (settled == Settled::done) {
          ASSERT_EQ(jobs[k].squared, jobs[k].of * jobs[k].of);
        }
      }
    }
  }
}

TEST(Helpers, TellWhatIsDoneOnce) {
  Square job;
  Helpers helpers(1);
  EXPECT_EQ(helpers.settle(job, Patience::endless), Settled::undone);
  do {
    helpers.post(job);
    helpers.wake();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  } while (helpers.settle(job, Patience::endless) == Settled::undone);
  EXPECT_EQ(helpers.settle(job, Patience::endless), Settled::undone);
}

struct Blocked final : Helpers::Job {
  void run(int) noexcept override {
    begun = true;
    while (!open) std::this_thread::yield();
  }
  std::atomic<bool> begun{false}, open{false};
};

// While the only helper is busy the owner is told so, and does what else waits.
TEST(Helpers, AreNotWaitedForLongerThanThePatience) {
  Blocked blocked;
  Square other;
  Helpers helpers(1);
  helpers.post(blocked);
  helpers.wake();
  while (!blocked.begun) std::this_thread::yield();
  EXPECT_EQ(helpers.settle(blocked, Patience::none), Settled::late);
  other.of = 3;
  helpers.post(other);
  EXPECT_EQ(helpers.settle(blocked, Patience::little), Settled::late);
  EXPECT_EQ(other.squared, 9);  // by the owner, meanwhile
  EXPECT_EQ(helpers.settle(other, Patience::none), Settled::done);
  blocked.open = true;
  EXPECT_EQ(helpers.settle(blocked, Patience::endless), Settled::done);
}

// Of more jobs than the ring has places the first are taken back by their owner in any case.
TEST(Helpers, TakeAnyNumberOfJobs) {
  std::vector<Square> jobs(5000);
  Helpers helpers(2);
  for (Square& job : jobs) {
    job.of = 2;
    helpers.post(job);
  }
  helpers.wake();
  for (Square& job : jobs)
    if (helpers.settle(job, Patience::endless) == Settled::done) {
      EXPECT_EQ(job.squared, 4);
    }
}

TEST(Helpers, EndWithJobsThatWait) {
  std::vector<Square> jobs(200);
  {
    Helpers helpers(2);
    for (Square& job : jobs) helpers.post(job);
    helpers.wake();
  }
  for (const Square& job : jobs) EXPECT_LE(job.times, 1);
}

// After a long pause they sleep, and wake again.
TEST(Helpers, WakeFromSleep) {
  Square job;
  Helpers helpers(2);
  for (int round = 0; round < 20; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    job.times = 0;
    job.of = round;
    helpers.post(job);
    helpers.wake();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (helpers.settle(job, Patience::endless) == Settled::done) {
      EXPECT_EQ(job.squared, round * round);
    }
  }
}

}  // namespace
}  // namespace brink::helpers_test
