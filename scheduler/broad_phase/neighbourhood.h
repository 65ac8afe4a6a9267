#pragma once
/// Bodies and still sites by place: levels of cell grids, one a class of size.

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "brink/core/base/large_vector.h"
#include "brink/scheduler/broad_phase/body_clock.h"
#include "brink/scheduler/broad_phase/flight.h"
#include "brink/scheduler/broad_phase/site_lists.h"

namespace brink {

/// Keeps every body in a cell of its level. Two bodies that are not in each other's blocks cannot touch
/// before one of them leaves its cell.
class Neighbourhood {
 public:
  /// Chooses levels and cell sizes for these bodies: a level holds radii up to four times the last one's, its
  /// cells hold one body each where there is room and are never smaller than a body. `by_place` false: one
  /// cell for all.
  Neighbourhood(std::span<Flight> flights, std::span<BodyClock> clocks, std::span<const Vec2> places,
                std::vector<SiteLists::Placed> still_sites, const Periods& periods, bool by_place);

  /// Puts body k into the cell at p; true if that is a new one.
  bool put_into_cell(int k, const Vec2& p);
  /// The box in which body k's centre stays as long as it is in its cell.
  Box box_of(int k) const { return grid(k).box_of(flights_[k].cell); }
  double cell_size(int k) const { return grid(k).size(); }

  /// Calls visit(j, image) for every other body, and that image of it, that k can meet while both stay in
  /// their cells; with `except`, without those of its former cell's blocks.
  template <class Visit>
  void near(int k, Visit&& visit, const Cell* except = nullptr) const {
    for (std::size_t m = 0; m < levels_.size(); ++m) {
      const CellGrid& grid = levels_[m].grid;
      const CellBlock block = block_of(k, flights_[k].cell, m);
      constexpr CellBlock none{{1, 1}, {0, 0}};
      const CellBlock former = except && !grid.wraps(block) ? block_of(k, *except, m) : none;
      grid.lists(block, [&](const Cell& c, const CellBodies& bodies) {
        if (former.contains(c)) return;
        const auto tell = [&](int j) {
          if (j != k) visit(j, image_in(grid, j, c));
        };
        for (unsigned i = 0; i < bodies.count; ++i) tell(bodies.first[i]);
        for (int j = bodies.more; j != CellBodies::kNone; j = flights_[j].next) tell(j);
      });
    }
  }

  /// What near(k, ., except) visits, body k itself included, at once: see CellGrid::around(), whose answer this is. -1,
  /// too, where there is more than one level, or no place for it.
  int around(int k, int* bodies, const Cell* except = nullptr) const {
    if (!around_) return -1;
    const CellGrid& grid = levels_[0].grid;
    const Cell& cell = flights_[k].cell;
    return except ? grid.around(cell, bodies, *except) : grid.around(cell, bodies);
  }

  /// Starts to fetch the cells about body k, in which expect() finds whom to fetch. Slow if k's flight is not at hand.
  void expect_cells(int k) const {
    if (around_) levels_[0].grid.expect_around(flights_[k].cell);
  }
  /// Starts to fetch what near(k) will visit: at many bodies, waiting for their memory is what looking costs.
  void expect(int k) const {
    const auto fetch = [&](int body) { prefetch_line(&flights_[std::max(body, 0)]); };
    if (around_) return levels_[0].grid.firsts_around(flights_[k].cell, fetch);
    for (std::size_t m = 0; m < levels_.size(); ++m)
      levels_[m].grid.lists(block_of(k, flights_[k].cell, m), [&](const Cell&, const CellBodies& bodies) {
        if (bodies.first[0] != CellBodies::kNone) prefetch(&flights_[bodies.first[0]]);
      });
  }

  /// Calls visit(site, image) for every still site, and that image of it, that k can meet in its cell.
  template <class Visit>
  void sites_near(int k, Visit&& visit) const {
    if (clocks_[k].sites == &no_sites_) return;  // most: of no list's memory anything is asked
    const Cell& cell = flights_[k].cell;
    const Image away = repeats_ ? grid(k).periods_between(grid(k).home(cell), cell) : Image{};
    for (const SiteImage& s : *clocks_[k].sites) visit(s.site, s.image + away);
  }

 private:
  struct Level {
    CellGrid grid;
    double radius = 0.0;  ///< the largest of its bodies' [m]
    std::unique_ptr<SiteLists> sites;
  };
  /// Which image of body j is in cell c, one of whose bodies it is.
  Image image_in(const CellGrid& grid, int j, const Cell& c) const {
    return !repeats_ || flights_[j].cell == c ? Image{} : grid.periods_between(flights_[j].cell, c);
  }
  const CellGrid& grid(int k) const { return levels_[clocks_[k].level].grid; }
  CellGrid& grid(int k) { return levels_[clocks_[k].level].grid; }
  CellBlock block_of(int k, const Cell& cell, std::size_t level) const {
    const Level& own = levels_[clocks_[k].level];
    if (static_cast<int>(level) == clocks_[k].level && !own.grid.one_cell())  // as the cells' size was chosen
      return {{cell.column - 1, cell.row - 1}, {cell.column + 1, cell.row + 1}};
    // by the level's radius, not the body's: then the blocks of two bodies hold each other
    const double reach = (own.radius + levels_[level].radius) * (1.0 + 4.0 * kFlightMargin);
    return levels_[level].grid.block_of(own.grid.box_of(cell).grown(reach));
  }
  void make_levels(std::span<const Vec2> places, bool by_place);
  void take_out(int k);
  void put_in(int k);
  const std::vector<SiteImage>* sites_of(Level& level, const Cell& cell) const;

  std::span<Flight> flights_;
  std::span<BodyClock> clocks_;
  std::vector<SiteLists::Placed> still_sites_;
  const std::vector<SiteImage> no_sites_;  ///< of every cell that has none
  Periods periods_;
  bool repeats_;
  bool around_ = false;  ///< around() has an answer
  std::vector<Level> levels_;
};

}  // namespace brink
