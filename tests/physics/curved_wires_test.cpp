// Wires of arcs and cubics, without thickness, and smooth solids with sharp tips, that are pressed upon each other in a drum, a room, a
// tray, a bowl or a hairpin: ends and tips slide over smooth joints of arcs, arcs over ends of arcs. The run's own watch looks often, and must see no
// wire on the other side of another. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for scenes that
// fail.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/seeded_worlds.h"

namespace brink::curved_wires_test {
namespace {

std::string wire(Random& random) {
  if (random.below(2) == 0) {
    const double r = random.uniform(0.15, 0.3), half = random.uniform(0.5, 2.8), x = r * std::sin(half),
                 y = -r * std::cos(half);
    return fmt::format("path = {{ d = 'M {} {} A {} {} 0 {} 1 {} {}' }}", -x, y, r, r,
                       half < M_PI / 2 ? 0 : 1, x, y);
  }
  return fmt::format("path = {{ d = 'M -0.25 0 C {} {} {} {} 0.25 0' }}", random.uniform(-0.3, 0.3),
                     random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3));
}

std::string solid(Random& random) {
  if (random.below(2) == 0) {
    const double r = random.uniform(0.25, 0.35), hollow = r * random.uniform(1.4, 2.0);
    return fmt::format("path = {{ d = 'M 0 {} A {} {} 0 0 1 0 {} A {} {} 0 0 0 0 {} Z' }}", -r, r, r, r,
                       hollow, hollow, -r);
  }
  return fmt::format("path = {{ d = 'M -0.25 0 Q 0 {} 0.25 0 Q 0 {} -0.25 0 Z' }}", random.uniform(0.2, 0.4),
                     -random.uniform(0.2, 0.4));
}

std::string pressed(std::uint64_t seed) {
  Random random(seed);
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  std::string text = fmt::format(
      "[world]\nduration = 1.5\ngravity = [0, -9.81]\nseed = {}\n[materials.default]\nrestitution = "
      "{}\nfriction = {}\n",
      seed, pick({0.0, 0.0, 0.0, 0.2}), pick({0.0, 0.0, 0.2, 0.6}));
  const std::string room =
      "polygon = { vertices = [[-1.2, 0], [1.2, 0], [1.2, 6], [-1.2, 6]] }\ninside_of = true\n";
  switch (random.below(5)) {
    case 0:
      text += "[[sites]]\n" + room;
      break;
    case 1:
      text += "[[sites]]\n" + room +
              fmt::format("motion = {{ angle = '{}*sin({}*t)' }}\n", random.uniform(0.1, 0.5),
                          random.uniform(1.0, 5.0));
      break;
    case 2:
      text += fmt::format("[[sites]]\nbezier = [[-1.7, 2], [-1, {}], [1, {}], [1.7, 2]]\n{}",
                          -random.uniform(0.2, 1.3), -random.uniform(0.2, 1.3),
                          random.below(2) ? "radius = 0.02\n" : "");
      break;
    default:
      text += fmt::format(
          "[[sites]]\ndisc = {{ radius = 1.3 }}\nposition = [0, 1.3]\ninside_of = true\n"
          "motion = {{ angular_velocity = {} }}\n",
          pick({0.0, 0.0, 1.0}));
  }
  const int bodies = 2 + static_cast<int>(random.below(2));
  for (int k = 0; k < bodies; ++k)
    text += fmt::format(
        "[[bodies]]\nname = \"b{}\"\n{}\nmass = {}\n"
        "scatter = {{ count = 1, region = [[-0.6, 0.9], [0.6, 1.9]], random_angle = true }}\n",
        k, k == 0 || random.below(3) ? wire(random) : solid(random), pick({1.0, 1.0, 0.1, 10.0}));
  return text;
}

/// Arcs of wire, straight wires and needles that fall upon each other in a site that is bent like a hairpin, and lie nested there: arcs
/// of one radius, each in the hollow of the other, whose ends lead along each other.
std::string nested(std::uint64_t seed) {
  Random random(seed);
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  const double bend = random.uniform(0.035, 0.35), lean = random.uniform(-0.6, 0.6);
  const auto leg = [&](double side) {
    const double angle = lean + 0.5 * side * bend;
    return fmt::format("[{}, {}]", 1.5 * std::sin(angle), 1.5 * std::cos(angle));
  };
  std::string text = fmt::format(
      "[world]\nduration = 1.5\ngravity = [0, -9.81]\n[materials.default]\nrestitution = {}\nfriction = {}\n"
      "[[sites]]\nname = \"hairpin\"\npolyline = [{}, [0, 0], {}]\n",
      pick({0.0, 0.0, 0.5}), pick({0.0, 0.0, 0.3}), leg(-1.0), leg(1.0));
  const double radius = random.uniform(0.4, 1.2);
  for (int k = 0; k < 2; ++k) {
    const double up = 0.68 + 0.6 * k;
    text += fmt::format("[[bodies]]\nname = \"b{}\"\nposition = [{}, {}]\nangle = {}\n", k,
                        up * std::sin(lean), up * std::cos(lean), -lean);
    switch (random.below(5)) {
      case 0:
        text += "chain = { vertices = [[0, -0.1], [0.004, 0.12]] }\nmass = 1\n";
        break;
      case 1:
        text += "polygon = { vertices = [[0, -0.2], [0.006, 0.1], [-0.006, 0.1]] }\ndensity = 1\n";
        break;
      default:
        text += fmt::format("path = {{ d = 'M 0 -0.1 A {} {} 0 0 {} 0 0.1' }}\nmass = {}\n", radius, radius,
                            random.below(4) ? 1 : 0, pick({1.0, 1.0, 0.1, 10.0}));
    }
  }
  return text;
}

void expect_sides_kept(const std::string& text, std::uint64_t seed) {
  const Scene scene = parse_scene(text, "wires");
  RunOptions options = testing::until(scene.duration);
  options.frame_interval = 0.001;
  const RunSummary summary = Simulator(scene.world, scene.solver).run(options);
  EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
  const bool gives = !std::holds_alternative<std::monostate>(scene.world.sites[0].motion);
  EXPECT_TRUE(gives || summary.energy_final <= summary.energy_initial * (1 + 1e-10)) << summary.energy_final;
  if (seed % 8 == 0) testing::expect_same_bits(text, seed);
}

TEST(CurvedWires, KeepTheirSides) {
  testing::for_each_world(60, pressed, [](std::uint64_t seed) { expect_sides_kept(pressed(seed), seed); });
}

TEST(CurvedWires, KeepTheirSidesNestedInAHairpin) {
  testing::for_each_world(60, nested, [](std::uint64_t seed) { expect_sides_kept(nested(seed), seed); });
}

}  // namespace
}  // namespace brink::curved_wires_test
