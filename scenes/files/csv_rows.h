#pragma once
/// Tables as other programs write them, read cell by cell with their places.

#include <string>
#include <string_view>
#include <vector>

namespace brink {

struct CsvCell {
  std::string text;          ///< without its quotes
  int line = 1, column = 1;  ///< where it begins; both count from 1, columns in bytes
  bool closed = true;        ///< false: the text ended within its quotes
};
using CsvRow = std::vector<CsvCell>;

/// The rows of a CSV text (RFC 4180; lines may also end with \n alone). Left out are empty lines, and those that begin
/// with a '#'.
std::vector<CsvRow> csv_rows(std::string_view text);

}  // namespace brink
