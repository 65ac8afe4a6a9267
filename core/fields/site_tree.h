#pragma once
/// A bounding-volume tree over the sites of an outline: the exact answer where a picture cannot give a short
/// list.

#include <cstdint>
#include <vector>

#include "brink/core/shapes/outline.h"

namespace brink {

/// Immutable; any number of threads may search it. Does not keep the outline.
class SiteTree {
 public:
  /// Number of nearest sites that a search lists; the next one bounds all others.
  static constexpr int kListed = 3;

  explicit SiteTree(const Outline& outline);

  /// Fills `sites` with the `kListed` nearest sites to q (by core distance less radius; nearest first, lower
  /// index first on ties) and returns a lower bound on the distance of every other one: infinity if there is
  /// none. Cost: O(log n) for points near a few sites, up to O(n) where many are equally near.
  double nearest(const Outline& outline, const Vec2& q, std::vector<std::uint32_t>& sites) const;

 private:
  /// Leaves hold sites order_[first .. first + count - 1]; inner nodes (count 0) have children at `first` and
  /// `first + 1`.
  struct Node {
    Box box;
    double radius = 0.0;  ///< largest of the sites below
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  struct Search;

  void build(const Outline& outline, std::uint32_t node, std::uint32_t first, std::uint32_t count,
             const std::vector<Box>& boxes);
  double lower_bound(const Node& node, const Vec2& q) const;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  double rounding_ = 0.0;
};

/// Box that holds the core of a site.
Box core_box(const Site& site);

}  // namespace brink
