#pragma once
/// SVG path data (SVG 2, section 9.3): from text to commands with absolute points, y still downward.

#include <array>
#include <string_view>
#include <vector>

#include "brink/core/base/geometry.h"

namespace brink {

enum class PathPieceKind { line, cubic, arc };

/// One piece of a subpath. Quadratics have become cubics (exactly).
struct PathPiece {
  PathPieceKind kind = PathPieceKind::line;
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  Vec2 control_1 = Vec2::Zero(), control_2 = Vec2::Zero();  ///< cubics
  double rx = 0.0, ry = 0.0;                                ///< arcs: half axes as written, >= 0
  double rotation = 0.0;                                    ///< arcs: of the x axis [degrees]
  bool large = false, sweep = false;                        ///< arcs: the two flags
};

struct Subpath {
  std::vector<PathPiece> pieces;
  bool closed = false;  ///< by Z, or by coming back to its start (last point == first point)
};

/// All commands M L H V C S Q T A Z in both cases; repeats, commas and spaces as the grammar has them.
/// Subpaths that draw nothing are dropped.
/// @throws BadInput naming the character (from 1) at which the data stops being a path.
std::vector<Subpath> parse_svg_path(std::string_view d);

}  // namespace brink
