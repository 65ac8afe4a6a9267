#include "brink/core/base/extended.h"

#include <gtest/gtest.h>

#include <random>

namespace brink::extended_test {
namespace {

BodyState random_state(std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> any(-size, size);
  return {{{any(random), any(random)}, any(random)}, {{any(random), any(random)}, any(random)}};
}

void expect_same(const BodyState& a, const BodyState& b) {
  EXPECT_EQ(a.pose.position, b.pose.position);
  EXPECT_EQ(a.pose.angle, b.pose.angle);
  EXPECT_EQ(a.twist.velocity, b.twist.velocity);
  EXPECT_EQ(a.twist.omega, b.twist.omega);
}

TEST(ExtendedState, IsItsRoundingAndWhatThatLeavesOver) {
  std::mt19937_64 random(20261124);
  for (int i = 0; i < 1000; ++i) {
    const BodyState high = random_state(random, 1e3), low = random_state(random, 1e-14);
    const ExtendedState both(high, low);
    expect_same(ExtendedState(both.rounded(), both.low()).rounded(), both.rounded());
    expect_same(ExtendedState(both.rounded(), both.low()).low(), both.low());
    // low parts that are more than a rounding are carried over, exactly
    EXPECT_EQ(both.position.x(), Real(high.pose.position.x()) + low.pose.position.x());
    EXPECT_EQ(both.twist.omega, Real(high.twist.omega) + low.twist.omega);
  }
}

TEST(ExtendedState, SeenFromNearbyLosesNothingFarAwayAfterManyTurns) {
  const Real turns = Real(2.0e9) * 2.0 * std::numbers::pi;  // of a turn in double: its low part is left over
  ExtendedState s;
  s.position = RealVec(Real(1e9) + 1e-9, Real(-1e9) + 2e-9);
  s.angle = turns + 0.25;
  const BodyState seen = s.seen_from(Vec2(1e9, -1e9));
  EXPECT_NEAR(seen.pose.position.x(), 1e-9, 1e-24);
  EXPECT_NEAR(seen.pose.position.y(), 2e-9, 1e-24);
  const SineCosine<Real> exact = sine_cosine(s.angle);
  EXPECT_NEAR(std::sin(seen.pose.angle), exact.sine.high(), 1e-15);
  EXPECT_NEAR(std::cos(seen.pose.angle), exact.cosine.high(), 1e-15);
}

TEST(ExtendedRotation, KeepsLengthsAndAddsUp) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-10.0, 10.0);
  for (int i = 0; i < 1000; ++i) {
    const Real a = any(random), b = any(random);
    const RealVec d(any(random), any(random));
    const RealVec twice = ExtendedRotation(a) * (ExtendedRotation(b) * d), once = ExtendedRotation(a + b) * d;
    EXPECT_LE((twice - once).norm(), Real(0x1p-79));
    EXPECT_LE(abs(once.norm() - d.norm()), Real(0x1p-79));
  }
}

TEST(ExtendedRotation, ByNothingIsNone) {
  EXPECT_EQ(ExtendedRotation(0).cosine, 1);
  EXPECT_EQ(ExtendedRotation(0).sine, 0);
  EXPECT_EQ(ExtendedRotation(0) * RealVec(2, 3), RealVec(2, 3));
}

}  // namespace
}  // namespace brink::extended_test
