// Heaps of smooth outlines of arcs and of stars and triangles in a drum or a tray that turns: sharp tips slide over the smooth joints of
// arcs that bend more or less, also within a step of first order. Nobody is in anybody, seen from outside at every frame; the same bits
// under every policy, each stopped. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for scenes that
// fail.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/seeded_worlds.h"

namespace brink::tips_over_humps_test {
namespace {

std::string star(Random& random) {
  const int tips = 4 + static_cast<int>(random.below(4));
  const double notch = random.uniform(0.4, 0.7);
  std::string vertices;
  for (int k = 0; k < 2 * tips; ++k) {
    const double angle = std::numbers::pi * k / tips, r = k % 2 ? 0.3 * notch : 0.3;
    vertices += fmt::format("[{:.9f}, {:.9f}],", r * std::cos(angle), r * std::sin(angle));
  }
  return fmt::format("polygon = {{ vertices = [{}] }}", vertices);
}

/// Cubics through points around, with the same tangents at each (Catmull-Rom).
std::string blob(Random& random) {
  const int count = 5 + static_cast<int>(random.below(4));
  std::vector<Vec2> p;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    p.emplace_back(0.3 * random.uniform(0.75, 1.15) * Vec2(std::cos(angle), std::sin(angle)));
  }
  const auto at = [&](int k) { return p[(k + count) % count]; };
  std::string d = fmt::format("M {:.9f} {:.9f}", p[0].x(), p[0].y());
  for (int k = 0; k < count; ++k) {
    const Vec2 from = at(k) + (at(k + 1) - at(k - 1)) / 6.0, to = at(k + 1) - (at(k + 2) - at(k)) / 6.0;
    d += fmt::format(" C {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}", from.x(), from.y(), to.x(), to.y(),
                     at(k + 1).x(), at(k + 1).y());
  }
  return fmt::format("path = {{ d = '{} Z' }}", d);
}

std::string heap(std::uint64_t seed) {
  Random random(seed);
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  std::string text = fmt::format(
      "[world]\nduration = 1.5\ngravity = [0, -9.81]\n[solver]\nmodes_contacts = "
      "{}\n[materials.default]\nrestitution = {}\n"
      "friction = {}\n[[sites]]\n{}\ninside_of = true\n",
      random.below(2) ? 0 : 16, pick({0.0, 0.0, 0.3}), pick({0.0, 0.0, 0.2, 0.9}),
      random.below(2) ? "disc = { radius = 1.6 }\nmotion = { angular_velocity = -2 }"
                      : "box = { width = 3, height = 3 }\nmotion = { angle = '0.3*sin(1.5*t)' }");
  const int bodies = 6 + static_cast<int>(random.below(3));
  for (int k = 0; k < bodies; ++k) {
    std::string shape;
    switch (random.below(4)) {
      case 0:
        shape = star(random);
        break;
      case 1:
        shape = "polygon = { vertices = [[-0.25, -0.2], [0.3, -0.1], [0, 0.3]] }";
        break;
      case 2:
        shape = fmt::format("path = {{ d = 'M -1 0 A 1 {0} 0 1 0 1 0 A 1 {0} 0 1 0 -1 0 Z', scale = 0.3 }}",
                            random.uniform(0.3, 0.9));
        break;
      default:
        shape = fmt::format("{}\ncurve_tolerance = {}", blob(random), pick({1e-2, 3e-3, 1e-3}));
    }
    text += fmt::format(
        "[[bodies]]\n{}\ndensity = {}\nposition = [{:.17g}, {:.17g}]\nangle = {:.17g}\n"
        "angular_velocity = {:.17g}\nvelocity = [{:.17g}, {:.17g}]\n",
        shape, pick({0.1, 1.0, 10.0}), 0.75 * (k % 3 - 1), 0.75 * (k / 3 - 1), random.uniform(-3.0, 3.0),
        random.uniform(-4.0, 4.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 0.0));
  }
  return text;
}

TEST(TipsOverHumps, NobodyIsInAnybody) {
  testing::for_each_world(40, heap, [](std::uint64_t seed) {
    const Scene scene = parse_scene(heap(seed), "heap");
    outside::FrameWatch watch(scene.world, scene.duration, 1e-9);
    RunOptions options = testing::until(scene.duration);
    options.frame_interval = 0.02;
    const RunSummary summary = Simulator(scene.world, scene.solver).run(options, &watch);
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    EXPECT_TRUE(watch.sound()) << watch.report();
    if (seed % 8 == 0) testing::expect_same_bits(heap(seed), seed);
  });
}

}  // namespace
}  // namespace brink::tips_over_humps_test
