#include "brink/scheduler/islands/modes/mode_problem.h"

namespace brink {

namespace {

Vec3 as_vector(const Acceleration& a) { return {a.linear.x(), a.linear.y(), a.angular}; }

/// What a support's own acceleration adds to the bends.
/// A support has no columns (row_of): its acceleration is known, and goes into the bends. A body's own is
/// an unknown of the problem.
void add_support(const ModeProblem& problem, int owner, double t, const Vec3& normal, const Vec3& tangent,
                 ContactRates& r) {
  if (owner < problem.bodies()) return;
  const Vec3 a = as_vector(problem.supports[owner - problem.bodies()].rate(problem.before(t)));
  r.normal_bend += normal.dot(a);
  r.tangential_bend += tangent.dot(a);
}

}  // namespace

BodyState state_of(const ModeProblem& problem, int owner, double t, std::span<const BodyState> states) {
  return owner < problem.bodies() ? states[owner] : problem.supports[owner - problem.bodies()].state(t);
}

ContactRates rates_at(const ModeProblem& problem, double t, std::span<const BodyState> states,
                      const ModeContact& c) {
  ContactRates r = rates_of(c.shape, state_of(problem, c.sample_owner, t, states),
                            state_of(problem, c.site_owner, t, states));
  add_support(problem, c.sample_owner, t, r.normal_on_sample, r.tangent_on_sample, r);
  add_support(problem, c.site_owner, t, r.normal_on_site, r.tangent_on_site, r);
  return r;
}

std::vector<ContactRates> rates_at(const ModeProblem& problem, double t, std::span<const BodyState> states) {
  // any closed mode: all contacts are looked at
  return rates_at(problem, t, states, std::vector(problem.contacts.size(), MotionMode::stick));
}

std::vector<ContactRates> rates_at(const ModeProblem& problem, double t, std::span<const BodyState> states,
                                   const std::vector<MotionMode>& modes) {
  std::vector<ContactRates> all(modes.size());
  for (std::size_t k = 0; k < modes.size(); ++k)
    if (is_closed(modes[k])) all[k] = rates_at(problem, t, states, problem.contacts[k]);
  return all;
}

ModeMoment moment_at(const ModeProblem& problem, double t, std::span<const BodyState> states) {
  return moment_at(problem, t, states, std::vector(problem.contacts.size(), MotionMode::stick));
}

ModeMoment moment_at(const ModeProblem& problem, double t, std::span<const BodyState> states,
                     const std::vector<MotionMode>& modes) {
  ModeMoment m;
  const int bodies = problem.bodies();
  std::vector<Acceleration> free(bodies);
  problem.free(t, states, free);
  m.free.resize(3 * bodies);
  for (int k = 0; k < bodies; ++k)
    for (int i = 0; i < 3; ++i)
      // a locked coordinate has no acceleration, whatever forces pull at it
      m.free[3 * k + i] = problem.inverse_mass[k][i] == 0.0 ? 0.0 : as_vector(free[k])[i];
  m.contacts = rates_at(problem, t, states, modes);
  return m;
}

Eigen::VectorXd row_of(const ModeProblem& problem, const ModeContact& contact, const Vec3& on_sample,
                       const Vec3& on_site) {
  const int bodies = problem.bodies();
  Eigen::VectorXd row = Eigen::VectorXd::Zero(3 * bodies);
  if (contact.sample_owner < bodies) row.segment<3>(3 * contact.sample_owner) += on_sample;
  if (contact.site_owner < bodies) row.segment<3>(3 * contact.site_owner) += on_site;
  return row;
}

}  // namespace brink
