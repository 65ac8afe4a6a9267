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

double yields(const Triple& a, const Triple& of_body, const Triple& b, const Triple& of_other,
              const Triple& c, const Triple& d) {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) sum += a.at[k] * of_body.at[k] * c.at[k] + b.at[k] * of_other.at[k] * d.at[k];
  return sum;
}

/// Contacts that share no body are taken side by side, so many at a time: one number of each is in one register.
constexpr int kAbreast = 8;
using Lanes = double[kAbreast];

/// Of bodies side by side.
struct alignas(64) Motions {
  Lanes x, y, angle;
};

/// Impulses of contacts side by side.
struct alignas(64) Loads {
  Lanes normal, tangential, rolling;
};

/// Of a sweep, lane by lane.
struct alignas(64) Largest {
  Lanes change, load;
};
inline double larger(double a, double b) { return a < b ? b : a; }

/// Contacts side by side, with what their bodies yield to them.
struct alignas(64) Yielding {
  Motions inverse_mass, other_inverse_mass;
  Lanes x, y;  ///< the normal, for the body: the tangent is (-y, x), and for the other both are the opposite
  Lanes normal_turns, other_normal_turns, tangent_turns, other_tangent_turns;  ///< along the angle
  Lanes nn, nt, tt;  ///< change of v_n, v_t at the contact for an impulse of 1 along each
  /// Impulses for a change of 1: of both along the two, where both are to be 0; of the normal alone; of the normal with
  /// friction at its most along the tangent, and against it; of the spin. 0 where nothing yields.
  Lanes nn_of, nt_of, tt_of, normal_alone, with_friction, against_friction, rolling_alone;
  Lanes room;                   ///< speed of opening at which the gap is closed in the step, below 0 [m/s]
  Lanes slides, turns;          ///< tangential speed and spin of the support
  Lanes friction, rolling_arm;  ///< largest q, and torque, for p = 1
  int body[kAbreast], other[kAbreast];  ///< places of bodies; of what does not yield the last
};

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
    take_places(problem.contacts);
    for (std::size_t k = 0; k < places_.size(); ++k) add(problem.contacts[k], problem.duration, places_[k]);
    for (std::size_t n = 0; n < contacts_.size(); ++n) change(contacts_[n], loads_[n]);
  }

  /// All contacts once, in their order or in the reverse.
  void sweep(bool forwards, double& most_changed, double& largest);

  /// Of the problem's contacts, in their order.
  std::vector<ContactLoad> loads() const {
    std::vector<ContactLoad> loads;
    for (const auto [n, lane] : places_)
      loads.push_back({loads_[n].normal[lane], loads_[n].tangential[lane], loads_[n].rolling[lane]});
    return loads;
  }

 private:
  struct Place {
    std::size_t n;
    int lane;
  };

  /// Each contact comes as early as it can behind those of its bodies that come before it, so that it finds what it would find
  /// in the problem's order.
  void take_places(const std::vector<StepContact>& contacts) {
    std::vector<std::size_t> next(velocity_.size(), 0);  // for a contact of the body
    std::vector<int> taken;                              // lanes
    for (const StepContact& s : contacts) {
      std::size_t& of_body = next[s.contact.body];
      std::size_t n = s.contact.other < 0 ? of_body : std::max(of_body, next[s.contact.other]);
      while (n < taken.size() && taken[n] == kAbreast) ++n;
      if (n == taken.size()) taken.push_back(0);
      places_.push_back({n, taken[n]++});
      of_body = n + 1;
      if (s.contact.other >= 0) next[s.contact.other] = n + 1;
    }
    // in a lane that is left nothing yields
    Yielding nothing{};
    std::fill_n(nothing.body, kAbreast, static_cast<int>(velocity_.size()) - 1);
    std::copy_n(nothing.body, kAbreast, nothing.other);
    contacts_.assign(taken.size(), nothing);
    loads_.resize(taken.size());
  }

  void add(const StepContact& s, double h, const Place& at) {
    const LastingContact& c = s.contact;
    const auto [n, k] = at;
    Yielding& y = contacts_[n];
    const Triple normal = Triple::of(c.normal_on_body), tangent = Triple::of(c.tangent_on_body);
    Triple other_normal{}, other_tangent{};
    y.body[k] = c.body;
    if (c.other >= 0) {
      y.other[k] = c.other;
      other_normal = Triple::of(c.normal_on_other);
      other_tangent = Triple::of(c.tangent_on_other);
    }
    const Triple &body = inverse_mass_[y.body[k]], &other = inverse_mass_[y.other[k]];
    put(body, y.inverse_mass, k);
    put(other, y.other_inverse_mass, k);
    y.x[k] = normal.at[0];
    y.y[k] = normal.at[1];
    y.normal_turns[k] = normal.at[2];
    y.other_normal_turns[k] = other_normal.at[2];
    y.tangent_turns[k] = tangent.at[2];
    y.other_tangent_turns[k] = other_tangent.at[2];
    const double nn = y.nn[k] = yields(normal, body, other_normal, other, normal, other_normal);
    const double nt = y.nt[k] = yields(normal, body, other_normal, other, tangent, other_tangent);
    const double tt = y.tt[k] = yields(tangent, body, other_tangent, other, tangent, other_tangent);
    const double det = nn * tt - nt * nt;
    if (det > 0.0) {
      y.nn_of[k] = tt / det;
      y.nt_of[k] = nt / det;
      y.tt_of[k] = nn / det;
    }
    const auto impulse = [](double yields) { return yields > 0.0 ? 1.0 / yields : 0.0; };
    y.normal_alone[k] = impulse(nn);
    y.with_friction[k] = impulse(nn + c.friction * nt);
    y.against_friction[k] = impulse(nn - c.friction * nt);
    y.rolling_alone[k] = impulse(body.at[2] + other.at[2]);
    y.room[k] = s.gap / h - s.support_velocity[0];
    y.slides[k] = s.support_velocity[1];
    y.turns[k] = s.support_velocity[2];
    y.friction[k] = c.friction;
    y.rolling_arm[k] = c.rolling_resistance;
    loads_[n].normal[k] = s.expected.normal;
    loads_[n].tangential[k] = s.expected.tangential;
    loads_[n].rolling[k] = s.expected.rolling;
  }

  static void put(const Triple& one, Motions& in, int k) {
    in.x[k] = one.at[0];
    in.y[k] = one.at[1];
    in.angle[k] = one.at[2];
  }
  void get(const int (&bodies)[kAbreast], Motions& velocities) const {
    for (int k = 0; k < kAbreast; ++k) put(velocity_[bodies[k]], velocities, k);
  }
  void set(const int (&bodies)[kAbreast], const Motions& to) {
    for (int k = 0; k < kAbreast; ++k) velocity_[bodies[k]] = {{to.x[k], to.y[k], to.angle[k], 0.0}};
  }

  /// The contacts' impulses with all others as they are, and by how much they are `more` than before.
  void renew(const Yielding& y, Loads& load, Loads& more, Largest& seen) const {
    Motions body, other;
    get(y.body, body);
    get(y.other, other);
    for (int k = 0; k < kAbreast; ++k) {
      // speeds without the impulse that it has; of the normal, gap / h more than what is to be 0 at least
      const double normal = (y.x[k] * body.x[k] - y.x[k] * other.x[k]) +
                            (y.y[k] * body.y[k] - y.y[k] * other.y[k]) +
                            (y.normal_turns[k] * body.angle[k] + y.other_normal_turns[k] * other.angle[k]) +
                            y.room[k] - y.nn[k] * load.normal[k] - y.nt[k] * load.tangential[k];
      const double slip = (y.y[k] * other.x[k] - y.y[k] * body.x[k]) +
                          (y.x[k] * body.y[k] - y.x[k] * other.y[k]) +
                          (y.tangent_turns[k] * body.angle[k] + y.other_tangent_turns[k] * other.angle[k]) -
                          y.slides[k] - y.nt[k] * load.normal[k] - y.tt[k] * load.tangential[k];
      // held, where friction can; where both directions move the same, nothing is left for it
      const bool both = y.nn_of[k] > 0.0;
      const double holds = both ? y.nt_of[k] * slip - y.nn_of[k] * normal : -normal * y.normal_alone[k];
      const double along = both ? y.nt_of[k] * normal - y.tt_of[k] * slip : 0.0;
      // It slips where what would hold it is outside the cone.
      const double way = along < 0.0 ? -y.friction[k] : y.friction[k];
      const double impulse = way > 0.0 ? y.with_friction[k] : y.against_friction[k];
      // Painleve: friction would press harder than the contact yields; without it there is always an answer
      const double slips = -normal * (impulse > 0.0 ? impulse : y.normal_alone[k]);
      const double drags = impulse > 0.0 ? way * slips : 0.0;
      const bool within = (holds >= 0.0) & (std::abs(along) <= y.friction[k] * holds);
      const double pressed = within ? holds : slips, pulled = within ? along : drags;
      // the torque against the turning, within its arm times the normal impulse
      const double most = y.rolling_arm[k] * pressed;
      const double turns =
          load.rolling[k] - (body.angle[k] - other.angle[k] - y.turns[k]) * y.rolling_alone[k];
      const double clamped = turns < -most ? -most : (most < turns ? most : turns);
      const double rolled = y.rolling_alone[k] > 0.0 ? clamped : 0.0;
      // what opens has none; between what is held they stay as they are
      const bool yields = y.nn[k] > 0.0, closes = normal < 0.0;
      const double p = yields ? (closes ? pressed : 0.0) : load.normal[k];
      const double q = yields ? (closes ? pulled : 0.0) : load.tangential[k];
      const double torque = yields ? (closes ? rolled : 0.0) : load.rolling[k];
      more.normal[k] = p - load.normal[k];
      more.tangential[k] = q - load.tangential[k];
      more.rolling[k] = torque - load.rolling[k];
      seen.change[k] = larger(seen.change[k], larger(std::abs(more.normal[k]), std::abs(more.tangential[k])));
      seen.load[k] = larger(seen.load[k], p);
      load.normal[k] = p;
      load.tangential[k] = q;
      load.rolling[k] = torque;
    }
  }

  /// The velocities, by impulses.
  void change(const Yielding& y, const Loads& by) {
    Motions body, other;
    get(y.body, body);
    get(y.other, other);
    for (int k = 0; k < kAbreast; ++k) {
      const double x = y.x[k] * by.normal[k] - y.y[k] * by.tangential[k];
      const double along_y = y.y[k] * by.normal[k] + y.x[k] * by.tangential[k];
      body.x[k] += y.inverse_mass.x[k] * x;
      body.y[k] += y.inverse_mass.y[k] * along_y;
      body.angle[k] += y.inverse_mass.angle[k] * (y.normal_turns[k] * by.normal[k] +
                                                  y.tangent_turns[k] * by.tangential[k] + by.rolling[k]);
      other.x[k] -= y.other_inverse_mass.x[k] * x;
      other.y[k] -= y.other_inverse_mass.y[k] * along_y;
      other.angle[k] +=
          y.other_inverse_mass.angle[k] * (y.other_normal_turns[k] * by.normal[k] +
                                           y.other_tangent_turns[k] * by.tangential[k] - by.rolling[k]);
    }
    set(y.body, body);
    set(y.other, other);
  }

  std::vector<Triple> inverse_mass_,
      velocity_;               ///< of every body, the latter with the impulses that contacts have
  std::vector<Place> places_;  ///< of the problem's contacts in the two below
  std::vector<Yielding> contacts_;
  std::vector<Loads> loads_;
};

BRINK_WIDE void Sweeps::sweep(bool forwards, double& most_changed, double& largest) {
  const std::size_t count = contacts_.size();
  Largest seen{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t n = forwards ? i : count - 1 - i;
    Loads more;
    renew(contacts_[n], loads_[n], more, seen);
    change(contacts_[n], more);
  }
  most_changed = *std::max_element(seen.change, seen.change + kAbreast);
  largest = *std::max_element(seen.load, seen.load + kAbreast);
}

}  // namespace

CoulombLoads sweep_by_coulomb(const StepProblem& problem, int fewest, int most, const GoOn& go_on) {
  CoulombLoads found;
  Sweeps sweeps(problem);
  for (; found.sweeps < most; ++found.sweeps) {
    if (go_on && !go_on()) break;
    double changed, largest;
    // forwards and backwards in turn: what is known at one end of a heap comes to the other in a sweep
    sweeps.sweep(found.sweeps % 2 == 0, changed, largest);
    if (changed <= (found.sweeps < fewest ? kSettled : kNearlySettled) * largest) break;
  }
  found.loads = sweeps.loads();
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
