/// From the forces of a world to the dynamics of its components:
///
///   unite the bodies that a spring joins, and those of each set of `together`
///   one ForceDynamics a set; a body's *place* in it is its rank among the set's bodies
///   hand every force to the dynamics of the bodies that it acts on, with places instead of indices
///
/// So a step of one component asks for its own forces alone, however many the world has.
#include "brink/core/world/forces.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "brink/core/base/elementary.h"
#include "brink/core/world/steady.h"

namespace brink {

namespace {

/// In the order of force_formula_variables().
using FormulaValues = std::array<double, 8>;
FormulaValues formula_values(double t, const BodyState& state, const Body& body) {
  const auto& [pose, twist] = state;
  return {t,           pose.position.x(),  pose.position.y(),
          pose.angle,  twist.velocity.x(), twist.velocity.y(),
          twist.omega, body.mass};
}

/// Where a spring's ends are [m], and how fast they part [m/s].
struct SpringLine {
  SpringLine(const SpringForce& s, std::span<const BodyState> states) {
    const BodyState& a = states[s.body_a];
    arm_a = Frame(a.pose).direction_to_world(s.at_a);
    // An anchor keeps arm and velocity 0, and end_b is its place in the world.
    Vec2 end_b = s.at_b, velocity_b = Vec2::Zero();
    if (s.body_b >= 0) {
      const BodyState& b = states[s.body_b];
      arm_b = Frame(b.pose).direction_to_world(s.at_b);
      end_b = b.pose.position + arm_b;
      velocity_b = b.twist.at(arm_b);
    }
    span = end_b - (a.pose.position + arm_a);
    length = span.norm();
    parts = velocity_b - a.twist.at(arm_a);
  }

  /// @pre length > 0
  Vec2 along() const { return span / length; }

  Vec2 arm_a, arm_b = Vec2::Zero();  ///< from the centres of mass, in world axes
  Vec2 span;                         ///< from the end on a to that on b
  double length = 0.0;
  Vec2 parts;
};

/// The accelerations of one component. Forces on single bodies are pointers into the world; springs are kept
/// with their bodies renumbered to places in the component.
class ForceDynamics final : public Dynamics {
 public:
  explicit ForceDynamics(const Vec2& gravity) : gravity_(gravity) {}

  /// Adds a body; returns its place.
  int join(const Body& body) {
    bodies_.push_back(&body);
    if (body.lock_x || body.lock_y || body.lock_angle) locked_.push_back(size() - 1);
    return size() - 1;
  }
  void take(const SpringForce& spring) { springs_.push_back(spring); }
  void take(int place, const DragForce& drag) { drags_.push_back({place, &drag}); }
  void take(int place, const AttractForce& attract) { attracts_.push_back({place, &attract}); }
  void take(int place, const ThrustForce& thrust) { thrusts_.push_back({place, &thrust}); }
  void take(int place, const FormulaForce& formula) {
    formulas_.push_back({place, &formula});
    for (const std::optional<Formula>* f : {&formula.fx, &formula.fy, &formula.torque})
      // steady_until() is asked step by step: which parts depend on time is found out here, once
      for (int part = 0; *f && part < (*f)->time_parts(); ++part) in_time_.emplace_back(**f, part);
  }

  int size() const override { return static_cast<int>(bodies_.size()); }
  void accelerations(double t, std::span<const BodyState> states,
                     std::span<Acceleration> out) const override {
    accelerations_along(t, states, states, out);
  }
  void accelerations_along(double t, std::span<const BodyState> lines, std::span<const BodyState> states,
                           std::span<Acceleration> out) const override;
  std::string not_finite(double t, std::span<const BodyState> states) const override;
  double next_break(double t) const override;
  double steady_until(double t) override;
  // Gravity never changes, and thrusts do at breaks only; all other forces go by the states or by the time.
  bool constant() const override {
    return springs_.empty() && drags_.empty() && attracts_.empty() && formulas_.empty();
  }
  LinearDrag linear_drag(double t) const override;

 private:
  template <class Force>
  struct On {  ///< a force on the body at `place`
    int place;
    const Force* force;
  };
  struct Load {  ///< force and torque on one body
    Vec2 force = Vec2::Zero();
    double torque = 0.0;
  };

  /// Each adds what its forces give to `out`, in world axes.
  void add_springs(std::span<const BodyState> lines, std::span<const BodyState> states,
                   std::span<Acceleration> out) const;
  void add_drags(std::span<const BodyState> states, std::span<Acceleration> out) const;
  void add_attractors(std::span<const BodyState> states, std::span<Acceleration> out) const;
  void add_thrusts(double t, std::span<Acceleration> out) const;
  void add_formulas(double t, std::span<const BodyState> states, std::span<Acceleration> out) const;
  /// By the full mass and inertia, held or not: hold_locked() comes after.
  void add(int place, const Load& load, std::span<Acceleration> out) const;
  /// A held coordinate is one of infinite mass: no force accelerates it.
  void hold_locked(std::span<Acceleration> out) const;

  Vec2 gravity_;
  std::vector<const Body*> bodies_;
  std::vector<int> locked_;  ///< places of those with a held coordinate
  std::vector<SpringForce> springs_;
  std::vector<On<DragForce>> drags_;
  std::vector<On<AttractForce>> attracts_;
  std::vector<On<ThrustForce>> thrusts_;
  std::vector<On<FormulaForce>> formulas_;
  std::vector<SteadyFormula> in_time_;  ///< every part of a formula that depends on time
};

void ForceDynamics::accelerations_along(double t, std::span<const BodyState> lines,
                                        std::span<const BodyState> states,
                                        std::span<Acceleration> out) const {
  for (Acceleration& a : out) a = {gravity_, 0.0};
  add_springs(lines, states, out);
  add_drags(states, out);
  add_attractors(states, out);
  add_thrusts(t, out);
  add_formulas(t, states, out);
  // last, as it overrules what all the forces have added to a held coordinate
  hold_locked(out);
}

void ForceDynamics::add(int place, const Load& load, std::span<Acceleration> out) const {
  out[place].linear += load.force / bodies_[place]->mass;
  out[place].angular += load.torque / bodies_[place]->inertia;
}

void ForceDynamics::hold_locked(std::span<Acceleration> out) const {
  for (const int k : locked_) {
    if (bodies_[k]->lock_x) out[k].linear.x() = 0.0;
    if (bodies_[k]->lock_y) out[k].linear.y() = 0.0;
    if (bodies_[k]->lock_angle) out[k].angular = 0.0;
  }
}

void ForceDynamics::add_springs(std::span<const BodyState> lines, std::span<const BodyState> states,
                                std::span<Acceleration> out) const {
  const bool elsewhere = lines.data() != states.data();
  for (const SpringForce& s : springs_) {
    const SpringLine now(s, states);
    // what an anchor gives of turning is its own
    const SpringLine line = elsewhere && s.body_b >= 0 ? SpringLine(s, lines) : now;
    // no direction there; a division would make the accelerations NaN and end the integration
    if (now.length == 0.0 || line.length == 0.0) continue;
    // The second term damps the rate at which the length changes, (v_b - v_a) . along, with v at the two
    // ends.
    const double pull = s.stiffness * (now.length - s.rest_length) + s.damping * now.along().dot(now.parts);
    // on a, towards b where the spring is stretched: `pull` > 0
    const Vec2 force = pull * line.along();
    add(s.body_a, {force, cross(line.arm_a, force)}, out);
    if (s.body_b >= 0) add(s.body_b, {-force, -cross(line.arm_b, force)}, out);
  }
}

void ForceDynamics::add_drags(std::span<const BodyState> states, std::span<Acceleration> out) const {
  for (const auto& [place, drag] : drags_) {
    const Twist& twist = states[place].twist;
    // Of the centre of mass alone: that other points of a turning body are faster is left to `angular`.
    const double factor = drag->linear + drag->quadratic * twist.velocity.norm();
    add(place, {-factor * twist.velocity, -drag->angular * twist.omega}, out);
  }
}

void ForceDynamics::add_attractors(std::span<const BodyState> states, std::span<Acceleration> out) const {
  for (const auto& [place, attract] : attracts_) {
    // Of length r, so that strength r^power along its unit vector is strength r^(power - 1) times it.
    const Vec2 inward = attract->center - states[place].pose.position;
    const double r = inward.norm();
    // pow(0, power - 1) is infinite for power < 1, and times 0 no number. Below power 0
    // that is left to end the integration.
    if (r == 0.0 && attract->power >= 0.0) continue;
    // an acceleration: the force is proportional to the mass, as gravity is
    out[place].linear += attract->strength * power(r, attract->power - 1.0) * inward;
  }
}

void ForceDynamics::add_thrusts(double t, std::span<Acceleration> out) const {
  for (const auto& [place, thrust] : thrusts_)
    // half open: at `to` it is off, and steps that end there ask just before
    // (SteppingIntegrator::accelerations)
    if (t >= thrust->from && t < thrust->to) add(place, {thrust->force, thrust->torque}, out);
}

void ForceDynamics::add_formulas(double t, std::span<const BodyState> states,
                                 std::span<Acceleration> out) const {
  for (const auto& [place, f] : formulas_) {
    // A formula gives a force and a torque about the centre of mass, in world axes; what is left out is 0.
    const FormulaValues values = formula_values(t, states[place], *bodies_[place]);
    Load load;
    if (f->fx) load.force.x() = (*f->fx)(values);
    if (f->fy) load.force.y() = (*f->fy)(values);
    if (f->torque) load.torque = (*f->torque)(values);
    add(place, load, out);
  }
}

/// Of formulas: whatever else may fail to be finite says nothing by its name.
std::string ForceDynamics::not_finite(double t, std::span<const BodyState> states) const {
  for (const auto& [place, f] : formulas_) {
    const FormulaValues values = formula_values(t, states[place], *bodies_[place]);
    for (const auto& [key, formula] : {std::pair("fx", &f->fx), {"fy", &f->fy}, {"torque", &f->torque}})
      if (*formula && !std::isfinite((**formula)(values)))
        return fmt::format("the formula {} = \"{}\" is not finite at t = {:.12g} s for '{}'", key,
                           (*formula)->text(), t, bodies_[place]->name);
  }
  return {};
}

/// Thrusts alone jump at times that are known. Where a formula jumps with the time no break is told: steps
/// shrink around it by steady_until().
double ForceDynamics::next_break(double t) const {
  double next = std::numeric_limits<double>::infinity();
  for (const auto& [place, thrust] : thrusts_) {
    if (thrust->from > t) next = std::min(next, thrust->from);
    if (thrust->to > t) next = std::min(next, thrust->to);
  }
  return next;
}

/// Each part keeps the cells of its last answer, which changes what an answer costs and not what it is; so it
/// is not for two threads at once.
double ForceDynamics::steady_until(double t) {
  double until = std::numeric_limits<double>::infinity();
  for (SteadyFormula& f : in_time_) until = std::min(until, f.until(t));
  return until;
}

/// One body, no spring, attractor or formula, and every drag linear. A held coordinate has no drive and, as
/// World::check demands, no velocity: the closed form keeps it still.
Dynamics::LinearDrag ForceDynamics::linear_drag(double t) const {
  LinearDrag form;
  if (size() != 1 || !springs_.empty() || !attracts_.empty() || !formulas_.empty()) return form;
  for (const auto& [place, drag] : drags_) {
    // linear only if all are; rates of several drags on one body add up
    if (drag->quadratic != 0.0) return {};
    form.linear += drag->linear / bodies_[place]->mass;
    form.angular += drag->angular / bodies_[place]->inertia;
  }
  // At rest drag is 0 and what is left is the drive: gravity and the thrusts that are on at t.
  // The pose does not matter: no force that goes by places is left.
  const BodyState at_rest;
  accelerations(t, {&at_rest, 1}, {&form.drive, 1});
  form.valid = true;
  return form;
}

/// Disjoint sets with path halving (Tarjan & van Leeuwen 1984); a set is named by its smallest member. Beside
/// DisjointSets no set knows its members: of a million bodies most are alone, and need no list each.
class SetNames {
 public:
  explicit SetNames(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int find(int k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void join(int a, int b) {
    const auto [low, high] = std::minmax({find(a), find(b)});
    // By index, not by rank: the root of a set stays its smallest member.
    parent_[high] = low;
  }

 private:
  std::vector<int> parent_;
};

/// The dynamics under construction, and where each body of the world is in them.
struct Assembly {
  struct Place {
    ForceDynamics* dynamics;
    int place;
  };
  std::vector<Place> of_body;

  /// Springs refer to places in their component; both ends are in one, as coupled_bodies() has joined them.
  void give(const SpringForce& spring) {
    SpringForce placed = spring;
    placed.body_a = of_body[spring.body_a].place;
    if (spring.body_b >= 0) placed.body_b = of_body[spring.body_b].place;
    of_body[spring.body_a].dynamics->take(placed);
  }
  void give(const ThrustForce& thrust) {
    of_body[thrust.body].dynamics->take(of_body[thrust.body].place, thrust);
  }
  /// Drags, attractors and formulas act on each body of their list alone.
  template <class Force>
  void give(const Force& force) {
    for (int body : force.bodies) of_body[body].dynamics->take(of_body[body].place, force);
  }
};

/// Sets of bodies that springs join, directly or over others. A spring to an anchor joins nobody.
SetNames coupled_bodies(const World& world) {
  SetNames sets(world.bodies.size());
  for (const Force& force : world.forces)
    if (const auto* spring = std::get_if<SpringForce>(&force); spring && spring->body_b >= 0)
      sets.join(spring->body_a, spring->body_b);
  return sets;
}

}  // namespace

std::vector<Component> make_components(const World& world, std::span<const std::vector<int>> together) {
  const int count = static_cast<int>(world.bodies.size());
  SetNames sets = coupled_bodies(world);
  for (const std::vector<int>& set : together)
    for (const int k : set) sets.join(set.front(), k);
  std::vector<Component> components;
  std::vector<int> component_of(world.bodies.size(), -1);
  Assembly assembly;
  for (int k = 0; k < count; ++k) {
    const int root = sets.find(k);  // the smallest of its set, so met first
    if (root == k) {
      component_of[k] = static_cast<int>(components.size());
      auto dynamics = std::make_shared<ForceDynamics>(world.gravity);
      assembly.of_body.push_back({dynamics.get(), dynamics->join(world.bodies[k])});
      components.push_back({{k}, std::move(dynamics)});
      continue;
    }
    // Bodies join in ascending order, which is the order of their places in the component.
    ForceDynamics* dynamics = assembly.of_body[root].dynamics;
    assembly.of_body.push_back({dynamics, dynamics->join(world.bodies[k])});
    components[component_of[root]].bodies.push_back(k);
  }
  // Last, as a force asks for the places of all its bodies.
  for (const Force& force : world.forces) std::visit([&](const auto& f) { assembly.give(f); }, force);
  return components;
}

}  // namespace brink
