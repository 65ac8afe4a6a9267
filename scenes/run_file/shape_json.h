#pragma once
/// Outlines as JSON: how a run file says what a body or a fixed site looks like.
///
/// One object a shape, in world units [m]:
///
///     {"solid": true, "container": false, "bounding_radius": 0.5,
///      "loops": [{"closed": true, "solid": true, "sites": [SITE, ...]}]}
///
/// A loop's sites follow each other, each from `a` to `b`; on a solid loop the solid is to the left. Every
/// SITE has a `radius` (thickness: the shape is everything within `radius` of the site, and the inside of
/// closed solid loops):
///
///     {"kind": "point",   "radius": r, "a": [x, y]}                       a disc is a point with a radius
///     {"kind": "segment", "radius": r, "a": [x, y], "b": [x, y]}
///     {"kind": "arc",     "radius": r, "a": [x, y], "b": [x, y],
///      "center": [x, y], "arc_radius": R, "sweep": radians}               sweep > 0: counter-clockwise, a to b
///
/// Bodies: about the centre of mass at angle 0. Fixed sites: in the world at `pose`, with two more keys:
///
///     "pose": [x, y, angle]     where the scene writes the site's own frame
///     "motion": null,
///               {"velocity": [vx, vy], "angular_velocity": w}, or
///               {"x": "...", "y": "...", "angle": "..."}
///                               both from `pose` on: where a formula is not 0 at t = 0, the site starts beside it
///
/// Numbers are written so that reading them back gives the same bits.

#include <string>

#include "brink/core/shapes/outline.h"
#include "brink/core/world/world.h"

namespace brink {

/// Beyond this coordinates [m] and angles [rad] are no scene's; squares of differences are still finite.
inline constexpr double kFarthestPlace = 1e20;

/// A body's outline as above.
std::string outline_to_json(const Outline& outline);

/// A fixed site's outline, pose and motion as above.
std::string fixed_site_to_json(const FixedSite& site);

/// The outline in such an object, finished (finish_outline), in the frame in which it was written.
/// @throws BadInput if the text is not such an object.
Outline outline_from_json(const std::string& text);

/// The fixed site in such an object, without name, kind and material: about its own frame, with pose and
/// motion, if it moves; else in the world, at the identity pose. @throws BadInput as above.
FixedSite fixed_site_from_json(const std::string& text);

}  // namespace brink
