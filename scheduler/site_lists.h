#pragma once
/// Which still fixed sites a body in a cell can reach.

#include <unordered_map>
#include <vector>

#include "brink/core/world/world.h"
#include "brink/scheduler/cell_grid.h"

namespace brink {

/// For every cell of one grid level, the still sites within `reach` of the cell's box; found when first asked
/// for. Lists stay where they are.
class SiteLists {
 public:
  /// `placed`: the still sites' outlines in the world, with their indices into World::sites.
  struct Placed {
    int site;
    Outline outline;
  };
  SiteLists(const std::vector<Placed>& sites, const CellGrid& grid, double reach)
      : sites_(&sites), grid_(&grid), reach_(reach) {}

  /// Sites of that cell, ascending. Cost: all sites when first asked, then a look-up.
  const std::vector<int>& of(const Cell& cell);

 private:
  bool reaches(const Outline& outline, const Box& box) const;

  const std::vector<Placed>* sites_;
  const CellGrid* grid_;
  double reach_;
  std::unordered_map<std::uint64_t, std::vector<int>> lists_;
};

}  // namespace brink
