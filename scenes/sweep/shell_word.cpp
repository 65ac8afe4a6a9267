#include "brink/scenes/sweep/shell_word.h"

#include <fmt/format.h>

#include "brink/core/base/printable.h"

namespace brink {
namespace {

// Characters that no POSIX shell gives a meaning to inside a word. `~` is missing, as it has
// one at the start.
bool is_bare(std::string_view text) {
  return !text.empty() && text.find_first_not_of(
                              "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                              "_-./=:,+@%") == std::string_view::npos;
}

/// Octal escapes: always three digits, so that what follows is not taken for a part of them.
/// Octal and not hexadecimal: how many digits belong to \x is not settled among shells.
std::string dollar_quoted(std::string_view text) {
  std::string word = "$'";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\'' || c == '\\')
      word += fmt::format("\\{}", c);
    else if (byte < 0x20 || byte >= 0x7f)
      word += fmt::format("\\{:03o}", byte);
    else
      word += c;
  }
  return word + "'";
}

}  // namespace

std::string shell_word(std::string_view text) {
  if (is_bare(text)) return std::string(text);
  // Something in it would act on a terminal or break the line.
  if (printable(text) != text) return dollar_quoted(text);
  // In single quotes nothing has a meaning but the quote itself: out, an escaped one, in again.
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

}  // namespace brink
