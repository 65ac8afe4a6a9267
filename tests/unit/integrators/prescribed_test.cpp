/// Prescribed motion against the functions it stands for.
#include "brink/integrators/prescribed.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <stdexcept>

#include "brink/core/base/error.h"
#include "brink/core/base/random.h"
#include "brink/core/world/formula.h"
#include "tests/support/seeded_random.h"

namespace brink::prescribed_test {
namespace {

using Eigen::Vector3d;

/// The motion of three formulas of t; `calls`, if given, counts how often it is evaluated.
PrescribedMotion prescribed(const char* x, const char* y = "0", const char* angle = "0",
                            const char* name = "test", int* calls = nullptr,
                            const Vector3d& base = Vector3d::Zero()) {
  const std::array<Formula, 3> of{Formula(x, {"t"}), Formula(y, {"t"}), Formula(angle, {"t"})};
  const auto value = [](const Formula& f, double t) { return f(std::span<const double>(&t, 1)); };
  return PrescribedMotion(
      base,
      [=](double t) {
        if (calls) ++*calls;
        return Vector3d(value(of[0], t), value(of[1], t), value(of[2], t));
      },
      [=](int i, double from, double to, BoundOf all) { return of[i].time_bound(0, from, to, all); }, name);
}

struct Deviation {
  double pose = 0.0, twist = 0.0;
};
/// Largest difference from x(t), vx(t) at random times in [from, to].
template <class X, class V>
Deviation deviation(const Motion& motion, double from, double to, X x, V v, std::uint64_t seed = 1) {
  Random random(seed);
  Deviation worst;
  for (int i = 0; i < 20000; ++i) {
    const double t = random.uniform(from, to);
    worst.pose = std::max(worst.pose, std::abs(motion.pose(t).position.x() - x(t)));
    worst.twist = std::max(worst.twist, std::abs(motion.twist(t).velocity.x() - v(t)));
  }
  return worst;
}

// 0.1 sin(6 t): its derivative is 0.6 cos(6 t). Rounding of values of 0.1 is 1.4e-17; 1e-14 leaves room for
// the sums.
TEST(Prescribed, SineIsFollowedToRounding) {
  PrescribedMotion motion = prescribed("0.1 * sin(6 * t)", "0", "cos(t)");
  ASSERT_EQ(motion.extend(50.0).status, Extent::Status::reached);
  const Deviation d = deviation(
      motion.motion(), 0.0, 50.0, [](double t) { return 0.1 * std::sin(6 * t); },
      [](double t) { return 0.6 * std::cos(6 * t); });
  std::printf("0.1 sin(6 t) over 50 s: pose %.2e m, twist %.2e m/s\n", d.pose, d.twist);
  EXPECT_LT(d.pose, 1e-14);
  EXPECT_LT(d.twist, 1e-11);
}

// A faster one 1 km away: the place is rounded by 1.1e-13 m; its rate by no more than near by, where Markov's
// inequality gives 2e-10 m/s for a fit to 1e-14 m in cells of 1/64 s.
TEST(Prescribed, FarBaseDoesNotBlurTheFit) {
  PrescribedMotion motion =
      prescribed("0.1 * sin(80 * t)", "0", "0", "test", nullptr, Vector3d(1000.0, 0.0, 0.0));
  ASSERT_EQ(motion.extend(50.0).status, Extent::Status::reached);
  const Deviation d = deviation(
      motion.motion(), 0.0, 50.0, [](double t) { return 1000.0 + 0.1 * std::sin(80 * t); },
      [](double t) { return 8.0 * std::cos(80 * t); });
  std::printf("1000 + 0.1 sin(80 t) over 50 s: pose %.2e m, twist %.2e m/s\n", d.pose, d.twist);
  EXPECT_LT(d.pose, 3e-13);
  EXPECT_LT(d.twist, 2e-10);
}

// A thousand times faster: cells are halved until they fit; the twist is of order 1000.
TEST(Prescribed, FastSineIsFollowedByHalvingCells) {
  PrescribedMotion motion = prescribed("sin(1000 * t)");
  ASSERT_EQ(motion.extend(2.0).status, Extent::Status::reached);
  const Deviation d = deviation(
      motion.motion(), 0.0, 2.0, [](double t) { return std::sin(1000 * t); },
      [](double t) { return 1000 * std::cos(1000 * t); });
  std::printf("sin(1000 t) over 2 s: pose %.2e m, twist %.2e m/s\n", d.pose, d.twist);
  EXPECT_LT(d.pose, 2e-12);
  EXPECT_LT(d.twist, 1e-6);
}

// At t near 10000 s a double holds the time to 1e-12 s, so the function itself is known to about 6e-13 only:
// the fit must accept that noise and not halve for ever.
TEST(Prescribed, NoiseOfLargeTimesIsAccepted) {
  int calls = 0;
  PrescribedMotion motion = prescribed("sin(6 * t)", "0", "0", "test", &calls);
  ASSERT_EQ(motion.extend(10000.0).status, Extent::Status::reached);
  EXPECT_LT(calls, 30 * 16 * 10010) << "less than 30 calls a cell of 1/16 s: hardly any was halved";
  const Deviation d = deviation(
      motion.motion(), 9990.0, 10000.0, [](double t) { return std::sin(6 * t); },
      [](double t) { return 6 * std::cos(6 * t); });
  std::printf("sin(6 t) near 10000 s: pose %.2e m, twist %.2e m/s\n", d.pose, d.twist);
  EXPECT_LT(d.pose, 5e-11);
  EXPECT_LT(d.twist, 1e-7);
}

// Pose and twist may not jump between neighbouring doubles; joins are at dyadic times, so those are tried one
// by one.
TEST(Prescribed, MotionIsContinuouslyDifferentiable) {
  PrescribedMotion motion = prescribed("sin(6 * t)", "abs(t - 0.3)", "exp(-t)");
  ASSERT_EQ(motion.extend(2.0).status, Extent::Status::reached);
  const Motion m = motion.motion();
  for (int i = 1; i < 2 * 4096; ++i) {
    const double t = i / 4096.0, before = std::nextafter(t, 0.0);
    const BodyState a = m.state(before), b = m.state(t);
    ASSERT_LT((a.pose.position - b.pose.position).norm(), 1e-14) << t;
    ASSERT_LT((a.twist.velocity - b.twist.velocity).norm(), 1e-11) << t;
    ASSERT_LT(std::abs(a.twist.omega - b.twist.omega), 1e-11) << t;
  }
}

// |t - 0.3| has its corner inside a cell, |t - 0.5| on the grid. Away from 2^-30 s around it the motion is
// exact; inside it the twist goes from -1 to 1 and the pose stays within 2^-30.
TEST(Prescribed, CornersAreRoundedOffWithinTheSmallestCell) {
  for (double corner : {0.3, 0.5}) {
    PrescribedMotion motion = prescribed(corner == 0.3 ? "abs(t - 0.3)" : "abs(t - 0.5)");
    ASSERT_EQ(motion.extend(1.0).status, Extent::Status::reached);
    const Motion m = motion.motion();
    EXPECT_NEAR(m.twist(corner - 2e-9).velocity.x(), -1.0, 1e-6);
    EXPECT_NEAR(m.twist(corner + 2e-9).velocity.x(), 1.0, 1e-6);
    EXPECT_NEAR(m.pose(corner).position.x(), 0.0, 1e-9);
    const Deviation d = deviation(
        m, 0.0, corner - 1e-8, [=](double t) { return std::abs(t - corner); }, [](double) { return -1.0; });
    EXPECT_LT(d.pose, 1e-14);
    EXPECT_LT(d.twist, 1e-6);
    const MotionBounds b = m.bounds(0.0, 1.0);
    EXPECT_GT(b.acceleration_radius + b.acceleration.norm(), 1e8)
        << "the enclosure must own up to the corner";
  }
}

// Pieces may not depend on how far the motion was asked, not one bit.
TEST(Prescribed, ManySmallAsksGiveTheBitsOfOneBigAsk) {
  PrescribedMotion big = prescribed("sin(7 * t)", "abs(sin(3 * t))", "t * t");
  PrescribedMotion small = prescribed("sin(7 * t)", "abs(sin(3 * t))", "t * t");
  big.extend(5.0);
  SeededRandom random(4);
  for (double t = 0.0; t < 5.0; t += random.uniform(0.0, 0.03)) small.extend(t);
  small.extend(5.0);
  EXPECT_EQ(big.motion().end(), small.motion().end());
  for (int i = 0; i < 5000; ++i) {
    const double t = random.uniform(0.0, 5.0);
    const BodyState a = big.motion().state(t), b = small.motion().state(t);
    ASSERT_EQ(a.pose.position, b.pose.position);
    ASSERT_EQ(a.twist.velocity, b.twist.velocity);
    ASSERT_EQ(a.pose.angle, b.pose.angle);
  }
}

TEST(Prescribed, ConstantAndPolynomialAreExactAndCheap) {
  int calls = 0;
  PrescribedMotion motion = prescribed("1.5", "2.0 * t", "t * t", "test", &calls);
  ASSERT_EQ(motion.extend(1.0).status, Extent::Status::reached);
  EXPECT_LE(calls, 18 * 21);
  const Motion m = motion.motion();
  for (double t = 0.0; t < 1.0; t += 0.01) {
    EXPECT_NEAR(m.pose(t).position.x(), 1.5, 1e-14);
    EXPECT_NEAR(m.twist(t).velocity.x(), 0.0, 1e-11);
    EXPECT_NEAR(m.twist(t).velocity.y(), 2.0, 1e-11);
    EXPECT_NEAR(m.twist(t).omega, 2.0 * t, 1e-11);
  }
}

// 1/1 before t = 0.7, 1/0 behind: the motion ends within the smallest cell of 2^-30 s before that, and says
// so.
TEST(Prescribed, ValueThatIsNotFiniteFailsAndIsLocated) {
  PrescribedMotion motion = prescribed("1.0 / (t < 0.7 ? 1.0 : 0.0)", "0", "0", "site \"piston\"");
  Extent extent = motion.extend(0.5);
  EXPECT_EQ(extent.status, Extent::Status::reached);
  for (int i = 0; i < 2; ++i) {
    extent = motion.extend(2.0);
    EXPECT_EQ(extent.status, Extent::Status::failed);
    EXPECT_NEAR(extent.end, 0.7, 1e-8);
    EXPECT_THAT(extent.why, ::testing::HasSubstr("site \"piston\" is not finite near t = 0.69999"));
  }
  EXPECT_NEAR(motion.motion().pose(0.69).position.x(), 1.0, 1e-14);
}

TEST(Prescribed, JumpOfTheValueFailsAndIsLocated) {
  for (double jump : {0.25, 0.7}) {  // on the grid and between
    PrescribedMotion motion =
        prescribed(jump == 0.25 ? "t < 0.25 ? 0 : 1" : "t < 0.7 ? 0 : 1", "0", "0", "site \"step\"");
    const Extent extent = motion.extend(2.0);
    EXPECT_EQ(extent.status, Extent::Status::failed);
    EXPECT_NEAR(extent.end, jump, 1e-8);
    EXPECT_THAT(extent.why, ::testing::HasSubstr("jumps"));
  }
}

// Whatever makes the jump, on the grid of cells, in the middle of one and at more of its places: bounds at that time alone are as wide
// as it jumps, and inside of the cell nothing is to be seen of it.
TEST(Prescribed, JumpsOnTheGridFailAndAreLocated) {
  const std::pair<const char*, double> jumps[] = {{"0.5 * rint(t)", 0.5},
                                                  {"-0.5 * rint(2 * t)", 0.25},
                                                  {"0.1 * rint(64 * t)", 0.0078125},
                                                  {"sign(t - 0.5)", 0.5},
                                                  {"t * sign(t - 0.3125)", 0.3125},
                                                  {"t - rint(2 * t) / 2", 0.25},
                                                  {"atan(tan(4 * pi * t))", 0.125},
                                                  {"atan2(sin(4 * pi * t), cos(4 * pi * t))", 0.25},
                                                  {"atan(1 / (t - 0.5))", 0.5},
                                                  {"t <= 0.75 ? sin(t) : 2", 0.75},
                                                  {"1e6 * sin(t) + rint(t)", 0.5}};
  for (const auto& [text, at] : jumps) {
    const Extent extent = prescribed(text).extend(2.0);
    EXPECT_EQ(extent.status, Extent::Status::failed) << text;
    EXPECT_NEAR(extent.end, at, 1e-8) << text;
    EXPECT_THAT(extent.why, ::testing::HasSubstr("jumps")) << text;
  }
}

// sqrt|t - 0.3| is infinitely fast at 0.3: no motion. |t - 0.3|^1.5 is not: its rate is 0 there.
TEST(Prescribed, InfiniteSpeedFailsAndSteepCurvatureDoesNot) {
  PrescribedMotion steep = prescribed("sqrt(abs(t - 0.3))");
  EXPECT_EQ(steep.extend(1.0).status, Extent::Status::failed);
  PrescribedMotion curved = prescribed("abs(t - 0.3)^1.5");
  const Extent extent = curved.extend(1.0);
  EXPECT_EQ(extent.status, Extent::Status::reached) << extent.why;
  const Deviation d = deviation(
      curved.motion(), 0.0, 1.0, [](double t) { return std::pow(std::abs(t - 0.3), 1.5); },
      [](double t) { return std::copysign(1.5 * std::sqrt(std::abs(t - 0.3)), t - 0.3); });
  std::printf("|t - 0.3|^1.5 over 1 s: pose %.2e m, twist %.2e m/s\n", d.pose, d.twist);
  EXPECT_LT(d.pose, 1e-12);
  EXPECT_LT(d.twist, 1e-5);
}

// 2 ms high at 0.7031 and zero elsewhere: it lives between the nodes of every larger cell.
TEST(Prescribed, ShortSpikesAreFollowed) {
  for (const char* spike : {"max(0, 0.3 - abs(t - 0.7031) * 300)", "0.3 * exp(-((t - 0.7031) / 0.0002)^2)"}) {
    PrescribedMotion motion = prescribed(spike);
    ASSERT_EQ(motion.extend(2.0).status, Extent::Status::reached) << spike;
    EXPECT_NEAR(motion.motion().pose(0.7031).position.x(), 0.3, 1e-6) << spike;
    EXPECT_NEAR(motion.motion().pose(0.6).position.x(), 0.0, 1e-15) << spike;
  }
}

// Corners of every kind are no jumps: |d/dt asin(sin(w t))| = w on both sides.
TEST(Prescribed, TrianglesAndOtherCornersAreFollowed) {
  const double w = 19.441694508615523;
  PrescribedMotion triangle = prescribed("asin(sin(19.441694508615523 * t))");
  ASSERT_EQ(triangle.extend(3.0).status, Extent::Status::reached);
  const Deviation d = deviation(
      triangle.motion(), 0.0, 3.0, [=](double t) { return std::asin(std::sin(w * t)); },
      [=](double t) { return std::copysign(w, std::cos(w * t)); });
  EXPECT_LT(d.pose, 1e-7) << "the arc sine itself is that rough near 1";
  EXPECT_LT(d.twist, 1e-6);
  for (const char* corners : {"abs(sin(5 * t))", "max(sin(3 * t), cos(2 * t))", "t < 1 ? t : 2 - t",
                              "abs(t - rint(t))", "min(t, 1)", "sqrt((t - 0.4)^2)", "acos(cos(7 * t))"}) {
    const Extent extent = prescribed(corners).extend(2.0);
    EXPECT_EQ(extent.status, Extent::Status::reached) << corners << ": " << extent.why;
  }
}

// A corner anywhere in the narrowest cell, level on one side, beside jumps in the same places.
TEST(Prescribed, CornersOfMaximaAreFollowedWhereverTheyLie) {
  SeededRandom random(11);
  for (int k = 0; k < 100; ++k) {
    const double place = random.uniform(0.1, 1.9), slope = random.uniform(0.05, 5.0);
    for (const char* corner : {"{:.17g} * max(0, t - {:.17g})", "{:.17g} * min(0, t - {:.17g})",
                               "{:.17g} * max(0, sin(t - {:.17g}))"}) {
      const std::string text = fmt::format(fmt::runtime(corner), slope, place);
      const Extent extent = prescribed(text.c_str()).extend(2.0);
      EXPECT_EQ(extent.status, Extent::Status::reached) << text << ": " << extent.why;
    }
    const std::string jump = fmt::format("{:.17g} * (t > {:.17g})", slope, place);
    EXPECT_EQ(prescribed(jump.c_str()).extend(2.0).status, Extent::Status::failed) << jump;
  }
}

TEST(Prescribed, WhatJumpsIsRefusedWhereItDoes) {
  for (const char* jumps : {"rint(t - 0.2)", "sign(t - 0.7)", "t < 0.7 ? 0 : 1e-3", "atan(1 / (t - 0.7))",
                            "0.1 * (t > 0.7)", "asin(sin(t)) * (t < 0.7)"}) {
    const Extent extent = prescribed(jumps).extend(2.0);
    EXPECT_EQ(extent.status, Extent::Status::failed) << jumps;
    EXPECT_NEAR(extent.end, 0.7, 1e-8) << jumps;
    EXPECT_THAT(extent.why, ::testing::HasSubstr("jumps")) << jumps;
  }
}

// max(f, f) is f, but no interval arithmetic sees that two terms are one.
TEST(Prescribed, WhatCannotBeBoundedIsSaid) {
  const Extent extent = prescribed("max(sin(t), sin(t) + 0)").extend(2.0);
  EXPECT_EQ(extent.status, Extent::Status::failed);
  EXPECT_THAT(extent.why, ::testing::HasSubstr("cannot be bounded"));
}

TEST(Prescribed, InstalmentsAndForgettingChangeNothing) {
  PrescribedMotion whole = prescribed("sin(400 * t)"), parts = prescribed("sin(400 * t)");
  whole.extend(20.0);
  while (parts.extend(20.0, 100).status == Extent::Status::unfinished) parts.forget_before(10.0);
  for (double t = 10.0; t < 20.0; t += 0.01)
    ASSERT_EQ(whole.motion().pose(t).position.x(), parts.motion().pose(t).position.x());
  EXPECT_EQ(parts.motion().begin(), 0.0);
  EXPECT_THROW(parts.motion().pose(1.0), std::logic_error);
}

TEST(Prescribed, AskThatIsNotANumberIsRefused) {
  PrescribedMotion motion = prescribed("0");
  EXPECT_THROW(motion.extend(std::nan("")), BadInput);
}

}  // namespace
}  // namespace brink::prescribed_test
