#include "brink/scenes/sweep/shell_word.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "brink/core/base/printable.h"

namespace brink::shell_word_test {
namespace {

// What a shell makes of it, asked of one. The final dot keeps the newlines before it.
std::string said_by_bash(const std::string& word) {
  const std::string line = "printf '%s.' " + word;
  std::FILE* pipe = ::popen(("bash -c \"$(cat <<'END'\n" + line + "\nEND\n)\"").c_str(), "r");
  std::string said;
  for (int c; (c = std::fgetc(pipe)) != EOF;) said += static_cast<char>(c);
  ::pclose(pipe);
  return said;
}

TEST(ShellWord, EveryTextComesBackAsItWasOnOnePrintableLine) {
  for (const std::string text :
       {"", "solver.policy=fast", "a b", "it's", "$(touch x)", "`x`", "a;b|c>d", "x\ny", "\x1b[31m'\\",
        "\"q\" \\n", "~", "*", "tab\t", "\xff\xfe", "\u202e", "-x"}) {
    const std::string word = shell_word(text);
    EXPECT_EQ(said_by_bash(word), text + ".") << word;
    EXPECT_EQ(printable(word), word);
  }
}

}  // namespace
}  // namespace brink::shell_word_test
