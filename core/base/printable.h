#pragma once
/// Text that came from a file, made fit to be shown: names, titles and paths are data, and what they hold
/// must not move the cursor, colour the screen, turn the reading direction or begin a new line.

#include <string>
#include <string_view>

namespace brink {

/// `text` with whatever a terminal or a log would act upon written as an escape: "\n", "\t", "\r", "\x1b" (a
/// control character, or a byte that is no UTF-8), "\u202e" (a control of direction, an invisible character
/// or a line separator). Everything else stays as it is, also backslashes. The result is one line of UTF-8.
std::string printable(std::string_view text);

}  // namespace brink
