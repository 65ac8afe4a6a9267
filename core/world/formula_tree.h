#pragma once
/// The expression tree of a formula, for bounds that no sampling can give.

#include <string>
#include <string_view>
#include <vector>

#include "brink/core/world/taylor.h"

namespace brink {

/// Reads muParser's grammar: what muParser has accepted means the same here. Its functions, pi and e are
/// known.
class FormulaTree {
 public:
  /// @throws std::invalid_argument naming what is not known: no bound can then be had.
  FormulaTree(std::string_view text, const std::vector<std::string>& variables);

  /// The largest parts of the formula that depend on the time alone: all of it if it has no other variable.
  /// Where the variable "t" does not occur there are none but the whole.
  int time_parts() const { return static_cast<int>(parts_.size()); }
  /// True if the variable "t" occurs.
  bool depends_on_time() const { return nodes_.back().in_time; }
  /// Encloses such a part and its derivatives over an interval of time.
  Taylor over(int part, double from, double to, int order) const;

 private:
  friend class FormulaReader;
  struct Function {
    std::string_view name;
    int least, most;  ///< arguments
    Taylor (*apply)(const std::vector<const Taylor*>& arguments);
  };
  struct Node {
    enum class Kind { number, time, other_variable, call } kind = Kind::number;
    Interval number{0.0};
    const Function* function = nullptr;
    std::vector<int> arguments;
    int first = 0;           ///< of the nodes of its subtree, which end with it
    bool in_time = false;    ///< uses "t"
    bool of_others = false;  ///< uses another variable
  };
  static const Function* find(std::string_view name);

  void find_parts(int root);

  std::vector<Node> nodes_;  ///< arguments before what they are given to
  std::vector<int> parts_;
};

}  // namespace brink
