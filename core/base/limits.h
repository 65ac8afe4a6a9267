#pragma once
/// Numbers that many rooms need by a short name.

#include <limits>

namespace brink {

/// A time that never comes [s]; a bound that bounds nothing.
inline constexpr double kForever = std::numeric_limits<double>::infinity();

/// The distance from 1 to the next double: sums and products are told to half of it, of what they are made of.
inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

}  // namespace brink
