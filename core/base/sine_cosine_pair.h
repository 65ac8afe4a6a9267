#pragma once
/// Sines and cosines of two angles side by side: most pairs of bodies turn, both.

#include "brink/core/base/sine_cosine.h"

namespace brink {

struct SineCosinePair {
  SineCosine<double> of_a, of_b;
};

/// sine_cosine() of each [rad], bit for bit, in little more than the time of one.
SineCosinePair sine_cosine(double a, double b);

}  // namespace brink
