#pragma once
/// Places for copies of one shape in a box, at random, without overlaps. Internal to the scene reader.

#include <cstdint>
#include <optional>
#include <vector>

#include "brink/core/base/periodic.h"
#include "brink/core/base/random.h"
#include "brink/core/shapes/outline.h"

namespace brink {

/// An outline where it stands: what a copy must keep clear of, and a copy once placed.
struct Obstacle {
  const Outline* outline = nullptr;
  Pose pose;
};

struct ScatterAsk {
  const Outline* outline = nullptr;
  Box region;  ///< holds every copy's position
  std::int64_t count = 1;
  double angle = 0.0;         ///< of every copy [rad]
  bool random_angle = false;  ///< any angle instead
  Periods periods = {};       ///< of the world: copies keep clear of images too
};

/// Poses of the copies: apart from one another and from every obstacle. The same arguments give the same
/// poses.
///
/// Random sequential insertion (Widom 1966) where the discs about the copies would fill less than 45 % of the
/// region; beyond that, or where insertion gets stuck, a random choice of places of a triangular lattice,
/// shaken within their room. Empty if even the tightest lattice has too few places; `*room` is then how many
/// it has.
std::optional<std::vector<Pose>> scatter_poses(const ScatterAsk& ask, const std::vector<Obstacle>& obstacles,
                                               Random& random, std::int64_t* room);

}  // namespace brink
