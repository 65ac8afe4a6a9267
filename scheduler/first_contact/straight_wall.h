#pragma once
/// First contact of a disc that goes straight at a straight wall which stands still, far from every case in which roundings
/// decide.

#include <optional>

#include "brink/scheduler/first_contact/closed_forms.h"

namespace brink {

/// The one segment of an outline that stands still, as discs' centres see it.
struct StraightWall {
  Frame frame;               ///< of the outline
  Vec2 begin, way;           ///< in the frame: an end of the segment, and from there to the other [m]
  double length = 0.0;       ///< [m]
  double radius = 0.0;       ///< half its thickness [m]
  double size = 0.0;         ///< the outline's bounding radius [m]
  double place_noise = 0.0;  ///< rounding of where it stands [m]
  double since = 0.0;        ///< when its motion began [s]

  /// Nothing where it is none: of more than a segment, with an inside, or moving.
  static std::optional<StraightWall> of(const Outline& outline, const Motion& motion);
};

struct WallContact : DiscContact {
  Vec2 normal;  ///< to the disc
};

/// A disc's contact in [from, to] with the wall, at a level of 0, when first_contact() tells it. False: none that is told
/// here; ask first_contact(). @pre the disc's motion is a parabola that covers [from, to]. Cost: three divisions, and
/// sixteen gaps side by side, once or twice.
bool straight_wall_met(const DiscMover& disc, const StraightWall& wall, double from, double to,
                       const SearchLimits& limits, WallContact& contact);

/// When the disc comes within the contact tolerance of the wall's line, or sooner [s]: before, nothing can be met. Infinity: it
/// goes away; its beginning: unknown. @pre as above.
double soonest_at_wall(const DiscMover& disc, const StraightWall& wall, const SearchLimits& limits);

}  // namespace brink
