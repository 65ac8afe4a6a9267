#include "brink/scheduler/broad_phase/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "brink/scheduler/broad_phase/tolerances.h"

namespace brink {

namespace {

constexpr double kCellsPerBox = 2.0;                        ///< a cell is this many times the median box
constexpr int kMostCellsAcross = 4;                         ///< boxes wider than this many cells are large
constexpr std::size_t kFewBoxes = 512;                      ///< boxes that need no cells
constexpr std::int64_t kMostCells = std::int64_t{1} << 60;  ///< only those that hold a box take room
constexpr std::size_t kCellsPerEntry = 4;                   ///< of more cells entries are sorted, not counted

/// Cells of a window, counted row by row.
struct Grid {
  Vec2 low;
  double cell;
  std::int64_t columns, rows;

  std::int64_t column(double x) const { return clamp((x - low.x()) / cell, columns); }
  std::int64_t row(double y) const { return clamp((y - low.y()) / cell, rows); }
  /// Compared as doubles, before the cast: the quotient of a place far outside the window may be more than
  /// any integer holds.
  static std::int64_t clamp(double v, std::int64_t n) {
    return v <= 0.0 ? 0 : v >= static_cast<double>(n) ? n - 1 : static_cast<std::int64_t>(v);
  }
};

/// Of the boxes' longer sides [m]; infinite ones do not count. 1 where there is nothing to go by: then any
/// cell will do. The median, as a few large boxes must not make the cells large.
double median_extent(const std::vector<Box>& boxes) {
  std::vector<double> extents;
  for (const Box& b : boxes)
    if (const double e = b.extent().maxCoeff(); std::isfinite(e)) extents.push_back(e);
  if (extents.empty()) return 1.0;
  const auto middle = extents.begin() + static_cast<std::ptrdiff_t>(extents.size() / 2);
  std::nth_element(extents.begin(), middle, extents.end());
  return *middle > 0.0 ? *middle : 1.0;
}

/// Over the finite boxes; what is infinite is large (Sorted), and needs no cell.
Grid make_grid(const std::vector<Box>& boxes) {
  Box all;
  for (const Box& b : boxes)
    if (std::isfinite(b.extent().maxCoeff())) all.add(b);
  Grid g{Vec2::Zero(), kCellsPerBox * median_extent(boxes), 1, 1};
  if (all.empty()) return g;
  g.low = all.low;
  const auto cells = [&](double extent) { return std::floor(extent / g.cell) + 1.0; };
  // A few boxes far away widen the window: larger cells then, so that their numbers fit 64 bits.
  while (cells(all.extent().x()) * cells(all.extent().y()) > static_cast<double>(kMostCells)) g.cell *= 2.0;
  g.columns = static_cast<std::int64_t>(cells(all.extent().x()));
  g.rows = static_cast<std::int64_t>(cells(all.extent().y()));
  return g;
}

/// Which image of the box has its centre in the first period.
Image image_at_home(const Box& box, const Periods& periods) {
  const auto along = [&](int axis) {
    const double size = periods.size[axis];
    if (!(size > 0.0)) return 0;
    const double whole = std::floor(box.center()[axis] / size);
    return -static_cast<int>(std::clamp(whole, -Periods::kFarthest, Periods::kFarthest));
  };
  return {along(0), along(1)};
}

Box moved(Box box, const Vec2& by) {
  box.low += by;
  box.high += by;
  return box;
}

struct Entry {
  std::int64_t cell;
  int box;
};

/// Boxes by the cells that they lie in, and those that lie in too many.
/// Every box is in one of the two: in `entries`, once for each of its cells, or in `large`.
struct Sorted {
  std::vector<Entry> entries;  ///< ascending
  std::vector<int> large;
  std::vector<char> is_large;

  Sorted(const std::vector<Box>& boxes, const Grid& grid) : is_large(boxes.size(), 0) {
    for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
      if (boxes[i].extent().maxCoeff() <= kMostCellsAcross * grid.cell) {
        add(i, boxes[i], grid);
      } else {  // not finite, too
        large.push_back(i);
        is_large[i] = 1;
      }
    }
    sort(grid);
  }

 private:
  /// By box within a cell, so that pairs come with i < j. They were added in the order of boxes, so where cells are not many
  /// more than entries these are put behind each other by cell, in that order.
  void sort(const Grid& grid) {
    const auto cells = static_cast<std::size_t>(grid.columns * grid.rows);
    if (cells > kCellsPerEntry * entries.size()) {
      std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return std::pair(a.cell, a.box) < std::pair(b.cell, b.box);
      });
      return;
    }
    std::vector<std::size_t> begins(cells + 1, 0);
    for (const Entry& e : entries) ++begins[e.cell + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    std::vector<Entry> sorted(entries.size());
    for (const Entry& e : entries) sorted[begins[e.cell]++] = e;
    entries = std::move(sorted);
  }
  /// At most (kMostCellsAcross + 1)^2 entries; a box over the window's edge is in the outermost cells.
  void add(int i, const Box& box, const Grid& grid) {
    for (auto r = grid.row(box.low.y()); r <= grid.row(box.high.y()); ++r)
      for (auto c = grid.column(box.low.x()); c <= grid.column(box.high.x()); ++c)
        entries.push_back({r * grid.columns + c, i});
  }
};

/// Pairs of boxes that share a cell. False if a visit was the last.
bool each_in_cells(const std::vector<Box>& boxes, const Grid& grid, const std::vector<Entry>& entries,
                   const std::function<bool(int, int)>& visit) {
  for (std::size_t i = 0; i < entries.size(); ++i)
    for (std::size_t j = i + 1; j < entries.size() && entries[j].cell == entries[i].cell; ++j) {
      const Box &a = boxes[entries[i].box], &b = boxes[entries[j].box];
      if (!a.overlaps(b)) continue;
      // a pair that shares several cells is named in one only: where the corner of its intersection lies
      const Vec2 corner = a.low.cwiseMax(b.low);
      if (grid.row(corner.y()) * grid.columns + grid.column(corner.x()) != entries[i].cell) continue;
      if (!visit(entries[i].box, entries[j].box)) return false;
    }
  return true;
}

/// Pairs of which one is large. False if a visit was the last.
bool each_with_large(const std::vector<Box>& boxes, const Sorted& sorted,
                     const std::function<bool(int, int)>& visit) {
  for (const int i : sorted.large)
    for (int j = 0; j < static_cast<int>(boxes.size()); ++j) {
      // two large boxes meet from both: named by the lower one
      if (j == i || (sorted.is_large[j] && j < i) || !boxes[i].overlaps(boxes[j])) continue;
      if (!visit(std::min(i, j), std::max(i, j))) return false;
    }
  return true;
}

/// By a sweep over their left edges: for a few boxes quicker than cells. False if a visit was the last.
bool each_of_few(const std::vector<Box>& boxes, const std::function<bool(int, int)>& visit) {
  struct Edge {
    double left;
    int box;
  };
  std::vector<Edge> edges;
  edges.reserve(boxes.size());
  for (const Box& b : boxes) edges.push_back({b.low.x(), static_cast<int>(edges.size())});
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.left < b.left || (a.left == b.left && a.box < b.box);
  });
  for (auto i = edges.begin(); i != edges.end(); ++i) {
    const Box& box = boxes[i->box];
    for (auto j = i + 1; j != edges.end() && j->left <= box.high.x(); ++j)
      if (box.overlaps(boxes[j->box]) && !visit(std::min(i->box, j->box), std::max(i->box, j->box)))
        return false;
  }
  return true;
}

/// A box about places of an outline's origin, grown by the outline and by `more` [m].
Box with_outline(const Box& places, const Outline& outline, double more) {
  // rounding goes with the coordinates, which may be far larger than the box
  const double scale = places.low.cwiseAbs().cwiseMax(places.high.cwiseAbs()).maxCoeff();
  return places.grown(outline.bounding_radius + more + kBoxMargin * (scale + outline.bounding_radius));
}

}  // namespace

Box swept_box(const Outline& outline, const Motion& motion, double from, double to) {
  const Vec2 start = motion.pose(from).position;
  if (!(from < to) || outline.container) return standing_box(outline, start);
  Box box;
  box.add(start);
  box.add(motion.pose(to).position);
  const MotionBounds b = motion.bounds(from, to);
  // A path leaves its chord by e(t) with e = 0 at both ends and |e''| <= a, so |e| <= a t (T - t) / 2,
  // which is a T^2 / 8 at most. Nor does it leave the chord's ends by more than half of its way, however bent it is in a corner.
  const double span = to - from, acceleration = b.acceleration.norm() + b.acceleration_radius;
  return with_outline(box, outline, std::min(acceleration * span / 4.0, b.speed()) * span / 2.0);
}

Box standing_box(const Outline& outline, const Vec2& place) {
  // a container is solid without end: its box leaves nobody out
  constexpr double everywhere = std::numeric_limits<double>::infinity();
  if (outline.container) return {{-everywhere, -everywhere}, {everywhere, everywhere}};
  return with_outline({place, place}, outline, 0.0);
}

bool each_overlapping(const std::vector<Box>& boxes, const std::function<bool(int i, int j)>& visit) {
  if (boxes.size() <= kFewBoxes) return each_of_few(boxes, visit);
  const Grid grid = make_grid(boxes);
  Sorted sorted(boxes, grid);
  return each_in_cells(boxes, grid, sorted.entries, visit) && each_with_large(boxes, sorted, visit);
}

std::vector<std::pair<int, int>> overlapping_pairs(const std::vector<Box>& boxes) {
  std::vector<std::pair<int, int>> pairs;
  each_overlapping(boxes, [&](int i, int j) {
    pairs.emplace_back(i, j);
    return true;
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

bool each_overlapping(const std::vector<Box>& boxes, const Periods& periods,
                      const std::function<bool(const ImagePair&)>& visit) {
  if (!periods.any()) return each_overlapping(boxes, [&](int i, int j) { return visit({i, j, {}}); });
  const int n = static_cast<int>(boxes.size());
  std::vector<Image> images;
  std::vector<Box> copies;  // every box at home, then those images that reach into the homes
  std::vector<int> owner(n);
  Box homes;
  for (int k = 0; k < n; ++k) {
    images.push_back(image_at_home(boxes[k], periods));
    copies.push_back(moved(boxes[k], periods.shift(images[k])));
    owner[k] = k;
    homes.add(copies[k]);
  }
  // What reaches a box at home reaches the box of all homes.
  for (int k = 0; k < n; ++k)
    periods.overlaps(homes, boxes[k], [&](const Image& image) {
      if (image == images[k]) return;
      images.push_back(image);
      copies.push_back(moved(boxes[k], periods.shift(image)));
      owner.push_back(k);
    });
  return each_overlapping(copies, [&](int i, int j) {
    // of the pair's images, the one whose first box is at home: the same is met with the second at home, too;
    // a body does not meet images of its own
    if (i >= n || owner[i] >= owner[j]) return true;
    return visit({owner[i], owner[j], images[j] + -images[i]});
  });
}

std::vector<ImagePair> overlapping_pairs(const std::vector<Box>& boxes, const Periods& periods) {
  std::vector<ImagePair> pairs;
  each_overlapping(boxes, periods, [&](const ImagePair& pair) {
    pairs.push_back(pair);
    return true;
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace brink
