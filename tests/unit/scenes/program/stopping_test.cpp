// Signals: the first asks to stop, the second ends the program.
#include "brink/scenes/program/stopping.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace brink::stopping_test {
namespace {

void two_signals(int first, int second) {
  stop_on_signals();
  std::raise(first);
  if (stop_asked()) std::raise(second);
  std::exit(0);
}

TEST(Stopping, ASecondSignalOfEitherKindEndsTheProgram) {
  EXPECT_EXIT(two_signals(SIGINT, SIGINT), ::testing::KilledBySignal(SIGINT), "");
  EXPECT_EXIT(two_signals(SIGINT, SIGTERM), ::testing::KilledBySignal(SIGTERM), "");
  EXPECT_EXIT(two_signals(SIGTERM, SIGINT), ::testing::KilledBySignal(SIGINT), "");
}

}  // namespace
}  // namespace brink::stopping_test
