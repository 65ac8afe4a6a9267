#include "brink/core/contacts/group.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "brink/core/contacts/impulse.h"
#include "brink/core/contacts/lcp.h"

namespace brink {

namespace {

/// Speeds below this part of the group's largest are rounding.
constexpr Real kRoundingOfSpeed = 64 * std::numeric_limits<Real>::epsilon();

/// Mobilities that are along one line to this part of them: as resolve_impulse() has it.
constexpr Real kOneDirection = 1e-14L;

/// Contacts without finite impulses are taken to yield by this part of what one alone would; if no more than that part of
/// an approach is left after it, they have some.
constexpr Real kGivesWay = 1e-9L, kStopped = 1e-6L;

/// A group in motion: contacts as rows, bodies' twists as they stand.
class Group {
 public:
  Group(const std::vector<GroupBody>& bodies, const std::vector<GroupContact>& contacts)
      : bodies_(bodies), contacts_(contacts) {
    for (const GroupBody& b : bodies) twists_.push_back(b.twist);
    // |v| + |omega| |r|, not the point's speed: where the two parts cancel, the roundings of both remain.
    for (const GroupContact& c : contacts) {
      const auto speed = [](const ExtendedTwist& t, const RealVec& arm) {
        return t.velocity.norm() + abs(t.omega) * arm.norm();
      };
      speed_ = std::max(speed_, speed(bodies[c.body].twist, c.arm));
      speed_ = std::max(
          speed_, c.other < 0 ? c.other_point_velocity.norm() : speed(bodies[c.other].twist, c.other_arm));
    }
  }

  int size() const { return static_cast<int>(contacts_.size()); }
  const std::vector<ExtendedTwist>& twists() const { return twists_; }
  /// The largest [m/s].
  Real speed() const { return speed_; }
  /// What rounding alone may make of a velocity at a contact [m/s].
  Real rounding() const { return kRoundingOfSpeed * speed_; }

  /// Of the contact points, body minus other, as the twists stand [m/s].
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
    // An impulse acts on `body`, and with the opposite sign on `other`; relative
    // velocities have the same signs.
    Real sum = shared(a.body, a.arm, u, b.body, b.arm, v);
    if (b.other >= 0) sum -= shared(a.body, a.arm, u, b.other, b.other_arm, v);
    if (a.other >= 0) sum -= shared(a.other, a.other_arm, u, b.body, b.arm, v);
    if (a.other >= 0 && b.other >= 0) sum += shared(a.other, a.other_arm, u, b.other, b.other_arm, v);
    return sum;
  }
  /// Of the contacts of `set`: entries only where two of them share a body that can move.
  SparseRealMatrix normal_mobilities(const std::vector<int>& set) const {
    const auto n = static_cast<int>(set.size());
    // at[body]: the contacts before i that lie on it, so that each pair of contacts is met once
    std::vector<std::vector<int>> at(bodies_.size());
    std::vector<Eigen::Triplet<Real>> entries;
    for (int i = 0; i < n; ++i) {
      std::vector<int> sharing{i};
      for (const int body : {contacts_[set[i]].body, contacts_[set[i]].other}) {
        if (body < 0) continue;
        sharing.insert(sharing.end(), at[body].begin(), at[body].end());
        at[body].push_back(i);
      }
      // Two contacts may share both bodies, and setFromTriplets adds up what is entered twice.
      std::sort(sharing.begin(), sharing.end());
      sharing.erase(std::unique(sharing.begin(), sharing.end()), sharing.end());
      for (const int j : sharing) add_mobility(set, i, j, entries);
    }
    SparseRealMatrix A(n, n);
    A.setFromTriplets(entries.begin(), entries.end());
    return A;
  }

  /// An impulse [N s] on the contact's body, and its opposite on the other.
  void push(int k, const RealVec& impulse) {
    const GroupContact& c = contacts_[k];
    push_body(c.body, c.arm, impulse);
    if (c.other >= 0) push_body(c.other, c.other_arm, -impulse);
  }
  void push_normal(int k, Real impulse) { push(k, impulse * contacts_[k].normal); }

 private:
  /// Symmetric: each pair is computed once and entered twice. Contacts that share a body may still not feel each
  /// other, and have no entry then.
  void add_mobility(const std::vector<int>& set, int i, int j,
                    std::vector<Eigen::Triplet<Real>>& entries) const {
    const Real m = mobility(set[i], contacts_[set[i]].normal, set[j], contacts_[set[j]].normal);
    if (m == 0) return;
    entries.emplace_back(i, j, m);
    if (i != j) entries.emplace_back(j, i, m);
  }
  /// What a body that both contacts lie on gives to mobility(); 0 of two different bodies.
  Real shared(int a, const RealVec& arm_a, const RealVec& u, int b, const RealVec& arm_b,
              const RealVec& v) const {
    if (a != b) return 0;
    const GroupBody& body = bodies_[a];
    // u.M^-1 v + (r_a x u)(r_b x v) / I
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

/// Impulses at the contacts of `set`, one an entry, so that v' + target >= 0.
LcpAnswer impulses(const Group& group, const std::vector<int>& set, const RealVector& target,
                   const GoOn& go_on) {
  RealVector q(target.size());
  for (std::size_t k = 0; k < set.size(); ++k) {
    // w = A z + q is v' + target, as v' = v + A z.
    q[k] = group.normal_velocity(set[k]) + target[k];
    // Within rounding the sign is chance, and a contact that rests would be pushed or not by it.
    if (abs(q[k]) <= group.rounding()) q[k] = 0;
  }
  SparseRealMatrix mobilities = group.normal_mobilities(set);
  const LcpAnswer exact = solve_lcp(mobilities, q, go_on);
  if (exact.status == LcpAnswer::Status::solved || exact.status == LcpAnswer::Status::stopped) return exact;
  // Normals that are opposite but for roundings (of a body in a slot of its own width) have impulses beyond all bounds,
  // or none. Contacts that give way a little have some; what approaches still is for the next group of the instant.
  SparseRealMatrix yielding = mobilities;
  for (Eigen::Index k = 0; k < q.size(); ++k) yielding.coeffRef(k, k) *= 1 + kGivesWay;
  const LcpAnswer found = solve_lcp(yielding, q, go_on);
  if (found.status == LcpAnswer::Status::stopped) return found;
  const bool stops = found.status == LcpAnswer::Status::solved &&
                     (mobilities * found.z + q).minCoeff() >= -kStopped * q.lpNorm<Eigen::Infinity>();
  return stops ? found : exact;
}

/// A problem without a solution, or one that is capped, is a jam to the group.
GroupResult::Status status_of(const LcpAnswer& answer) {
  switch (answer.status) {
    case LcpAnswer::Status::solved:
      return GroupResult::Status::resolved;
    case LcpAnswer::Status::stopped:
      return GroupResult::Status::stopped;
    default:
      return GroupResult::Status::jam;
  }
}

/// Twists as they were, and no impulses.
GroupResult unresolved(const Group& group, GroupResult::Status status) {
  GroupResult result;
  result.status = status;
  result.twists = group.twists();
  result.normal.assign(group.size(), 0);
  result.tangential.assign(group.size(), 0);
  return result;
}

/// True if a contact approaches that nothing can turn round.
bool has_jam(const Group& group, const std::vector<int>& set) {
  for (int k = 0; k < group.size(); ++k)
    // `set` is ascending, as movable() makes it
    if (group.normal_velocity(k) < -group.rounding() && !std::binary_search(set.begin(), set.end(), k))
      return true;
  return false;
}

/// One restitution for all: with several, energy could be made.
Real least_restitution(const std::vector<GroupContact>& contacts) {
  Real least = 1;
  for (const GroupContact& c : contacts) least = std::min<Real>(least, c.material.restitution);
  return least;
}

/// Coulomb's friction after the normal impulses of `result`, contact by contact.
void add_friction(Group& group, const std::vector<GroupContact>& contacts, GroupResult& result) {
  for (int k = 0; k < group.size(); ++k) {
    const Material& m = contacts[k].material;
    const Real bound = m.friction * result.normal[k];
    const RealVec tangent = extended::perp(contacts[k].normal);
    const Real yield = group.mobility(k, tangent, k, tangent);
    if (!(bound > 0) || !(yield > 0)) continue;
    // What can move in one direction alone has its velocity from the normal impulses: friction would change that, as it
    // does in resolve_impulse() nothing but the impulse.
    const RealVec& normal = contacts[k].normal;
    const Real across = group.mobility(k, tangent, k, normal), along = group.mobility(k, normal, k, normal);
    if (along * yield - across * across <= kOneDirection * along * yield) continue;
    // Of this contact alone, with the velocities that the contacts before it have left. The impulse lies
    // between 0 and the one that makes v_t into -e_t v_t, so that its work pt (v_t + v_t') / 2 is <= 0
    // for |e_t| <= 1.
    const Real wanted = -(1 + static_cast<Real>(m.tangential_restitution)) * group.velocity(k).dot(tangent);
    result.tangential[k] = std::clamp(wanted / yield, -bound, bound);
    group.push(k, result.tangential[k] * tangent);
  }
}

/// The work of normal impulses [J], by the mean velocity at each contact before and after.
Real work_of(const Group& before, const Group& after, const std::vector<int>& set, const RealVector& normal) {
  Real work = 0;
  for (std::size_t k = 0; k < set.size(); ++k)
    // exact: kinetic energy is quadratic in the twists, so that impulses p change it by p.(v + v') / 2
    work += normal[k] * (before.normal_velocity(set[k]) + after.normal_velocity(set[k])) / 2;
  return work;
}

/// A copy of the group after these impulses.
Group pushed(Group group, const std::vector<int>& set, const RealVector& normal) {
  for (std::size_t k = 0; k < set.size(); ++k) group.push_normal(set[k], normal[k]);
  return group;
}

/// Approaches below this part of the group's largest speed have no friction: each may push a contact together again, and of what
/// rounding makes of that nobody would see the end.
constexpr Real kTooSlowToRub = 1e-13L;

/// True if something approaches fast enough for friction.
bool rubs(const Group& group, const std::vector<int>& set) {
  return std::any_of(set.begin(), set.end(),
                     [&](int k) { return group.normal_velocity(k) < -kTooSlowToRub * group.speed(); });
}

/// Gives the impulses of `set` to a fresh group, then friction.
GroupResult given(const Group& group, const std::vector<GroupContact>& contacts, const std::vector<int>& set,
                  const RealVector& normal) {
  GroupResult result;
  result.normal.assign(contacts.size(), 0);
  for (std::size_t k = 0; k < set.size(); ++k) result.normal[set[k]] = normal[k];
  Group after = pushed(group, set, normal);
  result.lost = -work_of(group, after, set, normal);
  result.tangential.assign(contacts.size(), 0);
  if (rubs(group, set)) add_friction(after, contacts, result);
  result.twists = after.twists();
  return result;
}

/// Faster than rounding: what is slower rests, and would be pushed without end.
bool approaches(const Group& group, int k) { return group.normal_velocity(k) < -group.rounding(); }

/// Random lattices of 20 discs need fewer than 300; what rattles in a hole of its own size may need any number.
constexpr int kMostReflections = 10000;

/// Reflects until nothing approaches, or kMostReflections times; adds the impulses to `normal`.
LcpAnswer::Status reflect(Group& group, const std::vector<int>& set, RealVector& normal, int& reflections,
                          const GoOn& go_on) {
  for (; reflections < kMostReflections; ++reflections) {
    std::vector<int> approaching, place;
    for (std::size_t k = 0; k < set.size(); ++k)
      if (approaches(group, set[k])) {
        approaching.push_back(set[k]);
        place.push_back(static_cast<int>(k));
      }
    if (approaching.empty()) return LcpAnswer::Status::solved;
    const auto n = static_cast<Eigen::Index>(approaching.size());
    // z >= 0, w = v + A z >= 0 and z.w = 0 stop them. Given twice, with v' = v + 2 A z, they do the work
    // z.(v + v') = 2 z.w = 0: a reflection keeps the energy.
    const LcpAnswer stop = impulses(group, approaching, RealVector::Zero(n), go_on);
    if (stop.status != LcpAnswer::Status::solved) return stop.status;
    for (Eigen::Index k = 0; k < n; ++k) {
      group.push_normal(approaching[k], 2 * stop.z[k]);
      normal[place[k]] += 2 * stop.z[k];
    }
  }
  return LcpAnswer::Status::capped;
}

/// Of a group that reflects without end: Newton's law at all contacts if it leaves nothing approaching, else
/// the inelastic law.
GroupResult without_end(const Group& group, const std::vector<GroupBody>& bodies,
                        const std::vector<GroupContact>& contacts, const std::vector<int>& set,
                        const GoOn& go_on) {
  GroupResult together = resolve_together(bodies, contacts, go_on);
  if (together.status == GroupResult::Status::stopped) return together;
  if (together.status == GroupResult::Status::resolved) {
    RealVector normal(static_cast<Eigen::Index>(set.size()));
    for (std::size_t k = 0; k < set.size(); ++k) normal[k] = together.normal[set[k]];
    const Group after = pushed(group, set, normal);
    if (std::none_of(set.begin(), set.end(), [&](int k) { return approaches(after, k); })) return together;
  }
  // Nothing approaches after the inelastic law, whatever the group; what it costs in energy is in `lost`.
  const LcpAnswer stop = impulses(group, set, RealVector::Zero(static_cast<Eigen::Index>(set.size())), go_on);
  if (stop.status != LcpAnswer::Status::solved) return unresolved(group, status_of(stop));
  GroupResult result = given(group, contacts, set, stop.z);
  result.status = GroupResult::Status::endless;
  return result;
}

/// Coulomb's law at all contacts at once, without a rebound, as a complementarity problem: of every contact its normal impulse p,
/// its friction along the tangent f+ and against it f-, and the slip g that is left:
///
///   0 <= p  _|_  v_n' >= 0,   0 <= f+  _|_  v_t' + g >= 0,   0 <= f-  _|_  -v_t' + g >= 0,   0 <= g  _|_  mu p - f+ - f- >= 0
///
/// Impulses are scaled so that 1 changes v_n at its own contact by as much, with light bodies and heavy ones.
class PlasticProblem {
 public:
  PlasticProblem(const Group& group, const std::vector<GroupContact>& contacts, const std::vector<int>& set)
      : set_(set), scale_(static_cast<Eigen::Index>(set.size())) {
    const auto n = static_cast<Eigen::Index>(set.size());
    A_ = RealMatrix::Zero(4 * n, 4 * n);
    q_ = RealVector::Zero(4 * n);
    const auto normal = [&](Eigen::Index i) { return contacts[set[i]].normal; };
    const auto tangent = [&](Eigen::Index i) { return extended::perp(contacts[set[i]].normal); };
    const auto rounded = [&](Real v) { return abs(v) <= group.rounding() ? Real(0) : v; };
    for (Eigen::Index i = 0; i < n; ++i) scale_[i] = 1 / group.mobility(set[i], normal(i), set[i], normal(i));
    for (Eigen::Index i = 0; i < n; ++i) {
      const RealVec v = group.velocity(set[i]);
      q_[i] = rounded(v.dot(normal(i)));
      q_[n + i] = rounded(v.dot(tangent(i)));
      q_[2 * n + i] = -q_[n + i];
      for (Eigen::Index j = 0; j < n; ++j) {
        const auto yields = [&](const RealVec& a, const RealVec& b) {
          return scale_[j] * group.mobility(set[i], a, set[j], b);
        };
        A_(i, j) = yields(normal(i), normal(j));
        A_(i, n + j) = yields(normal(i), tangent(j));
        A_(n + i, j) = yields(tangent(i), normal(j));
        A_(n + i, n + j) = yields(tangent(i), tangent(j));
      }
      A_(n + i, 3 * n + i) = A_(2 * n + i, 3 * n + i) = 1;
      A_(3 * n + i, i) = static_cast<Real>(contacts[set[i]].material.friction);
      A_(3 * n + i, n + i) = A_(3 * n + i, 2 * n + i) = -1;
    }
    // f- is f+ the other way round
    A_.block(0, 2 * n, 2 * n, n) = -A_.block(0, n, 2 * n, n);
    A_.block(2 * n, 0, n, 3 * n) = -A_.block(n, 0, n, 3 * n);
  }

  /// Impulses along the normal and the tangent of each contact of the set. False: none were found.
  bool solve(const GoOn& go_on, RealVector& normal, RealVector& tangential) const {
    const LcpAnswer found = solve_lcp_by_lemke(A_, q_, go_on);
    if (found.status != LcpAnswer::Status::solved) return false;
    const Eigen::Index n = scale_.size();
    normal = scale_.cwiseProduct(found.z.head(n));
    tangential = scale_.cwiseProduct(found.z.segment(n, n) - found.z.segment(2 * n, n));
    return true;
  }

 private:
  std::vector<int> set_;
  RealVector scale_;  ///< impulse of one unit
  RealMatrix A_;
  RealVector q_;
};

ImpulseSide side(const GroupBody& body, const RealVec& arm) {
  return {body.twist, arm, body.inverse_mass_x, body.inverse_mass_y, body.inverse_inertia};
}

/// A contact by itself is resolved as under every other order: its own friction does not push it together again.
GroupResult resolve_alone(const Group& group, const std::vector<GroupBody>& bodies, const GroupContact& c) {
  if (group.normal_velocity(0) >= -group.rounding()) return unresolved(group, GroupResult::Status::resolved);
  ImpulseSide other;
  if (c.other < 0)
    other.twist.velocity = c.other_point_velocity;
  else
    other = side(bodies[c.other], c.other_arm);
  const ImpulseResult found = resolve_impulse(side(bodies[c.body], c.arm), other, c.normal, c.material);
  if (found.kind == ImpulseKind::jam) return unresolved(group, GroupResult::Status::jam);
  GroupResult result;
  result.twists = group.twists();
  result.normal.assign(1, found.normal);
  // told in doubles, whose roundings may be beyond the cone
  const Real bound = c.material.friction * result.normal[0];
  result.tangential.assign(1, std::clamp<Real>(found.tangential, -bound, bound));
  result.twists[c.body] = found.body;
  if (c.other >= 0) result.twists[c.other] = found.other;
  const Real before = group.normal_velocity(0);
  result.lost = -(1 - static_cast<Real>(c.material.restitution)) * result.normal[0] * before / 2;
  return result;
}

/// What approaches no faster than this part of the group's largest speed has been stopped, but for roundings.
constexpr Real kNoneLeft = 1e-15;
/// A dense problem of more contacts takes too long.
constexpr std::size_t kMostPlastic = 48;

}  // namespace

std::optional<GroupResult> resolve_plastic(const std::vector<GroupBody>& bodies,
                                           const std::vector<GroupContact>& contacts, const GoOn& go_on) {
  Group group(bodies, contacts);
  const std::vector<int> set = movable(group, contacts);
  if (set.size() > kMostPlastic || has_jam(group, set)) return std::nullopt;
  RealVector normal, tangential;
  if (!PlasticProblem(group, contacts, set).solve(go_on, normal, tangential)) return std::nullopt;
  GroupResult result;
  result.normal.assign(contacts.size(), 0);
  result.tangential.assign(contacts.size(), 0);
  const Group before = group;
  for (std::size_t k = 0; k < set.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    result.normal[set[k]] = normal[i];
    result.tangential[set[k]] = tangential[i];
    const RealVec& n = contacts[set[k]].normal;
    group.push(set[k], normal[i] * n + tangential[i] * extended::perp(n));
  }
  const auto stops = [&](int k) { return group.normal_velocity(k) >= -kNoneLeft * group.speed(); };
  if (!std::all_of(set.begin(), set.end(), stops)) return std::nullopt;
  result.lost = -work_of(before, group, set, normal);
  result.twists = group.twists();
  return result;
}

GroupResult resolve_together(const std::vector<GroupBody>& bodies, const std::vector<GroupContact>& contacts,
                             const GoOn& go_on) {
  const Group group(bodies, contacts);
  if (contacts.size() == 1) return resolve_alone(group, bodies, contacts[0]);
  // Contacts that nothing moves have no row: their mobility is 0, and if they approach no impulse helps.
  const std::vector<int> set = movable(group, contacts);
  if (has_jam(group, set)) return unresolved(group, GroupResult::Status::jam);
  // 0 <= p _|_ v' + e v >= 0, with v the velocities before: the target of each contact is e v.
  const auto newton = [&](auto restitution) {
    RealVector target(static_cast<Eigen::Index>(set.size()));
    for (std::size_t k = 0; k < set.size(); ++k)
      target[k] = restitution(set[k]) * group.normal_velocity(set[k]);
    return impulses(group, set, target, go_on);
  };
  // With one e complementarity says p.v' = -e p.v; as v' = v + A p, (1 + e) p.v = -p.A p <= 0, and the
  // work p.(v + v') / 2 = (1 - e) p.v / 2 is not positive. With several e it can be.
  LcpAnswer found = newton([&](int k) { return static_cast<Real>(contacts[k].material.restitution); });
  const auto solved = [&] { return found.status == LcpAnswer::Status::solved; };
  // Energy made beyond what rounding of the velocities makes of the work.
  if (solved() &&
      work_of(group, pushed(group, set, found.z), set, found.z) > found.z.sum() * group.rounding()) {
    const Real least = least_restitution(contacts);
    found = newton([&](int) { return least; });
  }
  return solved() ? given(group, contacts, set, found.z) : unresolved(group, status_of(found));
}

GroupResult resolve_reflections(const std::vector<GroupBody>& bodies,
                                const std::vector<GroupContact>& contacts, const GoOn& go_on) {
  const Group group(bodies, contacts);
  if (contacts.size() == 1) {
    GroupResult alone = resolve_alone(group, bodies, contacts[0]);
    alone.reflections = alone.normal[0] > 0 && contacts[0].material.restitution > 0.0 ? 1 : 0;
    return alone;
  }
  const std::vector<int> set = movable(group, contacts);
  if (has_jam(group, set)) return unresolved(group, GroupResult::Status::jam);
  const auto n = static_cast<Eigen::Index>(set.size());
  const Real e = least_restitution(contacts);
  LcpAnswer inelastic{LcpAnswer::Status::solved, RealVector::Zero(n), 0};
  // e = 1 takes none of the inelastic outcome and e = 0 none of the elastic one.
  if (e < 1) inelastic = impulses(group, set, RealVector::Zero(n), go_on);
  if (inelastic.status != LcpAnswer::Status::solved) return unresolved(group, status_of(inelastic));
  RealVector elastic = RealVector::Zero(n);
  Group mirrored = group;
  int reflections = 0;
  if (e > 0) {
    const LcpAnswer::Status status = reflect(mirrored, set, elastic, reflections, go_on);
    if (status == LcpAnswer::Status::stopped) return unresolved(group, GroupResult::Status::stopped);
    // reflections at their cap are no failure: without_end() follows
    if (status != LcpAnswer::Status::solved && reflections < kMostReflections)
      return unresolved(group, GroupResult::Status::jam);
  }
  // Velocities are linear in impulses, so v' = e v_elastic + (1 - e) v_inelastic. Nothing approaches in
  // either, hence not in v', whose kinetic energy is by convexity at most the same mixture of theirs.
  GroupResult result = reflections < kMostReflections
                           ? given(group, contacts, set, e * elastic + (1 - e) * inelastic.z)
                           : without_end(group, bodies, contacts, set, go_on);
  result.reflections = reflections;
  return result;
}

}  // namespace brink
