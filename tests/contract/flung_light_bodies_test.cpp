// Light bodies that springs or an attraction fling against heavy ones, among wires, without a rebound or with a small one: they turn so fast that within a rounding
// of the clock the speed of a contact changes by far more than a rounding of speeds. Every world comes to its end, with the same bits
// under every exact policy, each stopped at a random time. BRINK_SEED moves the seeds, BRINK_WORLDS their number; BRINK_KEEP names a
// folder for the scenes that fail.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/seeded_worlds.h"

namespace brink::flung_light_bodies_test {
namespace {

std::string shape(Random& random) {
  const double size = random.uniform(0.2, 0.5), thin = random.uniform(0.1, 0.3) * size;
  switch (random.below(6)) {
    case 0:
      return fmt::format("disc = {{ radius = {} }}", size / 2);
    case 1:
      return fmt::format("box = {{ width = {}, height = {} }}", 2 * size, thin);
    case 2:
      return fmt::format(
          "polygon = {{ vertices = [[0, 0], [{0}, 0], [{0}, {1}], [{1}, {1}], [{1}, {0}], [0, {0}]] }}", size,
          thin);
    case 3: {
      const int tips = 3 + static_cast<int>(random.below(5));
      std::string star;
      for (int k = 0; k < 2 * tips; ++k) {
        const double radius = k % 2 == 0 ? size : 0.5 * size, angle = std::numbers::pi * k / tips;
        star += fmt::format("[{}, {}], ", radius * std::cos(angle), radius * std::sin(angle));
      }
      return "polygon = { vertices = [" + star + "] }";
    }
    case 4:
      return fmt::format("chain = {{ vertices = [[0, 0], [{0}, 0], [{1}, {0}]] }}", size, size + thin);
    default:
      return fmt::format("capsule = {{ length = {}, radius = {} }}", 2 * size, thin);
  }
}

std::string scene_of(std::uint64_t seed) {
  Random random(seed);
  std::string text =
      fmt::format("[world]\nduration = 1\nseed = {}\n[materials.default]\nrestitution = {}\nfriction = {}\n",
                  seed, random.below(4) == 0 ? 0.2 : 0.0, random.below(3) == 0 ? 0.5 : 0.0);
  const int count = 3 + static_cast<int>(random.below(3));
  for (int k = 0; k < count; ++k)
    text += fmt::format(
        "[[bodies]]\nname = 'b{}'\n{}\nmass = {}\nscatter = {{ count = 1, region = [[-1.5, -1.5], [1.5, "
        "1.5]], "
        "random_angle = true, speed = 1.0, angular_speed = 2.0 }}\n",
        k, shape(random), k == 2 ? std::pow(10.0, random.uniform(-4.0, -1.0)) : random.uniform(0.5, 3.0));
  if (random.below(2) == 0)
    return text + fmt::format(
                      "[[sites]]\ndisc = {{ radius = 0.4 }}\n[[forces]]\nkind = 'attract'\n"
                      "center = [0.01, 0]\nstrength = 8\npower = {}\n",
                      -2 * static_cast<int>(random.below(2)));
  for (int k = 0; k < count; ++k) {
    const double stiffness = std::pow(10.0, random.uniform(0.0, 1.6));
    if (k == 0 || random.below(5) < 3)
      text += fmt::format(
          "[[forces]]\nkind = 'spring'\nbody = 'b{}[0]'\nanchor = [{}, {}]\nstiffness = {}\ndamping = {}\n",
          k, random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), stiffness,
          random.below(2) == 0 ? 0.0 : 0.3);
    else
      text += fmt::format(
          "[[forces]]\nkind = 'spring'\nbodies = ['b{}[0]', 'b{}[0]']\nstiffness = {}\nrest_length = 0.3\n",
          k, k - 1, stiffness);
  }
  return text;
}

TEST(FlungLightBodies, ComeToTheEndWithTheSameBits) {
  testing::for_each_world(60, scene_of, [](std::uint64_t seed) {
    const RunSummary s = testing::expect_same_bits(scene_of(seed), seed);
    EXPECT_EQ(s.termination, Termination::reached_end) << s.why;
    EXPECT_LE(s.energy_final, s.energy_initial);
  });
}

}  // namespace
}  // namespace brink::flung_light_bodies_test
