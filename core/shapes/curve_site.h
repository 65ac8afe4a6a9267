#pragma once
/// A site's core as a directed curve: directions, curvature, length, bounds; and how segments and arcs are
/// made.

#include <vector>

#include "brink/core/shapes/site.h"

namespace brink {

Site point_site(const Vec2& p, double radius);
Site segment_site(const Vec2& a, const Vec2& b, double radius);

/// What an arc site turns by at most [rad]: a quarter turn with a rounding, as a circle's split may leave it.
inline constexpr double kMostArcSweep = kQuarterTurn * (1 + 1e-12);

/// Appends the arc from a to b on the circle (center, arc_radius) that turns by sweep [rad], split evenly
/// into pieces of at most kMostArcSweep that share their end points bit for bit. @pre a and b lie on the
/// circle; sweep != 0.
void add_arc(std::vector<Site>& sites, const Vec2& a, const Vec2& b, const Vec2& center, double arc_radius,
             double sweep, double radius);

/// (cos, sin) of an angle [rad], exactly 0 and +-1 at whole quarter turns.
Vec2 unit_at(double angle);

/// Unit direction of travel at the start and at the end. @pre segment or arc.
Vec2 direction_at_start(const Site& site);
Vec2 direction_at_end(const Site& site);

/// Unit normal to the right of the direction of travel at p, which is on the core: outward on solid loops.
/// @pre segment or arc.
Vec2 right_normal(const Site& site, const Vec2& p);

/// Signed curvature [1/m], > 0 where travel turns left; 0 on a segment.
double curvature(const Site& site);

/// Length of the core [m]; 0 of a point.
double length(const Site& site);

/// Point of the core at a fraction of its length, 0 at a and 1 at b.
Vec2 point_along(const Site& site, double fraction);

/// True if a direction from the arc's centre points at the arc, ends included. @pre arc.
bool in_sector(const Site& arc, const Vec2& direction);

/// The same core, travelled the other way; pseudo-normals are left unset.
Site reversed(const Site& site);

/// Smallest box that holds the core (radius left out), exact for arcs.
Box core_bounds(const Site& site);

/// Largest distance from the frame's origin to the core [m], exact for arcs.
double farthest_from_origin(const Site& site);

}  // namespace brink
