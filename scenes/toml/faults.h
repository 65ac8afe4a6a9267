#pragma once
/// Collecting the faults of a scene file, each with its place. Internal to the scene reader.

#include <string>
#include <string_view>
#include <vector>

#include "brink/scenes/toml/scene_faults.h"

namespace brink {

/// Where something was said: a place in the file (counting from 1), or one of the --set overrides.
struct Where {
  int line = 0, column = 0;
  int override_index = -1;  ///< >= 0: said by that override; line and column are then 0
};

/// Gathers faults and hands them out at once, in file order.
class FaultList {
 public:
  explicit FaultList(std::vector<std::string> override_paths = {}) : paths_(std::move(override_paths)) {}

  void add(const Where& where, std::string message);
  /// A fault in another file that the scene names.
  void add_elsewhere(const std::string& file, int line, int column, const std::string& message);
  bool empty() const { return faults_.empty(); }
  std::size_t size() const { return faults_.size(); }
  /// @throws SceneFaults if there are any.
  void throw_if_any(const std::string& file);

 private:
  std::vector<std::string> paths_;
  std::vector<SceneFault> faults_;
};

/// The word of `known` with the smallest edit distance to `word` (first on ties), or empty if `known` is
/// empty.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

/// "a, b, c" of words.
std::string listed(const std::vector<std::string>& words);

/// At most 60 bytes of what was given, printable, in double quotes.
std::string in_quotes(std::string_view text);

/// A number as a person would write it: the shortest text that reads back as the same double.
std::string number_text(double x);

}  // namespace brink
