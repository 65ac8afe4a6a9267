// The bar of a terminal.
#include "brink/scenes/program/terminal.h"

#include <gmock/gmock.h>

namespace brink::terminal_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(BarLine, SaysHowFarItIsAndHowLongItWillTake) {
  EXPECT_EQ(bar_line(80, 0.5, 1.25, 7, "3 s left"),
            "[==============              ]  50%  t = 1.25 s  7 collisions  3 s left");
  EXPECT_THAT(bar_line(80, 0.5, 1.25, {}, ""), Not(HasSubstr("collisions")));
}

TEST(BarLine, FitsEveryWidth) {
  for (int columns = 1; columns <= 120; ++columns) {
    const std::string line = bar_line(columns, 0.37, 12345.6789, 123456789012, "99 min left");
    EXPECT_LT(line.size(), static_cast<std::size_t>(columns)) << columns;
  }
  // A narrow one: a shorter bar first, then none.
  EXPECT_THAT(bar_line(52, 0.5, 1.25, 7, "3 s left"), StartsWith("["));
  EXPECT_THAT(bar_line(40, 0.5, 1.25, 7, "3 s left"), StartsWith(" 50%"));
}

}  // namespace
}  // namespace brink::terminal_test
