#pragma once
/// One contact between a body and another body or a fixed site, at one time.

#include "brink/core/base/geometry.h"

namespace brink {

/// Ids as used in every result: body index; site index into World::sites.
struct Contact {
  double time = 0.0;  ///< [s]
  /// What `time`, one double, leaves over: the moment at which the collision is resolved is time + time_low,
  /// so that at 1e6 s, where doubles are 1e-10 s apart, it is still known to 1e-16 s [s].
  double time_low = 0.0;
  int body = -1;               ///< the body into which the normal points
  int other_body = -1;         ///< -1: a fixed site
  int other_site = -1;         ///< index into World::sites, or -1
  int site = -1;               ///< Voronoi site in the outline that carries it
  int sample = -1;             ///< sample in the outline that carries it
  bool sample_on_body = true;  ///< true: sample on `body`, site on the other; false: the reverse
  Vec2 point = Vec2::Zero();   ///< in the world [m]
  Vec2 normal = Vec2::Zero();  ///< unit, out of the other owner, into `body`
  double closing_speed = 0.0;  ///< [m/s], > 0 approaching
  double gap = 0.0;            ///< signed distance at `time` [m]
};

}  // namespace brink
