#include "brink/scheduler/islands/modes/choose_modes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "brink/core/contacts/lcp.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

/// The problem's unknowns: of every contact that may be closed its normal force, then of the still ones with
/// friction f+, f- and g.
class Complementarity {
 public:
  Complementarity(const ModeProblem& problem, const ModeMoment& moment,
                  const std::vector<ContactKnown>& known) {
    const Eigen::Index size = 3 * problem.bodies();
    inverse_mass_.resize(size);
    for (int k = 0; k < problem.bodies(); ++k)
      inverse_mass_.segment<3>(3 * k) = problem.inverse_mass[k].cast<Real>();
    free_ = moment.free.cast<Real>();
    for (std::size_t k = 0; k < known.size(); ++k)
      if (known[k] != ContactKnown::open) add(problem, moment.contacts[k], k, known[k]);
  }

  /// False: Lemke's method found no solution, or none that is finite.
  bool solve() {
    const auto n = static_cast<Eigen::Index>(unknowns_.size());
    RealMatrix A(n, n);
    RealVector q(n);
    std::vector<RealVector> pushed;  // what a unit of each force accelerates
    for (const Unknown& u : unknowns_) pushed.emplace_back(inverse_mass_.cwiseProduct(u.force));
    for (Eigen::Index i = 0; i < n; ++i) {
      q[i] = unknowns_[i].row.dot(free_) + unknowns_[i].bend;
      // rounding is that of all that its bodies fall by, though they may fall side by side, or along a wall
      size_ = std::max(size_, abs(unknowns_[i].bend) + most_along(unknowns_[i].row, free_));
      for (Eigen::Index j = 0; j < n; ++j)
        // w = A z + q: what each unit of force adds to the acceleration along a row
        A(i, j) = unknowns_[i].along(pushed[j]) + coupling(i, j);
    }
    const LcpAnswer answer = solve_lcp_by_lemke(A, q);
    if (answer.status != LcpAnswer::Status::solved || !answer.z.allFinite()) return false;
    z_ = answer.z;
    acceleration_ = free_;
    for (Eigen::Index j = 0; j < n; ++j) acceleration_ += answer.z[j] * pushed[j];
    return true;
  }

  const RealVector& acceleration() const { return acceleration_; }

  /// Adds to forces (impulses) of each contact, of such as do not slide.
  void add_forces(std::vector<double>& normal, std::vector<double>& tangential) const {
    for (std::size_t i = 0; i < unknowns_.size(); ++i) {
      const Unknown& u = unknowns_[i];
      const auto load = static_cast<double>(u.by * z_[static_cast<Eigen::Index>(i)]);
      if (u.kind == Unknown::Kind::normal) normal[u.of] += load;
      if (u.kind == Unknown::Kind::plus) tangential[u.of] += load;
      if (u.kind == Unknown::Kind::minus) tangential[u.of] -= load;
    }
  }

  /// What contact k does by the accelerations of the solution. @pre solve() gave true; k may be closed. An
  /// exact comparison with 0 would be a matter of roundings: kNoAcceleration of the largest number in q decides.
  MotionMode mode_of(std::size_t k, ContactKnown known, bool frictionless) const {
    const auto found =
        std::find_if(contacts_.begin(), contacts_.end(), [&](const Rows& r) { return r.of == k; });
    // complementarity: where a_n > 0 the normal force is 0, and the contact opens
    if (found->normal.dot(acceleration_) + found->normal_bend > kNoAcceleration * size_)
      return MotionMode::open;
    if (frictionless) return MotionMode::smooth;
    if (known == ContactKnown::slides_plus) return MotionMode::slip_plus;
    if (known == ContactKnown::slides_minus) return MotionMode::slip_minus;
    // what starts to slip slips the way in which its tangential acceleration leads
    const Real along = found->tangent.dot(acceleration_) + found->tangential_bend;
    if (abs(along) <= kNoAcceleration * size_) return MotionMode::stick;
    return along > 0 ? MotionMode::slip_plus : MotionMode::slip_minus;
  }

 private:
  /// One pair of the problem: z is a force (or g), w its complement.
  struct Unknown {
    RealVector row, force;  ///< w = row . a + bend + couplings; force: what one unit pushes with
    Real bend = 0;
    enum class Kind : unsigned char { normal, plus, minus, slack } kind = Kind::normal;
    std::size_t of = 0;
    Real friction = 0, by = 1;
    std::array<Eigen::Index, 2> bodies = {-1,
                                          -1};  ///< first columns of those that the row has; -1: of a support

    Real along(const RealVector& v) const {
      Real sum = 0;
      for (const Eigen::Index first : bodies)
        if (first >= 0) sum += row.segment<3>(first).dot(v.segment<3>(first));
      return sum;
    }
  };
  /// Of one contact that may be closed, scaled as its unknowns are: what mode_of() looks at.
  struct Rows {
    std::size_t of;
    RealVector normal, tangent;
    Real normal_bend, tangential_bend;
  };

  void add(const ModeProblem& problem, const ContactRates& r, std::size_t k, ContactKnown known) {
    const ModeContact& c = problem.contacts[k];
    const RealVector n = row_of(problem, c, r.normal_on_sample, r.normal_on_site).cast<Real>();
    const RealVector t = row_of(problem, c, r.tangent_on_sample, r.tangent_on_site).cast<Real>();
    // Normal rows have length one in the mass metric, so that light and heavy bodies are pivoted alike.
    // The tangent has the same factor: mu p >= f+ + f- is the same inequality in scaled forces then.
    const Real square = n.dot(inverse_mass_.cwiseProduct(n));
    const Real by = square > 0 ? 1 / sqrt(square) : Real(1);
    const Real mu = c.friction;
    const bool still = known == ContactKnown::still && mu > 0;
    // of what slides already the friction is at its bound: the normal force's column carries it
    const Real sign = known == ContactKnown::slides_plus ? -1 : known == ContactKnown::slides_minus ? 1 : 0;
    const Real normal_bend = by * Real(r.normal_bend), tangential_bend = by * Real(r.tangential_bend);
    const auto columns = [&](int owner) { return Eigen::Index{owner < problem.bodies() ? 3 * owner : -1}; };
    // a body that touches its own image has one place in the row
    const std::array<Eigen::Index, 2> of = {columns(c.sample_owner),
                                            c.site_owner == c.sample_owner ? -1 : columns(c.site_owner)};
    contacts_.push_back({k, by * n, by * t, normal_bend, tangential_bend});
    unknowns_.push_back(
        {by * n, by * (n + sign * mu * t), normal_bend, Unknown::Kind::normal, k, mu, by, of});
    if (!still) return;
    const RealVector none = RealVector::Zero(n.size());
    unknowns_.push_back({by * t, by * t, tangential_bend, Unknown::Kind::plus, k, mu, by, of});
    unknowns_.push_back({-by * t, -by * t, -tangential_bend, Unknown::Kind::minus, k, mu, by, of});
    // g, the tangential acceleration beyond friction: it pushes nobody, and is coupled to f+, f- alone
    unknowns_.push_back({none, none, 0, Unknown::Kind::slack, k, mu, 1, of});
  }

  /// Between unknowns of one contact, beside what accelerations couple.
  /// Rows +-a_t + g of f+ and f-, and mu p - f+ - f- of g (choose_modes.h).
  Real coupling(Eigen::Index i, Eigen::Index j) const {
    using Kind = Unknown::Kind;
    const Unknown &a = unknowns_[i], &b = unknowns_[j];
    if (a.of != b.of) return 0;
    if (b.kind == Kind::slack) return a.kind == Kind::plus || a.kind == Kind::minus ? 1 : 0;
    if (a.kind != Kind::slack) return 0;
    return b.kind == Kind::normal ? a.friction : -1;
  }

  RealVector inverse_mass_, free_, acceleration_, z_;
  std::vector<Unknown> unknowns_;
  std::vector<Rows> contacts_;
  Real size_ = 0;
};

}  // namespace

ModeChoice choose_modes(const ModeProblem& problem, const ModeMoment& moment,
                        const std::vector<ContactKnown>& known) {
  ModeChoice choice;
  choice.modes.assign(known.size(), MotionMode::open);
  Complementarity problem_of(problem, moment, known);
  if (!problem_of.solve()) return choice;
  choice.found = true;
  for (std::size_t k = 0; k < known.size(); ++k)
    if (known[k] != ContactKnown::open)
      choice.modes[k] = problem_of.mode_of(k, known[k], problem.contacts[k].friction == 0.0);
  return choice;
}

std::optional<PlasticImpact> plastic_impact(const ModeProblem& problem, double t,
                                            const std::vector<BodyState>& states,
                                            const std::vector<bool>& touching) {
  ModeMoment m;
  m.contacts = rates_at(problem, t, states);
  m.free.resize(3 * problem.bodies());
  for (int k = 0; k < problem.bodies(); ++k)
    m.free.segment<3>(3 * k) << states[k].twist.velocity, states[k].twist.omega;
  std::vector<ContactKnown> known;
  for (std::size_t k = 0; k < touching.size();
       ++k) {  // velocities for accelerations; supports are in the bends
    ContactRates& r = m.contacts[k];
    const ModeContact& c = problem.contacts[k];
    // Moreau's law goes by the slip after the impact, which the slip before does not tell
    known.push_back(touching[k] ? ContactKnown::still : ContactKnown::open);
    // what of v_n is not the bodies' own: with it "a_n" is v_n after the impact, and forces are impulses
    r.normal_bend = r.normal_velocity - row_of(problem, c, r.normal_on_sample, r.normal_on_site).dot(m.free);
    r.tangential_bend =
        r.tangential_velocity - row_of(problem, c, r.tangent_on_sample, r.tangent_on_site).dot(m.free);
  }
  Complementarity impact(problem, m, known);
  if (!impact.solve()) return std::nullopt;
  PlasticImpact after{states, std::vector(touching.size(), 0.0), std::vector(touching.size(), 0.0)};
  impact.add_forces(after.normal, after.tangential);
  for (int k = 0; k < problem.bodies(); ++k)
    after.states[k].twist = {impact.acceleration().segment<2>(3 * k).cast<double>(),
                             static_cast<double>(impact.acceleration()[3 * k + 2])};
  return after;
}

}  // namespace brink
