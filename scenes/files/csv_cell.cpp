#include "brink/scenes/files/csv_cell.h"

namespace brink {

std::string csv_cell(const std::string& text) {
  // Most names need no quotes, and are easier to read and to look for without.
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  // In quotes a quote is written twice; commas and line ends are themselves.
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

}  // namespace brink
