#pragma once
/// The classic detector: the particles of every body read colour and depth in pictures of everything else.
///
///   draw the diagram of all but body k
///   for each particle of k: depth < tolerance, or in an altered interior -> a contact:
///     owner and site from the colour, position from the particle, outward normal by depth_normal.h
///
/// A picture answers for pixel centres, in single precision, and a body is felt at its particles alone: times
/// and places err by about a pixel, and what fits between particles is missed. docs/classic.md measures both.
/// Source: Hoff et al. 1999 (diagrams by depth buffer); the classic method of this program's forerunner.

#include <span>
#include <string>
#include <vector>

#include "brink/core/shapes/sampling.h"
#include "brink/core/world/world.h"
#include "brink/scheduler/classic/depth_pictures.h"
#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/run/options.h"

namespace brink {

/// One particle that touches. In `contact`, `sample` counts the particles of the body that carries it, `site`
/// the sites of the other's outline, and `gap` is what the picture says (< 0: in the altered interior).
struct DepthContact {
  PairKey pair;
  FeatureContact contact;
};

/// How far two owners reach into each other, from the particles of each that lie inside the other.
struct DepthOverlap {
  PairKey pair;
  double depth = 0.0;          ///< of the deepest particle [m], > 0
  double area = 0.0;           ///< of volume particles [m^2]; the mean of both bodies' where both have such
  Vec2 normal = Vec2::Zero();  ///< out of the other, into pair.body, at the deepest particle
};

/// Everything seen at one moment, by body and particle.
struct DepthSight {
  std::vector<DepthContact> contacts;  ///< receding ones too
  std::vector<DepthOverlap> overlaps;  ///< ascending pairs
};

/// An owner now and a moment before, from which it is told on which side of a wire a particle has come.
struct OwnerMoment {
  BodyState now;
  BodyState before;
};

class DepthDetector {
 public:
  /// @throws BadInput where a body's sampling is not valid; IoError without a GL context.
  DepthDetector(const World& world, const SolverOptions& options, WorkCounters* work);

  /// Looks at one moment. `owners`: bodies, then fixed sites. `travel`: no two owners' points come nearer by
  /// more than this [m] before the next look: diagrams are truncated to what it and the tolerance need.
  DepthSight look(std::span<const OwnerMoment> owners, double travel);

  /// Depth below which a particle touches [m]: contact_tolerance of the scene's length, but at least half a
  /// pixel's diagonal, by which a particle is off the centre that its pixel speaks for.
  double tolerance(int body) const;
  const std::vector<Particle>& particles(int body) const { return particles_[body]; }
  /// One line a sampling: how many particles, and what can slip between them.
  std::vector<std::string> describe() const;

 private:
  struct Reader;
  const Outline& outline_of(int owner) const;
  std::vector<int> near_owners(int body, std::span<const OwnerMoment> owners, double margin) const;
  void look_from(int body, std::span<const OwnerMoment> owners);
  void note_overlap(const DepthContact& contact, double area, bool on_a);

  const World& world_;
  double tolerance_;  ///< [m]
  bool prune_;
  bool truncated_;
  std::vector<std::vector<Particle>> particles_;  ///< of every body
  double largest_particle_ = 0.0;                 ///< radius [m]
  DepthPictures pictures_;
  DepthSight sight_;                              ///< of the present look, so far
  std::vector<std::pair<double, double>> areas_;  ///< of sight_.overlaps: by each body's particles
};

}  // namespace brink
