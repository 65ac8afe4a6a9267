#pragma once
/// Forces as equations of motion: which bodies they couple, the accelerations they give, the energy they
/// store.

#include <memory>
#include <span>
#include <vector>

#include "brink/core/base/dynamics.h"
#include "brink/core/world/world.h"

namespace brink {

/// Bodies coupled by forces, in ascending order. Every body is in exactly one component.
struct Component {
  std::vector<int> bodies;
  std::shared_ptr<Dynamics> dynamics;  ///< over `bodies`, in that order
};

/// Splits the world into components: bodies joined by a spring are in one, and so are the bodies of each set
/// of `together`; all else are alone. `world` must outlive the dynamics. Uniform gravity with constant thrusts
/// is Dynamics::constant(); with linear drag it is linear_drag().
std::vector<Component> make_components(const World& world, std::span<const std::vector<int>> together = {});

/// Kinetic energy of all bodies, plus the potential of gravity, springs and attractors at these states [J].
double total_energy(const World& world, std::span<const BodyState> states);

struct Momentum {
  Vec2 linear = Vec2::Zero();  ///< [kg m/s]
  double angular = 0.0;        ///< about the world's origin [kg m^2/s]
};
Momentum total_momentum(const World& world, std::span<const BodyState> states);

/// True if every force stores energy (no drag, damping, thrust or formula): total_energy is then conserved
/// between elastic frictionless collisions with sites that do not move.
bool conservative(const World& world);

}  // namespace brink
