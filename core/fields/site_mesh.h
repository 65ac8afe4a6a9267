#pragma once
/// Internal to core/fields: sites as cones and tents, whose depth the rasteriser interpolates (Hoff, Keyser,
/// Lin, Manocha & Culver 1999).
///
/// A point is a cone of facets. With 2 delta the angle of a facet and m its middle direction, the rim lies at
/// R / cos(delta) with depth R, so the facet's depth is q.m = d cos(angle to m): never more than the distance
/// d, and less by d (1 - cos(delta)) <= R (1 - cos(delta)) at most. A segment is two rectangles, exact, and a
/// cone at each end. An arc is cut into chords, each a tent, with a sector of a cone at each joint on the
/// convex side, and half of one at its end: no farther off than the chord's sagitta and the sector's own error. Facets and chords are
/// chosen so that the sum is `error` at most.

#include "brink/core/fields/site_batch.h"

namespace brink::detail {

/// The scene's triangles for a window; numbering as make_batch(). `band` [m]; `error` [pixel], > 0: the bound
/// on the tessellation, which becomes SiteBatch::tessellation.
SiteBatch make_mesh_batch(const PixelGrid& grid, std::span<const PlacedOutline> scene, std::uint32_t excluded,
                          double band, double error);

}  // namespace brink::detail
