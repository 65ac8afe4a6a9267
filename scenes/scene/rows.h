#pragma once
/// Copies of one shape in rows that touch: stacks, pyramids, walls. Internal to the scene reader.

#include <cstdint>
#include <map>
#include <vector>

#include "brink/core/shapes/outline.h"

namespace brink {

struct RowsAsk {
  const Outline* outline = nullptr;
  double angle = 0.0;                 ///< of every copy [rad]
  Vec2 up = Vec2::UnitY();            ///< unit: from row to row
  std::vector<std::int64_t> lengths;  ///< copies in each row, lowest first, each >= 1
  double thin = 0.0;                  ///< of gap_of_touching() [m]
};

class CopyGaps;

/// Rows of copies, each row's middle above that of the lowest.
///
/// The copies of a row are as far apart as a copy that comes along the row from far away can come to the next,
/// and each row is let down as one onto those below. So nobody overlaps anybody, whatever the shape, and of
/// shapes that are convex and stand upright everybody touches everybody beside, below and above. Distances are
/// those of cast_outline(); what roundings leave of gaps below gap_of_touching() is pushed apart.
class TouchingRows {
 public:
  explicit TouchingRows(RowsAsk ask);

  /// Where the copies stand if the middle of the lowest row is there: row by row, each along up turned by -90
  /// degrees; the first `most` of them.
  std::vector<Pose> at(const Vec2& middle, std::size_t most) const;

 private:
  /// A copy that another may touch: so many rows below, and so many half distances to the side of it.
  struct Neighbour {
    std::size_t row = 0;
    std::int64_t halves = 0;
  };

  std::int64_t first(std::size_t row) const { return 1 - ask_.lengths[row]; }
  std::int64_t last(std::size_t row) const { return ask_.lengths[row] - 1; }
  Vec2 offset(std::int64_t halves, double height) const {
    return static_cast<double>(halves) * (0.5 * width_) * along_ + height * ask_.up;
  }
  double extent_along(const Vec2& direction) const;
  double distance_in_row() const;
  double drop(std::int64_t halves);
  double height_of(std::size_t row);
  std::vector<Neighbour> neighbours_of(std::size_t row, CopyGaps& gaps) const;
  template <class Visit>
  void for_offsets(std::size_t row, std::size_t below, Visit&& visit) const;

  RowsAsk ask_;
  Vec2 along_;
  double high_ = 0.0, wide_ = 0.0;  // a copy's extents along up and along the row [m]
  double width_ = 0.0;              // from copy to copy in a row [m]
  std::map<std::int64_t, double> drops_;
  std::vector<double> heights_;
  std::vector<std::vector<Neighbour>> neighbours_;
};

}  // namespace brink
