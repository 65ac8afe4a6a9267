#include "brink/scheduler/islands/modes/mode_step.h"

#include <array>

namespace brink {

namespace {

using Eigen::VectorXd;

/// The coefficients of Dormand and Prince (1980). The last row of kWeights is the fifth-order solution
/// itself (first same as last), so that the place of the seventh stage is the step's end; kError is the
/// fifth-order minus the fourth-order weights.
constexpr int kStages = 7;
constexpr std::array<double, kStages> kNodes{0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1, 1};
constexpr std::array<std::array<double, kStages - 1>, kStages> kWeights{{
    {},
    {1. / 5},
    {3. / 40, 9. / 40},
    {44. / 45, -56. / 15, 32. / 9},
    {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
    {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
    {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84},
}};
constexpr std::array<double, kStages> kError{71. / 57600,      0,         -71. / 16695, 71. / 1920,
                                             -17253. / 339200, 22. / 525, -1. / 40};

/// x, y, angle of all bodies, and their rates.
VectorXd flat(const std::vector<BodyState>& states) {
  const auto n = static_cast<Eigen::Index>(3 * states.size());
  VectorXd y(2 * n);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const BodyState& s = states[k];
    const auto at = static_cast<Eigen::Index>(3 * k);
    y.segment<3>(at) << s.pose.position, s.pose.angle;
    y.segment<3>(n + at) << s.twist.velocity, s.twist.omega;
  }
  return y;
}

/// The reverse of flat().
std::vector<BodyState> as_states(const VectorXd& y) {
  const Eigen::Index n = y.size() / 2;
  std::vector<BodyState> states(n / 3);
  for (std::size_t k = 0; k < states.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(3 * k);
    states[k] = {{y.segment<2>(at), y[at + 2]}, {y.segment<2>(n + at), y[n + at + 2]}};
  }
  return states;
}

}  // namespace

ModeTrial try_step(const ModeProblem& problem, const std::vector<MotionMode>& modes, double t,
                   const std::vector<BodyState>& from, double h) {
  const VectorXd start = flat(from);
  const Eigen::Index n = start.size() / 2;
  std::array<VectorXd, kStages> slopes;
  VectorXd place = start;
  for (int i = 0; i < kStages; ++i) {
    place = start;
    for (int j = 0; j < i; ++j)
      if (kWeights[i][j] != 0.0) place += (h * kWeights[i][j]) * slopes[j];
    // Forces of closed contacts follow from the stage's state alone; no gap is looked at, and what they
    // drift by is put back by projected() afterwards.
    const ModeForces f =
        forces_in(problem, moment_at(problem, t + kNodes[i] * h, as_states(place), modes), modes, false);
    slopes[i].resize(2 * n);
    slopes[i] << place.tail(n), f.acceleration;
  }
  VectorXd error = VectorXd::Zero(2 * n);
  for (int i = 0; i < kStages; ++i) error += (h * kError[i]) * slopes[i];
  return {as_states(place), as_states(error), place.allFinite() && error.allFinite()};
}

}  // namespace brink
