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

  /// A time > t up to which it is certain to lie, in each of two cells of time, beside a straight line by no
  /// more than twice its change there, or than a millionth of its size in the minute around: what tries a few
  /// points of it has seen it. The cells are of a dyadic grid, from 64 s down to 2^-30 s (where it jumps); the
  /// second is not narrower than the first, which holds t: so steps that are shorter than cells end where they
  /// like. A function of t alone. Cost: some microseconds a halving; next to nothing in the cell of last time.
  double until(double t);

 private:
  struct Cell {
    double begin = std::numeric_limits<double>::quiet_NaN(), width = 0.0;
    bool holds(double t) const;
    double end() const { return begin + width; }
  };

  bool is_steady(double begin, double width) const;
  Cell find(double t, const Cell& last);
  double width_to_try(double t, const Cell& last);

  const Formula* formula_;
  int part_;
  double minute_ = std::numeric_limits<double>::quiet_NaN();  ///< where the widest cell begins
  double size_ = 0.0;                                         ///< largest value in it; 0 where there is none
  Cell here_, next_;                                          ///< of last time, and the one that follows it
};

}  // namespace brink
