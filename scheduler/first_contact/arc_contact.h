#pragma once
/// Arc samples: a convex arc of one outline against the segment interiors and arcs of the other.
///
/// Everything else that an arc can touch first (vertices, arc ends) is met by vertex samples. A pair of an
/// arc (centre c, radius R, sector) and a site counts only while the touching direction lies in the sector of
/// both.

#include "brink/core/shapes/outline.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"

namespace brink {

/// One arc against one site at one moment.
struct ArcStep {
  bool active = false;     ///< the touching direction is in every sector: gap and rate are those of the pair
  double gap = 0.0;        ///< [m]
  double rate = 0.0;       ///< [m/s]
  double safe = 0.0;       ///< certified: the gap stays above half of `band` (or of itself) for this long [s]
  double curvature = 0.0;  ///< bound on how the gap bends towards zero [m/s^2]
  Vec2 normal = Vec2::Zero();  ///< in T's frame, out of the site, into the arc
  Vec2 point = Vec2::Zero();   ///< in T's frame, on the site's surface
};

/// True if the arc can be touched from its convex side (outer side of a solid's convex arc, or any wire).
inline bool touches_convex(const Site& arc) { return !arc.solid || arc.sweep > 0.0; }
/// True if the arc can be touched from the side of its centre.
inline bool touches_concave(const Site& arc) { return !arc.solid || arc.sweep < 0.0; }

/// `arc` is a site of S, placed; `path` is the path of its centre in T's frame; `site` is of T.
/// `window`: of the bounds [s].
/// A gap below minus both thicknesses and `band` [m] is no overlap:
/// the arc's facing side lies beyond the site, as at the far side of a body; such a pair is not active.
ArcStep arc_step(const Site& arc, const Site& site, const SamplePath& path, const Placed& s, const Placed& t,
                 double band, const RelativeBounds& relative, const PathBounds& bounds, double window);

}  // namespace brink
