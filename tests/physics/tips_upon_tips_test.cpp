// Sharp corners that come straight upon sharp corners, or upon the point where two sites meet: which side parts them is told by
// roundings there, and in neither may they sink. They begin there, from nowhere to a micrometre off, or are dropped and bounce. No
// overlap at frames, by axes that part convex outlines, and the same bits under every policy and from any snapshot. BRINK_SEED moves the
// seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for the scenes that fail.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "brink/core/base/random.h"
#include "tests/support/polygons_world.h"

namespace brink::tips_upon_tips_test {
namespace {

using testing::Polygon;
using testing::vertices;

testing::PolygonsWorld tips(std::uint64_t seed) {
  Random random(seed);
  testing::PolygonsWorld made;
  const double wide = random.uniform(0.1, 0.5), high = random.uniform(0.2, 1.2);
  made.body = {{-wide, high / 3.0}, {0.0, -2.0 * high / 3.0}, {wide, high / 3.0}};
  const double deep = random.uniform(0.2, 1.5);
  switch (random.below(3)) {
    case 0:  // a tip
      made.sites = {{{-0.4, -deep}, {0.4, -deep}, {0.0, 0.0}}};
      break;
    case 1:  // the joint of two boxes
      made.sites = {{{-0.8, -deep}, {0.0, -deep}, {0.0, 0.0}, {-0.8, 0.0}},
                    {{0.0, -deep}, {0.8, -deep}, {0.8, 0.0}, {0.0, 0.0}}};
      break;
    default:  // two corners that meet in their tips alone
      made.sites = {{{-0.8, 0.0}, {-0.4, -deep}, {0.0, 0.0}}, {{0.0, 0.0}, {0.4, -deep}, {0.8, 0.0}}};
  }
  const bool drops = random.below(3) == 0;
  constexpr std::array off{0.0,   0.0,   1e-17, 2.3e-16, 4.5e-16, 1e-15, 3e-15,
                           1e-14, 3e-14, 1e-13, 1e-12,   1e-10,   1e-6};
  constexpr std::array beside{0.0, 0.0, 0.0, 1e-17, 1e-16, 1e-15, 1e-14};
  constexpr std::array along{0.0, 0.0, 0.0, 0.3, -0.3, 1e-9};
  constexpr std::array far{0.0, 0.4, -7.3, 1000.1};
  made.place = {far[random.below(far.size())], 0.0};
  const double x = made.place.x() + (random.below(2) ? 1.0 : -1.0) * beside[random.below(beside.size())];
  const double tip = drops ? random.uniform(0.01, 0.2) : off[random.below(off.size())];
  made.text = fmt::format(
      "[world]\nduration = {}\ngravity = [0, {}]\n[materials.default]\nrestitution = {}\nfriction = {}\n",
      drops ? 1.0 : 0.1, drops || random.below(2) ? -9.81 : 0.0,
      std::array{1.0, 1.0, 0.8, 0.5, 0.0}[random.below(5)], random.below(3) ? 0.0 : 0.5);
  for (const Polygon& site : made.sites)
    made.text += fmt::format("[[sites]]\nposition = [{:.17g}, 0]\n", made.place.x()) + vertices(site);
  made.text += fmt::format("[[bodies]]\nposition = [{:.17g}, {:.17g}]\nvelocity = [{}, {}]\n{}", x,
                           tip + 2.0 * high / 3.0, drops ? 0.0 : along[random.below(along.size())],
                           drops ? 0.0 : -1.0, random.below(2) ? "lock = [\"angle\"]\n" : "") +
               vertices(made.body);
  return made;
}

TEST(TipsUponTips, DoNotSinkInUnderAnyPolicy) { testing::expect_no_overlaps(50, tips); }

}  // namespace
}  // namespace brink::tips_upon_tips_test
