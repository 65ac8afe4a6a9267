#include "brink/scenes/files/csv_cell.h"

#include <charconv>
#include <string_view>

namespace brink {

namespace {

bool is_number(const std::string& text) {
  const char *begin = text.data(), *end = begin + text.size();
  double number = 0.0;
  return std::from_chars(begin + (*begin == '+'), end, number).ptr == end;
}

}  // namespace

std::string csv_cell(const std::string& text) {
  // Most names need no quotes, and are easier to read and to look for without.
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  // In quotes a quote is written twice; commas and line ends are themselves.
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

std::string csv_text(const std::string& text) {
  const bool runs = !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos;
  return csv_cell(runs && !is_number(text) ? '\'' + text : text);
}

}  // namespace brink
