// Worlds far from the origin: places are rounded there by more than slow bodies move towards each other in a clock's step. The same
// bits under every policy, and from a snapshot taken anywhere. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP
// names a folder for the scenes that fail.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/seeded_worlds.h"

namespace brink::far_worlds_test {
namespace {

/// A few bodies in a room with corners, of wire, of thick wire or hollow, that stands, turns or is shaken.
std::string world_of(std::uint64_t seed) {
  Random random(seed);
  const double far = std::pow(10.0, random.uniform(2.0, 4.5)), x = random.below(2) ? far : -far,
               y = random.uniform(-1.0, 1.0) * far;
  const auto corners = 4 + random.below(9);
  std::string outline;
  for (std::uint64_t k = 0; k < corners; ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(corners);
    outline += fmt::format("{}[{:.12g}, {:.12g}]", k ? ", " : "", std::cos(angle), std::sin(angle));
  }
  const std::array rooms{fmt::format("chain = {{ vertices = [{}], closed = true }}", outline),
                         fmt::format("chain = {{ vertices = [{}], closed = true, radius = 0.01 }}", outline),
                         fmt::format("polygon = {{ vertices = [{}] }}\ninside_of = true", outline)};
  const std::array motions{
      std::string(), fmt::format("motion = {{ angular_velocity = {:.6g} }}", random.uniform(-5.0, 5.0)),
      fmt::format("motion = {{ x = \"0.02*sin({:.3g}*t)\" }}", random.uniform(2.0, 20.0))};
  const std::array shapes{"disc = { radius = 0.09 }", "disc = { radius = 0.09 }",
                          "box = { width = 0.2, height = 0.12 }",
                          "polygon = { vertices = [[0.12, 0], [-0.06, 0.1], [-0.06, -0.1]] }"};
  return fmt::format(
      "[world]\nduration = 1\ngravity = [0, -9.81]\nseed = {}\n[materials.default]\n"
      "restitution = {}\nfriction = {}\n"
      "[[sites]]\n{}\nposition = [{:.17g}, {:.17g}]\n{}\n"
      "[[bodies]]\n{}\ndensity = 10\nscatter = {{ count = {}, random_angle = true, speed = {},"
      " region = [[{:.17g}, {:.17g}], [{:.17g}, {:.17g}]] }}\n",
      seed + 1, std::array{0.0, 0.0, 0.3, 0.9, 1.0}[random.below(5)],
      std::array{0.0, 0.2, 0.4, 0.8}[random.below(4)], rooms[random.below(3)], x, y, motions[random.below(3)],
      shapes[random.below(4)], 1 + random.below(6), random.below(2) ? 0.0 : 2.0, x - 0.45, y - 0.45, x + 0.45,
      y + 0.45);
}

TEST(FarWorlds, GiveTheSameBitsUnderEveryPolicyAndFromAnySnapshot) {
  testing::for_each_world(12, world_of,
                          [](std::uint64_t seed) { testing::expect_same_bits(world_of(seed), seed); });
}

}  // namespace
}  // namespace brink::far_worlds_test
