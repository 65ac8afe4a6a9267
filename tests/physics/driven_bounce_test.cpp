/// Contact times on motions that no formula of the integrators gives: the error falls with the tolerance
/// asked for. References are closed forms in long double (bench_reference.h), so the error shown is the
/// integrator's alone.
#include <gtest/gtest.h>

#include <cmath>

#include "brink/scenes/bench/reference.h"
#include "tests/support/worlds.h"

namespace brink::driven_bounce_test {
namespace {

using testing::Events;

constexpr double kRadius = 0.25;

World ball_over_floor(double height, double restitution) {
  World world;
  world.gravity = {0.0, -9.81};
  world.materials[0].restitution = restitution;
  testing::add(world, testing::body(make_disc(kRadius), {0.0, height + kRadius}, {0.0, 0.0}));
  testing::add(world, testing::site(make_segment({-10.0, 0.0}, {10.0, 0.0})));
  return world;
}

/// The spring hangs from 3 m above the floor; every length is a short binary fraction, exact in the sums.
World world_of(const bench::SpringBall& b) {
  World world = ball_over_floor(static_cast<double>(b.height), static_cast<double>(b.restitution));
  SpringForce spring;
  spring.at_b = {0.0, 3.0};
  spring.stiffness = static_cast<double>(b.stiffness);
  spring.damping = static_cast<double>(b.damping);
  spring.rest_length = 3.0 - kRadius - static_cast<double>(b.rest);
  FormulaForce shaking;
  shaking.bodies = {0};
  shaking.fy = Formula("4*cos(7*t)", force_formula_variables());
  world.forces = {spring, shaking};
  return world;
}

World world_of(const bench::BallInAir& b) {
  World world = ball_over_floor(static_cast<double>(b.height), static_cast<double>(b.restitution));
  DragForce drag;
  drag.bodies = {0};
  drag.quadratic = static_cast<double>(b.drag);  // mass 1
  world.forces = {drag};
  return world;
}

struct Case {
  const char* name;
  const char* integrator;
  double best;  ///< error to be reached at tolerance 1e-12 [s]
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name << " " << c.integrator; }

class DrivenBounce : public ::testing::TestWithParam<Case> {
 protected:
  static constexpr double kEnd = 6.0;
  World world() const {
    return GetParam().name == std::string("spring") ? world_of(bench::SpringBall())
                                                    : world_of(bench::BallInAir());
  }
  std::vector<double> expected() const {
    return GetParam().name == std::string("spring") ? bench::impact_times(bench::SpringBall(), kEnd)
                                                    : bench::impact_times(bench::BallInAir(), kEnd);
  }
  /// Worst error of the impact times [s].
  double error(double tolerance, const std::vector<double>& times) const {
    SolverOptions options;
    options.integrator = GetParam().integrator;
    options.tolerance = tolerance;
    options.absolute_tolerance = 0.01 * tolerance;
    Simulator simulator(world(), options);
    Events events;
    const RunSummary summary = simulator.run(testing::until(kEnd), &events);
    EXPECT_EQ(summary.termination, Termination::reached_end) << summary.why;
    const auto hits = events.collisions();
    EXPECT_EQ(hits.size(), times.size()) << "tolerance " << tolerance;
    double worst = 0.0;
    for (std::size_t k = 0; k < std::min(hits.size(), times.size()); ++k)
      worst = std::max(worst, std::abs(hits[k].contact.time - times[k]));
    return worst;
  }
};

/// Slope of log y over log x by least squares.
double log_slope(const std::vector<double>& x, const std::vector<double>& y) {
  double mx = 0.0, my = 0.0, sxx = 0.0, sxy = 0.0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    mx += std::log(x[k]) / n;
    my += std::log(y[k]) / n;
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    sxx += (std::log(x[k]) - mx) * (std::log(x[k]) - mx);
    sxy += (std::log(x[k]) - mx) * (std::log(y[k]) - my);
  }
  return sxy / sxx;
}

// An adaptive method of order p with error control per step has a global error of about tolerance^(p/(p+1))
// to tolerance^1, so the slope is near 1 until rounding; every impact must come, at any tolerance.
TEST_P(DrivenBounce, ContactTimeErrorFollowsTheTolerance) {
  const std::vector<double> times = expected();
  ASSERT_GE(times.size(), 5U);
  std::vector<double> tolerances, errors;
  printf("%s %s, %zu impacts:", GetParam().name, GetParam().integrator, times.size());
  for (int k = 5; k <= 12; ++k) {
    tolerances.push_back(std::pow(10.0, -k));
    errors.push_back(error(tolerances.back(), times));
    printf(" %.1e", errors.back());
  }
  const double slope = log_slope(tolerances, errors);
  printf("; slope %.2f\n", slope);
  EXPECT_GE(slope, 0.7);
  EXPECT_LE(slope, 1.3);
  EXPECT_LE(errors.back(), GetParam().best);
}

// BDF is of order 5 at most and takes some 10^4 steps at 1e-12: its errors add up more.
INSTANTIATE_TEST_SUITE_P(ForcesAndIntegrators, DrivenBounce,
                         ::testing::Values(Case{"spring", "erk", 1e-11}, Case{"spring", "adams", 1e-10},
                                           Case{"spring", "bdf", 5e-9}, Case{"air", "erk", 1e-11},
                                           Case{"air", "adams", 1e-10}, Case{"air", "bdf", 5e-9}));

}  // namespace
}  // namespace brink::driven_bounce_test
