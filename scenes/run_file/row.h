#pragma once
/// Values read from a run file, each checked: what is of another type or out of range is a BadInput that
/// names the column. Internal to the run file.

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "brink/core/base/error.h"

namespace brink {

/// The values of a row, each of the type and in the range that a run file has there.
class Row {
 public:
  explicit Row(SQLite::Statement& statement) : statement_(statement) {}

  double real(int column) const {
    const double x = real_or_nan(column);
    if (!std::isfinite(x)) fail(column, "is not a finite number");
    return x;
  }
  double real_or_nan(int column) const {
    const SQLite::Column c = statement_.getColumn(column);
    if (c.isNull()) return std::nan("");  // how SQLite keeps it
    if (!c.isFloat() && !c.isInteger()) fail(column, "is not a number");
    if (std::isinf(c.getDouble())) fail(column, "is not a finite number");
    return c.getDouble();
  }
  /// 0 <= value < end.
  std::int64_t count(int column, std::int64_t end = std::numeric_limits<std::int64_t>::max()) const {
    const SQLite::Column c = statement_.getColumn(column);
    if (!c.isInteger() || c.getInt64() < 0 || c.getInt64() >= end) fail(column, "is out of range");
    return c.getInt64();
  }
  int id_or_none(int column, std::int64_t end = std::numeric_limits<int>::max()) const {
    return statement_.getColumn(column).isNull() ? -1 : static_cast<int>(count(column, end));
  }
  std::string text(int column) const {
    const SQLite::Column c = statement_.getColumn(column);
    if (!c.isText()) fail(column, "is not text");
    return c.getString();
  }

 private:
  [[noreturn]] void fail(int column, const char* what) const {
    throw BadInput(fmt::format("{} {}", statement_.getColumn(column).getName(), what));
  }
  SQLite::Statement& statement_;
};

/// All of a text as a finite number. @throws BadInput.
inline double number_in(const std::string& text) {
  double x = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x))
    throw BadInput("not a number");
  return x;
}

}  // namespace brink
