#include <cmath>
#include <numbers>

#include "brink/core/base/random.h"
#include "brink/scenes/scene/build.h"
#include "brink/scenes/scene/scatter.h"

namespace brink {
namespace {

// One random stream for each entry of the file, so that one scatter does not disturb another.
std::uint64_t stream(std::uint64_t seed, std::size_t ordinal, std::uint64_t purpose) {
  return Random(seed ^ (0x9e3779b97f4a7c15ULL * (2 * ordinal + purpose + 1))).next();
}

BodyState start_of(const PlannedThing& thing) {
  const ThingTable& table = *thing.table;
  return {thing.pose, {table.velocity.value, table.angular_velocity.value}};
}

std::vector<Obstacle> obstacles_of(const std::vector<PlannedThing>& things) {
  std::vector<Obstacle> out;
  for (const PlannedThing& thing : things)
    for (const BodyState& copy : thing.copies) out.push_back({thing.shape.outline.get(), copy.pose});
  return out;
}

}  // namespace

void Placer::place(std::vector<PlannedThing>& sites, std::vector<PlannedThing>& bodies) {
  for (auto* things : {&sites, &bodies})
    for (PlannedThing& thing : *things)
      if (!thing.table->scatter.given) stand(thing);
  for (auto* things : {&sites, &bodies})
    for (PlannedThing& thing : *things)
      if (thing.table->scatter.given) scatter(thing, sites, bodies);
}

void Placer::stand(PlannedThing& thing) {
  const GridTable grid = thing.table->grid.value;
  const auto copies = static_cast<std::size_t>(grid.columns * grid.rows);
  total_ += copies;
  if (total_ > static_cast<std::size_t>(kMostCopies))
    return faults_.add(thing.table->grid.given ? thing.table->grid.where : thing.table->place,
                       "too many copies; given " + std::to_string(total_) +
                           " so far, allowed: " + std::to_string(kMostCopies));
  if ((grid.columns > 1 && grid.spacing.x() == 0.0) || (grid.rows > 1 && grid.spacing.y() == 0.0))
    return faults_.add(thing.table->grid.where,
                       "grid: copies would stand in one place; given spacing [" +
                           number_text(grid.spacing.x()) + ", " + number_text(grid.spacing.y()) +
                           "], allowed: not 0 along x for several columns, along y for several rows");
  for (std::int64_t row = 0; row < grid.rows; ++row)
    for (std::int64_t column = 0; column < grid.columns; ++column) {
      BodyState state = start_of(thing);
      state.pose.position +=
          Vec2{static_cast<double>(column) * grid.spacing.x(), static_cast<double>(row) * grid.spacing.y()};
      thing.copies.push_back(state);
    }
}

void Placer::scatter(PlannedThing& thing, const std::vector<PlannedThing>& sites,
                     const std::vector<PlannedThing>& bodies) {
  const ScatterTable& asked = thing.table->scatter.value;
  const Where& where = thing.table->scatter.where;
  total_ += static_cast<std::size_t>(asked.count);
  if (total_ > static_cast<std::size_t>(kMostCopies))
    return faults_.add(where, "too many copies; given " + std::to_string(total_) +
                                  " so far, allowed: " + std::to_string(kMostCopies));
  std::vector<Obstacle> obstacles = obstacles_of(sites);
  for (const Obstacle& obstacle : obstacles_of(bodies)) obstacles.push_back(obstacle);
  ScatterAsk ask{thing.shape.outline.get(), {}, asked.count, thing.pose.angle, asked.random_angle, periods_};
  for (const Vec2& corner : asked.region) ask.region.add(corner);
  Random where_to(stream(seed_, thing.ordinal, 0)), how(stream(seed_, thing.ordinal, 1));
  std::int64_t room = 0;
  const auto poses = scatter_poses(ask, obstacles, where_to, &room);
  if (!poses)
    return faults_.add(where, "scatter: the region is too small; given " + std::to_string(asked.count) +
                                  " copies of bounding radius " + number_text(ask.outline->bounding_radius) +
                                  " m, allowed: about " + std::to_string(room) +
                                  " beside what is there already");
  for (const Pose& pose : *poses) {
    BodyState state = start_of(thing);
    const double heading = how.uniform(0.0, 2.0 * std::numbers::pi);
    const double way = how.below(2) == 0 ? 1.0 : -1.0;
    state.pose = pose;
    state.twist.velocity += asked.speed * Vec2{std::cos(heading), std::sin(heading)};
    state.twist.omega += asked.angular_speed * way;
    thing.copies.push_back(state);
  }
}

}  // namespace brink
