// Whether a run goes on.
#include "brink/scheduler/kernel/run_control.h"

#include <gtest/gtest.h>

namespace brink::run_control_test {
namespace {

/// One on the heap: of one on the stack GCC takes a halt that there is not for one that is not initialized.
class RunControlTest : public ::testing::Test {
 protected:
  RunControl run;
};

TEST_F(RunControlTest, TheFirstReasonToStopCounts) {
  EXPECT_TRUE(run.poll());
  run.stop(Termination::failed, "first");
  run.stop(Termination::stopped, "second");
  ASSERT_TRUE(run.halt());
  EXPECT_EQ(run.halt()->why, "first");
  EXPECT_FALSE(run.poll());
  run.forget_halt();
  EXPECT_TRUE(run.poll());
}

TEST_F(RunControlTest, ProgressIsAskedAfterEnoughWorkAndMayStop) {
  RunOptions options;
  int asked = 0;
  options.progress = [&](double t, std::uint64_t collisions) {
    EXPECT_EQ(t, 2.5);
    EXPECT_EQ(collisions, 3U);
    return ++asked < 2;
  };
  run.begin(options);
  run.set_time(2.5);
  run.work().collisions = 3;
  for (int k = 0; k < 2; ++k) {
    run.count_pieces(1U << 20);
    EXPECT_EQ(run.poll(), k == 0);
  }
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(run.halt()->termination, Termination::stopped);
}

// What cannot be undone is carried through unasked; what can be is cut.
TEST(RunControl, WhatIsIndivisibleIsCutOnlyWhereItCanBeUndone) {
  RunControl run;
  RunOptions options;
  int asked = 0;
  options.progress = [&](double, std::uint64_t) { return ++asked < 1; };
  run.begin(options);
  run.count_pieces(1U << 20);
  {
    const RunControl::Indivisible whole(run);
    EXPECT_TRUE(run.poll());
    EXPECT_FALSE(run.is_cut());
    EXPECT_EQ(asked, 0);
  }
  {
    const RunControl::Undoable undoable(run);
    const RunControl::Indivisible whole(run);
    EXPECT_FALSE(run.poll());
    EXPECT_TRUE(run.is_cut());
    EXPECT_EQ(asked, 1);
  }
  EXPECT_FALSE(run.is_cut());
  EXPECT_EQ(run.halt()->why, RunControl::kOnRequest);
}

TEST(RunControl, ALimitThatIsMetCutsNothing) {
  RunControl run;
  const RunControl::Undoable undoable(run);
  const RunControl::Indivisible whole(run);
  run.stop(Termination::stopped, "a limit");
  run.count_pieces(1U << 20);
  EXPECT_TRUE(run.poll());
  EXPECT_FALSE(run.is_cut());
}

}  // namespace
}  // namespace brink::run_control_test
