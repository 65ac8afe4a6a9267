#include "brink/scheduler/kernel/rest_check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
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
/// Where forces that are known at the rim, or friction, leave a body such a part of the largest force as an acceleration, those of
/// all will not balance it, nor a little more friction: of 500 questions of a heap of 1000 discs none that was answered
/// with more than 2e-3 was answered otherwise with either.
constexpr double kHopeless = 1e-2;
/// Accelerations of who does not stay are known to the root of this: they tell who moves most.
constexpr double kProved = 1e-4;

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

/// An island's members by their places, and the contacts that each of them has.
class RestCheck::Graph {
 public:
  explicit Graph(const Island& island) : island_(island), begins_(island.members.size() + 1, 0) {
    for (const HeldContact& c : island.contacts)
      joins_.emplace_back(place_of(c.pair.body), c.pair.with_site() ? -1 : place_of(c.pair.other_body));
    for (const auto& [a, b] : joins_)
      for (const int place : {a, b})
        if (place >= 0) ++begins_[place + 1];
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    contacts_.resize(begins_.back());
    std::vector<int> next(begins_.begin(), begins_.end() - 1);
    for (int k = 0; k < static_cast<int>(joins_.size()); ++k)
      for (const int place : {joins_[k].first, joins_[k].second})
        if (place >= 0) contacts_[next[place]++] = k;
  }

  const Island& island() const { return island_; }
  int count() const { return static_cast<int>(island_.members.size()); }
  int body_at(int place) const { return island_.members[place]; }
  /// -1: it is no member.
  int place_of(int body) const {
    const std::vector<int>& members = island_.members;
    const auto found = std::lower_bound(members.begin(), members.end(), body);
    return found != members.end() && *found == body ? static_cast<int>(found - members.begin()) : -1;
  }
  std::span<const int> contacts_of(int place) const {
    return {contacts_.data() + begins_[place], contacts_.data() + begins_[place + 1]};
  }
  /// Places of the contact's body and of its other; of the latter -1 for a site.
  std::pair<int, int> joined_by(int contact) const { return joins_[contact]; }

 private:
  const Island& island_;
  std::vector<std::pair<int, int>> joins_;  ///< of each contact
  std::vector<int> begins_, contacts_;      ///< of each member: contacts_[begins_[place] ...]
};

/// Some of an island's members.
struct RestCheck::Part {
  std::vector<int> places;   ///< of them, in the order in which they have come
  std::vector<int> numbers;  ///< of each member in that order; -1: it is none of them
  std::size_t near = 0;      ///< so many of the first are within a few contacts of the change

  void add(int place) {
    if (numbers[place] >= 0) return;
    numbers[place] = static_cast<int>(places.size());
    places.push_back(place);
  }
  int number_of(int place) const { return place < 0 ? -1 : numbers[place]; }
};

/// Rings about the bodies that are changed, each of those who touch the one before, and what these stand on, down to sites: an
/// additional weight has to come to some.
RestCheck::Part RestCheck::near_part(const Graph& graph, const std::vector<int>& changed) const {
  Part part;
  part.numbers.assign(graph.count(), -1);
  for (const int k : changed) part.add(graph.place_of(k));
  std::size_t begin = 0;
  for (int ring = 0; ring < kNear; ++ring) {
    const std::size_t end = part.places.size();
    for (; begin < end; ++begin)
      for (const int k : graph.contacts_of(part.places[begin])) {
        const auto [a, b] = graph.joined_by(k);
        part.add(a);
        if (b >= 0) part.add(b);
      }
  }
  part.near = part.places.size();
  for (std::size_t at = 0; at < part.places.size(); ++at) {
    const int place = part.places[at];
    const Vec2 pull = trajectories_->acceleration(graph.body_at(place)).linear;
    for (const int k : graph.contacts_of(place)) {
      const auto [a, b] = graph.joined_by(k);
      const double against = graph.island().contacts[k].feature.normal.dot(pull);
      if (b >= 0 && (a == place ? against < 0.0 : against > 0.0)) part.add(a == place ? b : a);
    }
  }
  return part;
}

/// All of the island, the part first.
RestCheck::Part RestCheck::whole(const Graph& graph, Part part) const {
  for (int place = 0; place < graph.count(); ++place) part.add(place);
  return part;
}

/// Whether contact forces hold a part.
struct RestCheck::Question {
  RestProblem problem;
  std::vector<int> among;  ///< contacts of the island, for each of the problem's
};

RestCheck::Question RestCheck::question_of(const Graph& graph, const Part& part) const {
  Question question;
  RestProblem& problem = question.problem;
  for (const int place : part.places) {
    const int k = graph.body_at(place);
    const Body& b = world_->bodies[k];
    problem.mass.emplace_back(b.lock_x ? kForever : b.mass, b.lock_y ? kForever : b.mass,
                              b.lock_angle ? kForever : b.inertia);
    const Acceleration a = trajectories_->acceleration(k);
    problem.force.emplace_back(b.mass * a.linear.x(), b.mass * a.linear.y(), b.inertia * a.angular);
  }
  const Island& island = graph.island();
  for (int k = 0; k < static_cast<int>(island.contacts.size()); ++k) {
    const HeldContact& c = island.contacts[k];
    const auto [body, other] = graph.joined_by(k);
    const int a = part.number_of(body), b = part.number_of(other);
    if (a < 0 && b < 0) continue;
    // across the rim
    if (a < 0 || (b < 0 && !c.pair.with_site())) {
      press(c, a < 0 ? c.pair.other_body : c.pair.body, problem.force[std::max(a, b)]);
      continue;
    }
    LastingContact rows = rows_of(c);
    rows.body = a;
    rows.other = b;
    const Material& material = response_->material_of(c.pair);
    rows.friction = material.friction;
    rows.rolling_resistance = material.rolling_resistance;
    problem.contacts.push_back(rows);
    problem.expected.push_back({c.normal_force, c.tangential_force, c.rolling_torque});
    question.among.push_back(k);
  }
  for (const HeldContact& c : island.leaning)
    for (const int k : {c.pair.body, c.pair.other_body})
      if (const int number = part.number_of(graph.place_of(k)); number >= 0)
        press(c, k, problem.force[number]);
  return question;
}

/// Asks, and notes in the answer what has come of it. False: nothing is sure, and more of the island, or a little more friction, may
/// tell.
bool RestCheck::settles(Island& island, const Graph& graph, const Part& part, double widened, double h,
                        Answer& answer) const {
  Question question = question_of(graph, part);
  for (LastingContact& c : question.problem.contacts) c.friction *= widened;
  const RestResult result = solver_->rest_forces(question.problem, go_on_, kProved);
  answer.stays = result.status == RestResult::Status::rests;
  if (result.status == RestResult::Status::stopped) return true;
  if (answer.stays) {
    double most = 0.0;
    for (std::size_t n = 0; n < question.among.size(); ++n) {
      const ContactLoad& load = result.loads[n];
      const double friction = question.problem.contacts[n].friction / widened;
      most = std::max(most, load.normal);
      answer.beyond = std::max(answer.beyond, std::abs(load.tangential) - friction * load.normal);
      HeldContact& c = island.contacts[question.among[n]];
      c.normal_force = load.normal;
      c.tangential_force = load.tangential;
      c.rolling_torque = load.rolling;
      c.lasted = h;
    }
    answer.beyond = most > 0.0 ? answer.beyond / most : 0.0;
    return true;
  }
  answer.moves_by = result.residual;
  double most = 0.0;
  for (const Vec3& w : result.acceleration) most = std::max(most, w.head<2>().norm());
  answer.moved.clear();
  for (std::size_t i = 0; i < part.places.size(); ++i)
    if (result.acceleration[i].head<2>().norm() >= kMovedMost * most)
      answer.moved.push_back(graph.body_at(part.places[i]));
  return answer.moves_by >= kHopeless;
}

/// In cones that are as wide as they are, and of all then a little wider: a step has held many still by friction that sweeps have
/// found, and would hold them for ever.
RestCheck::Answer RestCheck::ask(Island& island, const std::vector<int>& changed, double h) const {
  const Graph graph(island);
  Answer answer;
  Part part = near_part(graph, changed);
  for (std::size_t i = 0; i < part.near; ++i) answer.near.push_back(graph.body_at(part.places[i]));
  if (static_cast<int>(part.places.size()) < graph.count()) {
    if (settles(island, graph, part, 1.0, h, answer)) return answer;
    part = whole(graph, std::move(part));
  }
  if (!settles(island, graph, part, 1.0, h, answer)) settles(island, graph, part, kWidened, h, answer);
  return answer;
}

}  // namespace brink
