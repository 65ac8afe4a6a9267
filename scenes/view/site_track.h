#pragma once
/// Where sites that move are, for what goes from state to state along cubics.

#include <cstdint>
#include <vector>

#include "brink/core/world/world.h"

namespace brink {

/// A moving site at some times, in order; between two of them the cubic with their places and twists is off by no more than
/// `off` [m].
struct SiteTrack {
  std::vector<double> times;  ///< [s]
  std::vector<BodyState> states;
  double off =
      0.0;  ///< at the places looked at: quarters between two times; turning counts at what is farthest out
  bool whole = true;  ///< false: the motion fails, or there was no room, and the last time is before the end
};

/// From `begin` to `end` [s], as close together as it takes to be off by 1e-7 of the site's size, but no closer than the
/// begin and end of a jump of velocity need. A twist that is constant needs two states. `most`: states, at most.
SiteTrack track_site(const FixedSite& site, double begin, double end, std::int64_t most);

}  // namespace brink
