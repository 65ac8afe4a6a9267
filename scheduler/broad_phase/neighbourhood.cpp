#include "brink/scheduler/broad_phase/neighbourhood.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

constexpr int kFewBodies = 6;      ///< bodies that need no cells
constexpr double kLevelRatio = 4;  ///< of radii, from level to level
constexpr double kTopLevel = 24;   ///< holds all that is larger still

/// Of the bodies [m]; 0 where there are none.
double median_radius(std::span<const Flight> flights) {
  if (flights.empty()) return 0.0;
  std::vector<double> radii;
  for (const Flight& f : flights) radii.push_back(f.radius);
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return *middle;
}

/// Level 0 holds radii up to twice the median, level m > 0 those up to 2 median kLevelRatio^m.
int level_of(double radius, double median) {
  if (!(radius > 2.0 * median) || median == 0.0) return 0;
  return 1 + static_cast<int>(std::min(std::log(radius / (2.0 * median)) / std::log(kLevelRatio), kTopLevel));
}

}  // namespace

Neighbourhood::Neighbourhood(std::span<Flight> flights, std::span<BodyClock> clocks,
                             std::span<const Vec2> places, std::vector<SiteLists::Placed> still_sites,
                             const Periods& periods, bool by_place)
    : flights_(flights),
      clocks_(clocks),
      still_sites_(std::move(still_sites)),
      periods_(periods),
      repeats_(periods.any()) {
  make_levels(places, by_place && flights.size() > kFewBodies);
  around_ = levels_.size() == 1 && levels_[0].grid.has_around();
  for (int k = 0; k < static_cast<int>(flights.size()); ++k) {
    flights_[k].cell = grid(k).cell_of(places[k]);
    put_in(k);
  }
}

/// Three passes: the level of every body, with each level's largest radius and its number; the cells of each
/// level; the sites of each cell. Cells are sized by what the level holds, not by its class.
void Neighbourhood::make_levels(std::span<const Vec2> places, bool by_place) {
  Box all;
  for (const Vec2& p : places) all.add(p);
  const double median = median_radius(flights_);
  std::vector<std::size_t> counts;
  for (std::size_t k = 0; k < flights_.size(); ++k) {
    const int level = by_place ? level_of(flights_[k].radius, median) : 0;
    clocks_[k].level = level;
    if (static_cast<std::size_t>(level) >= levels_.size()) {
      levels_.resize(level + 1);
      counts.resize(level + 1);
    }
    levels_[level].radius = std::max(levels_[level].radius, flights_[k].radius);
    ++counts[level];
  }
  for (std::size_t m = 0; m < levels_.size(); ++m) {
    Level& level = levels_[m];
    // Between bodies of cells that are no neighbours lies at least a cell, less the slack on both sides:
    // size (1 - 2 kSlack). Two of the level's largest must not bridge that.
    const double tightest = 2.0 * level.radius * (1.0 + 8.0 * kFlightMargin) / (1.0 - 2.0 * CellGrid::kSlack);
    Vec2 extent = all.extent().cwiseMax(tightest);
    for (int axis = 0; axis < 2; ++axis)
      // where the plane repeats bodies are spread over the period, wherever their unwrapped places are
      if (periods_.size[axis] > 0.0) extent[axis] = periods_.size[axis];
    const double roomy =
        std::sqrt(extent.x() * extent.y() / static_cast<double>(std::max<std::size_t>(counts[m], 1)));
    // `roomy` is the side of one body's share of the area; 0.8 of it has two thirds of that area.
    double size = std::max(tightest, 0.8 * roomy);
    if (!by_place || !(size > 0.0)) size = std::numeric_limits<double>::infinity();
    level.grid = CellGrid(size, extent, periods_);
  }
  for (Level& level : levels_)
    level.sites = std::make_unique<SiteLists>(still_sites_, level.grid, periods_, level.radius);
}

bool Neighbourhood::put_into_cell(int k, const Vec2& p) {
  const Cell cell = grid(k).cell_of(p);
  if (clocks_[k].sites && cell == flights_[k].cell) return false;
  take_out(k);
  flights_[k].cell = cell;
  put_in(k);
  return true;
}

void Neighbourhood::take_out(int k) {
  // The list is in use only while the places at hand are full, and those have no gaps. So the free place
  // gets the last one at hand, and that one's place the first of the list, or kNone.
  CellBodies& bodies = grid(k).bodies(flights_[k].cell);
  int* const end = bodies.first + bodies.count;
  int* const at = std::find(bodies.first, end, k);
  if (at == end) {  // in the list
    if (bodies.more == k) {
      bodies.more = flights_[k].next;
      return;
    }
    int* from = &flights_[bodies.more].next;
    while (*from != k) from = &flights_[*from].next;
    *from = flights_[k].next;
    return;
  }
  *at = end[-1];
  end[-1] = bodies.more;
  if (bodies.more == CellBodies::kNone)
    --bodies.count;
  else
    bodies.more = flights_[bodies.more].next;
}

/// At hand while there is room, else at the head of the list.
void Neighbourhood::put_in(int k) {
  Level& level = levels_[clocks_[k].level];
  CellBodies& bodies = level.grid.bodies(flights_[k].cell);
  if (bodies.count < CellBodies::kAtHand) {
    bodies.first[bodies.count] = k;
    ++bodies.count;
  } else {
    flights_[k].next = bodies.more;
    bodies.more = k;
  }
  clocks_[k].sites = sites_of(level, flights_[k].cell);
}

/// Always the same list where there is none.
const std::vector<SiteImage>* Neighbourhood::sites_of(Level& level, const Cell& cell) const {
  if (level.sites->is_known_empty(cell)) return &no_sites_;
  const std::vector<SiteImage>& sites = level.sites->of(cell);
  return sites.empty() ? &no_sites_ : &sites;
}

}  // namespace brink
