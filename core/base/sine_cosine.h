#pragma once
/// Sine and cosine by IEEE 754 operations alone: the same bits from every compiler, C library and 64-bit machine.

#include "brink/core/base/double_double.h"

namespace brink {

template <class Number>
struct SineCosine {
  Number sine, cosine;
};

/// Of an angle [rad], each to 1.5 units in its last place, and 0.6 of those of 1. Angles of 2^45 rad or more, of
/// which a double tells hundredths of one at best, are left to the C library. NaN of what is not finite. Cost: that
/// of a library's two.
SineCosine<double> sine_cosine(double angle);

/// The same to 2^-84 of 1. Cost: about 100 ns.
SineCosine<DoubleDouble> sine_cosine(const DoubleDouble& angle);

/// The angle [rad] less whole turns: within half a turn, and a rounding. Of 2^45 rad or more as sine_cosine().
DoubleDouble within_half_a_turn(const DoubleDouble& angle);

}  // namespace brink
