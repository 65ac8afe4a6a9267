#pragma once
/// Where the plane lies on the picture.

#include "brink/core/base/geometry.h"

namespace brink::draw {

/// A window with square pixels, y upward in the world and downward on the picture.
struct View {
  Box window;          ///< exactly width x height pixels [m]
  double scale = 1.0;  ///< pixels a metre
  int width = 0, height = 0;

  /// Pixels right of and below the picture's top left corner.
  Vec2 to_picture(const Vec2& p) const {
    return {(p.x() - window.low.x()) * scale, (window.high.y() - p.y()) * scale};
  }
};

/// The smallest view of the given size around `box` with a margin (of its longer side) on every side. An
/// empty or flat box is widened to something visible.
View fitted(const Box& box, double margin, int width, int height);

/// A length of 1, 2 or 5 times a power of ten, the largest that is <= x. @pre x > 0.
double round_length(double x);

}  // namespace brink::draw
