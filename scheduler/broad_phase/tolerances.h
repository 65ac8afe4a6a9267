#pragma once
/// The margins of the broad phase, all in one place. They make bounds wider, never narrower: a pair too many is
/// searched for nothing, a pair too few would be missed.

#include <limits>

namespace brink {

/// Bounding discs are taken larger by this part of their size, which holds the rounding of the formulas of
/// flights but for that of places, and by kFlightRounding of the places' size (in both, of their ways as
/// well). A radius takes part in some ten operations, 1e-15 of it; the rest is room that costs next to no pair.
inline constexpr double kFlightMargin = 1e-9;
/// Place and way are sums of up to four terms of either sign, in two dimensions, of two flights: 16 roundings.
inline constexpr double kFlightRounding = 16.0 * std::numeric_limits<double>::epsilon();

/// Boxes are grown by this part of the coordinates they are made of: a place turned and shifted takes ten
/// roundings, 1e-15 of them; the rest is room that costs next to no pair.
inline constexpr double kBoxMargin = 1e-12;

}  // namespace brink
