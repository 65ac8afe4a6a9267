/// What the forces store: energy, momentum, and whether the energy is conserved.
#include <cmath>

#include "brink/core/base/elementary.h"

#include "brink/core/world/forces.h"

namespace brink {

namespace {

/// Held coordinates have no velocity, so that mass and inertia count as they are.
double kinetic(const Body& body, const Twist& twist) {
  return 0.5 * body.mass * twist.velocity.squaredNorm() + 0.5 * body.inertia * twist.omega * twist.omega;
}

/// k (length - rest)^2 / 2: the conservative part; a damper stores nothing.
double potential(const World&, const SpringForce& spring, std::span<const BodyState> states) {
  const Vec2 a = Frame(states[spring.body_a].pose).to_world(spring.at_a);
  const Vec2 b = spring.body_b < 0 ? spring.at_b : Frame(states[spring.body_b].pose).to_world(spring.at_b);
  // dU / d(length) = k (length - rest): the pull of add_springs() in forces.cpp without its damper.
  const double stretch = (b - a).norm() - spring.rest_length;
  return 0.5 * spring.stiffness * stretch * stretch;
}

/// The force is m strength r^power inward, so that it is the slope of the potential outward.
/// Integral of strength r^power: r^(power + 1) / (power + 1), a logarithm at power -1.
double potential(const World& world, const AttractForce& attract, std::span<const BodyState> states) {
  double sum = 0.0;
  for (int k : attract.bodies) {
    const double r = (states[k].pose.position - attract.center).norm();
    const double n = attract.power + 1.0;
    sum += world.bodies[k].mass * attract.strength * (n == 0.0 ? logarithm(r) : power(r, n) / n);
  }
  return sum;
}

/// Drag, thrusts and formulas have none that is counted; conservative() tells whether there are any.
template <class Other>
double potential(const World&, const Other&, std::span<const BodyState>) {
  return 0.0;
}

/// True if total_energy() counts all that the force does. Of what is not conservative that holds only where
/// its coefficients are 0. A thrust is switched on and off, and what formulas do is not known.
bool stores_energy(const SpringForce& spring) { return spring.damping == 0.0; }
bool stores_energy(const DragForce& d) { return d.linear == 0.0 && d.quadratic == 0.0 && d.angular == 0.0; }
bool stores_energy(const AttractForce&) { return true; }
bool stores_energy(const ThrustForce& thrust) { return thrust.force.isZero(0.0) && thrust.torque == 0.0; }
bool stores_energy(const FormulaForce&) { return false; }

}  // namespace

double total_energy(const World& world, std::span<const BodyState> states) {
  double energy = 0.0;
  for (std::size_t k = 0; k < world.bodies.size(); ++k) {
    const Body& body = world.bodies[k];
    // uniform gravity: potential 0 at the world's origin
    energy += kinetic(body, states[k].twist) - body.mass * world.gravity.dot(states[k].pose.position);
  }
  for (const Force& force : world.forces)
    energy += std::visit([&](const auto& f) { return potential(world, f, states); }, force);
  return energy;
}

Momentum total_momentum(const World& world, std::span<const BodyState> states) {
  Momentum total;
  for (std::size_t k = 0; k < world.bodies.size(); ++k) {
    // Of its orbit about the origin, and of its spin about its own centre of mass.
    const Body& body = world.bodies[k];
    const Vec2 p = body.mass * states[k].twist.velocity;
    total.linear += p;
    total.angular += cross(states[k].pose.position, p) + body.inertia * states[k].twist.omega;
  }
  return total;
}

bool conservative(const World& world) {
  for (const Force& force : world.forces)
    if (!std::visit([](const auto& f) { return stores_energy(f); }, force)) return false;
  return true;
}

}  // namespace brink
