/// World::check: every validation of the definitions, in the order in which a reader would meet them.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "brink/core/base/error.h"
#include "brink/core/shapes/text.h"
#include "brink/core/world/world.h"

namespace brink {

namespace {

/// Checks of one thing ("body \"ball\""): each throws BadInput unless its condition holds.
struct Checker {
  std::string subject;

  [[noreturn]] void fail(const std::string& what) const { throw BadInput(subject + ": " + what); }
  /// Messages read "SUBJECT: PARAMETER is VALUE; allowed: ALLOWED".
  void require(bool ok, const char* parameter, double value, const char* allowed) const {
    if (!ok) fail(std::string(parameter) + " is " + text(value) + "; allowed: " + allowed);
  }
  void finite(const char* parameter, double value) const {
    require(std::isfinite(value), parameter, value, "finite numbers");
  }
  void finite(const char* parameter, const Vec2& v) const {
    finite(parameter, v.x());
    finite(parameter, v.y());
  }
  void positive(const char* parameter, double value) const {
    require(std::isfinite(value) && value > 0.0, parameter, value, "finite numbers > 0");
  }
  void not_negative(const char* parameter, double value) const {
    require(std::isfinite(value) && value >= 0.0, parameter, value, "finite numbers >= 0");
  }
  /// NaN fails.
  void between(const char* parameter, double value, double low, double high, const char* allowed) const {
    require(value >= low && value <= high, parameter, value, allowed);
  }
  /// An index into a list of `count` things.
  void index(const char* parameter, int value, std::size_t count) const {
    if (value < 0 || static_cast<std::size_t>(value) >= count)
      fail(std::string(parameter) + " is " + std::to_string(value) + "; allowed: 0 to " +
           std::to_string(static_cast<long>(count) - 1));
  }
};

/// `body "ball"`, or `body 3` where it has no name.
std::string called(const char* kind, std::size_t index, const std::string& name) {
  std::string text = kind;
  text += ' ';
  if (name.empty()) return text += std::to_string(index);
  return text.append("\"").append(name).append("\"");
}

/// True if no two have one name: told by sorted hashes, as of a million names a tree takes a second. False: it may be.
template <class Things>
bool have_names_of_their_own(const Things& things) {
  std::vector<std::size_t> hashes;
  hashes.reserve(things.size());
  for (const auto& thing : things)
    if (!thing.name.empty()) hashes.push_back(std::hash<std::string>()(thing.name));
  std::sort(hashes.begin(), hashes.end());
  return std::adjacent_find(hashes.begin(), hashes.end()) == hashes.end();
}

/// Names are how files and messages tell things apart; things without a name go by their index.
template <class Things>
void check_names(const char* kind, const Things& things) {
  if (have_names_of_their_own(things)) return;
  std::set<std::string> seen;
  for (const auto& thing : things)
    if (!thing.name.empty() && !seen.insert(thing.name).second)
      throw BadInput(std::string(kind) + " \"" + thing.name +
                     "\": name is used twice; allowed: unique names");
}

/// Restitution above 1 would make energy at every impact. slip and spin are of the classic rebound, which
/// promises nothing of energy: any finite number.
void check_material(const Material& material, std::size_t i) {
  const Checker check{called("material", i, material.name)};
  check.between("restitution", material.restitution, 0.0, 1.0, "0 to 1");
  check.not_negative("friction", material.friction);
  check.between("tangential_restitution", material.tangential_restitution, -1.0, 1.0, "-1 to 1");
  check.not_negative("rolling_resistance", material.rolling_resistance);
  check.finite("slip", material.slip);
  check.finite("spin", material.spin);
}

/// What an outline is made of finish_outline() has checked.
void check_outline(const Checker& check, const std::shared_ptr<const Outline>& outline) {
  if (!outline || outline->sites.empty()) check.fail("has no outline; allowed: one with at least one site");
}

/// Signs only: whether spacing or count suffices is asked where particles are made.
void check_sampling(const Checker& check, const Sampling& sampling) {
  check.not_negative("sampling spacing", sampling.spacing);
  check.require(sampling.count >= 0, "sampling count", sampling.count, "integers >= 0");
  for (const Vec2& p : sampling.points) check.finite("sampling point", p);
}

/// A held coordinate must begin at rest.
void check_locks(const Checker& check, const Body& body) {
  const Twist& twist = body.initial.twist;
  const auto held = [&](bool lock, const char* parameter, double value) {
    check.require(!lock || value == 0.0, parameter, value, "0, as lock holds this coordinate");
  };
  // Of a held coordinate only the acceleration is left out: a velocity would carry it away for ever.
  held(body.lock_x, "velocity in x", twist.velocity.x());
  held(body.lock_y, "velocity in y", twist.velocity.y());
  held(body.lock_angle, "angular_velocity", twist.omega);
}

void check_body(const World& world, const Body& body, std::size_t i) {
  const Checker check{called("body", i, body.name)};
  check_outline(check, body.outline);
  // a container is solid out to infinity, and has no mass
  if (body.outline->container) check.fail("is a container; allowed: containers are fixed sites only");
  // Finite also where a coordinate is held: that is said by locks, never by an infinite mass.
  check.positive("mass", body.mass);
  check.positive("inertia", body.inertia);
  check.index("material", body.material, world.materials.size());
  check.finite("position", body.initial.pose.position);
  check.finite("angle", body.initial.pose.angle);
  check.finite("velocity", body.initial.twist.velocity);
  check.finite("angular_velocity", body.initial.twist.omega);
  // NaN would fail here as a velocity that is not 0; it is refused above by its own message.
  check_locks(check, body);
  check_sampling(check, body.sampling);
}

/// Images of one thing that may reach into one period: each is looked at where bodies are.
constexpr double kMostImages = 1e4;

/// So near the origin that the number of its image along each axis that repeats is a whole number that can be
/// held.
void check_place_in_periods(const Periods& periods, const Checker& check, const Vec2& position) {
  for (const int axis : {0, 1})
    if (periods.size[axis] > 0.0)
      check.require(std::abs(position[axis]) <= Periods::kFarthest * periods.size[axis], "position",
                    position[axis], "in a periodic world up to 1e9 periods from the origin");
}

/// The extent is looked at where the site stands at t = 0.
void check_site_in_periods(const Periods& periods, const Checker& check, const FixedSite& site) {
  if (site.outline->container)
    check.fail("is a container; allowed in a periodic world: sites of finite size");
  const Box bounds = transformed(*site.outline, site.pose).bounds;
  check_place_in_periods(periods, check, bounds.center());
  const Vec2 extent = bounds.extent();
  // A floor may be longer than a period; every image of it that reaches into one period is looked at.
  // Along each axis as many as fit into its length, and one.
  double images = 1.0;
  for (const int axis : {0, 1})
    if (periods.size[axis] > 0.0) images *= 1.0 + std::floor(extent[axis] / periods.size[axis]);
  // Along both axes together: a plate counts by its area in periods.
  if (images > kMostImages)
    check.fail("is " + text(extent.x()) + " m by " + text(extent.y()) + " m: it covers " + text(images) +
               " periods; allowed: up to " + text(kMostImages));
}

/// Of a world that repeats: the lengths, then the size of every body, then all places.
void check_periods(const World& world) {
  for (const double period : world.periods.size)
    if (!(period >= 0.0) || !std::isfinite(period))
      throw BadInput("world: periodic = " + text(period) +
                     "; allowed: a finite length > 0 [m], or 0 along an axis that does not repeat");
  if (!world.periods.any()) return;
  const double least = world.periods.least();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const double size = 2.0 * world.bodies[i].outline->bounding_radius;
    if (size > 0.5 * least)
      Checker{called("body", i, world.bodies[i].name)}.fail("is " + text(size) + " m across; allowed in a " +
                                                            "periodic world: up to half a period, " +
                                                            text(0.5 * least) + " m");
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i)
    check_place_in_periods(world.periods, Checker{called("body", i, world.bodies[i].name)},
                           world.bodies[i].initial.pose.position);
  for (std::size_t i = 0; i < world.sites.size(); ++i)
    check_site_in_periods(world.periods, Checker{called("fixed site", i, world.sites[i].name)},
                          world.sites[i]);
}

/// One overload for each way a site may move.
void check_motion(const Checker& check, const ConstantMotion& motion) {
  check.finite("motion velocity", motion.twist.velocity);
  check.finite("motion angular_velocity", motion.twist.omega);
}
void check_motion(const Checker& check, const FormulaMotion& motion) {
  const auto starts = [&](const char* parameter, const std::optional<Formula>& formula) {
    if (!formula) return;
    // Of later times nothing is said here: the motion ends where the formula does, and says so.
    const double t = 0.0;
    const double value = (*formula)({&t, 1});
    if (!std::isfinite(value))
      check.fail(std::string(parameter) + " = \"" + formula->text() + "\" is " + text(value) +
                 " at t = 0; allowed: formulas in t that are finite throughout the run");
  };
  starts("motion x", motion.x);
  starts("motion y", motion.y);
  starts("motion angle", motion.angle);
}
void check_motion(const Checker&, std::monostate) {}

void check_site(const World& world, const FixedSite& site, std::size_t i) {
  const Checker check{called("fixed site", i, site.name)};
  check_outline(check, site.outline);
  check.index("material", site.material, world.materials.size());
  check.finite("position", site.pose.position);
  check.finite("angle", site.pose.angle);
  std::visit([&](const auto& motion) { check_motion(check, motion); }, site.motion);
}

/// A force is handed to every body that it names: named twice, it would act twice.
void check_targets(const Checker& check, const std::vector<int>& bodies, std::size_t count) {
  std::set<int> seen;
  for (int body : bodies) {
    check.index("a body of bodies", body, count);
    if (!seen.insert(body).second)
      check.fail("bodies names body " + std::to_string(body) + " twice; allowed: once each");
  }
}

/// One overload a kind of force; the checker comes by value, as its subject gets the kind's name.
/// Coefficients below 0 are refused where they would drive what they are to hold or to brake.
void check_force(const World& world, const SpringForce& spring, Checker check) {
  check.subject += " (spring)";
  const std::size_t count = world.bodies.size();
  check.index("body_a", spring.body_a, count);
  if (spring.body_b != -1) check.index("body_b (-1: an anchor)", spring.body_b, count);
  if (spring.body_a == spring.body_b)
    check.fail("joins a body to itself; allowed: two bodies, or one and an anchor");
  check.finite("at_a", spring.at_a);
  check.finite("at_b", spring.at_b);
  check.not_negative("stiffness", spring.stiffness);
  check.not_negative("damping", spring.damping);
  check.not_negative("rest_length", spring.rest_length);
}
void check_force(const World& world, const DragForce& drag, Checker check) {
  check.subject += " (drag)";
  check_targets(check, drag.bodies, world.bodies.size());
  check.not_negative("linear", drag.linear);
  check.not_negative("quadratic", drag.quadratic);
  check.not_negative("angular", drag.angular);
}
/// A strength below 0 repels.
void check_force(const World& world, const AttractForce& attract, Checker check) {
  check.subject += " (attract)";
  check_targets(check, attract.bodies, world.bodies.size());
  check.finite("center", attract.center);
  check.finite("strength", attract.strength);
  check.finite("power", attract.power);
}
void check_force(const World& world, const ThrustForce& thrust, Checker check) {
  check.subject += " (thrust)";
  check.index("body", thrust.body, world.bodies.size());
  check.finite("force", thrust.force);
  check.finite("torque", thrust.torque);
  // `to` may be infinite; NaN is not later than anything and fails.
  check.finite("from", thrust.from);
  check.require(thrust.to > thrust.from, "to", thrust.to, "times later than from");
}
/// What the formulas give is not asked: it depends on states, and where it is not finite an integration ends.
void check_force(const World& world, const FormulaForce& force, Checker check) {
  check.subject += " (formula)";
  check_targets(check, force.bodies, world.bodies.size());
  if (!force.fx && !force.fy && !force.torque) check.fail("has no formula; allowed: any of fx, fy, torque");
}

}  // namespace

void World::check() const {
  Checker{"world"}.finite("gravity", gravity);
  // Each kind has names of its own: a body and a site may share one.
  check_names("material", materials);
  check_names("body", bodies);
  check_names("site", sites);
  for (std::size_t i = 0; i < materials.size(); ++i) check_material(materials[i], i);
  for (std::size_t i = 0; i < bodies.size(); ++i) check_body(*this, bodies[i], i);
  for (std::size_t i = 0; i < sites.size(); ++i) check_site(*this, sites[i], i);
  // after bodies and sites: it relies on their outlines and finite places
  check_periods(*this);
  for (std::size_t i = 0; i < forces.size(); ++i)
    std::visit([&](const auto& force) { check_force(*this, force, {"force " + std::to_string(i)}); },
               forces[i]);
}

}  // namespace brink
