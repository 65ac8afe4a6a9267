#pragma once
/// For how long a formula changes evenly with the time.

#include <limits>

#include "brink/core/world/formula.h"

namespace brink {

/// A part of a formula (see Formula::time_parts), and the cell of time that it was last asked about.
class SteadyFormula {
 public:
  /// @pre the formula outlives it.
  SteadyFormula(const Formula& formula, int part) : formula_(&formula), part_(part) {}

  /// A time > t up to which it is certain to lie beside a straight line by no more than twice its change, or
  /// than a millionth of its size in the minute around: what tries a few points of it has seen it. Cells of a
  /// dyadic grid, from 64 s down to 2^-30 s (where it jumps), so a function of t alone. Cost: some
  /// microseconds a halving; next to nothing in the cell of last time.
  double until(double t);

 private:
  bool is_steady(double begin, double width) const;
  double width_to_try(double t);

  const Formula* formula_;
  int part_;
  double minute_ = std::numeric_limits<double>::quiet_NaN();  ///< where the widest cell begins
  double size_ = 0.0;                                         ///< largest value in it; 0 where there is none
  double begin_ = 0.0, width_ = 0.0;                          ///< of the cell that was found in it
};

}  // namespace brink
