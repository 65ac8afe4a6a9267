// Bodies on arcs whose circles are far larger than they are: gaps to these are computed from large numbers, and rounded as
// such; a series of bounces ends before one is lower than that. The same bits under every policy, and from a snapshot taken
// anywhere. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for the scenes that fail.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/seeded_worlds.h"

namespace brink::flat_arcs_test {
namespace {

constexpr double kDuration = 1.0;

std::string world_of(std::uint64_t seed) {
  Random random(seed);
  const double radius = std::pow(10.0, random.uniform(0.5, 2.5)), size = random.uniform(0.1, 0.2);
  std::string text = fmt::format(
      "[world]\nduration = {}\ngravity = [0, -9.81]\n[solver]\nrest_speed = 0\n[materials.default]\n"
      "restitution = {}\nfriction = {}\nrolling_resistance = {}\n"
      "[[sites]]\narc = {{ center = [0, {:.17g}], radius = {:.17g}, from_deg = {}, to_deg = {} }}\n",
      kDuration, 0.2 * static_cast<double>(random.below(2)), random.below(2) ? 0.0 : 0.4,
      random.below(3) ? 0.002 : 0.0, radius, radius, 270.0 - std::min(30.0, 120.0 / radius),
      270.0 + std::min(30.0, 120.0 / radius));
  const int count = 1 + static_cast<int>(random.below(2));
  for (int k = 0; k < count; ++k) {
    const double flat = size * random.uniform(0.4, 0.9);
    text += fmt::format(
        "[[bodies]]\npath = {{ d = \"M {0} 0 A {1} {2} 0 1 1 {1} 0 A {1} {2} 0 1 1 {0} 0 Z\" }}\ndensity = "
        "5\n"
        "position = [{3}, {4}]\nangle = {5}\n",
        -size, size, flat, 0.5 * k - 0.3, 2.5 * size + 0.1 * radius * (1.0 - std::cos(0.5 / radius)),
        random.uniform(0.0, 6.28));
  }
  return text;
}

TEST(FlatArcs, GiveTheSameBitsUnderEveryPolicyAndFromAnySnapshot) {
  testing::for_each_world(16, world_of, [](std::uint64_t seed) {
    const RunSummary told = testing::expect_same_bits(world_of(seed), seed);
    EXPECT_EQ(told.termination, Termination::reached_end) << told.why;
    EXPECT_GT(told.collisions, 0U);
  });
}

}  // namespace
}  // namespace brink::flat_arcs_test
