#pragma once
/// Still wires without thickness, and whether something flew through one: a watch over the search for first
/// contact that shares nothing with it.

#include <functional>
#include <memory>
#include <optional>

#include "brink/core/base/geometry.h"
#include "brink/core/base/periodic.h"
#include "brink/core/shapes/site.h"

namespace brink {

/// Segments and arcs in the world, each of a fixed site, and their images where the plane repeats. Answers are told to
/// roundings of double: a way that begins or ends closer to a wall than that is not judged by it.
class ThinWalls {
 public:
  explicit ThinWalls(const Periods& periods = {});
  ~ThinWalls();

  /// A segment or an arc, as it stands in the world; `site`: the fixed site that it is of.
  void add(const Site& core, int site);
  bool empty() const { return count_ == 0; }

  /// A box about p whose inside no wall reaches; that place alone if one is there. Where the plane repeats, no wider than a
  /// period. Cost: a look at every wall if they are few, else a search in a tree; for every image that may be that near.
  Box clear_around(const Vec2& p) const;

  /// The site of a wall that a point went through on its way; nothing if there is none. `place` is where the
  /// point is at a time of [from, to]; `turns`: how often it turns about its centre on the way. Cost: a
  /// search in a tree of boxes along the straight line between the ends (O(log walls)); only a wall that this
  /// line crosses is looked at closer, by 64 places and as many more a turn; for every image about that line,
  /// where that are no more than 10 000.
  std::optional<int> crossed(const std::function<Vec2(double)>& place, double from, double to,
                             double turns = 0.0) const;

 private:
  struct Tree;
  using Place = std::function<Vec2(double)>;
  double room_about(const Vec2& p) const;
  std::optional<int> crossed_image(const Place& place, double from, double to, double turns) const;

  std::unique_ptr<Tree> tree_;
  Periods periods_;
  Box extent_;  ///< of all walls
  int count_ = 0;
};

}  // namespace brink
