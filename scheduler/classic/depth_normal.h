#pragma once
/// Outward normals where a particle touches, as the classic method finds them.

#include <functional>

#include "brink/core/base/geometry.h"
#include "brink/core/shapes/outline.h"

namespace brink {

/// A particle beside the site that its pixel names, in the frame of the site's owner [m, m/s].
struct ParticlePlace {
  Vec2 now = Vec2::Zero();
  Vec2 before = Vec2::Zero();    ///< where it was a moment ago, in the owner's frame of that moment
  Vec2 velocity = Vec2::Zero();  ///< relative to the owner's point there
};

struct DepthNormal {
  Vec2 normal = Vec2::Zero();  ///< unit, in the owner's frame, out of the owner
  bool crossed = false;        ///< the particle has gone through a wire: its depth counts as negative
};

/// The normal at a particle.
/// - Points and segments: by geometry, from the nearest point of the site to the particle; outward of a solid
///   whichever side the particle is on.
/// - Arcs: `gradient`, central differences of the picture's depth (negative in altered interiors, so that it
///   points outward on both sides). Where the differences are cut short, by a ridge of the diagram or by a
///   wire between the pixels read, geometry answers.
/// - Wires have no inside. A normal with which the particle recedes is flipped if the particle was on the
///   other side a moment ago: it is going through. One that recedes on its own side is not.
DepthNormal normal_of(const Site& site, const ParticlePlace& particle, const std::function<Vec2()>& gradient);

}  // namespace brink
