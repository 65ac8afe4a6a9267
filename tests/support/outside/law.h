#pragma once
/// What one collision may do, by the laws of Newton and Coulomb, and of energy (Brach 1989), from the impulse that was recorded.

#include <string>

#include "brink/core/world/world.h"
#include "tests/support/outside/flight.h"

namespace brink::outside {

inline Real combine(Combine rule, Real a, Real b) {
  switch (rule) {
    case Combine::max:
      return std::max(a, b);
    case Combine::min:
      return std::min(a, b);
    case Combine::mean:
      return (a + b) / 2;
    case Combine::geometric_mean:
      return std::sqrt(a * b);
    case Combine::product:
      return a * b;
  }
  return 0;
}

struct Surface {
  Real restitution = 1, friction = 0, tangential = 0;
};
inline Surface surface_of(const World& world, int a, int b) {
  const Material &m = world.materials[a], &n = world.materials[b];
  return {combine(world.restitution_rule, m.restitution, n.restitution),
          combine(world.friction_rule, m.friction, n.friction),
          std::max(m.tangential_restitution, n.tangential_restitution)};
}

/// How a body answers an impulse.
struct Inertia {
  Real x = 0, y = 0, angle = 0;  ///< inverse masses and inertia
};
inline Inertia inertia_of(const Body& b) {
  return {b.lock_x ? 0 : 1 / Real(b.mass), b.lock_y ? 0 : 1 / Real(b.mass),
          b.lock_angle ? 0 : 1 / Real(b.inertia)};
}
inline State pushed(State s, const Inertia& by, const Vec& arm, const Vec& impulse) {
  s.velocity = s.velocity + Vec{impulse.x * by.x, impulse.y * by.y};
  s.omega += wedge(arm, impulse) * by.angle;
  return s;
}

/// A collision as seen from outside: both sides before and after it, and what pushed them.
struct Impact {
  Vec normal;              ///< into the body
  Vec before, after;       ///< velocity of the body's touching point against the other's
  Real push = 0, rub = 0;  ///< impulses along the normal and along left_of(normal)
  Real noise = 0;          ///< how well these velocities are known [m/s]
  Surface surface;
};

/// What is wrong with it, in words; empty: nothing.
inline std::string wrong_with(const Impact& i) {
  const Real small = i.noise, closing = -dot(i.normal, i.before);
  const Real leaving = dot(i.normal, i.after), slides = dot(left_of(i.normal), i.after);
  if (!(i.push >= 0)) return "pulls";
  if (std::abs(i.rub) > i.surface.friction * i.push * (1 + 1e-9L)) return "friction outside its cone";
  // a push of nothing, where rounding took rest for an approach, is let pass; a wrong side is not
  if (closing < -(i.push > 0 ? 1 : 1e5L) * small)
    return "was parting already, at " + std::to_string(static_cast<double>(-closing)) + " m/s";
  if (i.push > 0 && std::abs(leaving - i.surface.restitution * closing) > small)
    return "parts at " + std::to_string(static_cast<double>(leaving)) + " m/s, came at " +
           std::to_string(static_cast<double>(closing)) + ": not as restitution says";
  // What impulses do: each along the mean of its velocities. No collision gains, however friction and restitution go together.
  const Real slid = dot(left_of(i.normal), i.before);
  const Real by_push = i.push * (leaving - closing) / 2, by_rub = i.rub * (slid + slides) / 2,
             noise = 1e-9L * (std::abs(by_push) + std::abs(by_rub)) + (i.push + std::abs(i.rub)) * small;
  const Real gained = by_push + by_rub;
  if (gained > noise) return "gains " + std::to_string(static_cast<double>(gained)) + " J";
  const bool sticks = std::abs(i.rub) < i.surface.friction * i.push * (1 - 1e-9L);
  const Real would = -i.surface.tangential * slid;
  // less friction than that is right where more would gain: there the collision loses nothing
  if (sticks && gained < -noise && std::abs(slides - would) > small + 1e-6L * std::abs(would))
    return "slides though it sticks";
  return {};
}

}  // namespace brink::outside
