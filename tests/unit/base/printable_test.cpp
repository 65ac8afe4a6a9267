#include "brink/core/base/printable.h"

#include <gtest/gtest.h>

namespace brink::printable_test {
namespace {

using namespace std::string_literals;

TEST(Printable, OrdinaryTextStaysAsItIs) {
  for (const char* text : {"", "ball[3]", "a\\nb 'c' \"d\"", "Käfig, мяч, 球, \U0001f3b1"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, ControlsAreEscaped) {
  EXPECT_EQ(printable("a\nb\tc\rd"), "a\\nb\\tc\\rd");
  EXPECT_EQ(printable("\x1b[31mred\x7f"), "\\x1b[31mred\\x7f");
  EXPECT_EQ(printable("a\0b"s), "a\\x00b");
  EXPECT_EQ(printable("\u009b31m"), "\\u009b31m");  // the one-character form of ESC [
}

// Names that show in another order than they are ("Trojan Source", Boucher & Anderson 2021).
TEST(Printable, ControlsOfDirectionAndLineSeparatorsAreEscaped) {
  EXPECT_EQ(printable("x\u202egnp.\u2066y\u2069"), "x\\u202egnp.\\u2066y\\u2069");
  EXPECT_EQ(printable("a\u2028b\u200bc\ufeff"), "a\\u2028b\\u200bc\\ufeff");
}

// What has the property Default_Ignorable_Code_Point shows nothing: names would look alike and differ.
TEST(Printable, CharactersThatAreNotSeenAreEscaped) {
  EXPECT_EQ(printable("a\u00adb\u034f\u115f\u17b4\u180b\u3164\uffa0"),
            "a\\u00adb\\u034f\\u115f\\u17b4\\u180b\\u3164\\uffa0");
  EXPECT_EQ(printable("x\ufe00y\ufe0f"), "x\\ufe00y\\ufe0f");
  EXPECT_EQ(printable("\U0001bca0\U0001d173\U000e0100\U000e01ef"), "\\u1bca0\\u1d173\\ue0100\\ue01ef");
}

// Bytes that are no UTF-8: a lone continuation, an overlong slash, a surrogate, a cut character.
TEST(Printable, BytesThatAreNoUtf8AreEscaped) {
  EXPECT_EQ(printable("\x80z"), "\\x80z");
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");
}

}  // namespace
}  // namespace brink::printable_test
