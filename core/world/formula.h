#pragma once
/// Formulas in scene files: the one door to muParser.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace brink {

/// A compiled expression in named variables, e.g. "0.1*sin(6*t)". Knows pi and e, and muParser's functions.
/// Every copy compiles its own state (some 10 kB); evaluation is thread-safe, one at a time an object. A
/// formula gives one value: no assignments ("="), no lists ("1, 2"). Cost: some 100 ns for a short formula.
class Formula {
 public:
  /// @throws BadInput: the formula, the position and what was not understood; unknown variables name those
  /// allowed.
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

 private:
  struct Compiled;
  std::unique_ptr<Compiled> compiled_;
};

}  // namespace brink
