// What statics says stands and what it says falls, close to the border between the two: built, then left alone for 100 s.
// Prints the table of docs/stability.md: creep, and the processor time from the first moment to the last.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <sstream>

#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink::standing_stress {
namespace {

struct Built {
  std::string name, why;  ///< why statics says so
  bool stands;
  Scene scene;
};

std::string header(double friction, const std::string& gravity) {
  std::ostringstream text;
  text.precision(17);
  text << "[world]\ngravity = " << gravity
       << "\n[materials.default]\nrestitution = 0\nfriction = " << friction
       << "\n[[sites]]\nname = \"floor\"\nbox = { width = 200, height = 1 }\nposition = [0, -0.5]\n";
  return text.str();
}

Scene on_floor(const std::string& bodies, double friction = 0.5, const std::string& gravity = "[0, -9.81]") {
  return parse_scene(header(friction, gravity) + bodies, "built");
}

/// Boxes of 0.4 x 0.2 m on the floor, arranged as `how` says.
Scene boxes(const std::string& how) {
  return on_floor(
      "[[bodies]]\nbox = { width = 0.4, height = 0.2 }\nposition = [0, 1]\ntouching = \"floor\"\n" + how);
}

/// Ten blocks of width 1, each farther out than the one below by `step`: the upper nine have their centre five steps
/// out, over the lowest block's edge at a step of 0.1.
Scene leaning(double step) {
  std::ostringstream text;
  text.precision(17);
  text << "[[bodies]]\nbox = { width = 1, height = 0.25 }\nposition = [0, 0.125]\nstack = 10\ntouching = "
          "\"floor\"\n"
       << "touching_direction = [" << -step << ", -0.25]\n";
  return on_floor(text.str());
}

/// Ten blocks, of which that number has a million times the density of the others.
Scene heavy(int which) {
  std::string text;
  for (int k = 0; k < 10; ++k)
    text += "[[bodies]]\nname = \"b" + std::to_string(k) +
            "\"\nbox = { width = 0.4, height = 0.2 }\nposition = [0, " + std::to_string(1 + k) +
            "]\ntouching = \"" + (k == 0 ? "floor" : "b" + std::to_string(k - 1)) +
            "\"\ndensity = " + (k == which ? "1e6" : "1") + "\n";
  return on_floor(text);
}

/// A block on a slope whose angle has the tangent 0.5, of the same friction times 1 + `more`: gravity leans, not the floor.
Scene on_slope(double more) {
  const double s = 0.5 / std::sqrt(1.25), c = 1.0 / std::sqrt(1.25);
  std::ostringstream gravity;
  gravity.precision(17);
  gravity << "[" << 9.81 * s << ", " << -9.81 * c << "]";
  return on_floor(
      "[[bodies]]\nbox = { width = 1, height = 0.2 }\nposition = [0, 1]\ntouching = \"floor\"\n"
      "touching_direction = [0, -1]\n",
      0.5 * (1.0 + more), gravity.str());
}

/// A half circle of eleven stones cut along radii, of that thickness over its mean radius, 2; joints open by 1e-12 m.
/// The least that stands is 0.107 (Milankovitch 1907).
Scene arch(double thickness, double friction) {
  constexpr int kStones = 11;
  constexpr double kOpen = 1e-12;
  const double in = 2.0 - thickness, out = 2.0 + thickness;  // half of it on either side
  std::ostringstream text;
  text.precision(17);
  double x = 0.0, y = kOpen;
  for (int k = 0; k < kStones; ++k) {
    const double a = M_PI * k / kStones, b = M_PI * (k + 1) / kStones;
    text << "[[bodies]]\npolygon = { vertices = [[" << in * std::cos(a) << ", " << in * std::sin(a) << "], ["
         << out * std::cos(a) << ", " << out * std::sin(a) << "], [" << out * std::cos(b) << ", "
         << out * std::sin(b) << "], [" << in * std::cos(b) << ", " << in * std::sin(b)
         << "]] }\ncentered = false\nposition = [" << x << ", " << y << "]\n";
    x -= kOpen * std::sin(b), y += kOpen * std::cos(b);
  }
  return on_floor(text.str(), friction);
}

/// Of the gallery, without the pellet that ends it.
Scene card_house() {
  Scene scene = load_scene(std::filesystem::path(BRINK_SOURCE_DIR) / "scenes/gallery/house_of_cards.toml");
  scene.world.bodies.pop_back();
  return scene;
}

std::vector<Built> all() {
  const std::string joints = "its line of thrust lies in the stones",
                    friction = "friction carries the spread";
  return {
      {"stack of 10", "", true, boxes("stack = 10\n")},
      {"stack of 50", "", true, boxes("stack = 50\n")},
      {"stack of 200", "", true, boxes("stack = 200\n")},
      {"pyramid, 20 in the lowest row", "", true, boxes("pyramid = 20\n")},
      {"pyramid, 40 in the lowest row", "", true, boxes("pyramid = 40\n")},
      {"wall of 20 rows of 10", "", true, boxes("wall = [10, 20]\n")},
      {"stack of 10, the top one 1e6 times as heavy", "", true, heavy(9)},
      {"stack of 10, the lowest 1e6 times as heavy", "", true, heavy(0)},
      {"house of 15 cards, friction 0.6", friction, true, card_house()},
      {"half circle of 11 stones, thickness 0.22 of its radius", "more than 0.107", true, arch(0.22, 0.7)},
      {"the same, 0.115", "more than 0.107", true, arch(0.115, 0.7)},
      {"the same, 0.100", "less than 0.107", false, arch(0.10, 0.7)},
      {"the same, 0.084", "less than 0.107", false, arch(0.084, 0.7)},
      {"the same, 0.22, friction 0.1", "slides at its joints", false, arch(0.22, 0.1)},
      {"leaning stack, 0.999 of the critical lean", "centre over the edge", true, leaning(0.0999)},
      {"leaning stack, 1.001 of it", "centre beyond the edge", false, leaning(0.1001)},
      {"block on a slope, friction 1 + 1e-7 of its tangent", "", true, on_slope(1e-7)},
      {"block on a slope, friction 1 - 1e-3 of its tangent", "", false, on_slope(-1e-3)}};
}

TEST(Standing, CloseToTheBorderForAHundredSeconds) {
  std::printf("| built | statics | seen | creep [m] | ms |\n| --- | --- | --- | --- | --- |\n");
  for (const Built& b : all()) {
    Simulator simulator(b.scene.world, b.scene.solver);
    RunOptions how;
    how.until = b.stands ? 100.0 : 3.0;
    how.checkpoint_seconds = -1.0;
    const std::clock_t begin = std::clock();
    const RunSummary summary = simulator.run(how);
    const double ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    double moved = 0.0;
    for (std::size_t k = 0; k < b.scene.world.bodies.size(); ++k)
      moved = std::max(moved, (simulator.state(static_cast<int>(k)).pose.position -
                               b.scene.world.bodies[k].initial.pose.position)
                                  .norm());
    const bool stood = moved == 0.0 && summary.resting == b.scene.world.bodies.size();
    std::printf("| %s | %s%s%s | %s | %.2g | %.1f |\n", b.name.c_str(), b.stands ? "stands" : "falls",
                b.why.empty() ? "" : ": ", b.why.c_str(),
                stood          ? "stands"
                : moved > 1e-3 ? "falls"
                               : "moves",
                moved, ms);
    EXPECT_EQ(summary.termination_text(), "reached_end") << b.name;
    EXPECT_EQ(stood, b.stands) << b.name;
    if (b.stands)
      EXPECT_EQ(summary.island_steps, 0U) << b.name;
    else
      EXPECT_GT(moved, 1e-3) << b.name;
  }
}

}  // namespace
}  // namespace brink::standing_stress
