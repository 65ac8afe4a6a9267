#include "brink/scheduler/islands/island_step.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

constexpr int kLooks = 8;        ///< along a step
constexpr int kCorrections = 6;  ///< of gaps that were missed
constexpr double kAimHigher = 1.1;
/// What the solver may miss, of the step's speed: gaps and energy are looked at themselves.
constexpr double kResidual = 1e-6;
/// A step may win this part of the energies that it turns over: the solver's rounding, and what faces that turn
/// push into what lies on them, which the true motion takes from their turning.
constexpr double kWonOf = 1e-6;
/// Friction bounds are taken from normal forces that were found with the bounds before, so often.
constexpr int kFrictionPasses = 2;

/// `lift`: how much higher than its gap a contact aims.
StepProblem problem_of(const IslandStep& step, double h, const std::vector<double>& lift) {
  StepProblem p;
  p.duration = h;
  p.mass = step.mass;
  p.velocity = step.velocity;
  p.force = step.force;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const IslandContact& c = step.contacts[k];
    StepContact s;
    s.contact = c.rows;
    s.gap = std::max(c.gap, 0.0) - lift[k];
    s.friction_bound = c.friction * c.normal_force * std::min(h, c.force_lasted);
    s.support_velocity = Vec3(c.normal_support, c.tangential_support, 0.0);
    p.contacts.push_back(s);
  }
  return p;
}

/// Coulomb by given bounds, each pass with the normal forces of the one before.
StepResult with_friction(ConeQp& solver, StepProblem& p, const IslandStep& step, int& factorisations) {
  StepResult result;
  for (int pass = 0; pass <= kFrictionPasses; ++pass) {
    result = solver.step(p);
    factorisations += result.factorisations;
    if (!(result.residual <= kResidual)) break;
    bool same = true;
    for (std::size_t k = 0; k < p.contacts.size(); ++k) {
      const double bound = step.contacts[k].friction * result.loads[k].normal;
      same = same && std::abs(bound - p.contacts[k].friction_bound) <= 1e-9 * bound;
      if (pass < kFrictionPasses) p.contacts[k].friction_bound = bound;
    }
    if (same) break;
  }
  return result;
}

/// How far gap k is missed along the step, at most [m]; <= 0: not at all.
double missed(std::size_t k, double h, const std::vector<Vec3>& velocity, const GapAlong& gap) {
  double least = 0.0;
  for (int look = 1; look <= kLooks; ++look)
    least = std::min(least, gap(k, h * look / static_cast<double>(kLooks), velocity));
  return -least;
}

/// What the bodies won in the step beyond what forces and moving supports gave them [J].
double won(const IslandStep& step, const StepResult& result, double h, double& of) {
  double change = 0.0;
  for (std::size_t i = 0; i < step.mass.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      if (std::isinf(step.mass[i][k])) continue;
      const double before = step.velocity[i][k], after = result.velocity[i][k];
      change += 0.5 * step.mass[i][k] * (after - before) * (after + before) - h * step.force[i][k] * after;
      of += 0.5 * step.mass[i][k] * (before * before + after * after) +
            std::abs(h * step.force[i][k] * after) +
            h * h * step.force[i][k] * step.force[i][k] / step.mass[i][k];
    }
  for (std::size_t k = 0; k < step.contacts.size(); ++k)
    change -= result.loads[k].normal * step.contacts[k].normal_support +
              result.loads[k].tangential * step.contacts[k].tangential_support;
  return change;
}

double residual(const IslandStep& step, const StepResult& result) {
  double most = 0.0, beyond = 0.0;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const ContactLoad& load = result.loads[k];
    most = std::max(most, load.normal);
    beyond = std::max(beyond, std::abs(load.tangential) - step.contacts[k].friction * load.normal);
  }
  return most > 0.0 ? beyond / most : 0.0;
}

}  // namespace

StepOutcome take_step(ConeQp& solver, IslandStep& step, double h, double tolerance, const GapAlong& gap) {
  StepOutcome outcome;
  std::vector<double> lift(step.contacts.size(), 0.0);
  for (int again = 0; again < kCorrections && !outcome.solved; ++again) {
    StepProblem p = problem_of(step, h, lift);
    const StepResult result = with_friction(solver, p, step, outcome.factorisations);
    if (!(result.residual <= kResidual)) return outcome;
    double worst = 0.0;
    for (std::size_t k = 0; k < step.contacts.size(); ++k) {
      const double miss = missed(k, h, result.velocity, gap);
      worst = std::max(worst, miss);
      if (miss > 0.1 * tolerance) lift[k] += kAimHigher * miss;
    }
    if (worst > tolerance) continue;
    double of = 0.0;
    const double won_here = won(step, result, h, of);
    if (won_here > kWonOf * of) return outcome;
    outcome.won = std::max(0.0, won_here);
    outcome.solved = true;
    outcome.friction_residual = residual(step, result);
    step.velocity = result.velocity;
    for (std::size_t k = 0; k < step.contacts.size(); ++k) {
      step.contacts[k].normal_force = result.loads[k].normal / h;
      step.contacts[k].tangential_force = result.loads[k].tangential / h;
    }
  }
  return outcome;
}

bool stays_at_rest(ConeQp& solver, IslandStep& step) {
  RestProblem p;
  p.mass = step.mass;
  p.force = step.force;
  for (const IslandContact& c : step.contacts) {
    p.contacts.push_back(c.rows);
    p.contacts.back().friction = c.friction;
  }
  const RestResult result = solver.rest_forces(p);
  if (result.status != RestResult::Status::rests) return false;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    step.contacts[k].normal_force = result.loads[k].normal;
    step.contacts[k].tangential_force = result.loads[k].tangential;
  }
  return true;
}

}  // namespace brink
