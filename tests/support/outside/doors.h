#pragma once
/// A run looked at from outside, of which a program changes the course: it puts bodies elsewhere, pushes
/// them, and lets pairs pass through each other.

#include <functional>

#include "tests/support/outside/watch.h"

namespace brink::outside {

/// A Watch that is told what a program does between runs. Times are the present ones.
class DoorWatch : public Watch {
 public:
  using Watch::Watch;

  /// Body k goes on from this state.
  void put(int k, Real t, const State& state) {
    go_on(k, t, state);
    rebase_energy(t);
  }

  /// Body k, in `before`, is given an impulse [N s] at a point [m]; returns the state in which it goes on.
  State push(int k, Real t, const State& before, const Vec& impulse, const Vec& point) {
    const Vec arm = point - before.place.at;
    const State after = pushed(before, bodies_[k].inertia, arm, impulse);
    go_on(k, t, {state(k, t).place, after.velocity, after.omega});
    rebase_energy(t);
    return after;
  }

  /// From now on owners a < b (bodies first, then sites) of whom `may_meet` says no are not looked at.
  void let_pass(Real t, const std::function<bool(int a, int b)>& may_meet) {
    for (Pair& p : pairs_) {
      if (free_) follow(p, t);
      p.apart = !may_meet(p.a, p.b);
      p.clear_to = t;
    }
  }

  /// The least gap of body k, were it in that state, to everybody whom it does not pass through [m].
  Real clearance(int k, Real t, const State& s) {
    Real least = kNever;
    for (const Pair& p : pairs_) {
      if (p.apart || (p.a != k && p.b != k)) continue;
      least =
          std::min(least, exact_gap(p.a, p.b, p.a == k ? s : state(p.a, t), p.b == k ? s : state(p.b, t)));
    }
    return least;
  }
  /// The gap of two owners now [m].
  Real gap_of(int a, int b, Real t) { return exact_gap(a, b, state(a, t), state(b, t)); }
  /// What it is told to [m].
  Real blur(int a, int b, Real t) const { return tolerance(a, b, t); }
  using Watch::of_place;

  void event(const Event& e) override {
    if (e.kind == EventKind::collision) look_at_filter(e);
    Watch::event(e);
  }

  void blame(double t, const std::string& what, int k) { fault(t, what, k, -1); }

 private:
  void go_on(int k, Real t, const State& state) {
    for (Pair& p : pairs_)
      if (free_ && (p.a == k || p.b == k)) follow(p, t);
    bodies_[k].flight = {t, state, bodies_[k].flight.pull};
    bodies_[k].astray = 0;
    bodies_[k].frame = t;
  }

  void look_at_filter(const Event& e) {
    const int other = e.contact.other_body >= 0 ? e.contact.other_body
                                                : static_cast<int>(bodies_.size()) + e.contact.other_site;
    for (const Pair& p : pairs_)
      if (p.apart && p.a == std::min(e.contact.body, other) && p.b == std::max(e.contact.body, other))
        fault(e.contact.time, "collide, though they are let pass", p.a, p.b);
  }

  void rebase_energy(Real t) {
    first_energy_ = 0;
    for (std::size_t k = 0; k < bodies_.size(); ++k)
      first_energy_ += energy_of(k, state(static_cast<int>(k), t)).sum;
  }
};

}  // namespace brink::outside
