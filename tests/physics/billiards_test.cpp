/// Billiards with closed forms: a circle's chords, a rectangle's unfolding, plates hit fast.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/support/worlds.h"

namespace brink::billiards_test {
namespace {

using testing::Events;

// A disc in a circular container, no forces: the angle between chord and wall stays, so foot n of the bounces
// is at th0 + n (pi - 2 b), b the angle between the path and the inward normal.
class CircularContainer : public ::testing::TestWithParam<double> {};

TEST_P(CircularContainer, FeetOfTenThousandBouncesAreEquallySpaced) {
  const double b = GetParam(), wall = 1.25, radius = 0.25, free = wall - radius;
  World world;
  // a chord that meets the inner circle (radius `free`) at angle 0 with angle b to the normal
  const Vec2 v(std::cos(b), std::sin(b));
  testing::add(world, testing::body(make_disc(radius), Vec2(free, 0.0) - 0.25 * v, v));
  testing::add(world, testing::site(make_disc_container(wall)));
  Simulator simulator(world, {});
  Events events;
  const int bounces = 10000;
  const double chord = 2.0 * free * std::cos(b);
  const RunSummary summary = simulator.run(testing::until(0.25 + chord * (bounces - 0.5)), &events);
  ASSERT_EQ(summary.termination, Termination::reached_end) << summary.why;
  const auto hits = events.collisions();
  ASSERT_EQ(hits.size(), static_cast<std::size_t>(bounces));
  double worst_angle = 0.0, worst_time = 0.0;
  for (int n = 0; n < bounces; ++n) {
    const Vec2 p = hits[n].contact.point;
    const double expected = n * (M_PI - 2.0 * b);
    worst_angle =
        std::max(worst_angle, std::abs(std::remainder(std::atan2(p.y(), p.x()) - expected, 2.0 * M_PI)));
    worst_time = std::max(worst_time, std::abs(hits[n].contact.time - (0.25 + n * chord)));
  }
  printf("circle, b = %.1f: %d hits, worst foot angle error %.2e rad, worst time error %.2e s\n", b, bounces,
         worst_angle, worst_time);
  // Rounded to double once a hit, the chords' turns would walk off to 1.7e-10; start states carry their
  // low-order parts, and what is left is the rounding of the first velocity (n 2e-16) and of the time.
  EXPECT_LE(worst_angle, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Chords, CircularContainer, ::testing::Values(0.1, 0.3, 0.5, 0.7));

/// When a point that goes straight in a stadium of that half length and radius meets it next, and where the wall's middle line or
/// circle is nearest there.
std::pair<long double, std::array<long double, 2>> next_in_stadium(long double a, long double r,
                                                                   const std::array<long double, 2>& p,
                                                                   const std::array<long double, 2>& v) {
  long double first = std::numeric_limits<long double>::infinity();
  std::array<long double, 2> middle{};
  const auto take = [&](long double t, long double mx) {
    if (t > 1e-9L && t < first) first = t, middle = {mx, 0.0L};
  };
  if (v[1] != 0) {
    const long double t = ((v[1] > 0 ? r : -r) - p[1]) / v[1], x = p[0] + v[0] * t;
    if (std::abs(x) <= a) take(t, x);
  }
  for (const long double end : {-a, a}) {
    const long double x = p[0] - end, b = x * v[0] + p[1] * v[1], c = x * x + p[1] * p[1] - r * r,
                      v2 = v[0] * v[0] + v[1] * v[1], d = b * b - v2 * c;
    if (d < 0) continue;
    for (const long double root : {-std::sqrt(d), std::sqrt(d)}) {
      const long double t = (root - b) / v2, there = p[0] + v[0] * t;
      if (end > 0 ? there >= a : there <= -a) take(t, end);
    }
  }
  return {first, middle};
}

// A disc in a capsule turned inside out (Bunimovich's stadium): near paths part there by a factor at each end, so that the first
// two dozen of hits are told.
TEST(Stadium, HitsAreThoseOfALoopThatKnowsNothingElse) {
  constexpr double kHalf = 1.0, kRadius = 1.2, kDisc = 0.1;
  World world;
  testing::add(world, testing::body(make_disc(kDisc), {0.3, -0.2}, {0.8, 0.6}));
  testing::add(world, testing::site(make_capsule_container(2.0 * kHalf, kRadius)));
  Simulator simulator(world, {});
  Events events;
  ASSERT_EQ(simulator.run(testing::until(100.0), &events).termination, Termination::reached_end);
  const auto hits = events.collisions();
  ASSERT_GE(hits.size(), 24U);
  std::array<long double, 2> p{0.3L, -0.2L}, v{0.8L, 0.6L};
  long double t = 0;
  for (int n = 0; n < 24; ++n) {
    const auto [after, middle] = next_in_stadium(kHalf, 1.2L - 0.1L, p, v);
    t += after;
    for (int k = 0; k < 2; ++k) p[k] += after * v[k];
    const std::array<long double, 2> out{p[0] - middle[0], p[1] - middle[1]};
    const long double along = (v[0] * out[0] + v[1] * out[1]) / (out[0] * out[0] + out[1] * out[1]);
    for (int k = 0; k < 2; ++k) v[k] -= 2 * along * out[k];
    EXPECT_NEAR(hits[n].contact.time, static_cast<double>(t), 1e-9) << "hit " << n;
  }
}

// A disc in a rectangle: each coordinate is a triangular wave.
long double triangular(double x0, double v, double low, double high, double t) {
  const long double width = static_cast<long double>(high) - low;  // v t is some 1e6 m: too long for double
  return low + std::abs(std::remainder(static_cast<long double>(x0) - low + static_cast<long double>(v) * t,
                                       2.0L * width));
}

/// How far the times of hits are off that come regularly on each axis [s]: as doubles, and with what those
/// leave over.
class HitTimes : public Recorder {
 public:
  using Pair = std::array<long double, 2>;
  HitTimes(const Pair& first, const Pair& period) : first_(first), period_(period) {}
  void frame(double, std::span<const BodyState>) override {}
  void checkpoint(double, const std::vector<std::byte>&) override {}
  void event(const Event& e) override {
    const int axis = std::abs(e.contact.normal.x()) > 0.5 ? 0 : 1;
    const auto expected = first_[axis] + static_cast<long double>(count_[axis]++) * period_[axis];
    const long double off = static_cast<long double>(e.contact.time) - expected;
    worst_double = std::max(worst_double, static_cast<double>(std::abs(off)));
    worst = std::max(worst, static_cast<double>(std::abs(off + e.contact.time_low)));
  }
  double worst = 0.0, worst_double = 0.0;

 private:
  Pair first_, period_;
  std::array<long, 2> count_{};
};

TEST(Rectangle, DiscFollowsTheUnfoldedTriangularWave) {
  const double radius = 0.25, w = 2.0, h = 1.5;
  World world;
  const Vec2 p0(0.3, 0.2), v0(1.0, std::sqrt(2.0) / 1.7);
  testing::add(world, testing::body(make_disc(radius), p0, v0));
  const Vec2 c[] = {{-w, -h}, {w, -h}, {w, h}, {-w, h}};
  for (int i = 0; i < 4; ++i) testing::add(world, testing::site(make_segment(c[i], c[(i + 1) % 4])));
  Simulator simulator(world, {});
  const double end = 1.62e6;  // a million hits
  const long double free_x = w - radius, free_y = h - radius;
  HitTimes times({(free_x - p0.x()) / v0.x(), (free_y - p0.y()) / v0.y()},
                 {2.0L * free_x / v0.x(), 2.0L * free_y / v0.y()});
  const RunSummary summary = simulator.run(testing::until(end), &times);
  ASSERT_EQ(summary.termination, Termination::reached_end) << summary.why;
  printf("rectangle: times of hits off by %.1e s as doubles, by %.1e s in all\n", times.worst_double,
         times.worst);
  EXPECT_LE(times.worst, 1e-12);  // doubles there are 2.3e-10 s apart
  const Vec2 p = simulator.state(0).pose.position;
  const double ex = std::abs(p.x() - triangular(p0.x(), v0.x(), -w + radius, w - radius, end));
  const double ey = std::abs(p.y() - triangular(p0.y(), v0.y(), -h + radius, h - radius, end));
  printf("rectangle: %llu hits, error %.2e m\n", static_cast<unsigned long long>(summary.collisions),
         std::max(ex, ey));
  EXPECT_GT(summary.collisions, 1000000U);
  EXPECT_LE(std::max(ex, ey), 1e-10);
}

// Thin plates hit at 1e2 .. 1e4 m/s: nothing overlaps and nothing passes through.
TEST(ThinPlates, FastShotNeverPassesThrough) {
  for (const double speed : {1e2, 1e3, 1e4}) {
    World world;
    const Shape plate = make_box(0.01, 1.0);
    testing::add(world, testing::body(make_box(0.02, 0.02), {-1.0, 0.013}, {speed, 0.0}, 2.0, 0.3, 40.0));
    for (int i = 0; i < 10; ++i) testing::add(world, testing::body(plate, {0.05 * i, 0.0}, {0.0, 0.0}, 1.0));
    Simulator simulator(world, {});
    RunOptions options = testing::until(20.0 / speed);
    options.frame_interval = 0.05 / speed;
    const RunSummary summary = simulator.run(options);
    ASSERT_EQ(summary.termination, Termination::reached_end) << summary.why;
    EXPECT_GT(summary.collisions, 5U);
    EXPECT_LE(summary.max_overlap, 1e-12) << "speed " << speed;
    EXPECT_NEAR(summary.energy_final / summary.energy_initial, 1.0, 1e-12);
    // the shot starts left of every plate and no plate can have been jumped: order along x is kept at the
    // middle plate
    EXPECT_LT(simulator.state(0).pose.position.x(), simulator.state(10).pose.position.x());
  }
}

}  // namespace
}  // namespace brink::billiards_test
