#pragma once
/// Elementary functions with the same bits from every compiler, C library and 64-bit machine (sine and cosine:
/// sine_cosine.h). They are computed in two doubles and rounded once; where the C library gives a first guess, a step
/// of Newton's takes its last bits out again. So an answer depends on it where the exact value is within 2^-90 of
/// the middle between two doubles: once in 2^37 arguments at random, and then if the libraries differ there.
///
/// Arguments beyond the domain give what <cmath> says of them.

#include "brink/core/base/double_double.h"

namespace brink {

/// e^x to 1 unit in its last place. Cost: that of a library's.
double exponential(double x);
/// ln x, rounded. Cost: about 0.5 us, as those below.
double logarithm(double x);
/// x^y, rounded. Whole powers up to the fourth are products.
double power(double x, double y);
/// The angle of (x, y) from the x axis [rad], within half a turn, rounded.
double angle_of(double y, double x);
/// The angle [rad] in [0, pi] whose cosine is x, to 1 unit in its last place.
double arc_cosine(double x);

/// In two doubles, to 2^-95 of themselves; powers below 1e-290 to fewer digits. @pre |x| < 700; 0 < x, finite.
DoubleDouble exponential(const DoubleDouble& x);
DoubleDouble logarithm_in_two(double x);

}  // namespace brink
