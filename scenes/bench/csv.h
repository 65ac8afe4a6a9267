#pragma once
/// A table of a benchmark, written line by line.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "brink/scenes/files/written_file.h"

namespace brink::bench {

class Csv {
 public:
  Csv(std::filesystem::path file, const std::string& head) : file_(std::move(file)), out_(file_) {
    out_ << head << '\n';
  }

  template <class... Values>
  void row(fmt::format_string<Values...> format, Values&&... values) {
    out_ << fmt::format(format, std::forward<Values>(values)...) << '\n';
  }

  /// @throws IoError if anything could not be written.
  void close() {
    out_.close();
    if (!out_) throw_not_written(file_);
  }

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace brink::bench
