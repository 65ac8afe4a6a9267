#pragma once
/// Who is near whom: bodies in the cells of a uniform grid, wrapped on a torus so that the plane has no edge;
/// where the plane repeats, on the torus that it is.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <vector>

#include "brink/core/base/large_vector.h"
#include "brink/core/base/periodic.h"

namespace brink {

/// A cell's column and row; any integers.
struct Cell {
  int column = 0, row = 0;
  bool operator==(const Cell& c) const { return column == c.column && row == c.row; }
};

/// Cells low .. high, both included.
struct CellBlock {
  Cell low, high;
  bool contains(const Cell& c) const {
    return (low.column <= c.column) & (c.column <= high.column) & (low.row <= c.row) & (c.row <= high.row);
  }
};

/// Bodies of one cell: the first few at hand, without gaps; the others in a list of their own.
struct CellBodies {
  static constexpr int kAtHand = 3;
  static constexpr int kNone = -1;
  int first[kAtHand] = {kNone, kNone, kNone};
  unsigned count : 2 = 0;  ///< at hand
  int more : 30 = kNone;   ///< the first of the list
};

/// One level of the grid: cells of one size for bodies of like size. A body stays in its cell while its
/// centre is in the cell's box grown by slack(): it does not flutter on a border.
class CellGrid {
 public:
  static constexpr double kSlack = 0.05;  ///< of a cell's size

  CellGrid() = default;
  /// @pre size > 0, may be infinite (one cell) along axes that do not repeat; `spread`: of the bodies [m].
  /// Along an axis that repeats, cells are as much larger as they must be to divide the period.
  CellGrid(double size, const Vec2& spread, const Periods& periods)
      : x_(size, spread.x(), periods.size.x()), y_(size, spread.y(), periods.size.y()) {
    slack_ = kSlack * std::min(x_.size, y_.size);
    cells_.assign(static_cast<std::size_t>(x_.count) * y_.count, {});
  }

  double size() const { return std::min(x_.size, y_.size); }
  double slack() const { return slack_; }
  bool one_cell() const { return std::isinf(size()); }
  Cell cell_of(const Vec2& p) const { return {x_.index(p.x()), y_.index(p.y())}; }
  /// The box in which a body of that cell has its centre.
  Box box_of(const Cell& c) const {
    if (x_.ends(c.column) && y_.ends(c.row))  // nearly always
      return {{c.column * x_.size - slack_, c.row * y_.size - slack_},
              {(c.column + 1) * x_.size + slack_, (c.row + 1) * y_.size + slack_}};
    return Box{{x_.edge(c.column), y_.edge(c.row)}, {x_.edge(c.column + 1), y_.edge(c.row + 1)}}.grown(
        slack_);
  }
  /// Cells whose bodies can have their centres in the box.
  CellBlock block_of(const Box& box) const {
    return {cell_of(box.low.array() - slack_), cell_of(box.high.array() + slack_)};
  }

  /// Calls visit(cell, its bodies) for the cells of the block. Where the plane does not repeat, each set of
  /// bodies once; it holds those of cells a torus away too. Where it does, once for each of its cells in the
  /// block.
  template <class Visit>
  void lists(const CellBlock& block, Visit&& visit) const {
    const int columns = x_.lists(block.low.column, block.high.column);
    const int rows = y_.lists(block.low.row, block.high.row);
    const int first = x_.wrapped(block.low.column);
    int row = y_.wrapped(block.low.row);
    for (int r = 0; r < rows; ++r) {
      const CellBodies* cells = cells_.data() + static_cast<std::size_t>(row) * x_.count;
      int column = first;
      for (int c = 0; c < columns; ++c) {
        visit(Cell{block.low.column + c, block.low.row + r}, cells[column]);
        if (++column == x_.count) column = 0;
      }
      if (++row == y_.count) row = 0;
    }
  }

  /// True if around() holds: the plane does not repeat, and is wide enough.
  bool has_around() const { return x_.count >= 4 && y_.count >= 4 && !x_.repeats && !y_.repeats; }
  static constexpr int kMostAround = 9 * CellBodies::kAtHand;
  /// Bodies of the cell and the eight about it, written to `bodies`, which has room for kMostAround and one:
  /// how many; or -1 where a cell has more than are at hand. Without a branch: how many a cell has cannot be foreseen.
  /// @pre has_around().
  int around(const Cell& c, int* bodies) const {
    // all that is read of the grid itself, before anything is written
    const CellBodies* const rows[] = {row_of(c.row - 1), row_of(c.row), row_of(c.row + 1)};
    const int columns[] = {column_of(c.column - 1), column_of(c.column), column_of(c.column + 1)};
    BodiesAtHand all(bodies);
    for (const CellBodies* row : rows)
      for (const int column : columns) all.add(row[column]);
    return all.count();
  }
  /// The same without those of the cell `former` and the eight about it.
  int around(const Cell& c, int* bodies, const Cell& former) const {
    const Cell step{c.column - former.column, c.row - former.row};
    if (std::abs(step.column) + std::abs(step.row) == 1) return ahead(c, step, bodies);
    const CellBlock seen{{former.column - 1, former.row - 1}, {former.column + 1, former.row + 1}};
    BodiesAtHand all(bodies);
    for (int r = c.row - 1; r <= c.row + 1; ++r)
      for (int q = c.column - 1; q <= c.column + 1; ++q)
        if (!seen.contains({q, r})) all.add(row_of(r)[column_of(q)]);
    return all.count();
  }

  /// Starts to fetch the cells that around() reads. @pre has_around().
  void expect_around(const Cell& c) const {
    const int first = column_of(c.column - 1), last = column_of(c.column + 1);
    for (int r = -1; r <= 1; ++r) {
      prefetch_line(row_of(c.row + r) + first);  // three cells may lie in two lines
      prefetch_line(row_of(c.row + r) + last);
    }
  }
  /// Calls visit(body) for the first body of each cell that around() reads; kNone where there is none. @pre has_around().
  template <class Visit>
  void firsts_around(const Cell& c, Visit&& visit) const {
    for (int r = -1; r <= 1; ++r)
      for (int q = -1; q <= 1; ++q) visit(row_of(c.row + r)[column_of(c.column + q)].first[0]);
  }
  /// True if the block is so wide that one list holds several of its cells, and is visited once.
  bool wraps(const CellBlock& b) const {
    return x_.wraps(b.low.column, b.high.column) || y_.wraps(b.low.row, b.high.row);
  }

  CellBodies& bodies(const Cell& c) {
    return cells_[static_cast<std::size_t>(y_.wrapped(c.row)) * x_.count + x_.wrapped(c.column)];
  }

  /// Where a plane repeats: the cell's image in the first period, and how many periods it is from there.
  Cell home(const Cell& c) const { return {x_.home(c.column), y_.home(c.row)}; }
  Image periods_between(const Cell& from, const Cell& to) const {
    return {x_.periods(to.column - from.column), y_.periods(to.row - from.row)};
  }

 private:
  struct Axis {
    double size = 1.0;
    double per_metre = 0.0;  ///< cells; 0: an only one
    int count = 1;           ///< sets of bodies; a power of two where the axis does not repeat
    bool repeats = false;

    Axis() = default;
    Axis(double least, double spread, double period) : size(least), repeats(period > 0.0) {
      if (std::isinf(least) && !repeats) return;
      if (repeats) {
        count = std::max(1, static_cast<int>(std::min(period / least, kMost)));
        size = period / count;
      } else {
        count = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::min(spread / least + 2.0, kMost))));
      }
      per_metre = 1.0 / size;
    }
    int index(double x) const {
      return per_metre == 0.0 ? 0 : static_cast<int>(std::clamp(std::floor(x * per_metre), -kFar, kFar));
    }
    /// True of a cell that has two ends, edge(c) and edge(c + 1): neither the only nor an outermost one.
    bool ends(int c) const {
      const bool low = c > -kFar, high = c < kFar, some = per_metre != 0.0;
      return low & high & some;
    }
    /// Where cell c begins; the outermost cells have no end, an only cell has neither end.
    double edge(int c) const {
      constexpr double everywhere = std::numeric_limits<double>::infinity();
      if (std::isinf(size)) return c > 0 ? everywhere : -everywhere;
      if (c <= -kFar) return -everywhere;
      return c > kFar ? everywhere : c * size;
    }
    int wrapped(int c) const {
      if (static_cast<unsigned>(c) < static_cast<unsigned>(count)) return c;
      if (!repeats) return c & (count - 1);
      const int remainder = c % count;
      return remainder < 0 ? remainder + count : remainder;
    }
    int lists(int low, int high) const { return repeats ? high - low + 1 : std::min(high - low + 1, count); }
    bool wraps(int low, int high) const { return !repeats && high - low >= count; }
    int home(int c) const { return repeats ? wrapped(c) : c; }
    int periods(int cells) const { return repeats ? cells / count : 0; }
  };
  static constexpr double kFar = 1e9;     ///< cells from the origin; all beyond is one
  static constexpr double kMost = 16384;  ///< sets of bodies along an axis

  /// Bodies at hand of several cells, one cell after another.
  class BodiesAtHand {
   public:
    explicit BodiesAtHand(int* bodies) : bodies_(bodies) {}
    void add(const CellBodies& cell) {
      std::memcpy(bodies_ + count_, &cell, sizeof cell);  // what is none of them, the next ones overwrite
      count_ += static_cast<int>(cell.count);
      more_ &= cell.more;  // all bits are set where there is none
    }
    /// -1 where a cell has more.
    int count() const { return more_ == CellBodies::kNone ? count_ : -1; }

   private:
    int* bodies_;
    int count_ = 0, more_ = CellBodies::kNone;
  };

  /// Those of the three cells that a step along one axis, into cell c, has come next to. @pre has_around().
  int ahead(const Cell& c, const Cell& step, int* bodies) const {
    const Cell middle{c.column + step.column, c.row + step.row};
    const int columns = std::abs(step.row), rows = std::abs(step.column);  // they lie across the step
    const CellBodies* cells[3];
    for (const int k : {-1, 0, 1})
      cells[k + 1] = row_of(middle.row + k * rows) + column_of(middle.column + k * columns);
    BodiesAtHand all(bodies);
    for (const CellBodies* cell : cells) all.add(*cell);
    return all.count();
  }

  /// Where a column is in each row. @pre has_around().
  int column_of(int column) const { return column & (x_.count - 1); }
  /// Cells of a row. @pre has_around().
  const CellBodies* row_of(int row) const {
    return cells_.data() + static_cast<std::size_t>(row & (y_.count - 1)) * x_.count;
  }

  Axis x_, y_;
  double slack_ = 0.0;
  LargeVector<CellBodies> cells_;
};

}  // namespace brink
