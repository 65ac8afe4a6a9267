/// Forces and motions: names become ids, texts become formulas, and what can be said before a run of
/// whether they make sense is said with its place in the file.
#include <algorithm>
#include <array>
#include <cmath>

#include "brink/core/base/error.h"
#include "brink/scenes/scene/build.h"
#include "brink/scheduler/kernel/site_motion.h"

namespace brink {
namespace {

// A formula, if it was given and reads; else a fault.
// `variables` are the names that it may use; the parser's message says which.
std::optional<Formula> formula(const Given<std::string>& text, const std::vector<std::string>& variables,
                               FaultList& faults) {
  if (!text.given) return std::nullopt;
  try {
    return Formula(text.value, variables);
  } catch (const BadInput& error) {
    faults.add(text.where, error.what());
  }
  return std::nullopt;
}

/// `when`: for which body, or at what time, the formula was asked.
void must_be_finite(double value, const Formula& f, const Where& where, const std::string& when,
                    FaultList& faults) {
  if (!std::isfinite(value))
    faults.add(where, "formula " + in_quotes(f.text()) + " is not finite; given " + number_text(value) + " " +
                          when + ", allowed: finite numbers throughout the run");
}

/// One force after the other: a force with a fault is left out of the world, and the others go on.
class ForceBuilder {
 public:
  ForceBuilder(const BodyNames& names, const std::vector<Vec2>& origins, bool placed, World& world,
               FaultList& faults)
      : names_(names), origins_(origins), placed_(placed), world_(world), faults_(faults) {}

  /// By the kind, one of force_kinds(): read_force() lets no other through.
  void build(const ForceTable& table) {
    if (table.kind == "spring")
      spring(table);
    else if (table.kind == "drag")
      drag(table);
    else if (table.kind == "attract")
      attract(table);
    else if (table.kind == "thrust")
      thrust(table);
    else
      formulas(table);
  }

 private:
  void spring(const ForceTable& table) {
    // Either `bodies`, or `body` and `anchor`, and not half of the latter: the first comparison finds
    // both or neither, the second a body without an anchor or an anchor without a body.
    SpringForce force = table.spring;
    if (table.bodies.faulty || table.body.faulty || table.anchor.faulty || table.at.faulty) return;
    if (table.bodies.given == (table.body.given || table.anchor.given) ||
        table.body.given != table.anchor.given)
      return faults_.add(table.place,
                         "spring: who it joins is not clear; given " + ends_given(table) +
                             ", allowed: bodies = [\"A\", \"B\"], or body = \"A\" and anchor = [x, y]");
    if (table.bodies.given ? !two_bodies(table, force) : !body_and_anchor(table, force)) return;
    world_.forces.emplace_back(force);
  }

  /// The keys of a spring's ends that the file has.
  static std::string ends_given(const ForceTable& table) {
    std::vector<std::string> keys;
    if (table.bodies.given) keys.emplace_back("bodies");
    if (table.body.given) keys.emplace_back("body");
    if (table.anchor.given) keys.emplace_back("anchor");
    return keys.empty() ? "nothing" : listed(keys);
  }

  /// Fills both ends; false after a fault. An attachment that is not given is at the centre of mass.
  bool two_bodies(const ForceTable& table, SpringForce& force) {
    const std::vector<std::string>& pair = table.bodies.value;
    if (pair.size() != 2 || pair[0] == pair[1]) {
      faults_.add(table.bodies.where, "spring: joins two different bodies; given " + in_quotes(listed(pair)) +
                                          ", allowed: bodies = [\"A\", \"B\"]");
      return false;
    }
    force.body_a = names_.find_one(pair[0], table.bodies.where, faults_);
    force.body_b = names_.find_one(pair[1], table.bodies.where, faults_);
    if (force.body_a < 0 || force.body_b < 0) return false;
    if (table.at.given && table.at.value.size() != 2) {
      faults_.add(table.at.where, "at: one place for each body; given 1, allowed: [[x, y], [x, y]]");
      return false;
    }
    force.at_a =
        in_outline(force.body_a, table.at.given ? table.at.value[0] : Vec2(Vec2::Zero()), table.at.given);
    force.at_b =
        in_outline(force.body_b, table.at.given ? table.at.value[1] : Vec2(Vec2::Zero()), table.at.given);
    return true;
  }

  /// The same of a body and a place of the world [m], which is taken as it is.
  bool body_and_anchor(const ForceTable& table, SpringForce& force) {
    force.body_a = names_.find_one(table.body.value, table.body.where, faults_);
    if (force.body_a < 0) return false;
    if (table.at.given && table.at.value.size() != 1) {
      faults_.add(table.at.where, "at: one place on the body; given 2, allowed: [x, y]");
      return false;
    }
    force.at_a =
        in_outline(force.body_a, table.at.given ? table.at.value[0] : Vec2(Vec2::Zero()), table.at.given);
    force.at_b = table.anchor.value;
    return true;
  }

  // A place given in the file's frame of a body, in the frame of its outline. Not given: the centre of mass.
  // `centered = false` moves the file's frame against the outline's.
  Vec2 in_outline(int body, const Vec2& p, bool was_given) const {
    return was_given ? Vec2(p + origins_[static_cast<std::size_t>(body)]) : p;
  }

  // The bodies that a force acts on: those named, or all.
  // In ascending order. A name that has copies stands for all of them.
  std::vector<int> targets(const ForceTable& table) {
    std::vector<int> out;
    if (!table.bodies.given) {
      for (std::size_t k = 0; k < world_.bodies.size(); ++k) out.push_back(static_cast<int>(k));
      return out;
    }
    if (table.bodies.value.empty())
      faults_.add(table.bodies.where,
                  "bodies: names nobody; given an array of 0, allowed: names, or no bodies key "
                  "for every body");
    for (const std::string& name : table.bodies.value)
      for (const int k : names_.find(name, table.bodies.where, faults_)) out.push_back(k);
    // Sorted, a body that is named twice stands beside itself.
    std::sort(out.begin(), out.end());
    if (std::adjacent_find(out.begin(), out.end()) != out.end())
      faults_.add(table.bodies.where, "bodies: names a body twice; given " +
                                          in_quotes(listed(table.bodies.value)) + ", allowed: each once");
    return out;
  }

  void drag(const ForceTable& table) {
    DragForce force = table.drag;
    force.bodies = targets(table);
    world_.forces.emplace_back(std::move(force));
  }

  void attract(const ForceTable& table) {
    AttractForce force = table.attract;
    force.bodies = targets(table);
    for (const int k : force.bodies)
      // Bodies that have not been placed stand at the origin, which would be a false alarm.
      if (placed_ && force.power < 0.0 &&
          world_.bodies[static_cast<std::size_t>(k)].initial.pose.position == force.center)
        faults_.add(table.place, "attract: the pull is infinite at its centre; given the body " +
                                     in_quotes(world_.bodies[static_cast<std::size_t>(k)].name) +
                                     " there, allowed: bodies elsewhere, or a power >= 0");
    world_.forces.emplace_back(std::move(force));
  }

  void thrust(const ForceTable& table) {
    ThrustForce force = table.thrust;
    if (table.body.faulty) return;
    if (!table.body.given)
      return faults_.add(table.place, "thrust: body is missing; given nothing, allowed: the name of a body");
    // Looked up before the times are compared, so that both faults are told.
    force.body = names_.find_one(table.body.value, table.body.where, faults_);
    if (!(force.to > force.from))
      return faults_.add(table.place, "thrust: ends before it starts; given from " + number_text(force.from) +
                                          " to " + number_text(force.to) + ", allowed: to > from");
    if (force.body >= 0) world_.forces.emplace_back(force);
  }

  void formulas(const ForceTable& table) {
    FormulaForce force;
    force.bodies = targets(table);
    const std::vector<std::string>& variables = force_formula_variables();
    if (table.fx.faulty || table.fy.faulty || table.torque.faulty) return;
    if (!table.fx.given && !table.fy.given && !table.torque.given)
      return faults_.add(table.place,
                         "formula: says nothing; given no formula, allowed: any of fx, fy, torque");
    // All three are read though one is faulty.
    force.fx = formula(table.fx, variables, faults_);
    force.fy = formula(table.fy, variables, faults_);
    force.torque = formula(table.torque, variables, faults_);
    check_start(force, force.fx, table.fx.where);
    check_start(force, force.fy, table.fy.where);
    check_start(force, force.torque, table.torque.where);
    world_.forces.emplace_back(std::move(force));
  }

  /// What is not finite at the start is a fault with its place; what becomes so later ends the run.
  void check_start(const FormulaForce& force, const std::optional<Formula>& f, const Where& where) {
    if (!f || !placed_) return;
    for (const int k : force.bodies) {
      const Body& body = world_.bodies[static_cast<std::size_t>(k)];
      const BodyState& s = body.initial;
      // In the order of force_formula_variables().
      const std::array values{0.0,
                              s.pose.position.x(),
                              s.pose.position.y(),
                              s.pose.angle,
                              s.twist.velocity.x(),
                              s.twist.velocity.y(),
                              s.twist.omega,
                              body.mass};
      const double value = (*f)(values);
      must_be_finite(value, *f, where, "at t = 0 for " + in_quotes(body.name), faults_);
      // One body is enough: a thousand copies would say the same thousand times.
      if (!std::isfinite(value)) return;
    }
  }

  const BodyNames& names_;
  const std::vector<Vec2>& origins_;
  bool placed_;
  World& world_;
  FaultList& faults_;
};

}  // namespace

/// Ids are given in the order of the calls. A name that is used twice keeps its first bodies; the fault
/// is told by who plans them.
void BodyNames::add(const std::string& name, int count, bool copied) {
  if (entries_.emplace(name, Entry{count_, count, copied}).second) words_.push_back(name);
  count_ += count;
}

/// All copies of a name, in the order of their ids. Cost: a search in a map, and their number.
std::vector<int> BodyNames::find(const std::string& name, const Where& where, FaultList& faults) const {
  std::vector<int> out;
  if (const auto found = entries_.find(name); found != entries_.end()) {
    for (int k = 0; k < found->second.count; ++k) out.push_back(found->second.first + k);
    return out;
  }
  // NAME[k]: one copy. The name as written went first, since a body may itself be called "a[0]".
  if (const auto [called, copy] = copy_named(name); copy) {
    const auto found = entries_.find(called);
    if (found != entries_.end() && found->second.copied && static_cast<int>(*copy) < found->second.count)
      return {found->second.first + static_cast<int>(*copy)};
  }
  faults.add(where, "no body is called " + in_quotes(name) +
                        (words_.empty() ? "; the scene has no bodies"
                                        : "; the nearest name is \"" + nearest_word(name, words_) + "\""));
  return out;
}

/// A name with a single copy is that copy: NAME and NAME[0] are one.
int BodyNames::find_one(const std::string& name, const Where& where, FaultList& faults) const {
  const std::vector<int> found = find(name, where, faults);
  if (found.size() == 1) return found[0];
  if (!found.empty())
    faults.add(where, "one body is meant; given " + in_quotes(name) + ", which is " +
                          std::to_string(found.size()) + " copies, allowed: one of them, as in \"" + name +
                          "[0]\"");
  return -1;
}

/// Forces come into the world in the order of the file.
void build_forces(const std::vector<ForceTable>& tables, const BodyNames& names,
                  const std::vector<Vec2>& origins, bool placed, World& world, FaultList& faults) {
  ForceBuilder builder(names, origins, placed, world, faults);
  for (const ForceTable& table : tables) builder.build(table);
}

namespace {

/// Cells of a formula's motion that are made before the run: some hundredths of a second.
constexpr std::uint64_t kMostCells = 16384;

/// A formula by which a site cannot even begin to move (it jumps there), or that nothing bounds, is a fault. The motion
/// is made up to the end of the run for that, or as far as it comes; a jump on the way is met by the run itself.
void must_move(std::optional<Formula> FormulaMotion::*part, const FormulaMotion& motion, double duration,
               const std::string& site, const Where& where, FaultList& faults) {
  // A formula alone, without the others of the site: so the fault stands at the key that is wrong.
  FormulaMotion alone;
  alone.*part = motion.*part;
  FixedSite moved;
  moved.name = site;
  moved.motion = alone;
  // After another fault it is not asked: what is not finite at the start would be told twice.
  if (!(motion.*part) || !faults.empty()) return;
  try {
    SiteMotion made(moved);
    const Extent extent = made.extend(duration, kMostCells);
    if (made.lacks_bounds()) faults.add(where, extent.why);
  } catch (const BadInput& e) {
    faults.add(where, e.what());
  }
}

}  // namespace

/// std::monostate: it stands still, or there was a fault. Formulas are asked at the beginning, half way
/// and at the end of the run, which finds what is wrong everywhere, such as sqrt(-t).
PrescribedPath build_motion(const Given<MotionTable>& given_motion, const std::string& site, double duration,
                            FaultList& faults) {
  if (!given_motion.given) return std::monostate{};
  const MotionTable& table = given_motion.value;
  const bool constant = table.velocity.given || table.angular_velocity.given;
  const bool formulas = table.x.given || table.y.given || table.angle.given;
  if (constant == formulas) {
    faults.add(given_motion.where, std::string("motion: is not clear; given ") +
                                       (constant ? "both kinds" : "nothing") +
                                       ", allowed: velocity and angular_velocity, or formulas x, y, angle");
    return std::monostate{};
  }
  // What of the two is not given is 0.
  if (constant) return ConstantMotion{{table.velocity.value, table.angular_velocity.value}};
  FormulaMotion motion{formula(table.x, {"t"}, faults), formula(table.y, {"t"}, faults),
                       formula(table.angle, {"t"}, faults)};
  const auto check = [&](const std::optional<Formula>& f, const Where& at) {
    // A jump between these times is met by the run itself, which then ends there.
    for (const double t : {0.0, 0.5 * duration, duration})
      if (f) must_be_finite((*f)({&t, 1}), *f, at, "at t = " + number_text(t), faults);
  };
  check(motion.x, table.x.where);
  check(motion.y, table.y.where);
  check(motion.angle, table.angle.where);
  must_move(&FormulaMotion::x, motion, duration, site, table.x.where, faults);
  must_move(&FormulaMotion::y, motion, duration, site, table.y.where, faults);
  must_move(&FormulaMotion::angle, motion, duration, site, table.angle.where, faults);
  return motion;
}

}  // namespace brink
