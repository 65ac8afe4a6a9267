#pragma once
/// What is certain of a function of time over an interval of it.

#include <limits>

namespace brink {

/// Of which derivatives bounds are asked for: each costs about the square of its order.
enum class BoundOf { value = 0, second = 2, eleventh = 11 };

/// Bounds that hold for every time of an interval, not for samples of it.
struct TimeBound {
  double low = 0.0, high = 0.0;  ///< of the value
  double second = 0.0;           ///< of |second derivative|; infinite where the function may have a corner
  double eleventh = 0.0;         ///< of |eleventh derivative| / 11!; infinite likewise

  double spread() const { return high - low; }
};

}  // namespace brink
