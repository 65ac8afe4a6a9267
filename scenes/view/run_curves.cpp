/// Curves are made from what a run file has: states at frames, masses, gravity, springs and attractions. So
/// they are sums over the recorded frames and not the run's own energies. Drag, thrust and formulas have no energy that
/// is kept.
#include "brink/scenes/view/run_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

/// world.gravity of the options; a run file has no column of it.
Vec2 gravity_in(const std::string& options) {
  const auto json = nlohmann::json::parse(options, nullptr, false);
  const nlohmann::json::json_pointer at("/world/gravity");
  if (!json.is_object() || !json.contains(at)) return Vec2::Zero();
  return {json.at(at).at(0).get<double>(), json.at(at).at(1).get<double>()};
}

}  // namespace

RunCurves::RunCurves(const World& world, const RunFile& run)
    : world_(&world),
      gravity_(gravity_in(run.meta("options").value_or("{}"))),
      springs_(run.springs()),
      attractions_(run.attractions()) {}

/// Energy in all springs at a frame [J]. Their ends are where the bodies are, without periods: as
/// core/world/energy.cpp takes them.
double RunCurves::of_springs(const RunFile::Frame& f) const {
  double energy = 0.0;
  for (const RunFile::Spring& s : springs_) {
    const Vec2 a = Frame(f.states[s.body].pose).to_world(s.at);
    const Vec2 b = s.other < 0 ? s.other_at : Frame(f.states[s.other].pose).to_world(s.other_at);
    // As core/world/energy.cpp: half k times the square of what it is longer than at rest.
    const double longer = (a - b).norm() - s.rest_length;
    energy += 0.5 * s.stiffness * longer * longer;
  }
  return energy;
}

/// Energy of all attractions at a frame [J], as core/world/energy.cpp takes it.
double RunCurves::of_attraction(const RunFile::Frame& f) const {
  double energy = 0.0;
  for (const AttractForce& a : attractions_)
    for (const int k : a.bodies) {
      const double r = (f.states[k].pose.position - a.center).norm(), n = a.power + 1.0;
      energy += world_->bodies[k].mass * a.strength * (n == 0.0 ? std::log(r) : std::pow(r, n) / n);
    }
  return energy;
}

/// A row of each curve: energies [J], momentum [N s], angular momentum about the origin [N m s].
void RunCurves::add(const RunFile::Frame& f) {
  double kinetic = 0.0, lifted = 0.0, turning = 0.0;
  Vec2 momentum = Vec2::Zero();
  for (std::size_t k = 0; k < f.states.size(); ++k) {
    const Body& b = world_->bodies[k];
    const auto& [pose, twist] = f.states[k];
    kinetic += 0.5 * (b.mass * twist.velocity.squaredNorm() + b.inertia * twist.omega * twist.omega);
    // -m g.x: zero at the origin, whatever the direction of gravity.
    lifted -= b.mass * gravity_.dot(pose.position);
    momentum += b.mass * twist.velocity;
    // Of the centre of mass about the origin, and the body's own.
    turning += b.mass * cross(pose.position, twist.velocity) + b.inertia * twist.omega;
  }
  const double sprung = of_springs(f), attracted = of_attraction(f);
  t_.push_back(f.t);
  kinetic_.push_back(kinetic);
  of_gravity_.push_back(lifted);
  of_springs_.push_back(sprung);
  of_attraction_.push_back(attracted);
  total_.push_back(kinetic + lifted + sprung + attracted);
  px_.push_back(momentum.x()), py_.push_back(momentum.y());
  turning_.push_back(turning);
  // Filled by the events of the interval that begins here; that of the last frame stays 0.
  collisions_.push_back(0.0);
}

void RunCurves::add(const Event& e) {
  // Collisions of an interval of frames are told as a rate, at its left end.
  if (e.kind != EventKind::collision || t_.size() < 2) return;
  // The first frame later than the event ends its interval.
  const auto after = std::upper_bound(t_.begin(), t_.end(), e.contact.time);
  // An event at the last frame's time belongs to the last interval.
  const auto k =
      std::clamp<std::ptrdiff_t>(after - t_.begin(), 1, static_cast<std::ptrdiff_t>(t_.size()) - 1);
  if (t_[k] > t_[k - 1]) collisions_[k - 1] += 1.0 / (t_[k] - t_[k - 1]);
}

void RunCurves::put(PageNumbers& to, nlohmann::ordered_json& about) const {
  about["curves"] = nlohmann::ordered_json::array();
  to.add("curve_t", t_);
  const auto curve = [&](const char* title, const char* unit, bool steps,
                         std::vector<std::pair<const char*, const std::vector<double>*>> of) {
    nlohmann::ordered_json names = nlohmann::ordered_json::array(), columns = names;
    for (const auto& [name, values] : of) {
      // A name of its own for each column: no panel has ten.
      const std::string column = fmt::format("curve_{}", columns.size() + 10 * about["curves"].size());
      to.add(column, *values);
      names.push_back(name);
      columns.push_back(column);
    }
    about["curves"].push_back(
        {{"title", title}, {"unit", unit}, {"steps", steps}, {"names", names}, {"columns", columns}});
  };
  // One frame makes no curve.
  if (t_.size() < 2) return;
  // What the world does not have has no curve: a line at 0 would only take room.
  std::vector<std::pair<const char*, const std::vector<double>*>> energies{{"kinetic", &kinetic_}};
  if (!gravity_.isZero(0.0)) energies.emplace_back("of gravity", &of_gravity_);
  if (!springs_.empty()) energies.emplace_back("of springs", &of_springs_);
  if (!attractions_.empty()) energies.emplace_back("of attraction", &of_attraction_);
  // A sum of one is that one.
  if (energies.size() > 1) energies.emplace_back("sum", &total_);
  curve("Energy at frames", "J", false, energies);
  curve("Momentum at frames", "N s", false, {{"x", &px_}, {"y", &py_}});
  curve("Angular momentum at frames", "N m s", false, {{"about the origin", &turning_}});
  curve("Collisions", "1/s", true, {{"collisions a second", &collisions_}});
}

}  // namespace brink
