// Ways through wires, as the watch over a run sees them.
#include "brink/scheduler/kernel/thin_walls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace brink::thin_walls_test {
namespace {

std::function<Vec2(double)> straight(Vec2 p, Vec2 q) {
  return [=](double t) { return Vec2(p + t * (q - p)); };
}

Site segment(const Vec2& a, const Vec2& b) {
  Site core;
  core.kind = SiteKind::segment;
  core.a = a;
  core.b = b;
  return core;
}

/// From the angle `from` on, by `sweep`, a quarter turn at most.
Site arc(const Vec2& center, double radius, double from, double sweep) {
  Site core;
  core.kind = SiteKind::arc;
  core.center = center;
  core.arc_radius = radius;
  core.sweep = sweep;
  core.a = center + radius * Vec2(std::cos(from), std::sin(from));
  core.b = center + radius * Vec2(std::cos(from + sweep), std::sin(from + sweep));
  return core;
}

TEST(ThinWalls, AWayThroughIsSeenAndNamesItsSite) {
  ThinWalls walls;
  EXPECT_TRUE(walls.empty());
  walls.add(segment({0.0, -1.0}, {0.0, 1.0}), 7);
  walls.add(segment({5.0, -1.0}, {5.0, 1.0}), 8);
  EXPECT_EQ(walls.crossed(straight({-1.0, 0.2}, {1.0, 0.3}), 0.0, 1.0), 7);
  EXPECT_EQ(walls.crossed(straight({4.0, 0.2}, {6.0, 0.3}), 0.0, 1.0), 8);
}

TEST(ThinWalls, AWayBesideTheEndIsNone) {
  ThinWalls walls;
  walls.add(segment({0.0, -1.0}, {0.0, 1.0}), 0);
  EXPECT_FALSE(walls.crossed(straight({-1.0, 1.1}, {1.0, 1.2}), 0.0, 1.0));
  EXPECT_FALSE(walls.crossed(straight({-1.0, 0.0}, {-0.1, 0.9}), 0.0, 1.0));
}

TEST(ThinWalls, AParabolaOverTheEndIsNoneThoughItsChordCrosses) {
  ThinWalls walls;
  walls.add(segment({0.0, -1.0}, {0.0, 0.5}), 0);
  const auto thrown = [](double t) {
    return Vec2(-1.0 + 2.0 * t, 4.0 * t * (1.0 - t));
  };  // 1 high over the wall
  EXPECT_FALSE(walls.crossed(thrown, 0.0, 1.0));
  walls.add(segment({0.0, 0.75}, {0.0, 2.0}), 1);
  EXPECT_EQ(walls.crossed(thrown, 0.0, 1.0), std::nullopt);  // the chord is below this one: not judged by it
}

TEST(ThinWalls, WhatFallsForLongBesideTheEndIsNotThrough) {
  ThinWalls walls;
  walls.add(segment({-2.0, 0.0}, {2.0, 0.0}), 0);
  // off the end at once, then down for a thousand seconds: whatever chords of it cross
  for (const double speed : {0.5, 5.0, 50.0})
    for (const double before : {0.4, 0.6})
      for (const double end : {1.0, 75.0, 1e3, 1e6}) {
        const auto falls = [&](double t) {
          return Vec2(2.0 - before * speed + speed * t, 1.0 - 4.905 * t * t);
        };
        const bool through = falls(std::sqrt(1.0 / 4.905)).x() < 2.0;
        EXPECT_EQ(through, before == 0.6);
        // the straight way between the ends tells some that are through: none that are not
        if (through) continue;
        EXPECT_FALSE(walls.crossed(falls, 0.0, end)) << speed << " " << end;
      }
}

TEST(ThinWalls, AWayThatEndsAtAWallWithinRoundingIsNotJudged) {
  ThinWalls walls;
  walls.add(segment({0.0, -1.0}, {0.0, 1.0}), 0);
  EXPECT_FALSE(walls.crossed(straight({-1.0, 0.0}, {1e-16, 0.0}), 0.0, 1.0));
}

TEST(ThinWalls, OneOfManyIsFound) {
  ThinWalls walls;
  for (int i = 0; i < 2000; ++i) {
    const double a = 0.01 * i;
    const Vec2 at(10.0 * std::cos(a) * (1.0 + 0.01 * i), 10.0 * std::sin(a) * (1.0 + 0.01 * i));
    walls.add(segment(at, at + Vec2(-0.01, 0.02)), i);
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
        walls.add(segment(ends.back().first, ends.back().second), k);
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
  walls.add(segment({3.0, -1.0}, {3.0, 1.0}), 0);
  const Box clear = walls.clear_around({0.5, 0.0});
  EXPECT_NEAR(clear.high.x(), 3.0, 1e-8);
  EXPECT_NEAR(clear.low.x(), -2.0, 1e-8);
  EXPECT_LT(clear.high.x(), 3.0);
}

/// How often a straight way crosses an arc, by where it meets the circle, in long double; -1: too close to tell, as it
/// ends near the arc, passes one of its ends or only just touches it.
int crossings(const Site& arc, const Vec2& p, const Vec2& q) {
  using Long = long double;
  constexpr Long kNear = 1e-9L;
  const Long wx = Long(p.x()) - arc.center.x(), wy = Long(p.y()) - arc.center.y(), dx = Long(q.x()) - p.x(),
             dy = Long(q.y()) - p.y(), r = arc.arc_radius;
  const Long a = dx * dx + dy * dy, b = wx * dx + wy * dy, c = wx * wx + wy * wy - r * r, d = b * b - a * c;
  if (std::abs(d) < kNear * a * r * r) return -1;
  if (d < 0.0L) return 0;
  const Long start = std::atan2(Long(arc.a.y()) - arc.center.y(), Long(arc.a.x()) - arc.center.x());
  int count = 0;
  for (const Long root : {-std::sqrt(d), std::sqrt(d)}) {
    const Long s = (root - b) / a;
    Long turned = std::atan2(wy + s * dy, wx + s * dx) - start;
    if (arc.sweep < 0.0) turned = -turned;
    turned = std::remainder(turned - 0.5L * std::abs(Long(arc.sweep)), 2.0L * std::numbers::pi_v<Long>);
    const Long beyond = std::abs(turned) - 0.5L * std::abs(Long(arc.sweep));
    if (beyond > kNear) continue;
    if (beyond > -kNear || std::abs(s) < kNear || std::abs(s - 1.0L) < kNear) return -1;
    count += s > 0.0L && s < 1.0L;
  }
  return count;
}

TEST(ThinWalls, AWayThroughAnArcIsSeen) {
  std::mt19937_64 random(32);
  std::uniform_real_distribution<double> place(-2.0, 2.0), angle(-7.0, 7.0), part(0.05, 1.0);
  int through = 0, beside = 0, twice = 0;
  for (int i = 0; i < 20000; ++i) {
    const double far = i % 2 ? 0.0 : 1e4;
    const Vec2 at(far + place(random), place(random));
    const double sweep = 0.5 * std::numbers::pi * part(random) * (i % 3 ? 1.0 : -1.0);
    const Site wall = arc(at, 2.0 * part(random), angle(random), sweep);
    const Vec2 p(far + place(random), place(random)), q(far + place(random), place(random));
    const int count = crossings(wall, p, q);
    if (count < 0) continue;
    ThinWalls walls;
    walls.add(wall, 3);
    const auto found = walls.crossed(straight(p, q), 0.0, 1.0);
    // in and out again is nothing for good
    EXPECT_EQ(found.has_value(), count == 1) << i;
    ++(count == 1 ? through : count == 2 ? twice : beside);
  }
  EXPECT_GT(through, 1000);
  EXPECT_GT(beside, 5000);
  EXPECT_GT(twice, 10);
}

TEST(ThinWalls, AWayRoundTheEndOfAnArcIsNone) {
  ThinWalls walls;
  walls.add(arc({0.0, 0.0}, 1.0, 0.0, 0.5 * std::numbers::pi), 0);
  // from inside the quarter to outside, over its upper end: the straight way between the two would cross it
  const auto over = [](double t) {
    const double angle = 0.7 + 1.2 * std::sin(std::numbers::pi * t), radius = 0.5 + t;
    return Vec2(radius * std::cos(angle), radius * std::sin(angle));
  };
  EXPECT_FALSE(walls.crossed(over, 0.0, 1.0));
  const auto out = [](double t) { return Vec2((0.5 + t) * std::cos(0.7), (0.5 + t) * std::sin(0.7)); };
  EXPECT_TRUE(walls.crossed(out, 0.0, 1.0));
  // through it from outside, and on through the open side
  EXPECT_TRUE(walls.crossed(straight({1.5, 1.5}, {-1.5, -1.5}), 0.0, 1.0));
}

TEST(ThinWalls, ABoxThatIsClearHoldsNoArc) {
  std::mt19937_64 random(33);
  std::uniform_real_distribution<double> place(-3.0, 3.0), angle(-7.0, 7.0), part(0.05, 1.0);
  for (const int count : {1, 16, 17, 100})
    for (int i = 0; i < 200; ++i) {
      ThinWalls walls;
      std::vector<Site> arcs;
      for (int k = 0; k < count; ++k) {
        arcs.push_back(arc({place(random), place(random)}, 2.0 * part(random), angle(random),
                           0.5 * std::numbers::pi * part(random)));
        walls.add(arcs.back(), k);
      }
      const Vec2 p(place(random), place(random));
      const Box clear = walls.clear_around(p);
      for (const Site& wall : arcs)
        for (int m = 0; m <= 100; ++m) {
          const Vec2 spoke = wall.a - wall.center;
          const double by = 0.01 * m * wall.sweep;
          const Vec2 on_wall = wall.center + Vec2(std::cos(by) * spoke.x() - std::sin(by) * spoke.y(),
                                                  std::sin(by) * spoke.x() + std::cos(by) * spoke.y());
          ASSERT_FALSE((on_wall.array() > clear.low.array() + 1e-12).all() &&
                       (on_wall.array() < clear.high.array() - 1e-12).all())
              << count << " walls, " << i;
        }
    }
}

// The same as walls that are written down as often as they are looked at.
TEST(ThinWalls, WhereThePlaneRepeatsImagesAreWalls) {
  std::mt19937_64 random(34);
  std::uniform_real_distribution<double> place(-1.0, 3.0), far(-9.0, 9.0), part(0.05, 1.0), angle(-7.0, 7.0);
  int through = 0;
  for (const Vec2& size : {Vec2(2.0, 1.5), Vec2(2.0, 0.0), Vec2(0.0, 1.5)})
    for (int i = 0; i < 2000; ++i) {
      ThinWalls repeated(Periods{size}), written;
      for (int k = 0; k < 3; ++k) {
        const Vec2 at(place(random), place(random));
        const Site wall = k == 0 ? arc(at, part(random), angle(random), 1.5 * part(random))
                                 : segment(at, at + Vec2(part(random), -part(random)));
        repeated.add(wall, k);
        const auto moved = [&](const Vec2& by) {
          Site image = wall;
          image.a += by;
          image.b += by;
          image.center += by;
          return image;
        };
        for (int right = size.x() > 0.0 ? -10 : 0; right <= (size.x() > 0.0 ? 10 : 0); ++right)
          for (int up = size.y() > 0.0 ? -12 : 0; up <= (size.y() > 0.0 ? 12 : 0); ++up)
            written.add(moved({right * size.x(), up * size.y()}), k);
      }
      const Vec2 p(far(random), far(random)), q = p + 0.3 * Vec2(far(random), far(random)) / 9.0;
      const auto found = repeated.crossed(straight(p, q), 0.0, 1.0);
      // of several that are crossed any may be named
      EXPECT_EQ(found.has_value(), written.crossed(straight(p, q), 0.0, 1.0).has_value()) << i;
      through += found.has_value();
      const Box clear = repeated.clear_around(p);
      if (clear.contains(q)) {
        EXPECT_FALSE(found) << i;
      }
    }
  EXPECT_GT(through, 150);
}

TEST(ThinWalls, AWayPastEndlessImagesIsNotJudged) {
  ThinWalls walls(Periods{Vec2(1.0, 1.0)});
  walls.add(segment({0.0, 0.0}, {0.5, 0.0}), 0);
  EXPECT_FALSE(walls.crossed(straight({0.2, -0.5}, {1e9, 1e9}), 0.0, 1.0));
}

}  // namespace
}  // namespace brink::thin_walls_test
