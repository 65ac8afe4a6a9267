#include "brink/scenes/scene_scatter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace brink {
namespace {

// What is taken already, in cells of a uniform grid over the region.
class Room {
 public:
  Room(double radius, const Box& region, std::int64_t count, const std::vector<Obstacle>& obstacles)
      : radius_(radius),
        apart_(2.0 * radius * (1.0 + 1e-9)),
        centres_(region.grown(-radius)),
        low_(region.low) {
    const Vec2 extent = region.extent();
    const double cells = std::clamp(4.0 * static_cast<double>(count), 16.0, 1e6);
    cell_ = std::max({apart_, std::sqrt(extent.x() * extent.y() / cells), extent.maxCoeff() / 1e6});
    columns_ = static_cast<int>(extent.x() / cell_) + 1;
    rows_ = static_cast<int>(extent.y() / cell_) + 1;
    places_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    small_.resize(places_.size());
    for (const Obstacle& obstacle : obstacles) add(obstacle);
  }

  const Box& centres() const { return centres_; }

  bool free(const Vec2& p) const {
    if (!centres_.contains(p)) return false;
    for (const Obstacle& obstacle : large_)
      if (touches(obstacle, p)) return false;
    for (const Obstacle& obstacle : small_[index(column(p.x()), row(p.y()))])
      if (touches(obstacle, p)) return false;
    for (int r = std::max(0, row(p.y()) - 1); r <= std::min(rows_ - 1, row(p.y()) + 1); ++r)
      for (int c = std::max(0, column(p.x()) - 1); c <= std::min(columns_ - 1, column(p.x()) + 1); ++c)
        for (const Vec2& other : places_[index(c, r)])
          if ((other - p).squaredNorm() < apart_ * apart_) return false;
    return true;
  }

  void take(const Vec2& p) { places_[index(column(p.x()), row(p.y()))].push_back(p); }
  void clear() {
    for (auto& cell : places_) cell.clear();
  }

 private:
  int column(double x) const { return std::clamp(static_cast<int>((x - low_.x()) / cell_), 0, columns_ - 1); }
  int row(double y) const { return std::clamp(static_cast<int>((y - low_.y()) / cell_), 0, rows_ - 1); }
  std::size_t index(int c, int r) const {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c);
  }

  // Into every cell from which a centre could touch it; into the list for all cells if those are many.
  void add(const Obstacle& obstacle) {
    const double reach = obstacle.outline->bounding_radius + radius_ * (1.0 + 1e-6);
    const Vec2 low = obstacle.pose.position.array() - reach, high = obstacle.pose.position.array() + reach;
    if (obstacle.outline->container) return large_.push_back(obstacle);
    if (!Box{low, high}.overlaps(centres_)) return;
    const Vec2 near = low.cwiseMax(centres_.low), far = high.cwiseMin(centres_.high);
    const int c0 = column(near.x()), c1 = column(far.x()), r0 = row(near.y()), r1 = row(far.y());
    if (static_cast<double>(c1 - c0 + 1) * (r1 - r0 + 1) > 256.0) return large_.push_back(obstacle);
    for (int r = r0; r <= r1; ++r)
      for (int c = c0; c <= c1; ++c) small_[index(c, r)].push_back(obstacle);
  }

  bool touches(const Obstacle& obstacle, const Vec2& p) const {
    const double reach = obstacle.outline->bounding_radius + radius_ * (1.0 + 1e-9);
    if (!obstacle.outline->container && (p - obstacle.pose.position).norm() > reach) return false;
    return !(gap_by_brute_force(*obstacle.outline, Frame(obstacle.pose).to_local(p)) >
             radius_ * (1.0 + 1e-9));
  }

  double radius_, apart_;
  Box centres_;
  Vec2 low_;
  double cell_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::vector<std::vector<Vec2>> places_;
  std::vector<std::vector<Obstacle>> small_;
  std::vector<Obstacle> large_;
};

Vec2 anywhere(const Box& box, Random& random) {
  const double x = random.uniform(box.low.x(), box.high.x());
  return {x, random.uniform(box.low.y(), box.high.y())};
}

std::optional<std::vector<Vec2>> insert_one_by_one(Room& room, std::int64_t count, Random& random) {
  constexpr int kTries = 5000;
  std::vector<Vec2> out;
  while (static_cast<std::int64_t>(out.size()) < count) {
    int tries = 0;
    Vec2 p = anywhere(room.centres(), random);
    while (!room.free(p) && ++tries < kTries) p = anywhere(room.centres(), random);
    if (tries == kTries) return std::nullopt;
    room.take(p);
    out.push_back(p);
  }
  return out;
}

std::vector<Vec2> lattice(const Room& room, double spacing) {
  std::vector<Vec2> out;
  const Box& box = room.centres();
  const double height = spacing * std::numbers::sqrt3 / 2.0;
  bool odd = false;
  for (double y = box.low.y(); y <= box.high.y(); y += height, odd = !odd)
    for (double x = box.low.x() + (odd ? spacing / 2.0 : 0.0); x <= box.high.x(); x += spacing)
      if (room.free({x, y})) out.emplace_back(x, y);
  return out;
}

std::vector<Vec2> choose_and_shake(Room& room, std::vector<Vec2> places, std::size_t count, double play,
                                   Random& random) {
  for (std::size_t k = 0; k < count; ++k) {
    std::swap(places[k], places[k + random.below(places.size() - k)]);
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double r = play * std::sqrt(random.uniform());
    const Vec2 shaken = places[k] + Vec2{r * std::cos(angle), r * std::sin(angle)};
    if (room.free(shaken)) places[k] = shaken;
  }
  places.resize(count);
  return places;
}

}  // namespace

std::optional<std::vector<Vec2>> scatter_places(double radius, const Box& region, std::int64_t count,
                                                const std::vector<Obstacle>& obstacles, Random& random,
                                                std::int64_t* room_for) {
  *room_for = 0;
  if (region.grown(-radius).empty()) return std::nullopt;
  const Vec2 extent = region.extent();
  const double area = extent.x() * extent.y(),
               wanted = static_cast<double>(count) * std::numbers::pi * radius * radius;
  const double tightest = 2.0 * radius * (1.0 + 1e-8);
  if (wanted > area) {
    *room_for = static_cast<std::int64_t>(0.9069 * area / (std::numbers::pi * radius * radius));
    return std::nullopt;
  }
  Room room(radius, region, count, obstacles);
  if (wanted < 0.45 * area)
    if (auto placed = insert_one_by_one(room, count, random)) return placed;
  room.clear();
  double spacing =
      std::max(tightest, std::sqrt(2.0 / std::numbers::sqrt3 * area / static_cast<double>(count)));
  while (true) {
    std::vector<Vec2> places = lattice(room, spacing);
    if (places.size() >= static_cast<std::size_t>(count))
      return choose_and_shake(room, std::move(places), static_cast<std::size_t>(count),
                              (spacing - tightest) / 2.0, random);
    *room_for = static_cast<std::int64_t>(places.size());
    if (spacing <= tightest) return std::nullopt;
    spacing = std::max(tightest, 0.97 * spacing);
  }
}

}  // namespace brink
