#pragma once
/// Motions that need no integrator: free flight under gravity, and sites that move as told.

#include <variant>

#include "brink/core/world/world.h"
#include "tests/support/outside/plane.h"

namespace brink::outside {

/// Where something is and how it moves.
struct State {
  Place place;
  Vec velocity;
  Real omega = 0;
};

inline State state_of(const BodyState& s) {
  return {{{s.pose.position.x(), s.pose.position.y()}, s.pose.angle},
          {s.twist.velocity.x(), s.twist.velocity.y()},
          s.twist.omega};
}

/// Velocity of the point of it that is `arm` from its origin.
inline Vec velocity_at(const State& s, const Vec& arm) { return s.velocity + left_of(arm) * s.omega; }

/// One parabola.
struct Flight {
  Real since = 0;
  State start;
  Vec pull;  ///< [m/s^2]

  State at(Real t) const {
    const Real h = t - since;
    State s = start;
    s.place.at = start.place.at + (start.velocity + pull * (h / 2)) * h;
    s.place.angle += start.omega * h;
    s.velocity = start.velocity + pull * h;
    return s;
  }
};

/// A fixed site, or one that moves as told.
class SitePath {
 public:
  explicit SitePath(const FixedSite& site) : motion_(site.motion) {
    start_.place = {{site.pose.position.x(), site.pose.position.y()}, site.pose.angle};
    if (const auto* m = std::get_if<ConstantMotion>(&site.motion)) {
      start_.velocity = {m->twist.velocity.x(), m->twist.velocity.y()};
      start_.omega = m->twist.omega;
    }
  }
  bool told_by_formula() const { return std::holds_alternative<FormulaMotion>(motion_); }
  bool stands() const { return std::holds_alternative<std::monostate>(motion_); }

  State at(Real t) const {
    if (!told_by_formula()) return Flight{0, start_, {}}.at(t);
    // rates by differences: some nine digits
    const double now = static_cast<double>(t), early = std::max(0.0, now - 1e-6), late = now + 1e-6;
    const Place before = told(early), after = told(late);
    const Real span = Real(late) - early;
    return {told(now), (after.at - before.at) * (1 / span), (after.angle - before.angle) / span};
  }

 private:
  Place told(double t) const {
    const auto& m = std::get<FormulaMotion>(motion_);
    const auto value = [&](const std::optional<Formula>& f) -> Real {
      return f ? (*f)(std::span<const double>(&t, 1)) : 0.0;
    };
    Place p = start_.place;
    p.at = p.at + Vec{value(m.x), value(m.y)};
    p.angle += value(m.angle);
    return p;
  }

  std::variant<std::monostate, ConstantMotion, FormulaMotion> motion_;
  State start_;
};

}  // namespace brink::outside
