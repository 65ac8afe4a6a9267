#pragma once
/// Formulas in scene files: the one door to muParser, and bounds over a while from their trees.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "brink/core/base/time_bound.h"

namespace brink {

/// A compiled expression in named variables, e.g. "0.1*sin(6*t)". Knows pi and e, and muParser's functions.
/// Every copy compiles its own state (some 10 kB); evaluation is thread-safe, one at a time an object. A
/// formula gives one value: no assignments ("="), no lists ("1, 2"). Cost: some 100 ns for a short formula.
class Formula {
 public:
  /// @throws BadInput: the formula, the position and what was not understood, or why it cannot be bounded;
  /// unknown variables name those allowed.
  Formula(std::string text, std::vector<std::string> variables);
  Formula(const Formula& other);
  Formula& operator=(const Formula& other);
  Formula(Formula&&) noexcept;
  Formula& operator=(Formula&&) noexcept;
  ~Formula();

  /// Value with the variables set, in the order given to the constructor. May be inf or NaN where the formula
  /// is.
  double operator()(std::span<const double> values) const;
  const std::string& text() const;

  /// Parts of the formula that depend on "t" and on no other variable, as large as they can be: all of it,
  /// one part, if it has no other.
  int time_parts() const;
  /// True if "t" occurs in it.
  bool depends_on_time() const;
  /// What is certain of such a part over [from, to] seconds, by interval arithmetic on the formula's tree: no
  /// spike is too short for it. Of the real function; what a double makes of it may lie a few roundings
  /// beside. Derivatives up to `highest`. Cost: some microseconds for the eleventh, a tenth of that for values.
  TimeBound time_bound(int part, double from, double to, BoundOf highest = BoundOf::eleventh) const;

 private:
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

}  // namespace brink
