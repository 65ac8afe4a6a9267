#include "brink/core/contacts/coulomb_sweeps.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

/// Sweeps end where no impulse changes by more than this part of the largest, or by more than that after the fewest. What is
/// left to come may be a hundred times as much: see unexplained().
constexpr double kSettled = 1e-9, kNearlySettled = 1e-3;

Vec3 inverse(const Vec3& mass) {
  // what is held has an infinite mass, and takes nothing
  return mass.unaryExpr([](double m) { return std::isinf(m) ? 0.0 : 1.0 / m; });
}

/// A contact with what its two bodies yield to it.
struct Yielding {
  const StepContact* given;
  Vec3 normal_moves_body, normal_moves_other;  ///< change of velocity for an impulse of 1
  Vec3 tangent_moves_body, tangent_moves_other;
  double turn_moves_body, turn_moves_other;
  double nn, nt, tt, rr;  ///< change of v_n, v_t, omega at the contact for an impulse of 1 along each
};

class Sweeps {
 public:
  explicit Sweeps(const StepProblem& problem) : h_(problem.duration), velocity_(problem.velocity) {
    std::vector<Vec3> yields;
    for (std::size_t i = 0; i < problem.mass.size(); ++i) {
      yields.push_back(inverse(problem.mass[i]));
      velocity_[i] += h_ * problem.force[i].cwiseProduct(yields[i]);
    }
    for (const StepContact& s : problem.contacts) add(s, yields);
  }

  void begin_with(const std::vector<ContactLoad>& loads) {
    for (std::size_t k = 0; k < loads.size(); ++k) change(contacts_[k], loads[k]);
  }

  /// The contact's impulse with all others as they are. True of one that slips.
  bool renew(std::size_t k, ContactLoad& load, double& most) {
    const Yielding& y = contacts_[k];
    const StepContact& s = *y.given;
    const LastingContact& c = s.contact;
    if (!(y.nn > 0.0)) return false;  // between what is held
    // speeds without the impulse that it has; of the normal, gap / h more than what is to be 0 at least
    const double normal = speed(c, c.normal_on_body, c.normal_on_other) + s.gap / h_ - s.support_velocity[0] -
                          y.nn * load.normal - y.nt * load.tangential;
    ContactLoad next;
    bool slips = false;
    if (normal < 0.0) {
      const double slip = speed(c, c.tangent_on_body, c.tangent_on_other) - s.support_velocity[1] -
                          y.nt * load.normal - y.tt * load.tangential;
      slips = hold_or_slip(y, c.friction, normal, slip, next);
      next.rolling = hold_turn(y, c, load.rolling, next.normal);
    }
    const ContactLoad more{next.normal - load.normal, next.tangential - load.tangential,
                           next.rolling - load.rolling};
    most = std::max({most, std::abs(more.normal), std::abs(more.tangential)});
    if (more.normal != 0.0 || more.tangential != 0.0 || more.rolling != 0.0) change(y, more);
    load = next;
    return slips;
  }

 private:
  void add(const StepContact& s, const std::vector<Vec3>& yields) {
    const LastingContact& c = s.contact;
    const Vec3 &body = yields[c.body], other = c.other < 0 ? Vec3(Vec3::Zero()) : yields[c.other];
    Yielding y{};
    y.given = &s;
    y.normal_moves_body = body.cwiseProduct(c.normal_on_body);
    y.normal_moves_other = other.cwiseProduct(c.normal_on_other);
    y.tangent_moves_body = body.cwiseProduct(c.tangent_on_body);
    y.tangent_moves_other = other.cwiseProduct(c.tangent_on_other);
    y.turn_moves_body = body[2];
    y.turn_moves_other = other[2];
    y.nn = c.normal_on_body.dot(y.normal_moves_body) + c.normal_on_other.dot(y.normal_moves_other);
    y.nt = c.normal_on_body.dot(y.tangent_moves_body) + c.normal_on_other.dot(y.tangent_moves_other);
    y.tt = c.tangent_on_body.dot(y.tangent_moves_body) + c.tangent_on_other.dot(y.tangent_moves_other);
    y.rr = body[2] + other[2];
    contacts_.push_back(y);
  }

  double speed(const LastingContact& c, const Vec3& on_body, const Vec3& on_other) const {
    return on_body.dot(velocity_[c.body]) + (c.other < 0 ? 0.0 : on_other.dot(velocity_[c.other]));
  }

  void change(const Yielding& y, const ContactLoad& by) {
    const LastingContact& c = y.given->contact;
    velocity_[c.body] += by.normal * y.normal_moves_body + by.tangential * y.tangent_moves_body;
    velocity_[c.body][2] += by.rolling * y.turn_moves_body;
    if (c.other < 0) return;
    velocity_[c.other] += by.normal * y.normal_moves_other + by.tangential * y.tangent_moves_other;
    velocity_[c.other][2] -= by.rolling * y.turn_moves_other;
  }

  /// Of a contact that would close at `normal` < 0 and slip by `slip`. True where it slips: what would hold it is outside
  /// the cone.
  static bool hold_or_slip(const Yielding& y, double friction, double normal, double slip,
                           ContactLoad& load) {
    const double det = y.nn * y.tt - y.nt * y.nt;
    if (det > 0.0) {
      load.normal = (y.nt * slip - y.tt * normal) / det;
      load.tangential = (y.nt * normal - y.nn * slip) / det;
    } else {
      // both directions move the same: nothing is left for friction
      load.normal = -normal / y.nn;
      load.tangential = 0.0;
    }
    if (load.normal >= 0.0 && std::abs(load.tangential) <= friction * load.normal) return false;
    const double way = std::copysign(friction, load.tangential);
    const double yields = y.nn + way * y.nt;
    // Painleve: friction would press harder than the contact yields; without it there is always an answer
    load.normal = -normal / (yields > 0.0 ? yields : y.nn);
    load.tangential = yields > 0.0 ? way * load.normal : 0.0;
    return true;
  }

  /// The torque against the turning, within r times the normal impulse.
  double hold_turn(const Yielding& y, const LastingContact& c, double torque, double normal) const {
    if (!(c.rolling_resistance > 0.0 && y.rr > 0.0)) return 0.0;
    const double turns =
        velocity_[c.body][2] - (c.other < 0 ? 0.0 : velocity_[c.other][2]) - y.given->support_velocity[2];
    const double most = c.rolling_resistance * normal;
    return std::clamp(torque - turns / y.rr, -most, most);
  }

  double h_;
  std::vector<Vec3> velocity_;  ///< of every body, with the impulses that contacts have
  std::vector<Yielding> contacts_;
};

}  // namespace

CoulombLoads sweep_by_coulomb(const StepProblem& problem, int fewest, int most, const GoOn& go_on) {
  CoulombLoads found;
  const std::size_t count = problem.contacts.size();
  for (const StepContact& s : problem.contacts) found.loads.push_back(s.expected);
  found.slips.assign(count, 0);
  Sweeps sweeps(problem);
  sweeps.begin_with(found.loads);
  for (; found.sweeps < most; ++found.sweeps) {
    if (go_on && !go_on()) break;
    double changed = 0.0, largest = 0.0;
    for (std::size_t n = 0; n < count; ++n) {
      // forwards and backwards in turn: what is known at one end of a heap comes to the other in a sweep
      const std::size_t k = found.sweeps % 2 == 0 ? n : count - 1 - n;
      found.slips[k] = sweeps.renew(k, found.loads[k], changed) ? 1 : 0;
      largest = std::max(largest, found.loads[k].normal);
    }
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
