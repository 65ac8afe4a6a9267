#include "brink/core/contacts/coulomb_sweeps.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/wide.h"

namespace brink {

namespace {

/// Sweeps end where no impulse changes by more than this part of the largest, or by more than that after the fewest. What is
/// left to come may be a hundred times as much: see unexplained().
constexpr double kSettled = 1e-9, kNearlySettled = 1e-3;

Triple inverse(const Vec3& mass) {
  // what is held has an infinite mass, and takes nothing
  return Triple::of(mass.unaryExpr([](double m) { return std::isinf(m) ? 0.0 : 1.0 / m; }));
}

/// A contact with what its two bodies yield to it.
struct Yielding {
  Triple normal_on_body, normal_on_other, tangent_on_body, tangent_on_other;
  int body, other;    ///< places of bodies; of what does not yield the last
  double nn, nt, tt;  ///< change of v_n, v_t at the contact for an impulse of 1 along each
  /// Impulses for a change of 1: of both along the two, where both are to be 0; of the normal alone; of the normal with
  /// friction at its most along the tangent, and against it; of the spin. 0 where nothing yields.
  double nn_of, nt_of, tt_of, normal_alone, with_friction, against_friction, rolling_alone;
  double room;                   ///< speed of opening at which the gap is closed in the step, below 0 [m/s]
  double slides, turns;          ///< tangential speed and spin of the support
  double friction, rolling_arm;  ///< largest q, and torque, for p = 1
};

double dot(const Triple& a, const Triple& u, const Triple& b, const Triple& v) {
  const Four sum = four(a.at) * four(u.at) + four(b.at) * four(v.at);
  return sum[0] + sum[1] + sum[2];
}

double yields(const Triple& a, const Triple& of_body, const Triple& b, const Triple& of_other,
              const Triple& c, const Triple& d) {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += a.at[k] * of_body.at[k] * c.at[k] + b.at[k] * of_other.at[k] * d.at[k];
  return sum;
}

class Sweeps {
 public:
  explicit Sweeps(const StepProblem& problem) {
    const std::size_t bodies = problem.mass.size();
    for (std::size_t i = 0; i < bodies; ++i) {
      inverse_mass_.push_back(inverse(problem.mass[i]));
      velocity_.push_back(Triple::of(problem.velocity[i]));
      for (int c = 0; c < 3; ++c)
        velocity_[i].at[c] += problem.duration * problem.force[i][c] * inverse_mass_[i].at[c];
    }
    // what does not yield: at rest, and nothing moves it
    inverse_mass_.push_back(Triple{});
    velocity_.push_back(Triple{});
    for (const StepContact& s : problem.contacts) add(s, problem.duration);
  }

  void begin_with(const std::vector<ContactLoad>& loads) {
    for (std::size_t k = 0; k < loads.size(); ++k) change(contacts_[k], loads[k]);
  }

  /// All contacts once, in their order or in the reverse.
  void sweep(bool forwards, std::vector<ContactLoad>& loads, double& most_changed, double& largest);

 private:
  void add(const StepContact& s, double h) {
    const LastingContact& c = s.contact;
    Yielding y{};
    y.normal_on_body = Triple::of(c.normal_on_body);
    y.tangent_on_body = Triple::of(c.tangent_on_body);
    if (c.other >= 0) {
      y.normal_on_other = Triple::of(c.normal_on_other);
      y.tangent_on_other = Triple::of(c.tangent_on_other);
    }
    y.body = c.body;
    y.other = c.other < 0 ? static_cast<int>(inverse_mass_.size()) - 1 : c.other;
    const Triple &body = inverse_mass_[y.body], &other = inverse_mass_[y.other];
    y.nn = yields(y.normal_on_body, body, y.normal_on_other, other, y.normal_on_body, y.normal_on_other);
    y.nt = yields(y.normal_on_body, body, y.normal_on_other, other, y.tangent_on_body, y.tangent_on_other);
    y.tt = yields(y.tangent_on_body, body, y.tangent_on_other, other, y.tangent_on_body, y.tangent_on_other);
    const double det = y.nn * y.tt - y.nt * y.nt;
    if (det > 0.0) {
      y.nn_of = y.tt / det;
      y.nt_of = y.nt / det;
      y.tt_of = y.nn / det;
    }
    const auto impulse = [](double yields) { return yields > 0.0 ? 1.0 / yields : 0.0; };
    y.normal_alone = impulse(y.nn);
    y.with_friction = impulse(y.nn + c.friction * y.nt);
    y.against_friction = impulse(y.nn - c.friction * y.nt);
    y.rolling_alone = impulse(body.at[2] + other.at[2]);
    y.room = s.gap / h - s.support_velocity[0];
    y.slides = s.support_velocity[1];
    y.turns = s.support_velocity[2];
    y.friction = c.friction;
    y.rolling_arm = c.rolling_resistance;
    contacts_.push_back(y);
  }

  /// The contact's impulse with all others as they are.
  ContactLoad renewed(const Yielding& y, const ContactLoad& load) const {
    const Triple &body = velocity_[y.body], &other = velocity_[y.other];
    ContactLoad next;
    if (!(y.nn > 0.0)) return load;  // between what is held
    // speeds without the impulse that it has; of the normal, gap / h more than what is to be 0 at least
    const double normal = dot(y.normal_on_body, body, y.normal_on_other, other) + y.room -
                          y.nn * load.normal - y.nt * load.tangential;
    if (!(normal < 0.0)) return next;
    const double slip = dot(y.tangent_on_body, body, y.tangent_on_other, other) - y.slides -
                        y.nt * load.normal - y.tt * load.tangential;
    hold_or_slip(y, normal, slip, next);
    // the torque against the turning, within its arm times the normal impulse
    if (y.rolling_arm > 0.0 && y.rolling_alone > 0.0) {
      const double turns = body.at[2] - other.at[2] - y.turns, most = y.rolling_arm * next.normal;
      next.rolling = std::clamp(load.rolling - turns * y.rolling_alone, -most, most);
    }
    return next;
  }

  void change(const Yielding& y, const ContactLoad& by) {
    const Four turns = {0.0, 0.0, by.rolling, 0.0};
    Four &body = four(velocity_[y.body].at), &other = four(velocity_[y.other].at);
    body += four(inverse_mass_[y.body].at) *
            (four(y.normal_on_body.at) * by.normal + four(y.tangent_on_body.at) * by.tangential + turns);
    other += four(inverse_mass_[y.other].at) *
             (four(y.normal_on_other.at) * by.normal + four(y.tangent_on_other.at) * by.tangential - turns);
  }

  /// Of a contact that would close at `normal` < 0 and slip by `slip`: it slips where what would hold it is outside the
  /// cone.
  static void hold_or_slip(const Yielding& y, double normal, double slip, ContactLoad& load) {
    if (y.nn_of > 0.0) {
      load.normal = y.nt_of * slip - y.nn_of * normal;
      load.tangential = y.nt_of * normal - y.tt_of * slip;
    } else {
      // both directions move the same: nothing is left for friction
      load.normal = -normal * y.normal_alone;
      load.tangential = 0.0;
    }
    if (load.normal >= 0.0 && std::abs(load.tangential) <= y.friction * load.normal) return;
    const double way = std::copysign(y.friction, load.tangential);
    const double impulse = way > 0.0 ? y.with_friction : y.against_friction;
    // Painleve: friction would press harder than the contact yields; without it there is always an answer
    load.normal = -normal * (impulse > 0.0 ? impulse : y.normal_alone);
    load.tangential = impulse > 0.0 ? way * load.normal : 0.0;
  }

  std::vector<Triple> inverse_mass_,
      velocity_;  ///< of every body, the latter with the impulses that contacts have
  std::vector<Yielding> contacts_;
};

BRINK_WIDE void Sweeps::sweep(bool forwards, std::vector<ContactLoad>& loads, double& most_changed,
                              double& largest) {
  const std::size_t count = loads.size();
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t k = forwards ? n : count - 1 - n;
    const ContactLoad next = renewed(contacts_[k], loads[k]);
    const ContactLoad more{next.normal - loads[k].normal, next.tangential - loads[k].tangential,
                           next.rolling - loads[k].rolling};
    if (more.normal != 0.0 || more.tangential != 0.0 || more.rolling != 0.0) change(contacts_[k], more);
    most_changed = std::max({most_changed, std::abs(more.normal), std::abs(more.tangential)});
    largest = std::max(largest, next.normal);
    loads[k] = next;
  }
}

}  // namespace

CoulombLoads sweep_by_coulomb(const StepProblem& problem, int fewest, int most, const GoOn& go_on) {
  CoulombLoads found;
  for (const StepContact& s : problem.contacts) found.loads.push_back(s.expected);
  Sweeps sweeps(problem);
  sweeps.begin_with(found.loads);
  for (; found.sweeps < most; ++found.sweeps) {
    if (go_on && !go_on()) break;
    double changed = 0.0, largest = 0.0;
    // forwards and backwards in turn: what is known at one end of a heap comes to the other in a sweep
    sweeps.sweep(found.sweeps % 2 == 0, found.loads, changed, largest);
    if (changed <= (found.sweeps < fewest ? kSettled : kNearlySettled) * largest) break;
  }
  return found;
}

double unexplained(const StepProblem& problem, const std::vector<Vec3>& velocity,
                   const std::vector<ContactLoad>& loads) {
  std::vector<Vec3> left;
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    Vec3 gains = velocity[i] - problem.velocity[i];
    for (int c = 0; c < 3; ++c)
      gains[c] = std::isinf(problem.mass[i][c])
                     ? 0.0
                     : problem.mass[i][c] * gains[c] - problem.duration * problem.force[i][c];
    left.push_back(gains);
  }
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const LastingContact& c = problem.contacts[k].contact;
    left[c.body] -= loads[k].normal * c.normal_on_body + loads[k].tangential * c.tangent_on_body;
    if (c.other >= 0)
      left[c.other] -= loads[k].normal * c.normal_on_other + loads[k].tangential * c.tangent_on_other;
  }
  double most = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i)
    for (int c = 0; c < 2; ++c)
      if (!std::isinf(problem.mass[i][c])) most = std::max(most, std::abs(left[i][c]));
  return most;
}

}  // namespace brink
