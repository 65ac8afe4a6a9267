#pragma once
/// What exists: bodies, fixed sites, materials and forces. Plain definitions, checked once, never mutated by
/// a run.

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "brink/core/base/periodic.h"
#include "brink/core/shapes/outline.h"
#include "brink/core/shapes/sampling.h"
#include "brink/core/world/formula.h"

namespace brink {

struct Material {
  std::string name = "default";
  double restitution = 1.0;             ///< Newton, 0..1
  double friction = 0.0;                ///< Coulomb, >= 0
  double tangential_restitution = 0.0;  ///< with friction: -1..1; 1 is the elastic rough "superball"
  double slip = 1.0;                    ///< `reflection` only: scalar of the tangential rebound
  double spin = 1.0;                    ///< `reflection` only: scalar of the angular rebound
  double rolling_resistance = 0.0;      ///< of contacts that last: largest torque for a normal force of 1 [m]
};

/// How two materials make one pair.
enum class Combine { max, min, mean, geometric_mean, product };

/// A rigid body; make_body() (make_body.h) gives one of a shape and a mass or density.
struct Body {
  std::string name;
  std::shared_ptr<const Outline> outline;  ///< about the centre of mass, which is the body's position
  double mass = 1.0;                       ///< [kg], > 0
  double inertia = 0.0;                    ///< about the centre of mass [kg m^2], > 0: must be given
  bool lock_x = false, lock_y = false, lock_angle = false;  ///< held coordinates: infinite mass there
  int material = 0;                                         ///< index into World::materials
  BodyState initial;
  Sampling sampling;  ///< of detector `depth` alone

  double inverse_mass_x() const { return lock_x ? 0.0 : 1.0 / mass; }
  double inverse_mass_y() const { return lock_y ? 0.0 : 1.0 / mass; }
  double inverse_inertia() const { return lock_angle ? 0.0 : 1.0 / inertia; }
};

/// A site's prescribed motion: a constant twist from its pose at t = 0 ...
struct ConstantMotion {
  Twist twist;
};
/// ... or its pose as formulas in t, relative to its pose at t = 0 (x, y [m], angle [rad]; empty: 0).
struct FormulaMotion {
  std::optional<Formula> x, y, angle;
};

/// One entry of the scene's fixed sites. It has infinite mass and belongs to the scene; it may move as told.
struct FixedSite {
  std::string name;
  std::string kind;  ///< the scene file's word for it: "segment", "disc", "polygon" ...
  std::shared_ptr<const Outline> outline;
  Pose pose;
  int material = 0;
  std::variant<std::monostate, ConstantMotion, FormulaMotion> motion;
};

/// Linear spring with damper between two bodies, or a body and an anchor. Conservative part: stiffness. Where
/// its ends meet it has no direction: the force there is 0.
struct SpringForce {
  int body_a = 0;
  int body_b = -1;           ///< -1: anchored
  Vec2 at_a = Vec2::Zero();  ///< where it is attached, in body a's frame [m]
  Vec2 at_b = Vec2::Zero();  ///< in body b's frame; or the anchor in the world
  double stiffness = 0.0;    ///< [N/m]
  double damping = 0.0;      ///< [N s/m], along the spring
  double rest_length = 0.0;  ///< [m]
};
/// F = -linear v - quadratic |v| v, torque = -angular omega, on each of `bodies`.
struct DragForce {
  std::vector<int> bodies;
  double linear = 0.0;     ///< [N s/m]
  double quadratic = 0.0;  ///< [N s^2/m^2]
  double angular = 0.0;    ///< [N m s]
};
/// Central force on every one of `bodies`: magnitude strength * m * r^power towards the centre (power -2:
/// gravity). At the centre itself: 0 for power >= 0; infinite below, which ends an integration.
struct AttractForce {
  std::vector<int> bodies;
  Vec2 center = Vec2::Zero();
  double strength = 0.0;
  double power = -2.0;
};
/// A constant force (world frame) and torque on one body during [from, to).
struct ThrustForce {
  int body = 0;
  Vec2 force = Vec2::Zero();
  double torque = 0.0;
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
};
/// Formulas in t, x, y, angle, vx, vy, omega, m on each of `bodies`.
struct FormulaForce {
  std::vector<int> bodies;
  std::optional<Formula> fx, fy, torque;
};
using Force = std::variant<SpringForce, DragForce, AttractForce, ThrustForce, FormulaForce>;

/// The variables of a FormulaForce, in the order in which they are passed.
const std::vector<std::string>& force_formula_variables();

struct World {
  std::string title;
  Vec2 gravity = Vec2::Zero();  ///< [m/s^2]
  Periods periods;              ///< [m]; none: the plane does not repeat
  std::vector<Material> materials{Material{}};
  Combine restitution_rule = Combine::max;
  Combine friction_rule = Combine::geometric_mean;
  std::vector<Body> bodies;
  std::vector<FixedSite> sites;
  std::vector<Force> forces;

  /// @throws BadInput: the first fault, naming the body, site or force, the value and what is allowed.
  void check() const;

  /// The scene's length [m], by which relative tolerances are scaled: the largest body diameter; where every
  /// body is a bare point, the largest site diameter; where that is 0 too, 1 m. Always > 0.
  double length() const;
};

/// The material of a pair: restitution and friction by the world's rules, the larger tangential restitution,
/// the products of slip and of spin. Symmetric in its arguments but for the name.
Material combined(const World& world, int material_a, int material_b);

}  // namespace brink
