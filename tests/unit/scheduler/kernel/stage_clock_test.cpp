// Seconds of stages: nobody's are counted twice.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "brink/scheduler/kernel/stage_clock.h"

namespace brink::stage_clock_test {
namespace {

using Clock = std::chrono::steady_clock;

void wait() { std::this_thread::sleep_for(std::chrono::milliseconds(3)); }

TEST(StageTimer, AStageIsWithoutThoseWithinIt) {
  StageTimer timer;
  double outer = 0.0, inner = 0.0, innermost = 0.0;
  const auto begin = Clock::now();
  {
    const StageTimer::Scope a(timer, outer);
    wait();
    for (int k = 0; k < 2; ++k) {
      const StageTimer::Scope b(timer, inner);
      wait();
      const StageTimer::Scope c(timer, innermost);
      wait();
    }
    wait();
  }
  const double all = std::chrono::duration<double>(Clock::now() - begin).count();
  for (const double seconds : {outer, inner, innermost}) EXPECT_GE(seconds, 0.006);
  EXPECT_LE(outer + inner + innermost, all * (1.0 + 1e-9));
}

TEST(StageTimer, OneInSoManyCountsForAll) {
  constexpr int every = StageTimer::Sampled::kEvery;
  StageTimer timer;
  double outer = 0.0, sampled = 0.0;
  unsigned count = 0;
  {
    const StageTimer::Scope a(timer, outer);
    const StageTimer::Sampled b(timer, sampled, count);
    wait();
  }
  EXPECT_GE(sampled, every * 0.003);
  const double once = sampled, before = outer;
  for (int k = 1; k < every; ++k) {
    const StageTimer::Sampled b(timer, sampled, count);
    const StageTimer::Scope a(timer, outer);  // of its own all the same
    wait();
  }
  EXPECT_EQ(sampled, once);
  EXPECT_GE(outer - before, (every - 1) * 0.003);
  { const StageTimer::Sampled b(timer, sampled, count); }
  EXPECT_GT(sampled, once);
}

}  // namespace
}  // namespace brink::stage_clock_test
