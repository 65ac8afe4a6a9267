#pragma once
/// Heaps poured into a bin, settled by Brink and, where they were installed when it was built, by two game engines.

#include <limits>
#include <string>
#include <vector>

#include "brink/scenes/scene/scene.h"

namespace brink::bench {

struct Heap {
  std::string name;  ///< "100 discs"
  Scene scene;       ///< bodies and sites: discs and convex polygons
};

/// What an engine made of a heap.
struct Settled {
  std::string engine;
  std::string why = {};  ///< it ended early; empty: it did not
  double at_rest =
      std::numeric_limits<double>::infinity();  ///< everybody asleep [s]; infinity: not by the end
  double cpu_seconds = 0.0;                     ///< of the steps alone, to the end
  double overlap = 0.0;                         ///< the deepest of two at any frame, of 1/60 s [m]
};

/// What peers are stepped by, and frames are apart [s].
inline constexpr double kFrame = 1.0 / 60.0;

/// Restitution 0, friction 0.5.
std::vector<Heap> heaps();

/// Deepest overlap of any two where bodies stand so [m], >= 0.
double deepest_overlap(const World& world, const std::vector<Pose>& bodies);

Settled settle_with_brink(const Heap& heap);
/// In fixed steps of kFrame, with the defaults of the engine (8 iterations for velocities, 3 for positions).
Settled settle_with_box2d(const Heap& heap);
/// In fixed steps of kFrame with 10 iterations, the default; its overlap allowed, 0.1 by default, is made 0.005 m, that of
/// Box2D: here lengths are meters.
Settled settle_with_chipmunk(const Heap& heap);

}  // namespace brink::bench
