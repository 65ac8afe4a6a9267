// Bodies that have met without a rebound and go on side by side, under forces that change: the errors of their integration alone
// bring them nearer or farther apart, by some 1e-13 m. When they meet again is the same under every policy, and however a
// run was stopped. BRINK_SEED moves the seeds of the random worlds, BRINK_WORLDS their number; BRINK_KEEP names a folder for
// the scenes that fail.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "brink/core/base/random.h"
#include "tests/support/seeded_worlds.h"

namespace brink::side_by_side_test {
namespace {

std::string shape(Random& random, double size) {
  switch (random.below(4)) {
    case 0:
      return fmt::format("disc = {{ radius = {} }}", 0.4 * size);
    case 1:
      return fmt::format("box = {{ width = {}, height = {} }}", 0.8 * size, 0.5 * size);
    case 2:
      return fmt::format("capsule = {{ length = {}, radius = {} }}", 0.4 * size, 0.2 * size);
    default:
      return fmt::format("polygon = {{ vertices = [[{0}, 0], [0, {0}], [-{1}, -{2}]] }}", 0.5 * size,
                         0.4 * size, 0.3 * size);
  }
}

/// Of the same acceleration for all, whatever their masses.
std::string force(Random& random, double size) {
  const double much = size * random.uniform(0.1, 2.0), fast = random.uniform(1.0, 6.0);
  switch (random.below(4)) {
    case 0:
      return fmt::format("fx = \"{:.17g}*m*sin({:.17g}*t)\"", much, fast);
    case 1:
      return fmt::format("fx = \"{:.17g}*m*sin({:.17g}*t)\"\nfy = \"{:.17g}*m*cos({:.17g}*t)\"", much, fast,
                         size * random.uniform(0.1, 2.0), random.uniform(1.0, 6.0));
    case 2:
      return fmt::format("fx = \"-{:.17g}*m*vx\"", random.uniform(0.1, 2.0));
    default:
      return fmt::format("fx = \"-{:.17g}*m*x\"", random.uniform(0.1, 2.0));
  }
}

/// Two or three in a row, the others fly at the first; every fourth scene has a wall behind that.
std::string side_by_side(std::uint64_t seed) {
  Random random(seed);
  const double size = std::pow(10.0, random.uniform(-1.0, 1.0));
  const bool locked = random.below(4) != 0;
  std::string text =
      fmt::format("[world]\nduration = {:.17g}\n[materials.default]\nrestitution = {:.17g}\nfriction = {}\n",
                  random.uniform(1.0, 3.0), random.below(3) == 0 ? random.uniform(0.0, 0.5) : 0.0,
                  random.below(2) ? 0.5 : 0.0);
  const int count = 2 + static_cast<int>(random.below(2));
  for (int k = 0; k < count; ++k)
    text += fmt::format(
        "[[bodies]]\n{}\nposition = [{:.17g}, {:.17g}]\nangle = {:.17g}\nvelocity = [{:.17g}, 0.0]\n{}",
        shape(random, size), 1.6 * size * k, size * random.uniform(0.0, 0.3), random.uniform(0.0, 6.0),
        size * (1.0 - k) * random.uniform(0.3, 2.0), locked ? "lock = [\"angle\"]\n" : "");
  if (random.below(4) == 0)
    text +=
        fmt::format("[[sites]]\nsegment = [[{0}, {1}], [{0}, {2}]]\n", -1.5 * size, -4.0 * size, 4.0 * size);
  return text + "[[forces]]\nkind = \"formula\"\n" + force(random, size) + "\n";
}

TEST(SideBySide, MeetAgainAtTheSameTimesUnderEveryPolicyAndGoOnWithTheSameBits) {
  testing::for_each_world(24, side_by_side,
                          [](std::uint64_t seed) { testing::expect_same_bits(side_by_side(seed), seed); });
}

}  // namespace
}  // namespace brink::side_by_side_test
