#pragma once
/// Small scenes for modes, made by hand: one or two bodies on lines and circles.

#include <cmath>
#include <vector>

#include "brink/scheduler/islands/modes/mode_motion.h"

namespace brink {

inline constexpr double kGravity = 9.81;

struct ModeScene {
  ModeProblem problem;
  std::vector<BodyState> states;
  std::vector<bool> closed;

  ModeScene() {
    problem.free = [](double, std::span<const BodyState>, std::span<Acceleration> out) {
      for (Acceleration& a : out) a = {{0.0, -kGravity}, 0.0};
    };
  }
  int add_body(double mass, double inertia, const BodyState& state) {
    problem.inverse_mass.emplace_back(1 / mass, 1 / mass, 1 / inertia);
    states.push_back(state);
    return problem.bodies() - 1;
  }
  /// Of all bodies that are there by then.
  int add_support(const Motion& motion) {
    problem.supports.push_back(motion);
    return problem.bodies() + static_cast<int>(problem.supports.size()) - 1;
  }
  int add_still() { return add_support(Motion::still({})); }
  void add(const SmoothContact& shape, int sample_owner, int site_owner, double friction,
           bool is_closed = true) {
    problem.contacts.push_back({shape, sample_owner, site_owner, friction, 0.0});
    closed.push_back(is_closed);
  }
};

/// A point of a body against the line through `place` with that normal.
inline SmoothContact point_on_line(const Vec2& sample, const Vec2& place, const Vec2& normal,
                                   double radius = 0.0) {
  SmoothContact c;
  c.sample = sample;
  c.sample_radius = radius;
  c.place = place;
  c.normal = normal.normalized();
  return c;
}

inline SmoothContact in_bowl(double sample_radius, double radius) {
  SmoothContact c;
  c.kind = SmoothContact::Kind::circle;
  c.hollow = true;
  c.sample_radius = sample_radius;
  c.radius = radius;
  return c;
}

/// A box of that half width and height on its lower corners, on a plane through the origin inclined by `angle`
/// (it goes up to the right), 1 kg; its lower side's middle is at the origin.
inline ModeScene box_on_incline(double half_width, double half_height, double angle, double friction,
                                const Twist& twist = {}) {
  ModeScene s;
  const Vec2 n(-std::sin(angle), std::cos(angle));
  const double w = 2 * half_width, h = 2 * half_height;
  s.add_body(1.0, (w * w + h * h) / 12, {{half_height * n, angle}, twist});
  const int plane = s.add_still();
  s.add(point_on_line({-half_width, -half_height}, {0, 0}, n), 0, plane, friction);
  s.add(point_on_line({half_width, -half_height}, {0, 0}, n), 0, plane, friction);
  return s;
}

struct ModeLog {
  struct Entry {
    double time;
    std::vector<MotionMode> modes;
    std::vector<BodyState> states;
  };
  std::vector<Entry> changes;  ///< the first: the beginning
  ModeEnd end = ModeEnd::step;
  int steps = 0;
  double time = 0.0;
  std::vector<BodyState> states;
  double worst_gap = 0.0;  ///< of closed contacts against what they keep, on the pieces [m]
};

/// Follows the scene to `until`, or to what ends it.
inline ModeLog follow(const ModeScene& scene, double until, const ModeLimits& limits) {
  ModeLog log;
  ModeMotion motion(scene.problem, limits, 0.0, scene.states);
  if (!motion.begin(scene.closed)) {
    log.end = ModeEnd::no_modes;
    return log;
  }
  log.changes.push_back({0.0, motion.modes(), motion.states()});
  while (motion.time() < until && log.steps < 1000000) {
    const std::vector<MotionMode> modes = motion.modes();
    const double from = motion.time();
    const ModeStep step = motion.step(until);
    ++log.steps;
    if (!step.pieces.empty())
      for (int i = 0; i <= 16; ++i) {
        const double t = from + (motion.time() - from) * i / 16;
        std::vector<BodyState> states;
        for (const PolynomialPiece& p : step.pieces) states.push_back(p.state(t));
        const auto rates = rates_at(scene.problem, t, states);
        for (std::size_t k = 0; k < modes.size(); ++k)
          if (is_closed(modes[k]))
            log.worst_gap = std::max(log.worst_gap, std::abs(rates[k].gap - scene.problem.contacts[k].kept));
      }
    log.end = step.end;
    if (step.end == ModeEnd::change) log.changes.push_back({motion.time(), motion.modes(), motion.states()});
    if (step.end != ModeEnd::step && step.end != ModeEnd::change) break;
  }
  log.time = motion.time();
  log.states = motion.states();
  return log;
}

}  // namespace brink
