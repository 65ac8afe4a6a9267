#include "brink/core/contacts/group.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/core/contacts/lcp.h"

namespace brink {

namespace {

/// Speeds below this part of the group's largest are rounding.
constexpr Real kRounding = 64 * std::numeric_limits<Real>::epsilon();

/// A group in motion: contacts as rows, bodies' twists as they stand.
class Group {
 public:
  Group(const std::vector<GroupBody>& bodies, const std::vector<GroupContact>& contacts)
      : bodies_(bodies), contacts_(contacts) {
    for (const GroupBody& b : bodies) twists_.push_back(b.twist);
    for (const GroupContact& c : contacts) {
      const auto speed = [](const ExtendedTwist& t, const RealVec& arm) {
        return t.velocity.norm() + std::abs(t.omega) * arm.norm();
      };
      speed_ = std::max(speed_, speed(bodies[c.body].twist, c.arm));
      speed_ = std::max(
          speed_, c.other < 0 ? c.other_point_velocity.norm() : speed(bodies[c.other].twist, c.other_arm));
    }
  }

  int size() const { return static_cast<int>(contacts_.size()); }
  const std::vector<ExtendedTwist>& twists() const { return twists_; }
  /// What rounding alone may make of a velocity at a contact [m/s].
  Real rounding() const { return kRounding * speed_; }

  RealVec velocity(int k) const {
    const GroupContact& c = contacts_[k];
    const RealVec other = c.other < 0 ? c.other_point_velocity : twists_[c.other].at(c.other_arm);
    return twists_[c.body].at(c.arm) - other;
  }
  Real normal_velocity(int k) const { return velocity(k).dot(contacts_[k].normal); }
  RealVector normal_velocities() const {
    RealVector v(size());
    for (int k = 0; k < size(); ++k) v[k] = normal_velocity(k);
    return v;
  }

  /// Change of velocity along u at contact i's point, per unit impulse along v at contact j.
  Real mobility(int i, const RealVec& u, int j, const RealVec& v) const {
    const GroupContact &a = contacts_[i], &b = contacts_[j];
    Real sum = shared(a.body, a.arm, u, b.body, b.arm, v);
    if (b.other >= 0) sum -= shared(a.body, a.arm, u, b.other, b.other_arm, v);
    if (a.other >= 0) sum -= shared(a.other, a.other_arm, u, b.body, b.arm, v);
    if (a.other >= 0 && b.other >= 0) sum += shared(a.other, a.other_arm, u, b.other, b.other_arm, v);
    return sum;
  }
  RealMatrix normal_mobilities(const std::vector<int>& set) const {
    const auto n = static_cast<int>(set.size());
    RealMatrix A(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j <= i; ++j)
        A(i, j) = A(j, i) = mobility(set[i], contacts_[set[i]].normal, set[j], contacts_[set[j]].normal);
    return A;
  }

  void push(int k, const RealVec& impulse) {
    const GroupContact& c = contacts_[k];
    push_body(c.body, c.arm, impulse);
    if (c.other >= 0) push_body(c.other, c.other_arm, -impulse);
  }
  void push_normal(int k, Real impulse) { push(k, impulse * contacts_[k].normal); }

 private:
  Real shared(int a, const RealVec& arm_a, const RealVec& u, int b, const RealVec& arm_b,
              const RealVec& v) const {
    if (a != b) return 0;
    const GroupBody& body = bodies_[a];
    const RealVec mass(body.inverse_mass_x, body.inverse_mass_y);
    return mass.dot(u.cwiseProduct(v)) +
           body.inverse_inertia * extended::cross(arm_a, u) * extended::cross(arm_b, v);
  }
  void push_body(int k, const RealVec& arm, const RealVec& impulse) {
    const GroupBody& body = bodies_[k];
    twists_[k].velocity += RealVec(body.inverse_mass_x, body.inverse_mass_y).cwiseProduct(impulse);
    twists_[k].omega += body.inverse_inertia * extended::cross(arm, impulse);
  }

  const std::vector<GroupBody>& bodies_;
  const std::vector<GroupContact>& contacts_;
  std::vector<ExtendedTwist> twists_;
  Real speed_ = 0;
};

/// The contacts that can be moved at all.
std::vector<int> movable(const Group& group, const std::vector<GroupContact>& contacts) {
  std::vector<int> set;
  for (int k = 0; k < group.size(); ++k)
    if (group.mobility(k, contacts[k].normal, k, contacts[k].normal) > 0) set.push_back(k);
  return set;
}

/// Impulses at the contacts of `set`, one an entry, so that v' + target >= 0; empty where there are none.
RealVector impulses(const Group& group, const std::vector<int>& set, const RealVector& target) {
  RealVector q(target.size());
  for (std::size_t k = 0; k < set.size(); ++k) {
    q[k] = group.normal_velocity(set[k]) + target[k];
    if (std::abs(q[k]) <= group.rounding()) q[k] = 0;
  }
  const LcpAnswer answer = solve_lcp(group.normal_mobilities(set), q);
  return answer.status == LcpAnswer::Status::solved ? answer.z : RealVector();
}

GroupResult jammed(const Group& group) {
  GroupResult result;
  result.status = GroupResult::Status::jam;
  result.twists = group.twists();
  result.normal.assign(group.size(), 0);
  result.tangential.assign(group.size(), 0);
  return result;
}

/// True if a contact approaches that nothing can turn round.
bool has_jam(const Group& group, const std::vector<int>& set) {
  for (int k = 0; k < group.size(); ++k)
    if (group.normal_velocity(k) < -group.rounding() && !std::binary_search(set.begin(), set.end(), k))
      return true;
  return false;
}

Real least_restitution(const std::vector<GroupContact>& contacts) {
  Real least = 1;
  for (const GroupContact& c : contacts) least = std::min<Real>(least, c.material.restitution);
  return least;
}

/// Coulomb's friction after the normal impulses of `result`, contact by contact.
void add_friction(Group& group, const std::vector<GroupContact>& contacts, GroupResult& result) {
  result.tangential.assign(contacts.size(), 0);
  for (int k = 0; k < group.size(); ++k) {
    const Material& m = contacts[k].material;
    const Real bound = m.friction * result.normal[k];
    const RealVec tangent = extended::perp(contacts[k].normal);
    const Real yield = group.mobility(k, tangent, k, tangent);
    if (!(bound > 0) || !(yield > 0)) continue;
    const Real wanted = -(1 + static_cast<Real>(m.tangential_restitution)) * group.velocity(k).dot(tangent);
    result.tangential[k] = std::clamp(wanted / yield, -bound, bound);
    group.push(k, result.tangential[k] * tangent);
  }
}

/// Gives the impulses of `set` to a fresh group, then friction.
GroupResult given(Group group, const std::vector<GroupContact>& contacts, const std::vector<int>& set,
                  const RealVector& normal) {
  GroupResult result;
  result.normal.assign(contacts.size(), 0);
  for (std::size_t k = 0; k < set.size(); ++k) {
    result.normal[set[k]] = normal[k];
    group.push_normal(set[k], normal[k]);
  }
  add_friction(group, contacts, result);
  result.twists = group.twists();
  return result;
}

/// The work of normal impulses [J], by the mean velocity at each contact before and after.
Real work_of(const Group& before, const std::vector<int>& set, const RealVector& normal) {
  Group after = before;
  for (std::size_t k = 0; k < set.size(); ++k) after.push_normal(set[k], normal[k]);
  Real work = 0;
  for (std::size_t k = 0; k < set.size(); ++k)
    work += normal[k] * (before.normal_velocity(set[k]) + after.normal_velocity(set[k])) / 2;
  return work;
}

constexpr int kMostReflections = 10000;

/// Reflects until nothing approaches; adds the impulses to `normal`. False if the cap was met or something
/// jams.
bool reflect(Group& group, const std::vector<int>& set, RealVector& normal, int& reflections) {
  for (; reflections < kMostReflections; ++reflections) {
    std::vector<int> approaching, place;
    for (std::size_t k = 0; k < set.size(); ++k)
      if (group.normal_velocity(set[k]) < -group.rounding()) {
        approaching.push_back(set[k]);
        place.push_back(static_cast<int>(k));
      }
    if (approaching.empty()) return true;
    const auto n = static_cast<Eigen::Index>(approaching.size());
    const RealVector stop = impulses(group, approaching, RealVector::Zero(n));
    if (stop.size() == 0) return false;
    for (Eigen::Index k = 0; k < n; ++k) {
      group.push_normal(approaching[k], 2 * stop[k]);
      normal[place[k]] += 2 * stop[k];
    }
  }
  return false;
}

}  // namespace

GroupResult resolve_together(const std::vector<GroupBody>& bodies,
                             const std::vector<GroupContact>& contacts) {
  const Group group(bodies, contacts);
  const std::vector<int> set = movable(group, contacts);
  if (has_jam(group, set)) return jammed(group);
  const auto newton = [&](auto restitution) {
    RealVector target(static_cast<Eigen::Index>(set.size()));
    for (std::size_t k = 0; k < set.size(); ++k)
      target[k] = restitution(set[k]) * group.normal_velocity(set[k]);
    return impulses(group, set, target);
  };
  RealVector normal = newton([&](int k) { return static_cast<Real>(contacts[k].material.restitution); });
  const Real scale = normal.size() > 0 ? normal.sum() * group.rounding() : Real(0);
  if (normal.size() > 0 && work_of(group, set, normal) > scale) {
    const Real least = least_restitution(contacts);
    normal = newton([&](int) { return least; });
  }
  return normal.size() == 0 && !set.empty() ? jammed(group) : given(group, contacts, set, normal);
}

GroupResult resolve_reflections(const std::vector<GroupBody>& bodies,
                                const std::vector<GroupContact>& contacts) {
  const Group group(bodies, contacts);
  const std::vector<int> set = movable(group, contacts);
  if (has_jam(group, set)) return jammed(group);
  const auto n = static_cast<Eigen::Index>(set.size());
  const Real e = least_restitution(contacts);
  const RealVector inelastic = e < 1 ? impulses(group, set, RealVector::Zero(n)) : RealVector::Zero(n);
  if (inelastic.size() != n) return jammed(group);
  RealVector elastic = RealVector::Zero(n);
  Group mirrored = group;
  int reflections = 0;
  if (e > 0 && !reflect(mirrored, set, elastic, reflections)) {
    const RealVector stop = impulses(group, set, RealVector::Zero(n));
    if (reflections < kMostReflections || stop.size() != n) return jammed(group);
    GroupResult result = given(group, contacts, set, stop);
    result.status = GroupResult::Status::endless;
    result.reflections = reflections;
    return result;
  }
  GroupResult result = given(group, contacts, set, e * elastic + (1 - e) * inelastic);
  result.reflections = reflections;
  return result;
}

}  // namespace brink
