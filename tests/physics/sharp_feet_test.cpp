// Bodies with sharp feet (wedges, tables on pointed legs, stars on two of their tips) that slide on one floor until they meet, tip
// to tip, at one height but for roundings: neither tip is then in the other body, and yet the two would be in each other. Seen
// from outside at every frame, and once more under another policy, stopped on the way. BRINK_SEED moves the seeds, BRINK_WORLDS
// their number.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/seeded_worlds.h"

namespace brink::sharp_feet_test {
namespace {

constexpr double kEnd = 1.5, kFloorEnd = 30.0;

/// Corners of a body that stands on y = 0, beside x = 0 to the right.
std::vector<Vec2> corners_of(Random& random) {
  const double w = random.uniform(0.4, 1.0), h = random.uniform(0.2, 0.8);
  switch (random.below(4)) {
    case 0:
      return {{0, 0}, {w, 0}, {random.uniform(0.1, 0.9) * w, h}};
    case 1:
      return {{0, 0}, {0.5 * w, random.uniform(0.2, 0.7) * h}, {w, 0}, {random.uniform(0.45, 0.55) * w, h}};
    case 2:
      return {{0, 0}, {w, 0}, {w, h}, {0, h}};
    default: {
      // on two neighbouring tips, turned so that they are level
      const int tips = 3 + static_cast<int>(random.below(5));
      const double part = std::numbers::pi / tips,
                   inner = random.uniform(0.3, 0.7) * std::cos(part) * 0.5 * w;
      std::vector<Vec2> star;
      for (int k = 0; k < 2 * tips; ++k) {
        const double radius = k % 2 == 0 ? 0.5 * w : inner, angle = -0.5 * std::numbers::pi - part + part * k;
        star.push_back(
            {0.5 * w + radius * std::cos(angle), 0.5 * w * std::cos(part) + radius * std::sin(angle)});
      }
      return star;
    }
  }
}

void add_floor(World& world, Random& random, const Frame& frame, double turn) {
  const auto at = [&](double y) { return frame.to_world({0.0, y}); };
  switch (random.below(4)) {
    case 0:
      testing::add(world, testing::site(make_segment({-kFloorEnd, 0}, {kFloorEnd, 0}), at(0.0), turn));
      return;
    case 1:
      testing::add(world, testing::site(make_box(2.0 * kFloorEnd, 1.0), at(-0.5), turn));
      return;
    case 2:
      testing::add(world,
                   testing::site(make_segment({-kFloorEnd, 0}, {kFloorEnd, 0}, 0.125), at(-0.125), turn));
      return;
    default:
      for (int k = 0; k < 12; ++k)
        testing::add(world, testing::site(make_box(5.0, 1.0),
                                          frame.to_world({-kFloorEnd + 5.0 * k + 2.5, -0.5}), turn));
      return;
  }
}

World make(Random& random) {
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  const double turn = random.below(3) != 0 ? 0.0 : random.uniform(-10.0, 10.0),
               far = pick({0.0, 0.0, 1.0, 1e3});
  const Frame frame(Pose{far * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)), turn});
  World w;
  w.gravity = frame.direction_to_world({pick({0.0, 0.0, 1.0}), -9.81});
  w.materials[0].restitution = pick({0.0, 0.0, 0.25, 0.5, 0.9});
  w.materials[0].friction = pick({0.0, 0.0, 0.1, 0.3});
  add_floor(w, random, frame, turn);
  const int bodies = 2 + static_cast<int>(random.below(2));
  double x = -2.0;
  for (int k = 0; k < bodies; ++k) {
    const Shape shape = make_polygon(corners_of(random));
    const double width = shape.outline.bounds.high.x() - shape.outline.bounds.low.x(),
                 up = random.below(2) == 0 ? 0.0 : random.uniform(0.001, 0.05);
    // towards each other; of three the middle one either way
    const double way = k == 0 ? 1.0 : k == bodies - 1 ? -1.0 : pick({-0.5, 0.0, 0.5});
    const Vec2 at = shape.measure.centroid - Vec2(shape.outline.bounds.low.x() - x, -up);
    testing::add(w, testing::body(shape, frame.to_world(at),
                                  frame.direction_to_world({way * random.uniform(0.5, 3.0), 0.0}),
                                  pick({1.0, 1.0, 2.0, 10.0}), turn));
    x += width + random.uniform(0.1, 0.6);
  }
  return w;
}

/// "" where it is sound, else what is wrong.
std::string fault_of(std::uint64_t seed) {
  Random random(seed);
  const World world = make(random);
  SolverOptions solver;
  solver.max_collisions = 20000;
  Simulator simulator(world, solver);
  if (!simulator.start_fault().empty()) return simulator.start_fault();
  outside::FrameWatch watch(world, kEnd, 1e-9);
  RunOptions options = testing::until(kEnd);
  options.frame_interval = 1.0 / 128.0;
  const RunSummary summary = simulator.run(options, &watch);
  if (summary.termination == Termination::failed) return summary.why;
  if (!watch.sound()) return watch.report();
  if (watch.gained > 1e-9L)
    return fmt::format("energy grew by {:.3g} of what there was", static_cast<double>(watch.gained));
  return testing::stopped_under_another_policy(world, solver, options, 4, seed, summary);
}

TEST(SharpFeet, MeetTipToTipOnAFloor) {
  const std::uint64_t first = testing::from_environment("BRINK_SEED", 1),
                      worlds = testing::from_environment("BRINK_WORLDS", 200);
  for (std::uint64_t seed = first; seed < first + worlds; ++seed)
    EXPECT_EQ(fault_of(seed), "") << "seed " << seed;
}

}  // namespace
}  // namespace brink::sharp_feet_test
