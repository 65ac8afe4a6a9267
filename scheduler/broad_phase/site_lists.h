#pragma once
/// Which still fixed sites a body in a cell can reach.

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "brink/core/world/world.h"
#include "brink/scheduler/broad_phase/cell_grid.h"

namespace brink {

/// A still site where it stands, or where one of its images does.
struct SiteImage {
  int site;
  Image image;
};

/// For every cell of one grid level, the still sites within `reach` of the cell's box; found when first asked
/// for. Lists stay where they are.
class SiteLists {
 public:
  /// `placed`: the still sites' outlines in the world, with their indices into World::sites.
  struct Placed {
    int site;
    Outline outline;
  };
  SiteLists(const std::vector<Placed>& sites, const CellGrid& grid, const Periods& periods, double reach)
      : sites_(&sites), grid_(&grid), periods_(periods), reach_(reach) {}

  /// Sites of the cell's image in the first period, ascending. Cost: all sites when first asked, then a bit or a
  /// look-up.
  const std::vector<SiteImage>& of(const Cell& cell);
  /// True if of() has found nothing for that cell before; it may have, too, where this is false. Cost: a bit.
  bool is_known_empty(const Cell& cell) const {
    const std::size_t place = place_of(cell);
    return place < empty_.size() && empty_[place];
  }

 private:
  void find(const Placed& placed, const Box& box, std::vector<SiteImage>& found) const;
  bool reaches(const Outline& outline, const Box& box) const;
  /// In empty_, of cells about the origin, where most bodies are; beyond them: none. Counted outwards, square about
  /// square (pairing function of Szudzik 2006), so that a small world needs few bits.
  std::size_t place_of(const Cell& cell) const {
    // 0, -1, 1, -2 ... are 0, 1, 2, 3 ...
    const auto outwards = [](std::int32_t k) {
      return (static_cast<std::uint32_t>(k) << 1) ^ static_cast<std::uint32_t>(k >> 31);
    };
    const std::size_t column = outwards(cell.column), row = outwards(cell.row);
    if (column >= kAcross || row >= kAcross) return ~std::size_t{0};
    return column < row ? row * row + column : column * column + column + row;
  }
  static constexpr std::uint32_t kAcross = 2048;

  const std::vector<Placed>* sites_;
  const CellGrid* grid_;
  Periods periods_;
  double reach_;
  const std::vector<SiteImage> none_;
  std::unordered_map<std::uint64_t, std::vector<SiteImage>>
      lists_;                ///< of cells that empty_ does not tell of
  std::vector<bool> empty_;  ///< cells for which nothing was found, by place_of(), as far as there are any
};

}  // namespace brink
