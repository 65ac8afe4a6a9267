// What a page says it is off by between frames, beside what it is off by.
#include "brink/scenes/view/interpolation_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "brink/core/shapes/shapes.h"

namespace brink::interpolation_error_test {
namespace {

/// One disc that moves along x by a function with its derivative, seen at frames.
struct Seen {
  World world;
  std::vector<double> times;
  std::array<std::vector<double>, 6> states;
  std::function<double(double)> x, v;

  Seen(std::function<double(double)> place, std::function<double(double)> speed, double step)
      : x(std::move(place)), v(std::move(speed)) {
    Body body;
    body.outline = std::make_shared<const Outline>(make_disc(0.1).outline);
    world.bodies = {body};
    for (int k = 0; k <= 40; ++k) {
      const double t = step * k;
      times.push_back(t);
      const double values[] = {x(t), 0.0, 0.0, v(t), 0.0, 0.0};
      for (int c = 0; c < 6; ++c) states[c].push_back(values[c]);
    }
  }
  double told(bool bends, std::vector<double> events = {}) const {
    const std::vector<std::vector<double>> of_bodies = {std::move(events)};
    return interpolation_error(world, times, states, of_bodies, bends);
  }
  /// The largest difference between frames.
  double off() const {
    double worst = 0.0;
    for (std::size_t k = 0; k + 1 < times.size(); ++k)
      for (int i = 1; i < 20; ++i) {
        const double h = times[k + 1] - times[k], s = h * i / 20.0, a = states[0][k], va = states[3][k];
        const double d = (states[0][k + 1] - a) / h, vb = states[3][k + 1];
        const double c2 = (3 * d - 2 * va - vb) / h, c3 = (va + vb - 2 * d) / (h * h);
        worst = std::max(worst, std::abs(a + s * (va + s * (c2 + s * c3)) - x(times[k] + s)));
      }
    return worst;
  }
};

TEST(InterpolationError, IsRoundingWhereAccelerationsAreConstant) {
  const Seen seen([](double t) { return 3.0 + t - 4.9 * t * t; }, [](double t) { return 1.0 - 9.8 * t; },
                  0.05);
  EXPECT_LT(seen.told(false), 1e-12);
  EXPECT_GE(seen.told(false), seen.off());
}

TEST(InterpolationError, IsThatOfASmoothMotion) {
  const Seen seen([](double t) { return std::sin(t); }, [](double t) { return std::cos(t); }, 0.2);
  EXPECT_GT(seen.off(), 1e-6);
  EXPECT_NEAR(seen.told(false) / seen.off(), 1.0, 0.2);
}

TEST(InterpolationError, CountsBendsThatNoEventTellsOf) {
  // Thrown back at t = .53, between the frames at .5 and .6.
  const Seen seen([](double t) { return std::abs(t - 0.53); }, [](double t) { return t < 0.53 ? -1.0 : 1.0; },
                  0.1);
  EXPECT_GT(seen.told(true), 0.5 * seen.off());
  EXPECT_LT(seen.told(true), 2.0 * seen.off());
  EXPECT_LT(seen.told(false, {0.53}), 1e-13) << "an event tells of it";
}

}  // namespace
}  // namespace brink::interpolation_error_test
