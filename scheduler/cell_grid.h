#pragma once
/// Who is near whom: bodies in the cells of a uniform grid, wrapped on a torus so that the plane has no edge.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "brink/core/base/geometry.h"

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
    return low.column <= c.column && c.column <= high.column && low.row <= c.row && c.row <= high.row;
  }
};

/// One level of the grid: square cells of one size for bodies of like size. A body stays in its cell while
/// its centre is in the cell's box grown by slack(): it does not flutter on a border.
class CellGrid {
 public:
  static constexpr int kNone = -1;
  static constexpr double kSlack = 0.05;  ///< of a cell's size

  CellGrid() = default;
  /// @pre size > 0, may be infinite (one cell); `across`, `down`: cells that the bodies spread over.
  CellGrid(double size, double across, double down) : size_(size) {
    columns_ = power_of_two(across);
    rows_ = power_of_two(down);
    heads_.assign(static_cast<std::size_t>(columns_) * rows_, kNone);
  }

  double size() const { return size_; }
  double slack() const { return kSlack * size_; }
  bool one_cell() const { return std::isinf(size_); }
  Cell cell_of(const Vec2& p) const {
    if (one_cell()) return {};
    return {index(p.x()), index(p.y())};
  }
  /// The box in which a body of that cell has its centre.
  Box box_of(const Cell& c) const {
    if (one_cell()) {
      const double all = std::numeric_limits<double>::infinity();
      return {{-all, -all}, {all, all}};
    }
    return Box{{edge(c.column), edge(c.row)}, {edge(c.column + 1), edge(c.row + 1)}}.grown(slack());
  }
  /// Cells whose bodies can have their centres in the box.
  CellBlock block_of(const Box& box) const {
    if (one_cell()) return {};
    return {cell_of(box.low.array() - slack()), cell_of(box.high.array() + slack())};
  }

  /// Calls visit(cell, first body of its list) for the cells of the block, each list once. Lists hold bodies
  /// of cells a torus away too.
  template <class Visit>
  void lists(const CellBlock& block, Visit&& visit) const {
    const int columns = std::min(block.high.column - block.low.column + 1, columns_);
    const int rows = std::min(block.high.row - block.low.row + 1, rows_);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        visit(Cell{block.low.column + c, block.low.row + r},
              heads_[place({block.low.column + c, block.low.row + r})]);
  }

  /// True if the block is so wide that one list holds several of its cells.
  bool wraps(const CellBlock& b) const {
    return b.high.column - b.low.column >= columns_ || b.high.row - b.low.row >= rows_;
  }

  int& head(const Cell& c) { return heads_[place(c)]; }

 private:
  static constexpr double kFar = 1e9;  ///< cells from the origin; all beyond is one

  static int power_of_two(double n) {
    int p = 1;
    while (p < n && p < (1 << 14)) p *= 2;
    return p;
  }
  int index(double x) const { return static_cast<int>(std::clamp(std::floor(x / size_), -kFar, kFar)); }
  /// Where column c begins; the outermost columns have no end.
  double edge(int c) const {
    if (c <= -kFar) return -std::numeric_limits<double>::infinity();
    return c > kFar ? std::numeric_limits<double>::infinity() : c * size_;
  }
  std::size_t place(const Cell& c) const {
    return static_cast<std::size_t>(c.row & (rows_ - 1)) * columns_ + (c.column & (columns_ - 1));
  }

  double size_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<int> heads_;
};

}  // namespace brink
