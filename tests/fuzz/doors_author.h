#pragma once
/// Random programs: what they do is decided while they go, and looked at from outside.

#include <cmath>
#include <numbers>
#include <optional>

#include "brink/core/base/hash.h"
#include "brink/core/base/random.h"
#include "doors.h"
#include "tests/support/outside/doors.h"

namespace brink::doors {

/// A random program: it decides while it goes, and remembers what it has done.
class Author {
 public:
  Author(std::uint64_t seed, const Scene& scene, outside::DoorWatch& watch)
      : random_(seed ^ 0x5ca1ab1eULL), scene_(scene), watch_(watch), driver_(scene, &watch) {
    for (const Body& b : scene.world.bodies) speed_ = std::max(speed_, b.initial.twist.velocity.norm());
  }

  Script script;
  const Told& told() const { return driver_.told; }

  void go() {
    const int legs = 3 + below(5);
    for (int leg = 1; leg <= legs; ++leg) {
      for (int doors = below(4); doors > 0; --doors)
        if (simulator().time() > 0.0) act();
      const double to = leg == legs ? scene_.duration : scene_.duration * (leg - random_.uniform()) / legs;
      if (!go_on(to)) return;
    }
  }

 private:
  int below(int n) { return static_cast<int>(random_.below(static_cast<std::uint64_t>(n))); }
  bool chance(double p) { return random_.uniform() < p; }
  double log_uniform(double low, double high) { return low * std::pow(high / low, random_.uniform()); }
  Simulator& simulator() { return driver_.simulator(); }
  int bodies() const { return static_cast<int>(scene_.world.bodies.size()); }
  int owners() const { return bodies() + static_cast<int>(scene_.world.sites.size()); }

  bool carry_out(const Door& door) {
    script.push_back(door);
    return driver_.carry_out(door);
  }

  bool go_on(double to) {
    Door door;
    door.until = to;
    if (chance(0.4)) {
      door.kind = Door::Kind::step;
      for (int steps = 1 + below(3); steps > 0; --steps)
        if (!step(door)) return false;
      if (chance(0.5)) return true;
      door.kind = Door::Kind::run;
    }
    return carry_out(door);
  }

  bool step(const Door& door) {
    const std::uint64_t before = driver_.told.summary.collisions;
    if (!carry_out(door)) return false;
    const std::uint64_t met = driver_.told.summary.collisions - before;
    const bool stopped = driver_.told.summary.termination == Termination::stopped;
    // contacts that are taken together count each
    const bool one = takes_together(order_of(scene_.solver.order)) ? met >= 1 : met == 1;
    if (stopped ? !one : met != 0) watch_.blame(simulator().time(), "a step of another length", 0);
    return true;
  }

  void act() {
    const int what = below(5);
    if (what == 0) return let_pass();
    if (what < 3) return push();
    put();
  }

  void let_pass() {
    Door door;
    door.kind = Door::Kind::filter;
    const double share = chance(0.3) ? 0.0 : random_.uniform();
    const double t = simulator().time();
    for (int a = 0; a < bodies(); ++a)
      for (int b = a + 1; b < owners(); ++b) {
        const bool in_each_other =
            passing_.contains({a, b}) && watch_.gap_of(a, b, t) <= 4 * watch_.blur(a, b, t);
        if (in_each_other || chance(b < bodies() ? share : 0.2 * share)) door.passing.insert({a, b});
      }
    watch_.let_pass(t, [&](int a, int b) { return !door.passing.contains({a, b}); });
    passing_ = door.passing;
    carry_out(door);
  }

  void push() {
    Door door;
    door.kind = Door::Kind::push;
    const int k = door.body = below(bodies());
    const Body& b = scene_.world.bodies[k];
    const std::vector<BodyState> before = simulator().states();
    const double size = b.outline->bounding_radius, strength = b.mass * speed_ * log_uniform(1e-3, 3.0);
    const double a = random_.uniform(0.0, 2 * std::numbers::pi);
    door.impulse = strength * Vec2(std::cos(a), std::sin(a));
    door.point = before[k].pose.position + size * Vec2(random_.uniform(-1, 1), random_.uniform(-1, 1));
    const outside::State after = watch_.push(k, simulator().time(), outside::state_of(before[k]),
                                             outside::vec(door.impulse), outside::vec(door.point));
    carry_out(door);
    others_stay(before, k);
    const outside::State now = outside::state_of(simulator().state(k));
    const outside::Real fast = outside::norm(after.velocity) + std::abs(after.omega) * size +
                               before[k].twist.velocity.norm() + std::abs(before[k].twist.omega) * size;
    const outside::Real off =
        outside::norm(now.velocity - after.velocity) + std::abs(now.omega - after.omega) * size;
    const double t = simulator().time();
    // the arm is a difference of places
    const double blur = 1.0 + (before[k].pose.position.norm() + door.point.norm()) / size;
    if (off > 16 * outside::kUlp * (blur * fast + scene_.world.gravity.norm() * t))
      watch_.blame(t, "another velocity than the push gives", k);
    const outside::State was = outside::state_of(before[k]);
    const outside::Real moved =
        outside::norm(now.place.at - was.place.at) + std::abs(now.place.angle - was.place.angle) * size;
    if (moved > watch_.of_place(k, t)) watch_.blame(t, "moved by a push", k);
    look_at_jump(before, door);
  }

  /// Momentum grows by the impulse, angular momentum by its moment, energy by its work.
  void look_at_jump(const std::vector<BodyState>& before, const Door& door) {
    const World& world = scene_.world;
    const std::vector<BodyState> after = simulator().states();
    const Momentum p = total_momentum(world, before), q = total_momentum(world, after);
    const Body& b = world.bodies[door.body];
    const BodyState &s = before[door.body], &e = after[door.body];
    const Vec2 arm = door.point - s.pose.position, mean = 0.5 * (s.twist.velocity + e.twist.velocity);
    const double turn = 0.5 * (s.twist.omega + e.twist.omega);
    const double work = door.impulse.dot(mean + turn * Vec2(-arm.y(), arm.x()));
    double momenta = 0.0, energies = std::abs(total_energy(world, before)), reach = door.point.norm();
    for (std::size_t k = 0; k < before.size(); ++k)
      for (const BodyState& x : {before[k], after[k]}) {
        const Body& of = world.bodies[k];
        const double v = x.twist.velocity.norm(), h = world.gravity.norm() * x.pose.position.norm();
        reach = std::max(reach, x.pose.position.norm());
        momenta += of.mass * v + of.inertia * std::abs(x.twist.omega) / std::max(reach, 1e-3);
        energies += of.mass * (v * v + h) + of.inertia * x.twist.omega * x.twist.omega;
      }
    const double size = b.outline->bounding_radius;
    // the arm is a difference of places
    const double fine = 1e-12 + 1e-15 * (s.pose.position.norm() + door.point.norm()) / size;
    const auto off = [&](double x, double y, double scale) { return !(std::abs(x - y) <= fine * scale); };
    const double moment = door.point.x() * door.impulse.y() - door.point.y() * door.impulse.x();
    if ((q.linear - p.linear - door.impulse).norm() > fine * (momenta + b.mass * speed_) ||
        off(q.angular - p.angular, moment, (momenta + b.mass * speed_) * std::max(reach, 1e-3)) ||
        off(total_energy(world, after) - total_energy(world, before), work, energies))
      watch_.blame(simulator().time(), "momentum or energy do not jump as the impulse says", door.body);
  }

  void put() {
    Door door;
    door.kind = Door::Kind::put;
    const int k = door.body = below(bodies());
    const auto free = free_state(k);
    if (!free) return;
    door.state = *free;
    const std::vector<BodyState> before = simulator().states();
    watch_.put(k, simulator().time(), outside::state_of(door.state));
    carry_out(door);
    others_stay(before, k);
    StateHash given, got;
    given.add(door.state);
    got.add(simulator().state(k));
    if (given.value() != got.value()) watch_.blame(simulator().time(), "is not where it was put", k);
  }

  void others_stay(const std::vector<BodyState>& before, int k) {
    for (int j = 0; j < bodies(); ++j) {
      StateHash was, is;
      was.add(before[j]);
      is.add(simulator().state(j));
      if (j != k && was.value() != is.value())
        watch_.blame(simulator().time(), "changed by another's door", j);
    }
  }

  /// A place near where somebody stood at the start, in nobody's way.
  std::optional<BodyState> free_state(int k) {
    const double size = scene_.world.bodies[k].outline->bounding_radius, t = simulator().time();
    const outside::Real room = log_uniform(1e-6, 1e-1) * size;
    for (int tries = 0; tries < 20; ++tries) {
      BodyState s;
      const int by = below(bodies());
      s.pose.position =
          scene_.world.bodies[by].initial.pose.position +
          (chance(0.5) ? 0.2 : 2.0) * size * Vec2(random_.uniform(-1, 1), random_.uniform(-1, 1));
      s.pose.angle = random_.uniform(-7.0, 7.0) * (chance(0.1) ? log_uniform(1.0, 1e7) : 1.0);
      const double speed = speed_ * (chance(0.7) ? 1.0 : chance(0.5) ? 0.0 : 10.0);
      s.twist = {speed * Vec2(random_.uniform(-1, 1), random_.uniform(-1, 1)),
                 speed / size * random_.uniform(-1, 1) * (chance(0.8) ? 1.0 : 30.0)};
      const outside::State there = outside::state_of(s);
      if (watch_.clearance(k, t, there) > room) return s;
    }
    return std::nullopt;
  }

  Random random_;
  const Scene& scene_;
  outside::DoorWatch& watch_;
  Driver driver_;
  Passing passing_;
  double speed_ = 0.0;
};

}  // namespace brink::doors
