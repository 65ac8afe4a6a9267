#include "brink/scheduler/broad_phase/site_lists.h"

#include <cmath>

#include "brink/scheduler/broad_phase/tolerances.h"

namespace brink {

/// True if a body of the level with its centre in the box may touch the outline. It may say so of a box that
/// is out of reach by a part of its diagonal, never the reverse.
bool SiteLists::reaches(const Outline& outline, const Box& box) const {
  // No place of the box is farther than `half` from its centre, and a distance changes by no more than
  // the way. The outermost cells have no end, nor has an only one: everything is in reach of them.
  const double half = 0.5 * box.extent().norm();
  if (!std::isfinite(half)) return true;
  if (!outline.container && !outline.bounds.grown(reach_).overlaps(box)) return false;
  // Deep in a solid, too, nothing can be met: a body's centre comes there only through its surface.
  return std::abs(gap_by_brute_force(outline, box.center())) <= (half + reach_) * (1.0 + kFlightMargin);
}

/// Adds the site, or each of its images, that is in reach of the box.
void SiteLists::find(const Placed& placed, const Box& box, std::vector<SiteImage>& found) const {
  if (!periods_.any()) {
    if (reaches(placed.outline, box)) found.push_back({placed.site, {}});
    return;
  }
  periods_.overlaps(box, placed.outline.bounds.grown(reach_), [&](const Image& image) {
    const Vec2 shift = periods_.shift(image);
    // the box is moved to the outline, not the outline to its image: one outline serves for all images
    if (reaches(placed.outline, {box.low - shift, box.high - shift})) found.push_back({placed.site, image});
  });
}

/// Of most cells of a large world nothing but a bit is kept.
const std::vector<SiteImage>& SiteLists::of(const Cell& cell) {
  const Cell home = grid_->home(cell);
  if (is_known_empty(home)) return none_;
  const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(home.column)) << 32) |
                   static_cast<std::uint32_t>(home.row);
  // the map never moves its lists: clocks of bodies keep pointers to them (BodyClock::sites)
  if (const auto known = lists_.find(key); known != lists_.end()) return known->second;
  const Box box = grid_->box_of(home);
  std::vector<SiteImage> found;
  for (const Placed& p : *sites_) find(p, box, found);
  const std::size_t place = place_of(home);
  if (!found.empty() || place == ~std::size_t{0}) return lists_.emplace(key, std::move(found)).first->second;
  if (place >= empty_.size()) empty_.resize(place + 1);
  empty_[place] = true;
  return none_;
}

}  // namespace brink
