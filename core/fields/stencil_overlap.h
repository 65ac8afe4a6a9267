#pragma once
/// How much two solids overlap, by a stencil count.

#include "brink/core/fields/pass_window.h"

namespace brink {

struct StencilOverlap {
  std::size_t pixels = 0;  ///< inside both
  double area = 0.0;       ///< of those pixels [m^2]
  double error = 0.0;      ///< bound on |area - true area|: pixels that a boundary passes through [m^2]
};

/// Draws each of the two over the window where both can be, marks the pixels in its altered interior, and
/// counts those marked twice. `resolution`: pixels along the window's longer side. What has no inside, a wire
/// without thickness, overlaps nothing. Cost: two passes.
/// @throws as PassRenderer.
StencilOverlap stencil_overlap(PassRenderer& renderer, const PlacedOutline& a, const PlacedOutline& b,
                               int resolution = 512);

}  // namespace brink
