// Ways through wires, as the watch over a run sees them.
#include "brink/scheduler/kernel/thin_walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace brink::thin_walls_test {
namespace {

std::function<Vec2(double)> straight(Vec2 p, Vec2 q) {
  return [=](double t) { return Vec2(p + t * (q - p)); };
}

TEST(ThinWalls, AWayThroughIsSeenAndNamesItsSite) {
  ThinWalls walls;
  EXPECT_TRUE(walls.empty());
  walls.add({0.0, -1.0}, {0.0, 1.0}, 7);
  walls.add({5.0, -1.0}, {5.0, 1.0}, 8);
  EXPECT_EQ(walls.crossed(straight({-1.0, 0.2}, {1.0, 0.3}), 0.0, 1.0), 7);
  EXPECT_EQ(walls.crossed(straight({4.0, 0.2}, {6.0, 0.3}), 0.0, 1.0), 8);
}

TEST(ThinWalls, AWayBesideTheEndIsNone) {
  ThinWalls walls;
  walls.add({0.0, -1.0}, {0.0, 1.0}, 0);
  EXPECT_FALSE(walls.crossed(straight({-1.0, 1.1}, {1.0, 1.2}), 0.0, 1.0));
  EXPECT_FALSE(walls.crossed(straight({-1.0, 0.0}, {-0.1, 0.9}), 0.0, 1.0));
}

TEST(ThinWalls, AParabolaOverTheEndIsNoneThoughItsChordCrosses) {
  ThinWalls walls;
  walls.add({0.0, -1.0}, {0.0, 0.5}, 0);
  const auto thrown = [](double t) {
    return Vec2(-1.0 + 2.0 * t, 4.0 * t * (1.0 - t));
  };  // 1 high over the wall
  EXPECT_FALSE(walls.crossed(thrown, 0.0, 1.0));
  walls.add({0.0, 0.75}, {0.0, 2.0}, 1);
  EXPECT_EQ(walls.crossed(thrown, 0.0, 1.0), std::nullopt);  // the chord is below this one: not judged by it
}

TEST(ThinWalls, AWayThatEndsAtAWallWithinRoundingIsNotJudged) {
  ThinWalls walls;
  walls.add({0.0, -1.0}, {0.0, 1.0}, 0);
  EXPECT_FALSE(walls.crossed(straight({-1.0, 0.0}, {1e-16, 0.0}), 0.0, 1.0));
}

TEST(ThinWalls, OneOfManyIsFound) {
  ThinWalls walls;
  for (int i = 0; i < 2000; ++i) {
    const double a = 0.01 * i;
    const Vec2 at(10.0 * std::cos(a) * (1.0 + 0.01 * i), 10.0 * std::sin(a) * (1.0 + 0.01 * i));
    walls.add(at, at + Vec2(-0.01, 0.02), i);
  }
  for (int i = 0; i < 2000; i += 37) {
    const double a = 0.01 * i;
    const Vec2 at(10.0 * std::cos(a) * (1.0 + 0.01 * i), 10.0 * std::sin(a) * (1.0 + 0.01 * i));
    const Vec2 middle = at + Vec2(-0.005, 0.01), across(0.002, 0.001);
    EXPECT_EQ(walls.crossed(straight(middle - across, middle + across), 0.0, 1.0), i);
  }
}

// Whatever the way within a clear box, no wall is crossed; and the box is as wide as the nearest wall lets it.
TEST(ThinWalls, ABoxThatIsClearHoldsNoWall) {
  std::mt19937_64 random(31);
  std::uniform_real_distribution<double> place(-10.0, 10.0), part(0.0, 1.0);
  for (const int count : {1, 4, 16, 17, 300})
    for (int i = 0; i < 300; ++i) {
      ThinWalls walls;
      std::vector<std::pair<Vec2, Vec2>> ends;
      for (int k = 0; k < count; ++k) {
        ends.emplace_back(Vec2(place(random), place(random)), Vec2(place(random), place(random)));
        walls.add(ends.back().first, ends.back().second, k);
      }
      const Vec2 p(place(random), place(random));
      const Box clear = walls.clear_around(p);
      for (const auto& [a, b] : ends)
        for (int m = 0; m <= 100; ++m) {
          const Vec2 on_wall = a + 0.01 * m * (b - a);
          const bool inside =
              (on_wall.array() > clear.low.array()).all() && (on_wall.array() < clear.high.array()).all();
          ASSERT_FALSE(inside) << count << " walls, " << i;
        }
      if (clear.extent().x() == 0.0) continue;
      const auto within = [&] {
        return Vec2(clear.low + Vec2(part(random), part(random)).cwiseProduct(clear.extent()));
      };
      const Vec2 from = within(), to = within();
      ASSERT_FALSE(walls.crossed([&](double t) { return Vec2(from + t * (to - from)); }, 0.0, 1.0));
    }
}

TEST(ThinWalls, AClearBoxReachesToTheNearestWall) {
  ThinWalls walls;
  walls.add({3.0, -1.0}, {3.0, 1.0}, 0);
  const Box clear = walls.clear_around({0.5, 0.0});
  EXPECT_NEAR(clear.high.x(), 3.0, 1e-8);
  EXPECT_NEAR(clear.low.x(), -2.0, 1e-8);
  EXPECT_LT(clear.high.x(), 3.0);
}

}  // namespace
}  // namespace brink::thin_walls_test
