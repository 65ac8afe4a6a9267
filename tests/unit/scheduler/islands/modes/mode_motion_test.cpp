// Motions with contacts that last, whose answers are known in closed form.
#include "brink/scheduler/islands/modes/mode_motion.h"

#include <gtest/gtest.h>

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <numbers>

#include "tests/unit/scheduler/islands/modes/mode_scenes.h"

namespace brink::mode_motion_test {
namespace {

constexpr double kPi = std::numbers::pi;

ModeLimits limits(double tolerance) {
  ModeLimits l;
  l.tolerance = tolerance;
  l.gap_tolerance = 1e-9;
  return l;
}

// ---- inclines: a box on two corners, whose friction is redundant

TEST(ModeMotion, BoxOnAnInclineSticksWhereFrictionSuffices) {
  const double angle = 20 * kPi / 180;  // tan: .363970
  for (const double mu : {0.3640, 0.5, 2.0}) {
    const ModeLog log = follow(box_on_incline(0.5, 0.25, angle, mu), 2.0, limits(1e-10));
    ASSERT_EQ(log.time, 2.0) << mu;
    const Vec2 at = 0.25 * Vec2(-std::sin(angle), std::cos(angle));
    EXPECT_NEAR((log.states[0].pose.position - at).norm(), 0.0, 1e-15) << mu;
    EXPECT_LT(log.states[0].twist.velocity.norm(), 1e-15) << mu;
  }
}

TEST(ModeMotion, BoxOnAnInclineSlidesWhereItDoesNot) {
  const double angle = 20 * kPi / 180;
  for (const double mu : {0.3639, 0.2, 0.0}) {
    const ModeLog log = follow(box_on_incline(0.5, 0.25, angle, mu), 2.0, limits(1e-10));
    ASSERT_EQ(log.time, 2.0) << mu;
    const double a = kGravity * (std::sin(angle) - mu * std::cos(angle));
    const Vec2 down(-std::cos(angle), -std::sin(angle));
    EXPECT_NEAR(log.states[0].pose.position.dot(down), 0.5 * a * 4, 1e-12) << mu;
    EXPECT_NEAR(log.states[0].twist.velocity.dot(down), 2 * a, 1e-12) << mu;
    EXPECT_LT(log.worst_gap, 1e-13) << mu;
  }
}

TEST(ModeMotion, SlidingBlockStopsWhereAndWhenItMust) {
  const double mu = 0.3, v = 2.0;
  const ModeLog log = follow(box_on_incline(0.5, 0.25, 0, mu, {{v, 0}, 0}), 2.0, limits(1e-10));
  ASSERT_EQ(log.time, 2.0);
  ASSERT_EQ(log.changes.size(), 2U);
  EXPECT_NEAR(log.changes[1].time, v / (mu * kGravity), 1e-12);
  EXPECT_EQ(log.changes[1].modes[0], MotionMode::stick);
  EXPECT_EQ(log.changes[1].modes[1], MotionMode::stick);
  EXPECT_NEAR(log.states[0].pose.position.x(), v * v / (2 * mu * kGravity), 1e-12);
}

TEST(ModeMotion, BlockThrownUpAnInclineTurnsBackWhereFrictionDoesNotHold) {
  const double angle = 0.5, mu = 0.3, v = 2.0;
  const Vec2 up(std::cos(angle), std::sin(angle));
  const ModeLog log = follow(box_on_incline(0.5, 0.25, angle, mu, {v * up, 0}), 1.0, limits(1e-10));
  const double rising = kGravity * (std::sin(angle) + mu * std::cos(angle)),
               falling = kGravity * (std::sin(angle) - mu * std::cos(angle));
  ASSERT_EQ(log.changes.size(), 2U);
  EXPECT_NEAR(log.changes[1].time, v / rising, 1e-12);
  const double down = 1.0 - v / rising;
  const double place = v * v / (2 * rising) - 0.5 * falling * down * down;
  EXPECT_NEAR(log.states[0].pose.position.dot(up), place, 1e-12);
}

// ---- discs

/// A disc of radius r, 1 kg, on a line through the origin inclined by `angle`.
ModeScene disc_on_incline(double r, double inertia, double angle, double mu, const Twist& twist = {}) {
  ModeScene s;
  const Vec2 n(-std::sin(angle), std::cos(angle));
  s.add_body(1.0, inertia, {{r * n, 0}, twist});
  const int plane = s.add_still();
  s.add(point_on_line({0, 0}, {0, 0}, n, r), 0, plane, mu);
  return s;
}

// Inertia k m r^2: rolls while mu (1 + 1/k) >= tan; a disc has k = 1/2, a ring 1.
TEST(ModeMotion, DiscAndRingRollOrSlipDownAnInclineByThreeMuAndTwoMu) {
  const double r = 0.3, angle = 0.6;
  const Vec2 down(-std::cos(angle), -std::sin(angle));
  for (const double k : {0.5, 1.0})
    for (const double part : {0.9, 0.999, 1.001, 1.1}) {  // of the friction at which it just rolls
      const double mu = part * std::tan(angle) / (1 + 1 / k);
      const ModeLog log = follow(disc_on_incline(r, k * r * r, angle, mu), 1.0, limits(1e-10));
      const bool rolls = part > 1;
      const double a =
          rolls ? kGravity * std::sin(angle) / (1 + k) : kGravity * (std::sin(angle) - mu * std::cos(angle));
      const double spin = rolls ? a / r : mu * kGravity * std::cos(angle) / (k * r);
      EXPECT_NEAR(log.states[0].pose.position.dot(down), 0.5 * a, 1e-12) << k << " " << part;
      EXPECT_NEAR(log.states[0].pose.angle, 0.5 * spin, 1e-11) << k << " " << part;
    }
}

TEST(ModeMotion, SlidingDiscRollsFromTwoSeventhsOfItsStoppingTime) {
  const double mu = 0.2, v = 3.0, r = 0.5;
  const ModeLog log = follow(disc_on_incline(r, 0.5 * r * r, 0, mu, {{v, 0}, 0}), 2.0, limits(1e-10));
  ASSERT_EQ(log.changes.size(), 2U);
  const double when = v / (3 * mu * kGravity);
  EXPECT_NEAR(log.changes[1].time, when, 1e-12);
  EXPECT_NEAR(log.changes[1].states[0].pose.position.x(), 5 * v * v / (18 * mu * kGravity), 1e-12);
  EXPECT_NEAR(log.states[0].pose.position.x(), 5 * v * v / (18 * mu * kGravity) + 2 * v / 3 * (2.0 - when),
              1e-12);
}

/// A disc that rolls in a bowl is a pendulum: (1 + k)(R - r) phi'' = -g sin phi.
double bowl_angle(double t, double phi0, double rate) {
  const double k = std::sin(phi0 / 2), quarter = boost::math::ellint_1(k);
  return 2 * std::asin(k * boost::math::jacobi_sn(k, quarter - rate * t));
}

ModeScene disc_in_bowl(double R, double r, double phi, double mu) {
  ModeScene s;
  s.add_body(1.0, 0.5 * r * r, {{(R - r) * Vec2(std::sin(phi), -std::cos(phi)), 0}, {}});
  const int bowl = s.add_still();
  s.add(in_bowl(r, R), 0, bowl, mu);
  return s;
}

TEST(ModeMotion, DiscRollsInABowlToTheToleranceAsked) {
  const double R = 2, r = 0.25, phi = kPi / 3, rate = std::sqrt(2.0 / 3 * kGravity / (R - r));
  std::vector<double> errors;
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    const ModeLog log = follow(disc_in_bowl(R, r, phi, 1.0), 5.0, limits(tolerance));
    ASSERT_EQ(log.time, 5.0);
    const Vec2 at = log.states[0].pose.position;
    errors.push_back(std::abs(std::atan2(at.x(), -at.y()) - bowl_angle(5.0, phi, rate)));
    EXPECT_LT(errors.back(), 100 * tolerance + 1e-12) << tolerance;
    EXPECT_LT(log.worst_gap, 1e-9) << tolerance;
  }
  const double slope = std::log10(errors[1] / errors[3]) / 4;  // at 1e-6 its gap keeps the steps short
  EXPECT_GT(slope, 0.8);                                       // a decade of tolerance is a decade of error
}

// With little friction it slips where the bowl is steep and rolls where it is flat; energy goes into the slip alone.
TEST(ModeMotion, DiscInABowlSlipsAtTheEndsAndRollsBetween) {
  const double R = 2, r = 0.25;
  std::vector<double> at;
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const ModeLog log = follow(disc_in_bowl(R, r, kPi / 3, 0.15), 5.0, limits(tolerance));
    ASSERT_EQ(log.time, 5.0);
    EXPECT_GE(log.changes.size(), 6U);
    at.push_back(log.states[0].pose.position.x());
  }
  EXPECT_NEAR(at[0], at[2], 1e-4);
  EXPECT_NEAR(at[1], at[2], 1e-6);
}

// ---- a rod of length 2 l slides down a wall: it leaves where cos th = 2/3 cos th0

/// From th0 at rest to th, with th'^2 = 3 g / (2 l) (cos th0 - cos th); th = th0 + (th1 - th0) s^2 takes the root
/// away. Simpson's rule.
double sliding_time(double l, double th0, double th1) {
  const auto f = [&](double s) {
    const double d = th1 - th0, th = th0 + d * s * s;
    if (s == 0) return 2 * std::sqrt(d) / std::sqrt(1.5 * kGravity / l * std::sin(th0));
    return 2 * d * s / std::sqrt(1.5 * kGravity / l * (std::cos(th0) - std::cos(th)));
  };
  const int n = 20000;
  double sum = f(0) + f(1);
  for (int i = 1; i < n; ++i) sum += (i % 2 ? 4 : 2) * f(static_cast<double>(i) / n);
  return sum / (3.0 * n);
}

TEST(ModeMotion, RodLeavesTheWallWhereTwoThirdsOfItsHeightAreLeft) {
  const double l = 0.5, th0 = 20 * kPi / 180, th1 = std::acos(2.0 / 3 * std::cos(th0));
  const double when = sliding_time(l, th0, th1);
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    ModeScene s;
    s.add_body(1.0, 1.0 / 12, {{{l * std::sin(th0), l * std::cos(th0)}, th0}, {}});
    const int room = s.add_still();
    s.add(point_on_line({0, -l}, {0, 0}, {0, 1}), 0, room, 0.0);
    s.add(point_on_line({0, l}, {0, 0}, {1, 0}), 0, room, 0.0);
    const ModeLog log = follow(s, 1.1 * when, limits(tolerance));
    ASSERT_EQ(log.changes.size(), 2U) << tolerance;
    EXPECT_NEAR(log.changes[1].time, when, 10 * tolerance + 1e-11) << tolerance;
    EXPECT_NEAR(log.changes[1].states[0].pose.angle, th1, 10 * tolerance + 1e-11) << tolerance;
    EXPECT_EQ(log.changes[1].modes[1], MotionMode::open);
    EXPECT_EQ(log.changes[1].modes[0], MotionMode::smooth);
    EXPECT_EQ(log.time, 1.1 * when);
  }
}

// ---- moving supports

TEST(ModeMotion, BlockOnABeltReachesItsSpeedAndStaysOnIt) {
  const double mu = 0.4, belt = 1.5;
  ModeScene s = box_on_incline(0.5, 0.25, 0, mu);
  s.problem.supports[0] = Motion::ballistic(0, {{}, {{belt, 0}, 0}}, {});
  const ModeLog log = follow(s, 2.0, limits(1e-10));
  ASSERT_EQ(log.changes.size(), 2U);
  const double when = belt / (mu * kGravity);
  EXPECT_NEAR(log.changes[1].time, when, 1e-12);
  EXPECT_NEAR(log.states[0].pose.position.x(), 0.5 * belt * when + belt * (2.0 - when), 1e-12);
  EXPECT_NEAR(log.states[0].twist.velocity.x(), belt, 1e-14);
}

// A floor that accelerates upward presses with m (g + a), and friction grows with it.
TEST(ModeMotion, BlockInALiftIsHeldDownByItsAcceleration) {
  const double mu = 0.3, a = 2.0, v = 3.0;
  ModeScene s = box_on_incline(0.5, 0.25, 0, mu, {{v, 0}, 0});
  s.problem.supports[0] = Motion::ballistic(0, {}, {{0, a}, 0});
  const ModeLog log = follow(s, 0.5, limits(1e-10));
  EXPECT_NEAR(log.states[0].twist.velocity.x(), v - mu * (kGravity + a) * 0.5, 1e-12);
  EXPECT_NEAR(log.states[0].pose.position.y(), 0.25 + 0.5 * a * 0.25, 1e-12);
}

// A table whose fall begins at g and grows beyond leaves what stands on it when it falls faster than g: at once.
TEST(ModeMotion, BlockIsLeftByATableThatFallsFasterThanItself) {
  ModeScene s = box_on_incline(0.5, 0.25, 0, 0.3);
  PolynomialPiece fall;  // y'' = -2 g t / 0.5: g at t = 0.25
  fall.end = 1.0;
  fall.degree = 3;
  fall.c[3] = {0, -4 * kGravity / 6, 0};
  const auto track = std::make_shared<Track>();
  track->pieces.push_back(fall);
  s.problem.supports[0] = Motion::dense(track);
  const ModeLog log = follow(s, 0.5, limits(1e-10));
  ASSERT_EQ(log.changes.size(), 2U);
  EXPECT_NEAR(log.changes[1].time, 0.25, 1e-11);
  const double v = -4 * kGravity / 2 * 0.0625, y = 0.25 - 4 * kGravity / 6 * 0.015625;
  EXPECT_NEAR(log.states[0].pose.position.y(), y + 0.25 * v - 0.5 * kGravity * 0.0625, 1e-11);
}

// ---- several bodies

// A block slides on a plank that slides freely: momentum is shared when they have one velocity.
TEST(ModeMotion, BlockOnAPlankAndThePlankComeToOneVelocity) {
  const double mu = 0.25, v = 2.0, m = 1.0, M = 3.0;
  ModeScene s;
  s.add_body(m, 0.1, {{{0, 0.45}, 0}, {{v, 0}, 0}});
  s.add_body(M, 5.0, {{{0, 0.1}, 0}, {}});
  const int floor = s.add_still();
  for (const double x : {-0.25, 0.25}) s.add(point_on_line({x, -0.25}, {0, 0.1}, {0, 1}), 0, 1, mu);
  for (const double x : {-4.0, 4.0}) s.add(point_on_line({x, -0.1}, {0, 0}, {0, 1}), 1, floor, 0.0);
  const ModeLog log = follow(s, 1.0, limits(1e-10));
  const double when = v / (mu * kGravity * (1 + m / M));
  ASSERT_EQ(log.changes.size(), 2U);
  EXPECT_NEAR(log.changes[1].time, when, 1e-12);
  EXPECT_NEAR(log.states[0].twist.velocity.x(), m * v / (m + M), 1e-12);
  EXPECT_NEAR(log.states[1].twist.velocity.x(), m * v / (m + M), 1e-12);
  const double energy_to_heat = 0.5 * m * v * v - 0.5 * m * m * v * v / (m + M);
  const double way = (log.states[0].pose.position - log.states[1].pose.position).x();
  EXPECT_NEAR(way * mu * m * kGravity, energy_to_heat, 1e-12);
}

// The same contacts ten times over change nothing but who carries how much.
TEST(ModeMotion, ContactsThatAreThereTenTimesDoNoHarm) {
  const double angle = 0.5, mu = 0.3;
  ModeScene once = box_on_incline(0.5, 0.25, angle, mu), often = once;
  for (int n = 0; n < 9; ++n)
    for (int k = 0; k < 2; ++k) often.add(once.problem.contacts[k].shape, 0, 1, mu);
  const ModeLog a = follow(once, 1.0, limits(1e-10)), b = follow(often, 1.0, limits(1e-10));
  EXPECT_EQ(b.time, 1.0);
  EXPECT_NEAR((a.states[0].pose.position - b.states[0].pose.position).norm(), 0.0, 1e-12);
}

// ---- forces

// Pushed with a force that grows as F' t, a block on a floor begins to slide when it exceeds mu m g.
TEST(ModeMotion, BlockBeginsToSlideWhenTheForceExceedsItsFriction) {
  const double mu = 0.4, growth = 2.0;
  ModeScene s = box_on_incline(0.5, 0.25, 0, mu);
  s.problem.free = [=](double t, std::span<const BodyState>, std::span<Acceleration> out) {
    out[0] = {{growth * t, -kGravity}, 0.0};
  };
  const ModeLog log = follow(s, 4.0, limits(1e-10));
  ASSERT_EQ(log.changes.size(), 2U);
  const double when = mu * kGravity / growth, since = 4.0 - when;
  EXPECT_NEAR(log.changes[1].time, when, 1e-11);
  EXPECT_NEAR(log.states[0].pose.position.x(), growth * since * since * since / 6, 1e-9);
}

// On a spring and a floor without friction: a harmonic oscillator.
TEST(ModeMotion, BlockOnASpringSwingsAlongTheFloor) {
  const double k = 40.0;
  ModeScene s = box_on_incline(0.5, 0.25, 0, 0.0, {{1, 0}, 0});
  s.problem.free = [=](double, std::span<const BodyState> states, std::span<Acceleration> out) {
    out[0] = {{-k * states[0].pose.position.x(), -kGravity}, 0.0};
  };
  for (const double tolerance : {1e-8, 1e-10, 1e-12}) {
    const ModeLog log = follow(s, 3.0, limits(tolerance));
    EXPECT_NEAR(log.states[0].pose.position.x(), std::sin(std::sqrt(k) * 3.0) / std::sqrt(k),
                200 * tolerance);
  }
}

// ---- open contacts close

// Housner 1963: a block that rocks about its corners. From th0 at rest about one corner to flat.
TEST(ModeMotion, RockingBlockComesDownWhenItMust) {
  const double b = 0.1, h = 0.4, alpha = std::atan2(b, h), th0 = alpha / 2;
  for (const double tolerance : {1e-6, 1e-8, 1e-10, 1e-12}) {
    ModeScene s;
    const Vec2 corner(std::cos(-th0) * b + std::sin(-th0) * h, std::sin(-th0) * b - std::cos(-th0) * h);
    s.add_body(1.0, (4 * b * b + 4 * h * h) / 12, {{-corner, -th0}, {}});
    const int floor = s.add_still();
    s.add(point_on_line({b, -h}, {0, 0}, {0, 1}), 0, floor, 1.0);
    s.add(point_on_line({-b, -h}, {0, 0}, {0, 1}), 0, floor, 1.0, false);
    const ModeLog log = follow(s, 1.0, limits(tolerance));
    EXPECT_EQ(log.end, ModeEnd::arrival);
    EXPECT_NEAR(log.time, 0.312308575, 10 * tolerance + 1e-9) << tolerance;
    EXPECT_NEAR(log.states[0].pose.angle, 0.0, 1e-12) << tolerance;
  }
}

}  // namespace
}  // namespace brink::mode_motion_test
