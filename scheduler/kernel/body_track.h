#pragma once
/// What the kernel keeps of a body beside the world's definition.

#include <cstdint>

#include "brink/integrators/motion.h"

namespace brink {

struct BodyTrack {
  static constexpr int kFree = -1;  ///< under the constant acceleration of its motion for ever: no integrator
  static constexpr int kHeld = -2;  ///< by an island: its twist is constant until the island's next step

  Motion motion;
  /// Names the motion: raised by every resolve that changes it, and never given twice, not even where a
  /// motion is undone.
  std::uint64_t version = 0;
  std::uint64_t last_undone = 0;   ///< the highest version that was undone
  double velocity_rounding = 0.0;  ///< see Mover
  double resolved_at = -1.0;       ///< time of the last resolve [s]; < 0: never
  /// Of the component that drives it; kFree, kHeld.
  int component = kFree;
  int place_in_component = 0;
  int last_partner = -1;     ///< owner met in its last collision
  std::uint32_t streak = 0;  ///< collisions in a row with that owner
};

}  // namespace brink
