#pragma once
/// An outline: the closed loops and open chains of sites that make a shape.

#include <string>
#include <vector>

#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/hull.h"
#include "brink/core/shapes/site.h"

namespace brink {

/// One connected run of sites inside an outline: sites first .. first + count - 1, each starting where the
/// last ended.
struct Loop {
  int first = 0;
  int count = 0;
  bool closed = false;  ///< the last site ends at the first one's start
};

/// A sample of the exact two-sided set: a vertex, or an arc as (centre, radius, sector).
///
/// The distance between two outlines that are apart is reached at a vertex of one of them, or at an arc, in
/// the direction from the arc's centre (design: shapes, sites, samples). A sample's id is its place in
/// Outline::samples.
///
/// An arc sample speaks for the arc's convex side only: it counts for a nearest point of the other outline
/// that is in the sector *and* at least arc_radius from the centre. On the concave side it is the other's
/// vertices and arcs that come nearest. So a solid's arcs that are concave toward the free side (holes,
/// containers) have no sample; a wire's arcs have one, as they are felt from both sides.
struct Sample {
  Vec2 p = Vec2::Zero();  ///< vertex, or the arc's centre, in the outline's frame [m]
  double radius = 0.0;    ///< thickness; for an arc: thickness + circle radius (convex side) [m]
  int arc_site =
      -1;  ///< -1: vertex (counts in every direction); else the arc's site: counts in its sector only
  int before = -1, after = -1;  ///< of a solid's vertex: the sites that end and begin there
  /// A solid's vertex at the bottom of a notch: whatever comes from outside meets one of its sides before. Or a straight joint,
  /// which nothing meets but along what joins there.
  bool hollow = false;
};

/// The sites of a shape in its own frame; immutable once built, shared by every body of that shape.
struct Outline {
  std::vector<Site> sites;
  std::vector<Loop> loops;
  std::vector<Sample> samples;  ///< the exact two-sided sample set
  Hull hull;                    ///< holds it; of a container empty
  std::vector<Vec2> facets;  ///< of a convex polygon, rounded or not: its sites' outward normals; else none
  bool solid = false;        ///< has an inside (every loop closed); distance is signed
  bool container = false;    ///< solid outside: the loops bound a hole in an infinite solid
  double bounding_radius =
      0.0;  ///< of a disc about the frame's origin that holds every site with its radius [m]
  /// Of the numbers that distances are computed from: the same, or how far the circle of an arc leads, which may be much
  /// farther [m].
  double magnitude = 0.0;
  Box bounds;                    ///< of every site with its radius
  double curve_deviation = 0.0;  ///< largest distance between a fitted curve and its arcs [m]

  /// A disc, or anything whose core is one point.
  bool is_point() const { return sites.size() == 1 && sites[0].kind == SiteKind::point; }
};

/// A disc about its owner's origin: it looks the same at any angle, so its angle is left out of every
/// computation.
inline bool is_centred_disc(const Outline& o) { return o.is_point() && o.sites[0].a.isZero(0.0); }

/// Fills Site::solid, pseudo-normals, samples, hull, facets, bounds and bounding radius from sites and loops. Call
/// once after assembling; loops must cover all sites in order and join up bit for bit. Samples: each loop's
/// vertices (of wires the distinct ones), then its arcs.
/// @throws BadInput on a site of zero length, an arc over a quarter turn or off its circle, a loop that does
/// not
///   join up, a solid with an open chain, a point, or sites of different radii, or NaN.
void finish_outline(Outline& outline);

/// True of a distance from the nearest site that no place inside a solid has, nor any in a container's room.
/// Much farther, all sites are equally near by rounding, and the side of one of them says nothing.
inline bool is_beyond(const Outline& outline, double distance) {
  return distance > 2.0 * outline.bounding_radius;
}

/// side_of() that nearest site of the outline; of a place that is_beyond() a solid, outside it, or in a container's
/// solid part.
double side_of_outline(const Outline& outline, const Site& site, const Nearest& nearest, const Vec2& q);

/// True if two segments of one thickness go on into each other straight, the one from the end of the other, to roundings of
/// their ends.
bool go_on_straight(const Site& in, const Site& out);

/// Signed gap [m] from q to the whole outline by brute force over its sites (the reference the fields are
/// tested against), with the nearest site in `*site` if given. The sign is the nearest site's side; of sites
/// equally near, as at a vertex, the first is taken (pseudo-normals make them agree). Beyond a solid's size,
/// what it is tells the sign. Cost: all sites.
/// @pre |q| < 1e150 m: beyond, squares overflow and the gap means nothing.
double gap_by_brute_force(const Outline& outline, const Vec2& q, int* site = nullptr);

/// How far an arc's ends lie off where its circle and sweep have them [m].
double arc_misfit(const Site& arc);
/// True if finish_outline() takes that for a rounding: of the arc's radius, and of its centre's coordinates, as in an
/// outline that was moved far away.
bool is_arc_fit(const Site& arc);

/// Reverses every loop and marks the outline as a container: what was inside is now free, all else solid.
/// @throws BadInput if the outline is not solid.
Outline as_container(Outline outline);

/// The outline with every site moved: first turned by angle, then shifted.
Outline transformed(const Outline& outline, const Pose& pose);

}  // namespace brink
