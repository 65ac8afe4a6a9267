// Sharp corners that fall, slide and turn in hollow corners, where both sides are as near, and what comes out may fall on either: no
// overlap at frames, by axes that part convex outlines, and the same bits under every policy and from any snapshot. BRINK_SEED moves
// the seeds, BRINK_WORLDS their number; BRINK_KEEP names a folder for the scenes that fail.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "brink/core/base/random.h"
#include "tests/support/polygons_world.h"

namespace brink::tips_in_notches_test {
namespace {

using testing::Polygon;

testing::PolygonsWorld tip_in_a_notch(std::uint64_t seed) {
  Random random(seed);
  testing::PolygonsWorld made;
  // half the angles of notch and tip, which has room
  const double notch = random.uniform(0.3, 1.3), tip = random.uniform(0.15, notch);
  const double deep = random.uniform(0.3, 1.0), half = deep * std::tan(notch);
  const double turned = random.below(2) ? random.uniform(-3.0, 3.0) : 0.0;
  const Eigen::Rotation2Dd turn(turned);
  const auto placed = [&](Polygon polygon) {
    for (Vec2& p : polygon) p = turn * p;
    return polygon;
  };
  made.place = random.below(2) ? Vec2(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0)) : Vec2(0.0, 0.0);
  made.sites = {placed({{-half - 0.5, -0.5}, {0.0, -0.5}, {0.0, 0.0}, {-half, deep}, {-half - 0.5, deep}}),
                placed({{0.0, -0.5}, {half + 0.5, -0.5}, {half + 0.5, deep}, {half, deep}, {0.0, 0.0}})};
  const Polygon block = placed({{-half - 0.5, -0.5},
                                {half + 0.5, -0.5},
                                {half + 0.5, deep},
                                {half, deep},
                                {0.0, 0.0},
                                {-half, deep},
                                {-half - 0.5, deep}});
  const double high = deep * random.uniform(0.3, 1.5), wide = high * std::tan(tip);
  made.body = {{0.0, -2.0 * high / 3.0}, {wide, high / 3.0}, {-wide, high / 3.0}};
  const double angle = turned + (random.below(3) ? random.uniform(tip - notch, notch - tip) : 0.0);
  constexpr std::array above{0.0, 0.0, 1e-9, 1e-6, 1e-3};
  const Vec2 centre = made.place + turn * Vec2(0.0, above[random.below(above.size())]) +
                      Eigen::Rotation2Dd(angle) * Vec2(0.0, 2.0 * high / 3.0);
  const Vec2 gravity = random.below(3) ? Vec2(turn * Vec2(0.0, -5.0)) : Vec2(0.0, 0.0);
  made.text = fmt::format(
      "[world]\nduration = 0.5\ngravity = [{:.17g}, {:.17g}]\n[materials.default]\nrestitution = "
      "{}\nfriction = {}\n",
      gravity.x(), gravity.y(), std::array{1.0, 0.5, 0.0, 0.8}[random.below(4)],
      std::array{0.0, 0.3, 1.0}[random.below(3)]);
  made.text += fmt::format("[[sites]]\nposition = [{:.17g}, {:.17g}]\n", made.place.x(), made.place.y()) +
               testing::vertices(block);
  made.text += fmt::format(
                   "[[bodies]]\nposition = [{:.17g}, {:.17g}]\nangle = {:.17g}\nvelocity = [{}, "
                   "{}]\nangular_velocity = {}\n",
                   centre.x(), centre.y(), angle, random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5),
                   random.below(2) ? random.uniform(-4.0, 4.0) : 0.0) +
               testing::vertices(made.body);
  return made;
}

TEST(TipsInNotches, DoNotSinkInUnderAnyPolicy) { testing::expect_no_overlaps(50, tip_in_a_notch); }

}  // namespace
}  // namespace brink::tips_in_notches_test
