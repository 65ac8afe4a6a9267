#pragma once
/// The corners of two solids, or a corner and a wire's end, that lie on each other: which lines have the one before them and
/// the other behind.

#include <vector>

#include "brink/core/shapes/outline.h"

namespace brink {

/// An outline at one of its vertices: a solid's boundary, or a wire.
struct Wedge {
  std::vector<Vec2> edges;    ///< unit directions away from the vertex
  std::vector<Vec2> normals;  ///< of those edges, out of the solid; of a wire to both sides
};

/// In the outline's frame; empty where no site ends. `vertex`: bit for bit an end of a site.
Wedge wedge_at(const Outline& outline, const Vec2& vertex);

/// The same in another frame: what `turn` makes of every direction.
template <class Turn>
Wedge turned(Wedge w, Turn&& turn) {
  for (auto* directions : {&w.edges, &w.normals})
    for (Vec2& d : *directions) d = turn(d);
  return w;
}

/// True if the line across n has the one wedge before it and the other behind.
bool parts(const Vec2& n, const Wedge& front, const Wedge& behind);

}  // namespace brink
