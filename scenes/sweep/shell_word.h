#pragma once
/// Texts in lines for a shell.

#include <string>
#include <string_view>

namespace brink {

/// `text` as one word of a POSIX shell, on one line and printable: bare where nothing in it means anything to
/// a shell, else in single quotes, else (control characters, bytes that are no UTF-8) as $'...' with escapes,
/// which POSIX has since 2024 and bash, zsh and ksh had before.
std::string shell_word(std::string_view text);

}  // namespace brink
