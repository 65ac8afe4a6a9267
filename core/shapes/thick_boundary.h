#pragma once
/// The boundary of a thick outline: where it can be touched.

#include <vector>

#include "brink/core/shapes/outline.h"

namespace brink {

/// The boundary of {q : gap <= 0} of an outline with radius > 0, as directed segments and arcs with the solid
/// on their left, in no order, radius 0. Pieces that other parts of the outline cover are cut away, so
/// overlaps count once.
///
/// Candidates are the offset of every site (both sides of a wire, the right side of a solid's site) and a
/// circle about every vertex. Each is cut where it meets another; a piece stays if its middle is exposed.
/// Exact up to rounding. Cost: pairs of sites whose boxes overlap, times sites.
std::vector<Site> thick_boundary(const Outline& outline);

}  // namespace brink
