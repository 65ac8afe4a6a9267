// Slender bodies with restitution and friction: gears on axles that rattle in each other, planets that wedge between a sun on its
// axle and a ring, and rods, needles and stars in a room, under every law of one contact (restitution and friction of any size, tangential restitution from -1 to 1, impact orders).
// Newton's restitution and Coulomb's friction together would gain energy (Kane & Levinson 1985): at no frame may there be more
// than before. BRINK_SEED moves the seeds, BRINK_WORLDS their number.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "brink/core/base/random.h"
#include "tests/support/outside/frame_watch.h"
#include "tests/support/seeded_worlds.h"

namespace brink::rubbing_rebounds_test {
namespace {

template <typename Value>
Value pick(Random& random, std::initializer_list<Value> of) {
  return *(of.begin() + random.below(of.size()));
}

std::string polygon(const std::vector<Vec2>& corners) {
  std::string text = "polygon = { vertices = [";
  for (const Vec2& p : corners) text += fmt::format("[{:.9g}, {:.9g}], ", p.x(), p.y());
  return text + "] }";
}

/// Trapezoids on a circle of that radius, a gap beside each.
std::vector<Vec2> gear(int teeth, double radius, double height, double width, double slant) {
  const double pitch = 2.0 * std::numbers::pi / teeth;
  std::vector<Vec2> corners;
  for (int k = 0; k < teeth; ++k)
    for (const auto& [side, out] :
         {std::pair(-1.0, -1.2), std::pair(-1.0, 0.8), std::pair(1.0, 0.8), std::pair(1.0, -1.2)}) {
      const double angle = pitch * (k + 0.5 * side * width * (out < 0.0 ? 1.0 + slant : 1.0 - slant));
      corners.push_back((radius + out * height) * Vec2(std::cos(angle), std::sin(angle)));
    }
  return corners;
}

/// Two to four, on axles in a row, a tooth of each in a gap of the one before.
std::string gears(Random& random) {
  const double module = std::pow(10.0, random.uniform(-2.0, 1.0)),
               height = module * random.uniform(0.35, 0.5), width = random.uniform(0.4, 0.47),
               slant = random.uniform(0.2, 0.5);
  std::string text;
  Vec2 at = Vec2::Zero();
  double angle = 0.0;
  int teeth_before = 0;
  const int count = 2 + static_cast<int>(random.below(3));
  for (int k = 0; k < count; ++k) {
    const int teeth = 8 + static_cast<int>(random.below(20));
    const double radius = 0.5 * module * teeth;
    if (k > 0) {
      const double along = random.uniform(-0.8, 0.8), apart = radius + 0.5 * module * teeth_before;
      // where the one before has a tooth this one has a gap, and the two turn against each other
      const double tooth = (along - angle) * teeth_before / (2.0 * std::numbers::pi);
      at += apart * Vec2(std::cos(along), std::sin(along));
      angle = along + std::numbers::pi - (0.5 - tooth) * 2.0 * std::numbers::pi / teeth;
    }
    text += fmt::format(
        "[[bodies]]\n{}\ndensity = {}\nposition = [{:.12g}, {:.12g}]\nangle = {:.12g}\nangular_velocity = "
        "{}\nlock "
        "= ['x', 'y']\n",
        polygon(gear(teeth, radius, height, width, slant)), std::pow(10.0, random.uniform(0.0, 2.0)), at.x(),
        at.y(), angle, k == 0 ? random.uniform(-10.0, 10.0) : 0.0);
    teeth_before = teeth;
  }
  return text;
}

/// How far from a whole number.
double off_whole(double x) { return std::abs(x - std::round(x)); }

/// A sun on its axle, and one to three planets that are free between it and a ring with teeth.
std::string planets(Random& random) {
  constexpr double kModule = 0.1, kHeight = 0.05;
  const int of_sun = 10 + static_cast<int>(random.below(10)),
            of_planet = 8 + static_cast<int>(random.below(7)), of_ring = of_sun + 2 * of_planet;
  const double width = random.uniform(0.42, 0.48), slant = random.uniform(0.2, 0.45);
  std::vector<Vec2> ring = gear(of_ring, 0.5 * kModule * of_ring, -kHeight, width, slant);
  std::string text = fmt::format("[[sites]]\n{}\ninside_of = true\n", polygon(ring));
  text += fmt::format("[[bodies]]\n{}\ndensity = 5\nlock = ['x', 'y']\nangular_velocity = {}\n",
                      polygon(gear(of_sun, 0.5 * kModule * of_sun, kHeight, width, slant)),
                      random.uniform(-8.0, 8.0));
  const int count = 1 + static_cast<int>(random.below(3));
  std::vector<Vec2> places;
  for (int k = 0; k < count; ++k) {
    const double turn = 2.0 * std::numbers::pi, orbit = 0.5 * kModule * (of_sun + of_planet);
    // about a third of the way round, where its teeth are in gaps of both
    double best = 1.0, along = 0.0, angle = 0.0;
    for (int n = -2000; n < 2000; ++n) {
      const double there = turn * k / 3.0 + 4e-4 * n, tooth = there * of_sun / turn;
      const double turned = there + std::numbers::pi - (0.5 - tooth) * turn / of_planet;
      const double off = off_whole((there - turned) * of_planet / turn - there * of_ring / turn - 0.5);
      if (off < best) best = off, along = there, angle = turned;
    }
    // not where it would be in one that is there
    const Vec2 at = orbit * Vec2(std::cos(along), std::sin(along));
    if (std::any_of(places.begin(), places.end(),
                    [&](const Vec2& p) { return (p - at).norm() < kModule * of_planet + 2.0 * kHeight; }))
      continue;
    places.push_back(at);
    text += fmt::format("[[bodies]]\n{}\ndensity = 5\nposition = [{:.12g}, {:.12g}]\nangle = {:.12g}\n",
                        polygon(gear(of_planet, 0.5 * kModule * of_planet, kHeight, width, slant)), at.x(),
                        at.y(), angle);
  }
  return text;
}

std::string slender(Random& random) {
  const double length = random.uniform(0.3, 0.6), width = random.uniform(0.02, 0.1);
  switch (random.below(4)) {
    case 0:
      return fmt::format("box = {{ width = {}, height = {} }}", length, width);
    case 1:
      return fmt::format("capsule = {{ length = {}, radius = {} }}", length, 0.5 * width);
    case 2:
      return polygon({{-0.5 * length, 0}, {0.5 * length, -0.5 * width}, {0.5 * length, 0.5 * width}});
    default: {
      std::vector<Vec2> star;
      for (int k = 0; k < 10; ++k)
        star.push_back((k % 2 == 0 ? 0.3 : 0.1) *
                       Vec2(std::cos(0.2 * k * std::numbers::pi), std::sin(0.2 * k * std::numbers::pi)));
      return polygon(star);
    }
  }
}

std::string in_a_room(Random& random) {
  std::string text =
      "[[sites]]\npolygon = { vertices = [[-2, -2], [2, -2], [2, 2], [-2, 2]] }\ninside_of = true\n";
  for (int k = 0; k < 9; ++k)
    text += fmt::format(
        "[[bodies]]\n{}\ndensity = {}\nposition = [{}, {}]\nangle = {}\nvelocity = [{}, "
        "{}]\nangular_velocity = {}\n",
        slender(random), std::pow(10.0, random.uniform(0.0, 2.0)), 1.3 * (k % 3 - 1), 1.3 * (k / 3 - 1),
        random.uniform(0.0, 7.0), random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0),
        random.uniform(-9.0, 9.0));
  return text;
}

std::string scene_of(std::uint64_t seed) {
  Random random(seed);
  // where contacts last a step has the velocity of its end all along: seen from frames, weights are then known to that
  std::string text = fmt::format(
      "[world]\nduration = 2\ngravity = [0, {}]\n[solver]\norder = '{}'\nmodes_contacts = "
      "{}\n[materials.default]\nrestitution = "
      "{}\nfriction = {}\ntangential_restitution = {}\n",
      pick(random, {-9.81, -1e-6}), pick(random, {"index", "closing_speed", "lcp", "reflections"}),
      pick(random, {0, 16}), random.below(2) == 0 ? pick(random, {1.0, 0.9, 0.5}) : random.uniform(0.1, 1.0),
      random.below(2) == 0 ? pick(random, {0.3, 0.6, 1.0}) : random.uniform(0.05, 1.5),
      pick(random, {0.0, 0.0, 1.0, -1.0, 0.5, -0.3}));
  switch (random.below(3)) {
    case 0:
      return text + gears(random);
    case 1:
      return text + planets(random);
    default:
      return text + in_a_room(random);
  }
}

void check(std::uint64_t seed) {
  const std::string text = scene_of(seed);
  const Scene scene = parse_scene(text, "rubbing");
  outside::FrameWatch watch(scene.world, scene.duration, 1e-9);
  RunOptions options = testing::until(scene.duration);
  options.frame_interval = 0.01;
  const RunSummary summary = Simulator(scene.world, scene.solver).run(options, &watch);
  ASSERT_EQ(summary.termination, Termination::reached_end) << summary.why;
  EXPECT_TRUE(watch.sound()) << watch.report();
  EXPECT_LE(watch.gained, 1e-10L) << "at " << watch.when;
  EXPECT_LE(summary.energy_final, summary.energy_initial + 1e-10 * std::abs(summary.energy_initial));
  testing::expect_same_bits(text, seed);
}

TEST(RubbingRebounds, GainNoEnergy) { testing::for_each_world(24, scene_of, check); }

}  // namespace
}  // namespace brink::rubbing_rebounds_test
