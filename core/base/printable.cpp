#include "brink/core/base/printable.h"

#include <array>
#include <cstdint>
#include <cstdio>

namespace brink {
namespace {

/// A code point, and how many bytes it takes.
struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  ///< 0: what stands there is no UTF-8
};

/// The character at the beginning of `text`, which is not empty (RFC 3629).
Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  // 0x80 .. 0xbf continue a character, 0xc0 and 0xc1 could only begin
  // overlong forms, and beyond 0xf4 there are no characters
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0x7fU >> bytes);
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(k) & 0x3fU);
  }
  // of each length the least code that needs it: below is an overlong
  // form, by which a control would have more than one spelling
  constexpr std::array<std::uint32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return code < least[bytes] || code > 0x10ffff || surrogate ? Character{} : Character{code, bytes};
}

/// Characters that are acted upon or not seen: all of the Unicode categories Cc (controls), Zl and Zp
/// (separators of lines and paragraphs), annotations, and what has the property
/// Default_Ignorable_Code_Point: marks and controls of direction, zero-width spaces and joiners, fillers,
/// variation selectors, the soft hyphen, tags, controls of shorthand and of music. Format characters that
/// are seen, as of Arabic numbers, stay.
bool hidden(std::uint32_t code) {
  struct Range {
    std::uint32_t first, last;
  };
  static constexpr Range ranges[] = {
      {0x00, 0x1f},     {0x7f, 0x9f},       {0xad, 0xad},       {0x34f, 0x34f},    {0x61c, 0x61c},
      {0x115f, 0x1160}, {0x17b4, 0x17b5},   {0x180b, 0x180f},   {0x200b, 0x200f},  {0x2028, 0x202e},
      {0x2060, 0x206f}, {0x3164, 0x3164},   {0xfe00, 0xfe0f},   {0xfeff, 0xfeff},  {0xffa0, 0xffa0},
      {0xfff0, 0xfffb}, {0x1bca0, 0x1bca3}, {0x1d173, 0x1d17a}, {0xe0000, 0xe0fff}};
  for (const Range& r : ranges)
    if (code >= r.first && code <= r.last) return true;
  return false;
}

/// A number by a printf format, of at most 15 characters.
std::string escape(const char* format, unsigned code) {
  char buffer[16];
  std::snprintf(buffer, sizeof buffer, format, code);
  return buffer;
}

/// What stands for a hidden character: short names where C has them, else its number in hexadecimal.
std::string escaped(std::uint32_t code) {
  if (code == '\n') return "\\n";
  if (code == '\t') return "\\t";
  if (code == '\r') return "\\r";
  return escape(code < 0x80 ? "\\x%02x" : "\\u%04x", code);
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character c = first_of(text);
    if (c.bytes == 0)
      out += escape("\\x%02x", static_cast<unsigned char>(text[0]));
    else if (hidden(c.code))
      out += escaped(c.code);
    else
      out += text.substr(0, c.bytes);
    // of what is no UTF-8 one byte at a time: the next may begin a character
    text.remove_prefix(c.bytes == 0 ? 1 : c.bytes);
  }
  return out;
}

}  // namespace brink
