// The level that BRINK_LOG asks for. Each case in a process of its own: the logger is made once.
#include "brink/core/base/log.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace brink::log_test {
namespace {

/// Logs a line of every kind and ends; `level` null: BRINK_LOG is unset.
[[noreturn]] void log_and_exit(const char* level) {
  level ? setenv("BRINK_LOG", level, 1) : unsetenv("BRINK_LOG");
  log().info("kept to itself");
  log().warn("take care");
  log().error("all is lost");
  std::_Exit(0);
}

TEST(LogDeathTest, LevelUnsetIsWarn) {
  EXPECT_EXIT(log_and_exit(nullptr), ::testing::ExitedWithCode(0),
              "^warning: take care\nerror: all is lost\n$");
}

TEST(LogDeathTest, LevelThatIsKnownIsTaken) {
  EXPECT_EXIT(log_and_exit("info"), ::testing::ExitedWithCode(0),
              "^info: kept to itself\nwarning: take care");
  EXPECT_EXIT(log_and_exit("error"), ::testing::ExitedWithCode(0), "^error: all is lost\n$");
  EXPECT_EXIT(log_and_exit("off"), ::testing::ExitedWithCode(0), "^$");
}

TEST(LogDeathTest, LevelThatIsUnknownIsSaidAndErrorsAreStillHeard) {
  for (const char* level : {"Warn", "verbose", ""})
    EXPECT_EXIT(
        log_and_exit(level), ::testing::ExitedWithCode(0),
        "^warning: BRINK_LOG is .*allowed: trace, debug.*\nwarning: take care\nerror: all is lost\n$");
}

}  // namespace
}  // namespace brink::log_test
