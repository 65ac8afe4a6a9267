#pragma once
/// Points along the boundary of an outline, by length.

#include <vector>

#include "brink/core/shapes/outline.h"

namespace brink {

/// The boundary of an outline as segments and arcs without thickness: its sites, or where it has a radius the
/// boundary of what lies within it (thick_boundary.h). A bare point is one piece, of no length.
std::vector<Site> boundary_pieces(const Outline& outline);

/// Sum of the pieces' lengths [m].
double total_length(const std::vector<Site>& pieces);

/// Points on every piece, its ends included, evenly and at most `spacing` [m] apart; where pieces meet, once.
/// @pre spacing > 0.
std::vector<Vec2> walk(const std::vector<Site>& pieces, double spacing);

/// The point of the pieces, joined in order, that is `way` [m] from the first one's start.
Vec2 point_at(const std::vector<Site>& pieces, double way);

}  // namespace brink
