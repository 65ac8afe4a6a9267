#include "brink/scenes/files/csv_rows.h"

namespace brink {
namespace {

/// Goes through a text letter by letter, and knows where it is.
class CsvReader {
 public:
  explicit CsvReader(std::string_view text) : text_(text) {}

  bool at_end() const { return at_ == text_.size(); }
  bool at_line_end() const { return at_end() || text_[at_] == '\n' || text_.substr(at_, 2) == "\r\n"; }
  bool at_comment() const { return !at_end() && text_[at_] == '#'; }

  void skip_line() {
    while (!at_line_end()) take();
    end_line();
  }
  void end_line() {
    if (!at_end() && text_[at_] == '\r') take();
    if (!at_end()) take();
  }

  /// Up to the line's end, which is left where it is.
  CsvRow row() {
    CsvRow cells{cell()};
    while (!at_line_end()) {
      take();  // the comma
      cells.push_back(cell());
    }
    return cells;
  }

 private:
  char take() {
    const char c = text_[at_++];
    column_ = c == '\n' ? 1 : column_ + 1;
    line_ += c == '\n';
    return c;
  }

  /// Up to a comma or the line's end, neither of which counts within quotes.
  CsvCell cell() {
    CsvCell cell{{}, line_, column_, true};
    while (!cell.closed || (!at_line_end() && text_[at_] != ',')) {
      if (at_end()) break;
      const char c = take();
      if (c != '"') {
        cell.text += c;
      } else if (!cell.closed && !at_end() && text_[at_] == '"') {
        cell.text += take();  // in quotes a quote is written twice
      } else {
        cell.closed = !cell.closed;
      }
    }
    return cell;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1, column_ = 1;
};

}  // namespace

std::vector<CsvRow> csv_rows(std::string_view text) {
  std::vector<CsvRow> rows;
  CsvReader reader(text);
  while (!reader.at_end()) {
    if (reader.at_comment() || reader.at_line_end()) {
      reader.skip_line();
      continue;
    }
    rows.push_back(reader.row());
    reader.end_line();
  }
  return rows;
}

}  // namespace brink
