#include "brink/scheduler/kernel/rest_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "brink/core/base/limits.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

/// What is so many contacts away from the change, and carries nobody who is not, is not asked at first.
constexpr int kNear = 3;
/// Of those who move the ones are told that are moved by this part of what the most is, or more.
constexpr double kMovedMost = 0.1;
/// Of what forces pull a body by, so much is nothing.
constexpr double kNothing = 1e-9;

}  // namespace

RestCheck::RestCheck(const World& world, const Trajectories& trajectories, const ContactSearch& search,
                     CollisionResponse& response, ConeQp& solver, double now, GoOn go_on)
    : world_(&world),
      trajectories_(&trajectories),
      search_(&search),
      response_(&response),
      solver_(&solver),
      now_(now),
      go_on_(std::move(go_on)) {}

/// Of bodies here, not places: the caller names them.
LastingContact RestCheck::rows_of(const HeldContact& c) const {
  const ExtendedState body = trajectories_->state_now(c.pair.body);
  const ExtendedState other =
      c.pair.with_site() ? search_->other_state(c.pair, now_)
                         : trajectories_->state_now(c.pair.other_body).shifted(search_->shift_of(c.pair));
  const RealVec arm = c.feature.point.cast<Real>() + (other.position - body.position);
  return contact_at(0, c.pair.with_site() ? -1 : 1, c.feature.normal, arm.cast<double>(), c.feature.point);
}

/// What the contact does to one of its two, who stands; the other one may be on its way.
void RestCheck::press(const HeldContact& c, int body, Vec3& force) const {
  const bool is_body = body == c.pair.body;
  const Vec2 arm =
      is_body ? Vec2(c.place - trajectories_->state_now(body).position.cast<double>()) : c.feature.point;
  const Vec2 push = c.normal_force * c.feature.normal + c.tangential_force * perp(c.feature.normal);
  const double sign = is_body ? 1.0 : -1.0;
  force += sign * Vec3(push.x(), push.y(), cross(arm, push) + c.rolling_torque);
}

std::vector<int> RestCheck::differs(const Island& island, const std::vector<HeldContact>& leaning) const {
  std::map<int, Vec3> change;
  const auto add = [&](const std::vector<HeldContact>& contacts, double sign) {
    for (const HeldContact& c : contacts)
      for (const int k : {c.pair.body, c.pair.other_body}) {
        if (!std::binary_search(island.members.begin(), island.members.end(), k)) continue;
        Vec3 force = Vec3::Zero();
        press(c, k, force);
        change.try_emplace(k, Vec3::Zero()).first->second += sign * force;
      }
  };
  add(leaning, 1.0);
  add(island.leaning, -1.0);
  std::vector<int> bodies;
  for (const auto& [k, force] : change) {
    const double radius = search_->outline_of(k).bounding_radius;
    const double least = kNothing * world_->bodies[k].mass * trajectories_->acceleration(k).linear.norm();
    if (force.head<2>().norm() > least || std::abs(force[2]) > least * radius) bodies.push_back(k);
  }
  return bodies;
}

/// A part of an island, and the contacts that it has.
struct RestCheck::Part {
  std::vector<int> bodies, near;
  std::map<int, int> places;          ///< of bodies
  std::vector<std::size_t> contacts;  ///< of the island
};

/// Rings about the bodies that are changed, each of those who touch the one before, and what these stand on, down to sites: an
/// additional weight has to come to some. Or all of the island.
RestCheck::Part RestCheck::part_of(const Island& island, const std::vector<int>& changed, bool all) const {
  std::map<int, std::vector<std::size_t>> contacts_of;
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const PairKey& pair = island.contacts[k].pair;
    contacts_of[pair.body].push_back(k);
    if (!pair.with_site()) contacts_of[pair.other_body].push_back(k);
  }
  Part part;
  const auto add = [&](int body) {
    if (part.places.emplace(body, static_cast<int>(part.bodies.size())).second) part.bodies.push_back(body);
  };
  for (const int k : changed) add(k);
  std::size_t begin = 0;
  for (int ring = 0; ring < kNear; ++ring) {
    const std::size_t end = part.bodies.size();
    for (; begin < end; ++begin)
      for (const std::size_t k : contacts_of[part.bodies[begin]]) {
        const PairKey& pair = island.contacts[k].pair;
        add(pair.body);
        if (!pair.with_site()) add(pair.other_body);
      }
  }
  part.near = part.bodies;
  for (std::size_t at = 0; at < part.bodies.size(); ++at)
    for (const std::size_t k : contacts_of[part.bodies[at]]) {
      const HeldContact& c = island.contacts[k];
      const bool is_body = c.pair.body == part.bodies[at];
      const double against = c.feature.normal.dot(trajectories_->acceleration(part.bodies[at]).linear);
      if (!c.pair.with_site() && (is_body ? against < 0.0 : against > 0.0))
        add(is_body ? c.pair.other_body : c.pair.body);
    }
  if (all)
    for (const int k : island.members) add(k);
  std::set<std::size_t> theirs;
  for (const int body : part.bodies) theirs.insert(contacts_of[body].begin(), contacts_of[body].end());
  part.contacts.assign(theirs.begin(), theirs.end());
  return part;
}

/// In cones that are as wide as they are, and then a little wider: a step has held many still by friction that sweeps have
/// found, and would hold them for ever.
RestCheck::Answer RestCheck::ask(Island& island, const std::vector<int>& changed, double h) const {
  Answer answer;
  std::size_t asked = 0;
  for (const bool all : {false, true}) {
    const Part part = part_of(island, changed, all);
    if (part.bodies.size() == asked) break;  // there are no more
    asked = part.bodies.size();
    answer.near = part.near;
    RestProblem problem;
    for (const int k : part.bodies) {
      const Body& b = world_->bodies[k];
      problem.mass.emplace_back(b.lock_x ? kForever : b.mass, b.lock_y ? kForever : b.mass,
                                b.lock_angle ? kForever : b.inertia);
      const Acceleration a = trajectories_->acceleration(k);
      problem.force.emplace_back(b.mass * a.linear.x(), b.mass * a.linear.y(), b.inertia * a.angular);
    }
    std::vector<std::size_t> among;  // contacts of the island
    const auto place_of = [&](int body) {
      const auto found = part.places.find(body);
      return found == part.places.end() ? -1 : found->second;
    };
    for (const std::size_t k : part.contacts) {
      const HeldContact& c = island.contacts[k];
      const int a = place_of(c.pair.body), b = c.pair.with_site() ? -1 : place_of(c.pair.other_body);
      // across the rim
      if (a < 0 || (b < 0 && !c.pair.with_site())) {
        const int inside = a < 0 ? c.pair.other_body : c.pair.body;
        press(c, inside, problem.force[place_of(inside)]);
        continue;
      }
      LastingContact rows = rows_of(c);
      rows.body = a;
      rows.other = b;
      const Material& material = response_->material_of(c.pair);
      rows.friction = material.friction;
      rows.rolling_resistance = material.rolling_resistance;
      problem.contacts.push_back(rows);
      among.push_back(k);
    }
    for (const HeldContact& c : island.leaning)
      for (const int k : {c.pair.body, c.pair.other_body})
        if (const int place = place_of(k); place >= 0) press(c, k, problem.force[place]);
    for (const double widened : {1.0, kWidened}) {
      for (LastingContact& c : problem.contacts) c.friction *= widened;
      const RestResult result = solver_->rest_forces(problem, go_on_);
      if (result.status == RestResult::Status::stopped) return {};
      if (result.status == RestResult::Status::rests) {
        double most = 0.0;
        for (std::size_t n = 0; n < among.size(); ++n) {
          const ContactLoad& load = result.loads[n];
          const double friction = problem.contacts[n].friction / widened;
          most = std::max(most, load.normal);
          answer.beyond = std::max(answer.beyond, std::abs(load.tangential) - friction * load.normal);
          HeldContact& c = island.contacts[among[n]];
          c.normal_force = load.normal;
          c.tangential_force = load.tangential;
          c.rolling_torque = load.rolling;
          c.lasted = h;
        }
        answer.beyond = most > 0.0 ? answer.beyond / most : 0.0;
        answer.stays = true;
        return answer;
      }
      double most = 0.0;
      for (const Vec3& w : result.acceleration) most = std::max(most, w.head<2>().norm());
      answer.moved.clear();
      for (std::size_t i = 0; i < part.bodies.size(); ++i)
        if (result.acceleration[i].head<2>().norm() >= kMovedMost * most)
          answer.moved.push_back(part.bodies[i]);
    }
  }
  return answer;
}

}  // namespace brink
