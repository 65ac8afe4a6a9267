#pragma once
/// Places for equal discs in a box, at random, without overlaps. Internal to the scene reader.

#include <cstdint>
#include <optional>
#include <vector>

#include "brink/core/base/random.h"
#include "brink/core/shapes/outline.h"

namespace brink {

struct Obstacle {
  const Outline* outline = nullptr;
  Pose pose;
};

/// `count` centres of discs of `radius`, each disc wholly inside `region`, apart from one another and from
/// every obstacle. The same arguments give the same places.
///
/// Random sequential insertion (Widom 1966) up to 45 % of the area; beyond that, or where it gets stuck, a
/// random choice of places of a triangular lattice, shaken within their room. Empty if even the tightest
/// lattice has too few places;
/// `*room` is then how many it has.
std::optional<std::vector<Vec2>> scatter_places(double radius, const Box& region, std::int64_t count,
                                                const std::vector<Obstacle>& obstacles, Random& random,
                                                std::int64_t* room);

}  // namespace brink
