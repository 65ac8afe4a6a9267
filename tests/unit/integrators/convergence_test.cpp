/// The order of every integrator, shown on problems with known answers. Each test prints what it measured.
#include <gtest/gtest.h>

#include <cstdio>

#include "brink/integrators/dense_output.h"
#include "brink/integrators/integrator.h"
#include "tests/unit/integrators/problems.h"

namespace brink::convergence_test {
namespace {

using namespace problems;

struct Problem {
  const char* name;
  std::shared_ptr<Dynamics> (*dynamics)();
  BodyState (*exact)(double t);
};
const Problem kProblems[] = {{"oscillator", oscillator, oscillator_state},
                             {"kepler", kepler, kepler_state},
                             {"spinning_drag", spinning_drag, spinning_drag_state}};

/// Least-squares slope of log(error) over log(size).
double slope(const std::vector<double>& sizes, const std::vector<double>& errors) {
  const std::size_t n = sizes.size();
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = std::log(sizes[i]), y = std::log(errors[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// Error of pose and twist at t = 3 s, a step end of every step used here.
double end_error(const char* integrator, const Problem& problem, const IntegratorOptions& options,
                 WorkCounters* work = nullptr) {
  const auto made = make_integrator(integrator, problem.dynamics(), options, work);
  const BodyState start = problem.exact(0.0);
  made->start(0.0, {&start, 1});
  EXPECT_EQ(made->extend(3.0).status, Extent::Status::reached);
  return difference(made->motion(0).state(3.0), problem.exact(3.0));
}

/// Largest error of pose and twist between step ends too.
double dense_error(const char* integrator, const Problem& problem, const IntegratorOptions& options) {
  const auto made = make_integrator(integrator, problem.dynamics(), options, nullptr);
  const BodyState start = problem.exact(0.0);
  made->start(0.0, {&start, 1});
  made->extend(3.0);
  const Motion motion = made->motion(0);
  double worst = 0.0;
  for (double t = 0.0; t <= 3.0; t += 0.00137)
    worst = std::max(worst, (motion.pose(t).position - problem.exact(t).pose.position).norm());
  return worst;
}

struct FixedStepCase {
  const char* integrator;
  double order;
};

class FixedStepOrder : public ::testing::TestWithParam<FixedStepCase> {};

// A method of order p has an error that falls as step^p: halving the step five times must show p in the
// slope.
TEST_P(FixedStepOrder, ErrorFallsAsTheStepToTheOrder) {
  const auto [integrator, order] = GetParam();
  for (const Problem& problem : kProblems) {
    std::vector<double> steps, errors, dense;
    for (int k = 5; k <= 9; ++k) {
      steps.push_back(std::ldexp(1.0, -k));
      errors.push_back(end_error(integrator, problem, {1e-10, 1e-12, steps.back()}));
      dense.push_back(dense_error(integrator, problem, {1e-10, 1e-12, steps.back()}));
    }
    const double at_ends = slope(steps, errors), between = slope(steps, dense);
    std::printf("%-20s %-14s order %.4f, between steps %.4f, error %.2e at step 1/512 s\n", integrator,
                problem.name, at_ends, between, errors.back());
    EXPECT_NEAR(at_ends, order, 0.15) << problem.name;
    EXPECT_NEAR(between, order, 0.15) << problem.name;
  }
}
INSTANTIATE_TEST_SUITE_P(All, FixedStepOrder,
                         ::testing::Values(FixedStepCase{"euler", 1.0},
                                           FixedStepCase{"semi_implicit_euler", 1.0},
                                           FixedStepCase{"rk4", 4.0}),
                         [](const auto& made) { return std::string(made.param.integrator); });

class AdaptiveTolerance : public ::testing::TestWithParam<const char*> {};

// An adaptive solver keeps its error in proportion to the tolerance, more or less: over six decades of
// tolerance the slope of log error lies near 1 (Soederlind 2006 calls this tolerance proportionality), and
// dense output is as good.
TEST_P(AdaptiveTolerance, ErrorFallsWithTheTolerance) {
  for (const Problem& problem : kProblems) {
    std::vector<double> tolerances, errors, dense;
    WorkCounters work;
    for (int k = 5; k <= 11; ++k) {
      tolerances.push_back(std::pow(10.0, -k));
      work = {};
      errors.push_back(end_error(GetParam(), problem, {tolerances.back(), tolerances.back(), 0.001}, &work));
      dense.push_back(dense_error(GetParam(), problem, {tolerances.back(), tolerances.back(), 0.001}));
    }
    const double at_end = slope(tolerances, errors), between = slope(tolerances, dense);
    std::printf(
        "%-6s %-14s slope %.3f, between steps %.3f; error %.2e, between %.2e at 1e-11 (%llu steps, %llu "
        "rhs)\n",
        GetParam(), problem.name, at_end, between, errors.back(), dense.back(),
        static_cast<unsigned long long>(work.solver_steps),
        static_cast<unsigned long long>(work.right_hand_sides));
    EXPECT_GT(at_end, 0.6) << problem.name;
    EXPECT_LT(at_end, 1.4) << problem.name;
    EXPECT_GT(between, 0.6) << problem.name;
    EXPECT_LT(errors.back(), 3e-8) << problem.name;
    EXPECT_LT(dense.back(), 3e-8) << problem.name;
  }
}
INSTANTIATE_TEST_SUITE_P(All, AdaptiveTolerance, ::testing::Values("erk", "adams", "bdf"),
                         [](const auto& made) { return std::string(made.param); });

/// Energy drift of the worst moment over 100 s (known answer 26), sampled every 0.1 s.
template <class Energy>
double worst_drift(const Motion* motions, std::size_t count, Energy energy) {
  std::vector<BodyState> states(count);
  const auto at = [&](double t) {
    for (std::size_t k = 0; k < count; ++k) states[k] = motions[k].state(t);
    return energy(states);
  };
  const double start = at(0.0);
  double worst = 0.0;
  for (int i = 0; i <= 1000; ++i) worst = std::max(worst, std::abs(at(0.1 * i) - start));
  return worst;
}

class EnergyOver100Seconds : public ::testing::TestWithParam<const char*> {};

// The spring pair and the Kepler orbit store energy; a solver of tolerance 1e-10 that makes some thousand
// steps may lose about 1e-7 of it. Energies here are of order 1 J.
TEST_P(EnergyOver100Seconds, IsKeptToTheTolerance) {
  const IntegratorOptions options{1e-10, 1e-12, 0.001};
  const auto pair = make_integrator(GetParam(), spring_pair(), options);
  pair->start(0.0, spring_pair_start());
  ASSERT_EQ(pair->extend(100.0).status, Extent::Status::reached);
  const Motion both[] = {pair->motion(0), pair->motion(1)};
  const double spring = worst_drift(both, 2, [](const auto& s) { return spring_pair_energy(s); });
  const auto orbit = make_integrator(GetParam(), kepler(), options);
  const BodyState start = kepler_state(0.0);
  orbit->start(0.0, {&start, 1});
  ASSERT_EQ(orbit->extend(100.0).status, Extent::Status::reached);
  const Motion one[] = {orbit->motion(0)};
  const double kepler_drift = worst_drift(one, 1, [](const auto& s) { return kepler_energy(s[0]); });
  std::printf("%-20s energy drift over 100 s: spring pair %.2e J, kepler %.2e J/kg\n", GetParam(), spring,
              kepler_drift);
  const bool euler = std::string(GetParam()).find("euler") != std::string::npos;
  EXPECT_LT(spring, euler ? 0.2 : 1e-6);
  EXPECT_LT(kepler_drift, euler ? 0.2 : 1e-6);
}
INSTANTIATE_TEST_SUITE_P(All, EnergyOver100Seconds,
                         ::testing::Values("euler", "semi_implicit_euler", "rk4", "erk", "adams", "bdf"),
                         [](const auto& made) { return std::string(made.param); });

// Hermite interpolation of exact end values: cubic is O(h^4), quintic O(h^6) (Hairer, Norsett & Wanner 1993,
// II.6).
TEST(DenseOutput, HermiteInterpolantsHaveTheirOrders) {
  const auto acceleration = [](double t) -> Acceleration {
    const BodyState s = oscillator_state(t);
    return {-kOmega * kOmega * s.pose.position, -kOmega * kOmega * s.pose.angle};
  };
  std::vector<double> steps, cubic, quintic;
  for (int k = 1; k <= 5; ++k) {
    const double h = std::ldexp(1.0, -k), middle = 0.8, t0 = middle - 0.5 * h, t1 = middle + 0.5 * h;
    const BodyState from = oscillator_state(t0), to = oscillator_state(t1), exact = oscillator_state(middle);
    const auto error = [&](const PolynomialPiece& piece) {
      return (piece.state(middle).pose.position - exact.pose.position).norm();
    };
    steps.push_back(h);
    cubic.push_back(error(cubic_piece(t0, from, t1, to)));
    quintic.push_back(error(quintic_piece(t0, from, acceleration(t0), t1, to, acceleration(t1))));
  }
  std::printf("cubic Hermite order %.3f, quintic %.3f\n", slope(steps, cubic), slope(steps, quintic));
  EXPECT_NEAR(slope(steps, cubic), 4.0, 0.1);
  EXPECT_NEAR(slope(steps, quintic), 6.0, 0.1);
}

// Classic sequences by hand for one body under a = -4 x, step h = 1/8, from x = 1, v = 0:
// Euler: x1 = 1, v1 = -1/2; x2 = 1 - 1/16, v2 = -1. Semi-implicit: v1 = -1/2, x1 = 1 - 1/16; v2 = v1 - x1 /
// 2, x2 = x1 + v2 / 8.
TEST(FixedStep, StatesAtStepEndsAreTheClassicSequences) {
  BodyState start;
  start.pose.position = {1.0, 0.0};
  const IntegratorOptions options{1e-10, 1e-12, 0.125};
  const auto euler = make_integrator("euler", oscillator(), options);
  euler->start(0.0, {&start, 1});
  euler->extend(0.5);
  EXPECT_EQ(euler->motion(0).state(0.125).pose.position.x(), 1.0);
  EXPECT_EQ(euler->motion(0).state(0.125).twist.velocity.x(), -0.5);
  EXPECT_EQ(euler->motion(0).state(0.25).pose.position.x(), 1.0 - 1.0 / 16.0);
  EXPECT_EQ(euler->motion(0).state(0.25).twist.velocity.x(), -1.0);
  const auto semi = make_integrator("semi_implicit_euler", oscillator(), options);
  semi->start(0.0, {&start, 1});
  semi->extend(0.5);
  const double x1 = 1.0 - 1.0 / 16.0, v2 = -0.5 - 0.5 * x1;
  EXPECT_EQ(semi->motion(0).state(0.125).pose.position.x(), x1);
  EXPECT_EQ(semi->motion(0).state(0.25).twist.velocity.x(), v2);
  EXPECT_EQ(semi->motion(0).state(0.25).pose.position.x(), x1 + 0.125 * v2);
}

}  // namespace
}  // namespace brink::convergence_test
