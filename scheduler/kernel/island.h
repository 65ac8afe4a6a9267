#pragma once
/// What an island is made of: bodies joined by contacts that last.

#include <limits>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "brink/scheduler/events/agenda.h"
#include "brink/scheduler/islands/near_features.h"

namespace brink {

/// A contact of an island, at the start of its step.
struct HeldContact {
  PairKey pair;
  NearFeature feature;
  double normal_force = 0.0, tangential_force = 0.0;  ///< [N]
  double lasted = 0.0;                                ///< the step over which they are means [s]

  auto order() const { return std::tuple(pair.order(), feature.sample_on_a, feature.sample, feature.site); }
};

/// Normal force [N] of a contact, and the time over which that was a mean [s]: by pair, side, sample, site.
using WarmForces = std::map<std::tuple<PairKey, bool, int, int>, std::pair<double, double>>;

struct Island {
  std::vector<int> members;           ///< ascending
  std::vector<HeldContact> contacts;  ///< in order
  bool rests = false;
  double due = std::numeric_limits<double>::infinity();  ///< when its step ends [s]
  /// The contact whose bounces come to their limit where the step ends; body < 0: none.
  double then = std::numeric_limits<double>::infinity();  ///< of one at rest: `due` after that [s]
  PairKey series;
  FeatureContact series_contact;
};

/// What islands came to.
struct IslandTally {
  std::uint64_t captured = 0, steps = 0, slept = 0, woken = 0, factorisations = 0;
  double absorbed = 0.0;           ///< the largest approach that a step took without a rebound [m/s]
  double energy_won = 0.0;         ///< that steps made, by rounding and by faces that turn [J]
  double friction_residual = 0.0;  ///< the largest, of the largest normal force of its island
};

}  // namespace brink
