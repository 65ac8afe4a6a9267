#include "brink/core/world/world.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

/// What two coefficients make together. Every rule keeps numbers of 0 to 1 within 0 to 1 and none makes a
/// negative one, so that a pair is as valid as its materials.
double combine(Combine rule, double a, double b) {
  switch (rule) {
    case Combine::max:
      return std::max(a, b);
    case Combine::min:
      return std::min(a, b);
    case Combine::mean:
      return 0.5 * (a + b);
    case Combine::geometric_mean:
      return std::sqrt(a * b);
    case Combine::product:
      break;
  }
  return a * b;
}

}  // namespace

const std::vector<std::string>& force_formula_variables() {
  static const std::vector<std::string> names{"t", "x", "y", "angle", "vx", "vy", "omega", "m"};
  return names;
}

double World::length() const {
  // Bounding radii are about the frame's origin, of a body its centre of mass.
  double largest = 0.0;
  for (const Body& body : bodies)
    if (body.outline) largest = std::max(largest, 2.0 * body.outline->bounding_radius);
  if (largest > 0.0) return largest;
  for (const FixedSite& site : sites)
    if (site.outline) largest = std::max(largest, 2.0 * site.outline->bounding_radius);
  return largest > 0.0 ? largest : 1.0;
}

Material combined(const World& world, int material_a, int material_b) {
  const Material& a = world.materials.at(material_a);
  const Material& b = world.materials.at(material_b);
  Material pair;
  // Only the name depends on the order: a pair has the same law whichever of the two is the body.
  pair.name = a.name == b.name ? a.name : a.name + "/" + b.name;
  pair.restitution = combine(world.restitution_rule, a.restitution, b.restitution);
  pair.friction = combine(world.friction_rule, a.friction, b.friction);
  // The rules are for restitution and friction; what follows has one way each.
  pair.tangential_restitution = std::max(a.tangential_restitution, b.tangential_restitution);
  pair.rolling_resistance = std::max(a.rolling_resistance, b.rolling_resistance);
  pair.slip = a.slip * b.slip;
  pair.spin = a.spin * b.spin;
  return pair;
}

}  // namespace brink
