#include "brink/scheduler/site_lists.h"

#include <cmath>

namespace brink {

bool SiteLists::reaches(const Outline& outline, const Box& box) const {
  const double half = 0.5 * box.extent().norm();
  if (!std::isfinite(half)) return true;
  if (!outline.container && !outline.bounds.grown(reach_).overlaps(box)) return false;
  return std::abs(gap_by_brute_force(outline, box.center())) <= (half + reach_) * (1.0 + 1e-9);
}

const std::vector<int>& SiteLists::of(const Cell& cell) {
  const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(cell.column)) << 32) |
                   static_cast<std::uint32_t>(cell.row);
  const auto [it, is_new] = lists_.try_emplace(key);
  if (is_new) {
    const Box box = grid_->box_of(cell);
    for (const Placed& p : *sites_)
      if (reaches(p.outline, box)) it->second.push_back(p.site);
  }
  return it->second;
}

}  // namespace brink
