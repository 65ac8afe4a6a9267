#pragma once
/// How outlines are put together: loops of sites, their orientation, and the checks that every builder
/// shares.

#include <string>
#include <vector>

#include "brink/core/shapes/shapes.h"

namespace brink {

/// Appends the sites as one more loop or chain.
void add_loop(Outline& outline, const std::vector<Site>& sites, bool closed);

/// Segments through the vertices; closed: back to the first.
std::vector<Site> segments_through(const std::vector<Vec2>& vertices, bool closed, double radius);

/// The vertices without exact repeats of the one before (closed: also of the last by the first).
std::vector<Vec2> without_repeats(const std::vector<Vec2>& vertices, bool closed);

/// Signed area enclosed by a closed run of sites, > 0 counter-clockwise [m^2].
double enclosed_area(const std::vector<Site>& sites);

/// Travels the other way.
std::vector<Site> reversed(const std::vector<Site>& sites);

/// Finishes an outline that was put together and measures it.
/// @throws BadInput if it is so large or small that its measure is not a number > 0 (a bare point may have
/// 0).
Shape finish_shape(Outline outline);

/// Checks that say what is wrong, what was given and what is allowed.
void require_positive(const char* name, double value);
void require_radius(double value);
void require_finite(const char* name, const Vec2& value);

}  // namespace brink
