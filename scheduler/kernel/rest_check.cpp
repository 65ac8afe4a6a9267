#include "brink/scheduler/kernel/rest_check.h"

#include <algorithm>
#include <array>

namespace brink {

namespace {

/// So many contacts rings reach from what has changed.
constexpr std::array kRings{3, 9, 27};
/// Who is moved by less than this part of what moves the fastest is not: the proof that a ring moves tells no more.
constexpr double kMoves = 1e-3;

}  // namespace

/// Members of an island about some of them.
struct RestCheck::Ring {
  std::vector<int> bodies;  ///< ascending
  std::vector<std::size_t> inside,
      rim;  ///< contacts of the island among these and sites; and that lead out of them
  int place_of(int body) const {
    const auto found = std::lower_bound(bodies.begin(), bodies.end(), body);
    return found != bodies.end() && *found == body ? static_cast<int>(found - bodies.begin()) : -1;
  }
};

/// By breadth first over the island's contacts.
RestCheck::Ring RestCheck::ring(const Island& island, const std::set<int>& about, int contacts) const {
  const auto place = [&](int body) {
    return std::lower_bound(island.members.begin(), island.members.end(), body) - island.members.begin();
  };
  std::vector<std::vector<int>> beside(island.members.size());
  for (const HeldContact& c : island.contacts) {
    if (c.pair.with_site()) continue;
    beside[place(c.pair.body)].push_back(c.pair.other_body);
    beside[place(c.pair.other_body)].push_back(c.pair.body);
  }
  Ring ring;
  std::vector<bool> seen(island.members.size(), false);
  std::vector<int> edge(about.begin(), about.end());
  for (const int k : edge) seen[place(k)] = true;
  for (int n = 0; !edge.empty(); ++n) {
    ring.bodies.insert(ring.bodies.end(), edge.begin(), edge.end());
    if (n == contacts) break;
    std::vector<int> next;
    for (const int k : edge)
      for (const int j : beside[place(k)])
        if (!seen[place(j)]) seen[place(j)] = true, next.push_back(j);
    edge = std::move(next);
  }
  std::sort(ring.bodies.begin(), ring.bodies.end());
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const PairKey& pair = island.contacts[k].pair;
    const bool a = ring.place_of(pair.body) >= 0,
               b = !pair.with_site() && ring.place_of(pair.other_body) >= 0;
    if (a && (b || pair.with_site()))
      ring.inside.push_back(k);
    else if (a || b)
      ring.rim.push_back(k);
  }
  return ring;
}

RealVec RestCheck::arm(const HeldContact& c) const {
  const ExtendedState body = trajectories_->state_now(c.pair.body);
  return c.feature.point.cast<Real>() + (search_->other_state(c.pair, now_).position - body.position);
}

RestProblem RestCheck::problem(const Island& island, const Ring& ring, const RestLoads& loads) const {
  RestProblem p;
  RestLoads at_rim;
  for (const std::size_t k : ring.rim)
    add_load(at_rim, island.contacts[k], arm(island.contacts[k]),
             [&](int body) { return ring.place_of(body) >= 0; });
  for (const int k : ring.bodies) {
    const Body& b = world_->bodies[k];
    const Acceleration a = trajectories_->acceleration(k);
    constexpr double kHeld = std::numeric_limits<double>::infinity();
    p.mass.emplace_back(b.lock_x ? kHeld : b.mass, b.lock_y ? kHeld : b.mass,
                        b.lock_angle ? kHeld : b.inertia);
    p.force.emplace_back(b.mass * a.linear.x(), b.mass * a.linear.y(), b.inertia * a.angular);
    const auto add = [&](const RestLoads& of) {
      if (const auto found = of.find(k); found != of.end()) p.force.back() += found->second;
    };
    add(loads);
    add(at_rim);
  }
  for (const std::size_t k : ring.inside) {
    const HeldContact& c = island.contacts[k];
    const int other = c.pair.with_site() ? -1 : ring.place_of(c.pair.other_body);
    p.contacts.push_back(contact_at(ring.place_of(c.pair.body), other, c.feature.normal,
                                    arm(c).cast<double>(), c.feature.point));
    const Material& material = response_->material_of(c.pair);
    p.contacts.back().friction = material.friction;
    p.contacts.back().rolling_resistance = material.rolling_resistance;
  }
  return p;
}

/// A ring that has come to be the whole island is the last.
std::set<int> RestCheck::moving(Island& island, const std::set<int>& about, const RestLoads& loads) const {
  std::set<int> moving;
  std::size_t before = 0;
  for (const int contacts : kRings) {
    const Ring ring = this->ring(island, about, contacts);
    if (ring.bodies.size() == before) break;
    before = ring.bodies.size();
    const RestResult result = solver_->rest_forces(problem(island, ring, loads));
    if (result.status == RestResult::Status::rests) {
      for (std::size_t n = 0; n < ring.inside.size(); ++n) {
        HeldContact& c = island.contacts[ring.inside[n]];
        c.normal_force = result.loads[n].normal;
        c.tangential_force = result.loads[n].tangential;
      }
      return {};
    }
    double most = 0.0;
    for (const Vec3& w : result.acceleration) most = std::max(most, w.cwiseAbs().maxCoeff());
    moving.clear();
    for (std::size_t i = 0; i < ring.bodies.size(); ++i)
      if (result.status == RestResult::Status::undecided ||
          !(result.acceleration[i].cwiseAbs().maxCoeff() <= kMoves * most))
        moving.insert(ring.bodies[i]);
  }
  return moving;
}

}  // namespace brink
