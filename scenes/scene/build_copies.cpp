/// How many copies an entry has, what they are called, and where they stand. The order of placing is
/// what everything here is about: nobody is placed before what its place depends on.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "brink/core/base/elementary.h"
#include "brink/core/base/random.h"
#include "brink/scenes/scene/build.h"
#include "brink/scenes/scene/rows.h"
#include "brink/scheduler/kernel/site_motion.h"

namespace brink {
namespace {

// One random stream for each entry of the file, so that one scatter does not disturb another.
// Purposes 0 and 1 of entry n are the numbers 2 n + 1 and 2 n + 2, so no two streams have the same. The
// multiplier is 2^64 over the golden ratio, made odd: it spreads small numbers over all bits. Random's
// own seeding mixes them once more.
std::uint64_t stream(std::uint64_t seed, std::size_t ordinal, std::uint64_t purpose) {
  return Random(seed ^ (0x9e3779b97f4a7c15ULL * (2 * ordinal + purpose + 1))).next();
}

/// Has no place before everything else has one.
bool is_random(const ThingTable& table) { return table.scatter.given || table.pile.given; }

/// Everything that has been placed so far, sites first; what has no copies yet is not in the way.
std::vector<Obstacle> obstacles_of(const std::vector<PlannedThing>& sites,
                                   const std::vector<PlannedThing>& bodies) {
  std::vector<Obstacle> out;
  for (const auto* things : {&sites, &bodies})
    for (const PlannedThing& thing : *things)
      for (const BodyState& copy : thing.copies) out.push_back(at_start(thing, copy));
  return out;
}

/// Copies in each row of a stack, pyramid or wall, lowest first; none of them asked for: empty. Their
/// sum is that of copies_of().
std::vector<std::int64_t> lengths_of_rows(const ThingTable& table) {
  if (table.stack.given) return std::vector<std::int64_t>(static_cast<std::size_t>(table.stack.value), 1);
  std::vector<std::int64_t> out;
  for (std::int64_t n = table.pyramid.given ? table.pyramid.value : 0; n > 0; --n) out.push_back(n);
  if (!table.wall.given) return out;
  const auto [columns, rows] = table.wall.value;
  // the top row is a short one: what stands half on the row below is held down by the row above
  for (std::int64_t row = 0; row < rows; ++row)
    out.push_back(rows > 1 && columns > 1 && (rows - row) % 2 == 1 ? columns - 1 : columns);
  return out;
}

// Without the key `grid` the table says one column and one row: a single copy at the position.
// Row by row, as copies are numbered: copy k is in column k mod columns.
std::vector<Pose> grid_poses(const PlannedThing& thing, const Vec2& position) {
  const GridTable& grid = thing.table->grid.value;
  std::vector<Pose> out;
  for (std::int64_t row = 0; row < grid.rows; ++row)
    for (std::int64_t column = 0; column < grid.columns; ++column)
      out.push_back({position + Vec2{static_cast<double>(column) * grid.spacing.x(),
                                     static_cast<double>(row) * grid.spacing.y()},
                     thing.pose.angle});
  return out;
}

// A spacing of 0 is all right along an axis that has one copy alone.
bool in_one_place(const GridTable& grid) {
  return (grid.columns > 1 && grid.spacing.x() == 0.0) || (grid.rows > 1 && grid.spacing.y() == 0.0);
}

}  // namespace

/// By the keys alone, before any copy is made: a million of them is refused without being built.
CopyCount copies_of(const ThingTable& table) {
  if (table.scatter.given) return {table.scatter.value.count, table.scatter.where, true};
  if (table.pile.given) return {table.pile.value.count, table.pile.where, true};
  if (table.grid.given) return {table.grid.value.columns * table.grid.value.rows, table.grid.where, true};
  if (table.stack.given) return {table.stack.value, table.stack.where, true};
  if (table.pyramid.given)
    return {table.pyramid.value * (table.pyramid.value + 1) / 2, table.pyramid.where, true};
  if (!table.wall.given) return {1, table.place, false};
  const auto [columns, rows] = table.wall.value;
  // Odd counts from the top down: rows 1, 3, 5 ... are short, (rows + 1) / 2 of them.
  // Must agree with lengths_of_rows(): names are counted by this, places by that.
  const std::int64_t shorter = rows > 1 && columns > 1 ? (rows + 1) / 2 : 0;
  return {columns * rows - shorter, table.wall.where, true};
}

// The last bracket: a name may itself hold some, as "a[0][3]", copy 3 of "a[0]".
std::pair<std::string, std::optional<std::size_t>> copy_named(const std::string& name) {
  const std::size_t bracket = name.rfind('[');
  if (bracket == std::string::npos || name.back() != ']') return {name, std::nullopt};
  const std::string digits = name.substr(bracket + 1, name.size() - bracket - 2);
  // Seven digits hold kMostCopies, and stoul cannot overflow.
  if (digits.empty() || digits.size() > 7 || digits.find_first_not_of("0123456789") != std::string::npos)
    return {name, std::nullopt};
  return {name.substr(0, bracket), std::stoul(digits)};
}

std::optional<Vec2> down_of(const ThingTable& table, const Vec2& gravity) {
  const Vec2 down = table.touching_direction.given ? table.touching_direction.value : gravity;
  if (down.isZero(0.0)) return std::nullopt;
  // Scaled before its length is taken: squares of 1e-200 m/s^2 would be 0, and gravity would
  // have no direction.
  return Vec2((down / down.lpNorm<Eigen::Infinity>()).normalized());
}

/// The pose is the entry's own, the twist that of all copies. A site's table has no velocities, so its
/// twist is zero.
BodyState start_of(const PlannedThing& thing) {
  const ThingTable& table = *thing.table;
  return {thing.pose, {table.velocity.value, table.angular_velocity.value}};
}

Obstacle at_start(const PlannedThing& thing, const BodyState& copy) {
  // Bodies have no motion, and are where they are written at the start.
  FixedSite site;
  site.pose = copy.pose;
  site.motion = thing.motion;
  return {thing.shape.outline.get(), told_pose(site, 0.0)};
}

// Rows are found once, here; the function that is returned only shifts them.
Copies standing_poses(const PlannedThing& thing, const PlaceRules& rules) {
  const ThingTable& table = *thing.table;
  if (!table.stack.given && !table.pyramid.given && !table.wall.given)
    return [&thing](const Vec2& position, std::size_t most) {
      std::vector<Pose> poses = grid_poses(thing, position);
      if (poses.size() > most) poses.resize(most);
      return poses;
    };
  // Rows need an up; where nothing says which it is, +y.
  const Vec2 down = down_of(table, rules.gravity).value_or(-Vec2::UnitY());
  const TouchingRows rows(
      {thing.shape.outline.get(), thing.pose.angle, -down, lengths_of_rows(table), rules.thin});
  return [rows](const Vec2& middle, std::size_t most) { return rows.at(middle, most); };
}

void Placer::place(std::vector<PlannedThing>& sites, std::vector<PlannedThing>& bodies) {
  for (auto* things : {&sites, &bodies}) {
    // A scene may have a million of each. counted() comes first below: it also adds up what is placed later.
    total_ = 0;
    for (PlannedThing& thing : *things)
      if (counted(thing) && !is_random(*thing.table) && !thing.table->touching.given) stand(thing);
  }
  // Random copies must keep clear of all that stands or lies, so they come last, each after those before it.
  if (!faults_.empty()) return;
  put_on_others(sites, bodies, rules_, faults_);
  for (auto* things : {&sites, &bodies})
    for (PlannedThing& thing : *things) {
      if (thing.table->scatter.given) scatter(thing, obstacles_of(sites, bodies));
      if (thing.table->pile.given) pile(thing, obstacles_of(sites, bodies));
    }
}

/// Adds the copies of an entry to those so far; false and a fault beyond kMostCopies.
bool Placer::counted(const PlannedThing& thing) {
  const CopyCount copies = copies_of(*thing.table);
  if ((total_ += copies.count) <= kMostCopies) return true;
  faults_.add(copies.where, "too many copies; given " + std::to_string(total_) +
                                " so far, allowed: " + std::to_string(kMostCopies));
  return false;
}

/// Copies at the entry's own position, whatever is there: an overlap is told by who asks for overlaps,
/// not here.
void Placer::stand(PlannedThing& thing) {
  const GridTable& grid = thing.table->grid.value;
  if (in_one_place(grid))
    return faults_.add(thing.table->grid.where,
                       "grid: copies would stand in one place; given spacing [" +
                           number_text(grid.spacing.x()) + ", " + number_text(grid.spacing.y()) +
                           "], allowed: not 0 along x for several columns, along y for several rows");
  for (const Pose& pose : standing_poses(thing, rules_)(thing.pose.position, kAllCopies)) {
    thing.copies.push_back(start_of(thing));
    thing.copies.back().pose = pose;
  }
}

/// Copies in the box that the table gives; its two corners may be any two that are opposite.
void Placer::scatter(PlannedThing& thing, const std::vector<Obstacle>& obstacles) {
  const ScatterTable& asked = thing.table->scatter.value;
  ScatterAsk ask{
      thing.shape.outline.get(), {}, asked.count, thing.pose.angle, asked.random_angle, rules_.periods};
  for (const Vec2& corner : asked.region) ask.region.add(corner);
  // Speeds have a stream of their own: how many numbers places take depends on what is in the way.
  Random where_to(stream(seed_, thing.ordinal, 0)), how(stream(seed_, thing.ordinal, 1));
  std::int64_t room = 0;
  const auto poses = scatter_poses(ask, obstacles, where_to, &room);
  if (!poses)
    return faults_.add(thing.table->scatter.where,
                       "scatter: the region is too small; given " + std::to_string(asked.count) +
                           " copies of bounding radius " + number_text(ask.outline->bounding_radius) +
                           " m, allowed: about " + std::to_string(room) + " beside what is there already");
  for (const Pose& pose : *poses) {
    BodyState state = start_of(thing);
    // Drawn even where speeds are 0, so that a speed given later leaves the directions of all
    // copies as they are.
    const double heading = how.uniform(0.0, 2.0 * std::numbers::pi);
    const double way = how.below(2) == 0 ? 1.0 : -1.0;
    state.pose = pose;
    // In the world's axes, on top of the velocity that all copies have.
    const SineCosine<double> of = sine_cosine(heading);
    state.twist.velocity += asked.speed * Vec2{of.cosine, of.sine};
    state.twist.omega += asked.angular_speed * way;
    thing.copies.push_back(state);
  }
}

// A scatter in a column above the position that is as high as it takes, seen with down along -y.
void Placer::pile(PlannedThing& thing, const std::vector<Obstacle>& obstacles) {
  // Filled less than the 45 % up to which scatter_poses() inserts at random; the last height is 1.25^39,
  // some 6000 times the first, which leaves whatever else reaches into the column behind.
  constexpr double kFilled = 0.4;  // of the column, by the discs about the copies
  constexpr int kHeights = 40;     // that are tried
  const PileTable& asked = thing.table->pile.value;
  const Vec2 up = -down_of(*thing.table, rules_.gravity).value_or(-Vec2::UnitY());
  // Turned so that the frame's y axis points up: (-sin, cos) of its angle is `up`.
  const Frame frame({thing.pose.position, angle_of(-up.x(), up.y())});
  const double turn = angle_of(frame.sine, frame.cosine), radius = thing.shape.outline->bounding_radius;
  if (turn != 0.0 && rules_.periods.any())
    return faults_.add(thing.table->pile.where, "pile: the plane repeats; given a way down of [" +
                                                    number_text(-up.x()) + ", " + number_text(-up.y()) +
                                                    "], allowed there: [0, -1]");
  // Upright, the frame is the world's: no turning to and fro, and no roundings by it.
  const bool upright = turn == 0.0;
  // Obstacles in the pile's frame, where they are turned back by as much as copies are.
  std::vector<Obstacle> seen = obstacles;
  if (!upright)
    for (Obstacle& o : seen) o.pose = {frame.to_local(o.pose.position), o.pose.angle - turn};
  const Vec2 base = upright ? thing.pose.position : Vec2(Vec2::Zero());
  // In the turned frame, as everything that scatter_poses() is given.
  ScatterAsk ask{thing.shape.outline.get(),
                 {},
                 asked.count,
                 thing.pose.angle - turn,
                 asked.random_angle,
                 rules_.periods};
  // The height at which the discs fill kFilled of a column that is a radius wider to each side.
  double height = std::numbers::pi * radius * radius * static_cast<double>(asked.count) /
                  (kFilled * (asked.width + 2.0 * radius));
  for (int k = 0; k < kHeights; ++k, height = 1.25 * height + radius) {
    // Centres are a radius above the position at least, so that no copy reaches below it.
    ask.region = Box();
    ask.region.add(base + Vec2(-0.5 * asked.width, radius));
    ask.region.add(base + Vec2(0.5 * asked.width, radius + height));
    // The stream begins anew for each height: the poses depend on the height that sufficed, not
    // on those before.
    Random random(stream(seed_, thing.ordinal, 0));
    std::int64_t room = 0;
    const auto poses = scatter_poses(ask, seen, random, &room);
    // Too low, or something stands in the way: 1.25 times as high, and a radius more.
    if (!poses) continue;
    for (const Pose& pose : *poses) {
      thing.copies.push_back(start_of(thing));
      thing.copies.back().pose = upright ? pose : Pose{frame.to_world(pose.position), pose.angle + turn};
    }
    return;
  }
  faults_.add(thing.table->pile.where, "pile: there is no room above; given " + std::to_string(asked.count) +
                                           " copies of bounding radius " + number_text(radius) +
                                           " m, allowed: a column that is free, or becomes so higher up");
}

}  // namespace brink
