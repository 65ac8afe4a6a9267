#pragma once
/// When an open contact closes first, on motions that are made: by steps that cannot pass it.
///
/// As in the search for first contact, with q the sample's point in the site's frame, v its velocity and
/// a >= |q''|:  gap(t + s) >= gap + gap' s - (a + v^2 / rho) s^2 / 2, the last for a hollow circle alone.

#include "brink/scheduler/islands/modes/mode_problem.h"

namespace brink {

struct Arrival {
  bool found = false;
  /// The last double found at which the gap is not below zero, or the beginning; if none was found, up to when
  /// all are certain to stay open [s].
  double time = 0.0;
  int contact = -1;
};

/// The first contact that is `open` and closes in [from, to] on these motions of the bodies; of several at one time
/// the first in order. `slack` > 0: what a gap may be below zero by rounding [m]. Looks a thousand times at each; one
/// that hovers near touching all along may be told to stay open for less than was asked.
Arrival first_arrival(const ModeProblem& problem, const std::vector<MotionMode>& modes,
                      const std::vector<PolynomialPiece>& bodies, double from, double to, double slack);

}  // namespace brink
