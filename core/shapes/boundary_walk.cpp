#include "brink/core/shapes/boundary_walk.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/thick_boundary.h"

namespace brink {

namespace {

/// Points nearer to each other than this, of the spacing, are one.
constexpr double kSame = 1e-6;

/// Keeps points that are not kept already: on a grid of cells of `size`, those whose cell is not taken,
/// nor one of the eight around it, into which an equal point may have been rounded.
class Distinct {
 public:
  explicit Distinct(double size) : size_(size) {}

  bool take(const Vec2& p) {
    // whole numbers, but as doubles: an integer would overflow where the outline is far from the origin
    const Vec2 at = (p / size_).array().round();
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        if (cells_.contains({at.x() + dx, at.y() + dy})) return false;
    cells_.insert({at.x(), at.y()});
    return true;
  }

 private:
  double size_;
  std::set<std::pair<double, double>> cells_;
};

}  // namespace

std::vector<Site> boundary_pieces(const Outline& outline) {
  const bool thick =
      std::any_of(outline.sites.begin(), outline.sites.end(), [](const Site& s) { return s.radius > 0.0; });
  return thick ? thick_boundary(outline) : outline.sites;
}

double total_length(const std::vector<Site>& pieces) {
  double sum = 0.0;
  for (const Site& piece : pieces) sum += length(piece);
  return sum;
}

/// Each piece is divided evenly into as few parts as keep to the spacing. In the order of the pieces.
std::vector<Vec2> walk(const std::vector<Site>& pieces, double spacing) {
  std::vector<Vec2> points;
  Distinct distinct(kSame * spacing);
  for (const Site& piece : pieces) {
    // a length of whole spacings up to rounding gets no part more
    const int parts = std::max(1, static_cast<int>(std::ceil(length(piece) / spacing - kSame)));
    for (int k = 0; k <= parts; ++k) {
      const Vec2 p = point_along(piece, static_cast<double>(k) / parts);
      if (distinct.take(p)) points.push_back(p);
    }
  }
  return points;
}

/// @pre there is a piece, and 0 <= way <= total_length() up to rounding.
Vec2 point_at(const std::vector<Site>& pieces, double way) {
  for (const Site& piece : pieces) {
    const double own = length(piece);
    // a bare point has no length to divide by
    if (way <= own && own > 0.0) return point_along(piece, way / own);
    way -= own;
  }
  // rounding left a little of the way
  return point_along(pieces.back(), 1.0);
}

}  // namespace brink
