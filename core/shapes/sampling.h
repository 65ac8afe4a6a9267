#pragma once
/// The samplings of the classic method: an outline as particles that read the depth of a rendered diagram.
/// The exact detectors do not use them; they have Outline::samples.

#include <cstdint>
#include <vector>

#include "brink/core/shapes/outline.h"

namespace brink {

/// How an outline is turned into particles.
struct Sampling {
  enum class Kind {
    vertices,  ///< every vertex, with the outline's thickness; a disc is its centre
    boundary,  ///< along the boundary, at most a spacing apart, the ends of every piece included
    volume,    ///< `boundary`, and a square lattice of that spacing inside
    random,    ///< drawn along the boundary with `seed`, each place equally likely
    raster,    ///< the boundary drawn in pixels whose side is the spacing: their centres
    file       ///< `points` as they are: the classic text data file (sample_file.h)
  };
  Kind kind = Kind::vertices;
  double spacing = 0.0;    ///< [m]; boundary, volume, raster; random: boundary length / spacing are drawn
  int count = 0;           ///< where spacing is 0: particles of the whole boundary (boundary, random), cells
                           ///< along the longer side (volume, raster)
  std::uint64_t seed = 1;  ///< random
  std::vector<Vec2> points;  ///< file: in the outline's frame [m]
};

/// A particle of a body, in the outline's frame.
struct Particle {
  Vec2 p = Vec2::Zero();  ///< [m]
  double radius = 0.0;    ///< it touches at this distance [m]; > 0 for vertices of thick outlines alone
  double area = 0.0;      ///< of the solid that it stands for [m^2]; > 0 inside alone (volume)
};

/// Most particles that one outline may have.
inline constexpr int kMostParticles = 1'000'000;

/// The particles of an outline, in a fixed order: same arguments, same particles. A wire has no inside: its
/// volume sampling is its boundary sampling.
/// @throws BadInput where neither spacing nor count is > 0 and the kind needs one, or where they would make
/// more than kMostParticles.
std::vector<Particle> make_particles(const Outline& outline, const Sampling& sampling);

/// What can slip between the particles unseen: the diameter of the largest disc about a point of the boundary
/// that holds no particle [m]. A feature of another shape that is narrower can enter there. Found by walking
/// the boundary in `steps` steps, so short by at most boundary / steps. Cost: steps times particles.
double widest_gap(const Outline& outline, const std::vector<Particle>& particles, int steps = 2048);

}  // namespace brink
