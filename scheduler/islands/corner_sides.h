#pragma once
/// Samples at the corners of solids: on which of two sides they lie, before or behind the next one, and corners that are through each
/// other. Internal to near_features().

#include "brink/scheduler/islands/outline_half.h"

namespace brink::islands {

/// How far q is before the other side at the nearer end of a straight side of a solid, where the two have a convex corner [m];
/// below 0: it is not. At an acute corner what is beside the one is abreast of the other, and behind its line. Upon the other's
/// line, to `upon` [m], roundings say nothing: it is before it if the sample's edges are, or else the two are in each other.
double before_next_side(const Half& half, const Sample& sample, const Site& site, const Vec2& q, double upon);

/// True of a corner before a straight side of a solid, right at the end of that, to `upon` [m], if it lies upon the next side from
/// there on: whichever of the two roundings have put above the other, it goes over the end.
bool goes_over(const Half& half, const Sample& sample, const Site& site, const Nearest& nearest,
               const Vec2& q, double upon);

/// Where a sample lies that is upon a corner of a solid; either_side: it may go on along this one as well as along the other.
enum class OnCorner { nowhere, this_side, other_side, either_side };

/// Of a sample upon an end of site j, a straight side of a solid, where it has a convex corner with another: on that of
/// the two that parts it from the corner; if neither does, on none where a side of its own corner does, else on that which faces
/// the sample's owner more. Corner on corner, each lies on the face below it.
OnCorner on_corner(const Half& half, const Sample& sample, std::size_t j, const Vec2& q, double tie);

/// True if the straight side j of a solid has a hollow corner with another at that end.
bool has_hollow_corner(const Outline& outline, std::size_t j, const Vec2& end);

/// True if sample i, upon the line beyond an end of site j, parts from the corner there by no other of its sides: behind site
/// j the two overlap, be it by a strip of no width (a box right upon another that is as wide).
bool has_no_way_by(const Half& half, int i, std::size_t j, const Vec2& q);

/// How deep two convex corners are in each other of which neither vertex is in the other solid [m]: their sides cross
/// beside both. Or two corners of wires, or of a wire and a solid, one vertex of which has gone through a side of the other at its
/// corner. 0: they are not. The site's corner is the one at the end that is nearer to the sample at q.
double through_corner(const Half& half, const Sample& sample, const Site& site, const Vec2& q);

}  // namespace brink::islands
