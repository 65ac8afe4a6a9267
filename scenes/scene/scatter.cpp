/// Two ways to place copies, in this order:
///
///     insertion:  draw a place until one is free; give up after kPlacesTried in a row
///     lattice:    free places of a triangular lattice, as wide as the count allows; too few: 3 % narrower;
///                 draw among them, shake each within the room that the spacing leaves
///
/// Whether a place is free is asked of Room. It may say no of a place that is free (discs about shapes,
/// a budget), never yes of one that is not.
#include "brink/scenes/scene/scatter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "brink/core/base/sine_cosine.h"
#include "brink/core/query/outline_gap.h"

namespace brink {
namespace {

// What is taken already, in cells of a uniform grid over the region.
// A copy asks its own cell alone, so placing n copies costs n times what is near one.
class Room {
 public:
  Room(const ScatterAsk& ask, const std::vector<Obstacle>& obstacles)
      : outline_(ask.outline),
        region_(ask.region),
        periods_(ask.periods),
        reach_(ask.outline->bounding_radius),
        // Copies keep so far apart beyond touching: distances are told to roundings of sizes,
        // far less than this.
        margin_(1e-9 * reach_) {
    const Vec2 extent = region_.extent();
    // About four cells a copy, none smaller than a copy's disc (then an obstacle is in few cells), and
    // at most 1e6 along an axis however long and thin the region is.
    const double cells = std::clamp(4.0 * static_cast<double>(ask.count), 16.0, 1e6);
    cell_ = std::max({2.0 * reach_, std::sqrt(extent.x() * extent.y() / cells), extent.maxCoeff() / 1e6});
    // A place alone, for points without a radius: any cell holds it.
    if (!(cell_ > 0.0)) cell_ = 1.0;
    columns_ = static_cast<int>(extent.x() / cell_) + 1;
    rows_ = static_cast<int>(extent.y() / cell_) + 1;
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (const Obstacle& obstacle : obstacles) take(obstacle);
    buried_.assign(cells_.size(), Buried::unknown);
    // The whole region lies in an obstacle, deeper than a copy's disc reaches: nowhere in it is a
    // place, whatever the shape.
    for (const Obstacle& obstacle : obstacles) full_ = full_ || buries(obstacle, region_, reach_);
  }

  bool full() const { return full_; }

  /// True if a copy at this pose is clear of all that is taken. False outside the region. Takes from
  /// the budget.
  bool free(const Pose& pose) {
    if (full_ || !region_.contains(pose.position)) return false;
    const auto clear = [&](const Obstacle& taken) { return apart(taken, {outline_, pose}); };
    // take_image() has put every obstacle into each cell from which a copy could touch it:
    // one cell is enough.
    const int c = column(pose.position.x()), r = row(pose.position.y());
    // Of other shapes a centre that is buried is no proof, as their origin may lie outside of them.
    if (outline_->is_point() && is_buried(c, r)) return false;
    const auto& near = cells_[index(c, r)];
    return std::all_of(near.begin(), near.end(), clear) && std::all_of(large_.begin(), large_.end(), clear);
  }

  // Every image of it that a copy in the region could touch.
  void take(const Obstacle& obstacle) {
    // It is solid everywhere but in its room, so it is near to every cell.
    if (obstacle.outline->container) return large_.push_back(obstacle);
    const double reach = obstacle.outline->bounding_radius + reach_ + 2.0 * margin_;
    Box around;
    around.add(obstacle.pose.position);
    around = around.grown(reach);
    if (images_in(around) > kMostImages) return void(full_ = true);  // no room between so many
    periods_.overlaps(region_, around, [&](const Image& image) {
      Obstacle there = obstacle;
      there.pose.position += periods_.shift(image);
      take_image(there, reach);
    });
  }

 private:
  enum class Buried : char { unknown, no, yes };
  // Images of one obstacle that are looked at, each of which may go into hundreds of cells.
  static constexpr double kMostImages = 1e4;

  /// True if every place of the box lies in the obstacle, by `depth` at least: nothing is free there. A gap
  /// changes by no more than the way between two places.
  static bool buries(const Obstacle& obstacle, const Box& box, double depth) {
    const Vec2 center = Frame(obstacle.pose).to_local(box.center());
    return gap_by_brute_force(*obstacle.outline, center) <= -(0.5 * box.extent().norm() + depth);
  }

  /// Asked once a cell: a pile that has to rise out of something large asks for hundreds of thousands of
  /// places within it. Of copies that are discs alone, which are not free wherever their centres are buried.
  bool is_buried(int c, int r) {
    // What is found stays true as more copies are taken: a cell that is buried never becomes free. One
    // that is not may become so, and then its places are only tried for longer.
    Buried& known = buried_[index(c, r)];
    if (known != Buried::unknown) return known == Buried::yes;
    Box cell;
    cell.add(region_.low + cell_ * Vec2(c, r));
    cell.add(region_.low + cell_ * Vec2(c + 1, r + 1));
    const auto covers = [&](const Obstacle& taken) { return buries(taken, cell, 0.0); };
    const auto& near = cells_[index(c, r)];
    const bool yes =
        std::any_of(near.begin(), near.end(), covers) || std::any_of(large_.begin(), large_.end(), covers);
    known = yes ? Buried::yes : Buried::no;
    return yes;
  }

  // About how many images of a box meet the region.
  double images_in(const Box& box) const {
    double count = 1.0;
    for (int axis = 0; axis < 2; ++axis)
      if (periods_.size[axis] > 0.0)
        count *= 1.0 + (region_.extent()[axis] + box.extent()[axis]) / periods_.size[axis];
    return count;
  }

  // Into every cell from which a copy could touch it; into the list for all cells if those are many.
  void take_image(const Obstacle& obstacle, double reach) {
    const Vec2 low = obstacle.pose.position.array() - reach, high = obstacle.pose.position.array() + reach;
    const int c0 = column(low.x()), c1 = column(high.x()), r0 = row(low.y()), r1 = row(high.y());
    // What covers hundreds of cells, as a wall along the region does, is asked once a copy in place of
    // filling all their lists.
    if (static_cast<double>(c1 - c0 + 1) * (r1 - r0 + 1) > 256.0) return large_.push_back(obstacle);
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c) cells_[index(c, r)].push_back(obstacle);
  }

  /// Cell of a coordinate; what lies outside of the grid belongs to the cell at its rim.
  static int place(double along, double cell, int count) {
    return static_cast<int>(std::clamp(std::floor(along / cell), 0.0, static_cast<double>(count - 1)));
  }
  int column(double x) const { return place(x - region_.low.x(), cell_, columns_); }
  int row(double y) const { return place(y - region_.low.y(), cell_, rows_); }
  std::size_t index(int c, int r) const {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
  }

  // Discs first, then the outlines themselves as long as the budget lasts (it keeps intricate shapes from
  // taking minutes; discs alone only cost room).
  bool apart(const Obstacle& taken, const Obstacle& copy) {
    // A container is solid outside its disc, so the discs say nothing of it.
    const double centres = (copy.pose.position - taken.pose.position).norm();
    if (!taken.outline->container && centres > taken.outline->bounding_radius + reach_ + margin_) return true;
    const auto& a = *taken.outline;
    const auto& b = *copy.outline;
    // Distance of the copy's centre from the outline: if it is more than the copy's radius they are
    // apart whatever the copy's shape; of a disc it decides.
    const double gap = gap_by_brute_force(a, Frame(taken.pose).to_local(copy.pose.position));
    budget_ -= static_cast<double>(a.sites.size());
    if (gap > reach_ + margin_) return true;
    // Without a budget the copy's disc alone decides, which errs on the side of keeping apart.
    if (b.is_point() || budget_ < 0.0) return false;
    // What surely_apart() costs at most: samples of each times sites of the other.
    budget_ -= static_cast<double>(a.samples.size() * b.sites.size() + b.samples.size() * a.sites.size());
    return surely_apart(a, taken.pose, b, copy.pose, margin_);
  }

  const Outline* outline_;
  Box region_;
  Periods periods_;
  bool full_ = false;  // nothing more fits
  double reach_, margin_, cell_ = 1.0;
  // Comparisons of a sample and a site that are left, for all copies together.
  double budget_ = 1e8;
  int columns_ = 1, rows_ = 1;
  // By cell, row by row: all from which a copy whose position lies in that cell may be touched.
  std::vector<std::vector<Obstacle>> cells_;
  std::vector<Buried> buried_;  // by cell
  // Asked for every place: containers, and what covers many cells.
  std::vector<Obstacle> large_;
};

/// A place of the region, each equally likely. Draws two numbers, three where angles are random: a
/// scene's places depend on how many.
Pose anywhere(const ScatterAsk& ask, Random& random) {
  Pose pose;
  pose.position.x() = random.uniform(ask.region.low.x(), ask.region.high.x());
  pose.position.y() = random.uniform(ask.region.low.y(), ask.region.high.y());
  pose.angle = ask.angle + (ask.random_angle ? random.uniform(0.0, 2.0 * std::numbers::pi) : 0.0);
  return pose;
}

// The room is a copy: where this fails the lattice begins with the obstacles alone.
// Empty if kPlacesTried places in a row are taken. A greater count draws the same places first.
std::optional<std::vector<Pose>> insert_one_by_one(const ScatterAsk& ask, Room room, Random& random) {
  // Random insertion of discs jams at a coverage of 0.547; below 45 % a free place is found in
  // far fewer tries.
  constexpr int kPlacesTried = 5000;
  std::vector<Pose> out;
  while (static_cast<std::int64_t>(out.size()) < ask.count) {
    int tries = 0;
    Pose pose = anywhere(ask, random);
    while (!room.free(pose) && ++tries < kPlacesTried) pose = anywhere(ask, random);
    if (tries == kPlacesTried) return std::nullopt;
    room.take({ask.outline, pose});
    out.push_back(pose);
  }
  return out;
}

// The free places of a triangular lattice, `spacing` apart.
// Row by row from the lower left corner; every second row is shifted by half a spacing, rows are
// sqrt(3) / 2 of it apart, so each place has six neighbours at the same distance.
std::vector<Pose> lattice(const ScatterAsk& ask, Room& room, double spacing, Random& random) {
  std::vector<Pose> out;
  const Box& box = ask.region;
  const double height = spacing * std::numbers::sqrt3 / 2.0;
  // Where the plane repeats, the last place of a row, and the last row, keep the spacing from the image of the first.
  const auto last = [&](double first, double high, double period) {
    return period > 0.0 ? std::min(high, first + period - spacing) : high;
  };
  const Vec2& period = ask.periods.size;
  const double top = last(box.low.y(), box.high.y(), period.y());
  bool odd = false;
  for (double y = box.low.y(); y <= top; y += height, odd = !odd) {
    const double first = box.low.x() + (odd ? spacing / 2.0 : 0.0),
                 right = last(first, box.high.x(), period.x());
    for (double x = first; x <= right; x += spacing) {
      // Only its angle is used.
      Pose pose = anywhere(ask, random);
      pose.position = {x, y};
      if (room.free(pose)) out.push_back(pose);
    }
  }
  return out;
}

/// Draws `count` of the places without repetition (the first steps of a Fisher-Yates shuffle), and moves
/// each by at most `play`, evenly over a disc. Neighbours are 2 play further apart than copies need, so
/// two that are moved towards each other stay apart: only obstacles have to be asked.
std::vector<Pose> choose_and_shake(Room& room, std::vector<Pose> places, std::size_t count, double play,
                                   Random& random) {
  for (std::size_t k = 0; k < count; ++k) {
    std::swap(places[k], places[k + random.below(places.size() - k)]);
    // The root makes all parts of the disc equally likely: a share u of its area lies within play
    // sqrt(u).
    const double heading = random.uniform(0.0, 2.0 * std::numbers::pi),
                 r = play * std::sqrt(random.uniform());
    Pose shaken = places[k];
    const SineCosine<double> of = sine_cosine(heading);
    shaken.position += r * Vec2{of.cosine, of.sine};
    // Else it stays where it was on the lattice, which is free.
    if (room.free(shaken)) places[k] = shaken;
  }
  places.resize(count);
  return places;
}

}  // namespace

std::optional<std::vector<Pose>> scatter_poses(const ScatterAsk& ask, const std::vector<Obstacle>& obstacles,
                                               Random& random, std::int64_t* room) {
  // Two discs of copies touch at 2 radius; the rest is more than Room's margin of 1e-9 radius a pair.
  const double radius = ask.outline->bounding_radius, tightest = 2.0 * radius * (1.0 + 1e-8);
  *room = 0;
  // Discs may reach over the region's rim by a radius, as it holds positions.
  const Vec2 extent = ask.region.grown(radius).extent();
  const double area = extent.x() * extent.y(), disc = std::numbers::pi * radius * radius;
  const double wanted = static_cast<double>(ask.count) * disc;
  // More discs than the area itself: no way of placing them is tried.
  if (ask.outline->is_point() && wanted > area) {
    // pi / (2 sqrt 3): the hexagonal packing.
    *room = static_cast<std::int64_t>(0.9069 * area / disc);  // the densest packing of discs
    return std::nullopt;
  }
  // Made once: both ways begin with the obstacles alone, each on a copy.
  const Room empty(ask, obstacles);
  if (empty.full()) return std::nullopt;
  // Bounding discs say little of plates and needles: for these insertion is tried however much the
  // discs would fill.
  // Points without a radius fill nothing, be the region a line or a place.
  if (wanted < 0.45 * area || wanted == 0.0 || !ask.outline->is_point())
    if (auto placed = insert_one_by_one(ask, empty, random)) return placed;
  Room shelf = empty;
  // Each place of the lattice has sqrt(3) / 2 spacing^2 for itself: so many places fit. Obstacles take
  // some, then the spacing shrinks by 3 % at a time.
  double spacing =
      std::max(tightest, std::sqrt(2.0 / std::numbers::sqrt3 * area / static_cast<double>(ask.count)));
  // a region that is nearly all taken is not searched to its last corner
  const double most = 4.0 * static_cast<double>(ask.count) + 2e5;
  // `*room` is what the last lattice had: a number for the message, and no promise.
  while ((extent.x() / spacing + 1.0) * (extent.y() / spacing + 1.0) < most) {
    std::vector<Pose> places = lattice(ask, shelf, spacing, random);
    if (places.size() >= static_cast<std::size_t>(ask.count))
      return choose_and_shake(shelf, std::move(places), static_cast<std::size_t>(ask.count),
                              0.5 * (spacing - tightest), random);
    *room = static_cast<std::int64_t>(places.size());
    if (spacing <= tightest) return std::nullopt;
    spacing = std::max(tightest, 0.97 * spacing);
  }
  return std::nullopt;
}

}  // namespace brink
