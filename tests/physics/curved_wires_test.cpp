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

/// A wire, without thickness, that two of fit into each other.
std::string form(Random& random) {
  const double high = random.uniform(0.02, 0.3), half = random.uniform(0.1, 0.28);
  switch (random.below(7)) {
    case 0:
      return fmt::format("chain = {{ vertices = [[-0.2, {}], [0, 0], [0.2, {}]] }}", high,
                         random.uniform(0.02, 0.3));
    case 1:
      return fmt::format("chain = {{ vertices = [[-0.3, {}], [-0.1, 0], [0.1, {}], [0.3, 0]] }}", high,
                         0.7 * high);
    case 2:
      return "path = { d = 'M 0.3 0 A 0.2 0.2 0 0 0 0.1 0 A 0.2 0.2 0 0 1 -0.1 0 A 0.2 0.2 0 0 0 -0.3 0' }";
    case 3:
      return "path = { d = 'M 0.2 0 A 0.3 0.3 0 0 0 -0.2 0 L -0.4 -0.1' }";
    case 4:  // flat
      return fmt::format("path = {{ d = 'M {} 0 A 2 2 0 0 0 {} 0' }}", half, -half);
    case 5:  // an arch
      return fmt::format("path = {{ d = 'M {} 0 A 0.3 0.3 0 0 0 {} 0' }}", half, -half);
    default:  // a cup
      return fmt::format("path = {{ d = 'M {} 0 A 0.3 0.3 0 0 0 {} 0' }}", -half, half);
  }
}

/// Two of one form that come down one into the other, on a floor that may move.
std::string of_one_form(std::uint64_t seed) {
  Random random(seed);
  const auto pick = [&](std::initializer_list<double> of) { return *(of.begin() + random.below(of.size())); };
  std::string text = fmt::format(
      "[world]\nduration = 1.5\ngravity = [0, -9.81]\n[materials.default]\nrestitution = {}\nfriction = {}\n"
      "[[sites]]\nname = 'f'\nsegment = [[-5, 0], [5, 0]]\n",
      pick({0.0, 0.0, 0.3, 0.7}), pick({0.0, 0.3, 1.0}));
  const char* const motions[] = {"", "", "motion = { y = '0.05*sin(8*t)' }\n",
                                 "motion = { x = '0.1*sin(9*t)' }\n"};
  text += motions[random.below(4)];
  const std::string shape = form(random);
  if (random.below(4) == 0)
    return text + "[[bodies]]\n" + shape + "\ndensity = 1\nposition = [0, 1]\nstack = 2\ntouching = 'f'\n";
  const double aside = pick({0.0, 0.02, 0.1});
  for (int k = 0; k < 2; ++k)
    text += fmt::format("[[bodies]]\n{}\ndensity = 1\nposition = [{}, {}]\nangle = {}\n", shape,
                        random.uniform(-aside, aside), 0.4 + (aside == 0.0 ? 0.12 : 0.35) * k,
                        aside == 0.02 && random.below(2) == 0 ? random.uniform(-0.02, 0.02) : 0.0);
  return text;
}

TEST(CurvedWires, KeepTheirSidesNestedInAHairpin) {
  testing::for_each_world(60, nested, [](std::uint64_t seed) { expect_sides_kept(nested(seed), seed); });
}

TEST(CurvedWires, KeepTheirSidesWhereTheyFitIntoEachOther) {
  testing::for_each_world(30, of_one_form,
                          [](std::uint64_t seed) { expect_sides_kept(of_one_form(seed), seed); });
}

}  // namespace
}  // namespace brink::curved_wires_test
