// Ways through wires, as the watch over a run sees them.
#include "brink/scheduler/kernel/thin_walls.h"

#include <gtest/gtest.h>

#include <cmath>

namespace brink {
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

}  // namespace
}  // namespace brink
