/// Closed-form motions against their formulas, and the enclosures of polynomial pieces.
#include "brink/integrators/motion.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <new>

#include "brink/core/base/random.h"
#include "brink/integrators/dense_output.h"
#include "brink/integrators/integrator.h"
#include "tests/support/seeded_random.h"
#include "tests/unit/integrators/problems.h"

namespace brink::motion_test {
namespace {

using namespace problems;

const BodyState kThrown{{{0.3, -0.7}, 0.1}, {{2.5, 4.25}, -1.75}};

// The parabola is computed by the textbook formula in the textbook's order, so the bits are the formula's.
TEST(Ballistic, StateIsTheFormulaBitForBit) {
  const Acceleration a{{0.5, -9.81}, 0.3};
  const Motion motion = Motion::ballistic(1.0, kThrown, a);
  SeededRandom random(5);
  for (int i = 0; i < 1000; ++i) {
    const double t = random.uniform(1.0, 20.0), s = t - 1.0;
    const BodyState state = motion.state(t);
    EXPECT_EQ(state.pose.position.x(), 0.3 + s * (2.5 + 0.5 * s * 0.5));
    EXPECT_EQ(state.pose.position.y(), -0.7 + s * (4.25 + 0.5 * s * -9.81));
    EXPECT_EQ(state.pose.angle, 0.1 + s * (-1.75 + 0.5 * s * 0.3));
    EXPECT_EQ(state.twist.velocity.y(), 4.25 + s * -9.81);
    EXPECT_EQ(state.twist.omega, -1.75 + s * 0.3);
  }
  EXPECT_EQ(motion.end(), std::numeric_limits<double>::infinity());
}

// Known answer 3 without its floor: from height 10 a body has fallen 10 m at t = sqrt(20 / 9.81).
TEST(Ballistic, FallOfTenMetersTakesSqrtOfTwentyOverG) {
  const Motion motion = Motion::ballistic(0.0, {{{0.0, 10.0}, 0.0}, {}}, {{0.0, -9.81}, 0.0});
  EXPECT_NEAR(motion.pose(std::sqrt(20.0 / 9.81)).position.y(), 0.0, 1e-14);
}

TEST(Drag, StateIsTheExponentialFormula) {
  const Motion motion =
      Motion::drag(0.0, spinning_drag_state(0.0), {{0.0, kGravity}, 0.0}, kLinearDrag, kAngularDrag);
  for (double t = 0.0; t < 30.0; t += 0.37)
    EXPECT_LT(difference(motion.state(t), spinning_drag_state(t)), 1e-12) << t;
}

// Whatever its memory held before: who sets some coefficients leaves the others at 0.
TEST(Motion, APieceBeginsWithCoefficientsOfZero) {
  alignas(PolynomialPiece) std::array<std::byte, sizeof(PolynomialPiece)> memory;
  memory.fill(std::byte{0xff});
  const auto* const piece = new (memory.data()) PolynomialPiece;
  for (const Eigen::Vector3d& c : piece->c) EXPECT_TRUE(c.isZero(0.0));
}

// Of every kind of motion, against differences of its own twist.
TEST(Motion, RateIsTheDerivativeOfTheTwist) {
  PolynomialPiece piece;
  piece.end = 10.0;
  piece.degree = 4;
  for (int k = 0; k <= 4; ++k) piece.c[k] = Eigen::Vector3d(0.3 * k, 1 - k, 0.1) / (1 << k);
  const auto track = std::make_shared<Track>();
  track->pieces.push_back(piece);
  const auto drag = Motion::drag(0.0, kThrown, {{0.0, -9.81}, 1.0}, 0.5, 0.25);
  const auto parabola = Motion::ballistic(0.0, kThrown, {{0.5, -9.81}, 0.3});
  const auto chain = std::make_shared<const std::vector<Motion>>(std::vector{drag});
  for (const Motion& m : {parabola, drag, Motion::chain(chain), Motion::dense(track)})
    for (const double t : {0.5, 1.0, 3.0}) {
      const double h = 1e-5;
      const Twist before = m.twist(t - h), after = m.twist(t + h);
      EXPECT_LT((m.rate(t).linear - (after.velocity - before.velocity) / (2 * h)).norm(), 1e-8);
      EXPECT_NEAR(m.rate(t).angular, (after.omega - before.omega) / (2 * h), 1e-8);
    }
}

// As the drag goes to 0 the motion goes to the parabola: x = v s (1 - z/2) + a s^2 / 2 (1 - z/3) + O(z^2), z
// = k s.
TEST(Drag, WeakDragIsTheParabolaToFirstOrderAtEveryScale) {
  for (double k = 1e-18; k < 1e-5; k *= 7.0) {
    const Motion motion = Motion::drag(0.0, kThrown, {{0.0, -9.81}, 0.0}, k, k);
    const double s = 1.5, z = k * s;
    const double y = -0.7 + s * 4.25 * (1.0 - 0.5 * z) - 0.5 * 9.81 * s * s * (1.0 - z / 3.0);
    EXPECT_NEAR(motion.pose(s).position.y(), y, 20.0 * z * z + 1e-14) << "k = " << k;
  }
}

// The twist is the derivative of the pose across the point where the series hands over to the difference (z =
// 1/2).
TEST(Drag, TwistIsTheDerivativeOfThePose) {
  const Motion motion = Motion::drag(0.0, kThrown, {{1.0, -9.81}, 2.0}, 0.5, 0.25);
  for (double t = 0.1; t < 4.0; t += 0.01) {
    const double h = 1e-5;
    const Vec2 slope = (motion.pose(t + h).position - motion.pose(t - h).position) / (2.0 * h);
    EXPECT_LT((slope - motion.twist(t).velocity).norm(), 1e-9) << t;
  }
}

TEST(Drag, BoundsEncloseSampledRates) {
  const Motion motion = Motion::drag(0.0, kThrown, {{1.0, -9.81}, 2.0}, 0.5, 0.25);
  SeededRandom random(2);
  for (int i = 0; i < 300; ++i) {
    const double from = random.uniform(0.0, 10.0), to = from + random.uniform(0.0, 5.0);
    const MotionBounds b = motion.bounds(from, to);
    for (int j = 0; j < 10; ++j) {
      const Twist w = motion.twist(random.uniform(from, to));
      EXPECT_LE((w.velocity - b.velocity).norm(), b.velocity_radius + 1e-13);
      EXPECT_LE(std::abs(w.omega - b.omega), b.omega_radius + 1e-13);
      const Vec2 a = Vec2(1.0, -9.81) - 0.5 * w.velocity;
      EXPECT_LE((a - b.acceleration).norm(), b.acceleration_radius + 1e-13);
      EXPECT_LE(std::abs(2.0 - 0.25 * w.omega), b.alpha + 1e-13);
    }
  }
}

// Two freely falling bodies have no relative acceleration: centres are equal, radii 0.
TEST(Ballistic, BoundsOfTwoFallingBodiesHaveNoRelativeAcceleration) {
  const Acceleration g{{0.0, -9.81}, 0.0};
  const MotionBounds a = Motion::ballistic(0.0, kThrown, g).bounds(0.0, 3.0);
  const MotionBounds b = Motion::ballistic(0.5, {}, g).bounds(0.5, 3.0);
  EXPECT_EQ(a.acceleration, b.acceleration);
  EXPECT_EQ(a.acceleration_radius + b.acceleration_radius, 0.0);
}

// Random polynomials of every degree: the enclosure must hold at random points, and be exact for a point
// interval.
TEST(PolynomialPiece, BoundsEncloseRandomPolynomials) {
  const std::uint64_t seed = 17;
  Random random(seed);
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  for (int i = 0; i < 2000; ++i) {
    PolynomialPiece piece;
    piece.degree = static_cast<int>(random.below(PolynomialPiece::kMaxDegree + 1));
    piece.begin = 0.0;
    piece.end = 1.0;
    piece.origin = random.uniform(-0.5, 1.5);
    for (int k = 0; k <= piece.degree; ++k)
      for (int j = 0; j < 3; ++j) piece.c[k][j] = random.uniform(-1.0, 1.0);
    const double from = random.uniform(), to = random.uniform(from, 1.0);
    const MotionBounds b = piece.bounds(from, to);
    for (int j = 0; j < 10; ++j) {
      const double t = random.uniform(from, to), s = t - piece.origin;
      const Twist w = piece.state(t).twist;
      Eigen::Vector3d second = Eigen::Vector3d::Zero();
      for (int k = 2; k <= piece.degree; ++k) second += k * (k - 1) * std::pow(s, k - 2) * piece.c[k];
      ASSERT_LE((w.velocity - b.velocity).norm(), b.velocity_radius + 1e-10);
      ASSERT_LE(std::abs(w.omega - b.omega), b.omega_radius + 1e-10);
      ASSERT_LE((second.head<2>() - b.acceleration).norm(), b.acceleration_radius + 1e-9);
      ASSERT_LE(std::abs(second.z()), b.alpha + 1e-9);
    }
  }
}

// With a thrust from 0.3 to 0.55 the closed form is a chain of three parabolas: x(0.55) = 5/32, then 1.25 m/s
// for ever.
// A step of some hundred roundings of the clock: what the clock rounds of a fast body's way is no acceleration.
TEST(DenseOutput, ATinyStepOfAFastBodyHasTheAccelerationOfItsEnds) {
  SeededRandom random(11);
  for (int i = 0; i < 2000; ++i) {
    const double begin = random.uniform(0.01, 100.0), rounding = begin * 2.2e-16;
    const double h = rounding * random.uniform(20.0, 2000.0), end = begin + h;
    const auto any = [&](double most) {
      return Vec2(random.uniform(-most, most), random.uniform(-most, most));
    };
    const Acceleration a{any(1000.0), random.uniform(-1000.0, 1000.0)};
    const BodyState from{{any(2.0), random.uniform(-2.0, 2.0)}, {any(500.0), random.uniform(-500.0, 500.0)}};
    // as the solver steps, which does not round its own h
    BodyState to = from;
    to.pose.position += h * from.twist.velocity;
    to.pose.angle += h * from.twist.omega;
    to.twist.velocity += h * a.linear;
    to.twist.omega += h * a.angular;
    for (const PolynomialPiece& piece :
         {quintic_piece(begin, from, a, end, to, a), cubic_piece(begin, from, end, to)}) {
      const MotionBounds b = piece.bounds(begin, end);
      // twists are rounded as well, by some 1e-13 m/s
      const double of_twists = 8.0 * 2.2e-16 * 700.0 / h;
      EXPECT_LT(b.acceleration.norm() + b.acceleration_radius, 2.0e4 + 20.0 * of_twists) << i;
      EXPECT_LT(b.alpha, 2.0e4 + 20.0 * of_twists) << i;
    }
  }
}

TEST(ClosedForm, ThrustMakesAChainThatReachesInfinity) {
  const auto integrator = make_integrator("auto", std::make_shared<Thrusted>(0.3, 0.55, true), {});
  integrator->start(0.0, std::vector<BodyState>{{}});
  EXPECT_EQ(integrator->extend(0.1).end, 0.3);
  const Motion motion = integrator->motion(0);
  EXPECT_EQ(motion.begin(), 0.0);
  EXPECT_EQ(motion.end(), 0.3);
  EXPECT_EQ(integrator->extend(10.0).end, std::numeric_limits<double>::infinity());
  EXPECT_EQ(motion.end(), std::numeric_limits<double>::infinity()) << "motions grow with the chain";
  EXPECT_FALSE(motion.is_ballistic());
  EXPECT_NEAR(motion.pose(0.55).position.x(), 5.0 / 32.0, 1e-15);
  EXPECT_NEAR(motion.pose(10.55).position.x(), 5.0 / 32.0 + 12.5, 1e-13);
  EXPECT_NEAR(motion.pose(2.0).position.y(), -2.0 * 9.81, 1e-13);
  const MotionBounds b = motion.bounds(0.2, 0.7);
  EXPECT_LE((Vec2(5.0, kGravity) - b.acceleration).norm(), b.acceleration_radius + 1e-12);
  EXPECT_LE((Vec2(0.0, kGravity) - b.acceleration).norm(), b.acceleration_radius + 1e-12);
}

}  // namespace
}  // namespace brink::motion_test
