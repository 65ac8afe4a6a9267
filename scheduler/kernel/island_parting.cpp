#include "brink/scheduler/kernel/island_parting.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "brink/core/base/disjoint_sets.h"
#include "brink/scheduler/islands/step_balance.h"
#include "brink/scheduler/islands/tolerances.h"
#include "brink/scheduler/kernel/island_modes.h"

namespace brink {

namespace {

/// Contact tolerances that a contact is open before its bodies are let go from modes.
constexpr double kClear = 100.0;
/// So many of these together have moved a member: the digits of a coarse solve are some hundreds.
constexpr double kMoved = 1e3;
/// Members of an agitated island that are closer than this part of the smallest member's size stay together.
constexpr double kRattles = 0.25;
/// What meets again within this part of a step has never been apart; so many halvings of that are looked at.
constexpr double kAtOnce = 1.0 / 32.0;
constexpr int kLooksBack = 6;
/// A speed below this part of what the smallest member gains as it falls by its size is none.
constexpr double kNoSpeed = 1e-7;

}  // namespace

/// Contacts hold at rest that are as near as rests() has them.
std::vector<HeldContact> IslandParting::that_hold() const {
  const double near = std::max(step_.search.limits().tolerance, kHolds * step_.members.size());
  std::vector<HeldContact> found;
  for (const HeldContact& c : step_.contacts) {
    const bool among = stands(c.pair.body) && (c.pair.with_site() || stands(c.pair.other_body));
    if (among && !c.feature.beside_arc && !c.feature.goes_on &&
        c.feature.gap - approach().kept(c.feature) <= near)
      found.push_back(as_held(c, ContactMode::rest));
  }
  return found;
}

/// With what they give: of many, what is told of them balances no more than it has to.
std::vector<HeldContact> IslandParting::that_lean() const {
  std::vector<HeldContact> found;
  for (std::size_t k = 0; k < step_.contacts.size(); ++k) {
    const HeldContact& c = step_.contacts[k];
    if (c.pair.with_site() || stands(c.pair.body) == stands(c.pair.other_body)) continue;
    HeldContact& lean = found.emplace_back(as_held(c, ContactMode::none));
    lean.normal_force = step_.gives[k].normal;
    lean.tangential_force = step_.gives[k].tangential;
    // of a support the problem has what is given to the other: the opposite of what the pair's body has
    const bool of_other = step_.members.is_support(step_.members.place_of(c.pair.body));
    lean.rolling_torque = of_other ? -step_.gives[k].rolling : step_.gives[k].rolling;
  }
  return found;
}

bool IslandParting::stands(int body) const {
  const int place = step_.members.place_of(body);
  return step_.members.is_support(place) || step_.at_rest[place];
}

/// A force that is more than a rounding of the heaviest member's weight; also one of friction alone, of which bounds that
/// lag may leave some where nothing presses any more: who is let go must have been moved by nobody.
bool IslandParting::pushes(const HeldContact& c) const {
  return std::max(c.normal_force, std::abs(c.tangential_force)) > no_force();
}

double IslandParting::no_force() const { return kNoForce * step_.members.heaviest() * step_.members.pull(); }

/// Of all contacts together, by what the step has made of the member's velocity [N].
double IslandParting::contact_force_on(int member) const {
  return contact_impulse(step_.problem.mass[member], step_.problem.force[member],
                         as_vector(step_.members.state(member).twist.rounded()),
                         step_.problem.velocity[member], step_.h, step_.members.bounding_radius(member)) /
         step_.h;
}

/// True if the two, which touch, would meet again at once if both were let go, in a small part of the step, though a step of
/// constant twists opens their gap: an arc that turns under a body which forces lift, but not as fast as it bends away.
/// `velocity`: that of all members now; it is the same afterwards.
bool IslandParting::falls_back(const HeldContact& c, std::vector<Vec3>& velocity) const {
  if (!approach().touches(c) || c.feature.goes_on) return false;
  const auto [a, b] = step_.members.members_of(c.pair);
  const Vec3 of_a = velocity[a], of_b = velocity[b];
  // the way of a time with the mean velocity of a fall is that of the fall
  const auto mean = [&](int member, const Vec3& before, double time) {
    return Vec3(before + 0.5 * time * as_vector(step_.members.acceleration(member)));
  };
  // what has sunk already is none that falls
  const double deeper = std::min(c.feature.gap, approach().kept(c.feature)) - step_.search.limits().touch;
  bool meets = false;
  for (int k = kLooksBack; k >= 0 && !meets; --k) {
    const double time = std::ldexp(step_.h * kAtOnce, -k);
    velocity[a] = mean(a, of_a, time);
    velocity[b] = mean(b, of_b, time);
    meets = step_.members.gap(c, time, velocity) < deeper;
  }
  velocity[a] = of_a;
  velocity[b] = of_b;
  return meets;
}

/// Nothing pushes, but one of the two alone, left to its parabola, could run into the other's step: that has the
/// twist of its end from the start on, which a parabola comes to by and by. Where others push both, each takes steps, and
/// there is no parabola: what rolls along beside a heap, touching nobody, does not keep it awake. By modes, it has just been
/// let go: an open contact is looked at from there on as well as any other, until it is clear of it. And who meets where the
/// step ends: a search as far as that could tell either, by roundings.
bool IslandParting::stays_near(std::size_t contact, bool both_pushed, std::vector<Vec3>& velocity) const {
  const HeldContact& c = step_.contacts[contact];
  const double behind = both_pushed && !step_.by_modes ? 0.0 : step_.members.pull() * step_.h;
  const double tolerance = step_.search.limits().tolerance;
  if (step_.by_modes) {
    const double closing = step_.members.closing_speed(c);
    // a parting of this speed rises kClear tolerances: v^2 / 2 a
    if (c.feature.gap <= kClear * tolerance &&
        IslandModes::is_slow(step_.members, step_.search, c, -closing, std::sqrt(kClear)))
      return true;
    return !c.pair.with_site() && (c.feature.gap - step_.h * (closing + behind) <= tolerance ||
                                   step_.gaps_at_end[contact] <= kClear * tolerance);
  }
  if (falls_back(c, velocity) || (step_.captured == c.pair && approach().touches(c))) return true;
  // a site takes no step, nor does what is at rest: whoever is let go meets it by the ordinary search
  if (c.pair.with_site() || stands(c.pair.body) || stands(c.pair.other_body)) return false;
  const double closing = step_.members.closing_speed(
      c, ExtendedTwist(as_twist(step_.problem.velocity[step_.members.place_of(c.pair.body)])),
      ExtendedTwist(as_twist(step_.problem.velocity[step_.members.place_of(c.pair.other_body)])));
  return c.feature.gap - step_.h * (closing + behind) <= tolerance;
}

/// Pairs of members whose bounding discs are so near that they stay together while the island is agitated: who
/// rattles would be back at once.
std::vector<std::pair<int, int>> IslandParting::neighbours() const {
  const double near = kRattles * step_.members.size();
  const auto left = [&](int i) {
    return static_cast<double>(step_.members.state(i).position.x()) - step_.members.bounding_radius(i);
  };
  std::vector<int> by_left(step_.members.count());
  std::iota(by_left.begin(), by_left.end(), 0);
  std::sort(by_left.begin(), by_left.end(),
            [&](int a, int b) { return std::pair(left(a), a) < std::pair(left(b), b); });
  std::vector<std::pair<int, int>> found;
  for (std::size_t x = 0; x < by_left.size(); ++x)
    for (std::size_t y = x + 1; y < by_left.size(); ++y) {
      const int a = by_left[x], b = by_left[y];
      const double reach = step_.members.bounding_radius(a) + step_.members.bounding_radius(b) + near;
      // those that follow begin farther right still
      if (left(b) > left(a) + 2.0 * step_.members.bounding_radius(a) + near) break;
      const RealVec apart = step_.members.state(a).position - step_.members.state(b).position;
      if (static_cast<double>(apart.norm()) <= reach) found.emplace_back(a, b);
    }
  return found;
}

IslandParts IslandParting::parts(bool rests) const {
  const int count = static_cast<int>(step_.members.count());
  DisjointSets joined;
  joined.reset(count);
  std::vector<bool> pushed(step_.members.count(), false), seen(step_.members.count(), false);
  const auto places = [this](const HeldContact& c) {
    // a site keeps its body in an island, but joins nobody to it; nor does what is at rest
    auto [a, b] = step_.members.members_of(c.pair);
    if (step_.at_rest[a]) a = b;
    if (step_.at_rest[b]) b = a;
    return std::pair(a, b);
  };
  for (const HeldContact& c : step_.contacts) {
    // at rest all that touch stay together: forces of redundant contacts are one choice of many, and 0 for
    // some
    if (!rests && !pushes(c)) continue;
    const auto [a, b] = places(c);
    pushed[a] = pushed[b] = true;
    joined.unite(a, b);
  }
  // whatever pushed it, as forces that are told are not those that move it (StepOutcome::friction_residual)
  for (int i = 0; i < count && !rests && !step_.by_modes && !step_.contacts.empty(); ++i)
    pushed[i] = pushed[i] || contact_force_on(i) > kMoved * no_force();
  const std::vector<bool> by_others = pushed;
  std::vector<Vec3> velocity = step_.members.velocities();
  for (std::size_t k = 0; k < step_.contacts.size(); ++k) {
    const auto [a, b] = places(step_.contacts[k]);
    if (rests || pushes(step_.contacts[k]) || !stays_near(k, by_others[a] && by_others[b], velocity))
      continue;
    pushed[a] = pushed[b] = true;
    joined.unite(a, b);
  }
  // who leans on those at rest goes on together: what these carry is asked once
  int leans = -1;
  for (const HeldContact& c : step_.contacts) {
    if (c.pair.with_site() || stands(c.pair.body) == stands(c.pair.other_body)) continue;
    const int a = places(c).first;
    if (!pushed[a]) continue;
    if (leans >= 0) joined.unite(leans, a);
    leans = a;
  }
  if (step_.agitated && !rests)
    for (const auto& [a, b] : neighbours()) {
      pushed[a] = pushed[b] = true;
      joined.unite(a, b);
    }
  for (int i = 0; i < count; ++i)
    // springs hold a component together, and an island holds it whole or not at all
    for (const int j : step_.members.coupled_to(i)) joined.unite(i, j);
  IslandParts parts;
  // Sets come in the order of their least member. One without a push anywhere is let go, body by body.
  for (int i = 0; i < count; ++i) {
    if (seen[i] || step_.at_rest[i]) continue;
    std::vector<int> set(joined.of(i).begin(), joined.of(i).end());
    std::sort(set.begin(), set.end());
    for (const int j : set) seen[j] = true;
    if (std::any_of(set.begin(), set.end(), [&](int j) { return pushed[j]; }))
      parts.together.push_back(std::move(set));
    else
      parts.free.insert(parts.free.end(), set.begin(), set.end());
  }
  return parts;
}

/// By the relative velocity of the two points that touch, along the tangent; where that is none, by the relative
/// spin. Without a push it has no mode.
ContactMode IslandParting::mode_of(const HeldContact& c, bool rests) const {
  if (!pushes(c)) return ContactMode::none;
  if (rests) return ContactMode::rest;
  const auto twist = [this](int body) {
    const int member = step_.members.place_of(body);
    return step_.by_modes ? step_.members.state(member).twist.rounded()
                          : as_twist(step_.members.velocity_of(member, step_.problem.velocity));
  };
  const Twist a = twist(c.pair.body);
  const Twist b =
      c.pair.with_site() ? step_.members.other_state(c.pair).twist.rounded() : twist(c.pair.other_body);
  // with the twists that the step has: those of its end, or of its beginning by modes
  const Vec2 relative = a.at(step_.members.arm(c).cast<double>()) - b.at(c.feature.point);
  const double slow = kNoSpeed * std::sqrt(step_.members.pull() * step_.members.size());
  // what an impact at the beginning of a step by modes has stopped sticks from then on
  const bool sticks = step_.by_modes && c.motion == MotionMode::stick;
  if (!sticks && std::abs(cross(c.feature.normal, relative)) > slow) return ContactMode::slip;
  return std::abs(a.omega - b.omega) * step_.members.size() > slow ? ContactMode::roll : ContactMode::stick;
}

HeldContact IslandParting::as_held(const HeldContact& c, ContactMode mode) const {
  HeldContact held = c;
  held.mode = mode;
  held.place = step_.members.other_state(c.pair).position.cast<double>() + c.feature.point;
  return held;
}

Island IslandParting::island_of(const std::vector<int>& together, bool rests, double end) const {
  Island island;
  std::vector<char> is_in(step_.members.count(), 0);
  for (const int i : together) is_in[i] = 1;
  for (const int i : together) island.members.push_back(step_.members.bodies()[i]);
  // Contacts among these alone, and with what stands: what leads to a member that leaves is searched again.
  const auto has = [&](int body) { return stands(body) || is_in[step_.members.place_of(body)] != 0; };
  for (const HeldContact& c : step_.contacts) {
    const auto [a, b] = step_.members.members_of(c.pair);
    if ((is_in[a] || is_in[b]) && has(c.pair.body) && (c.pair.with_site() || has(c.pair.other_body)))
      island.contacts.push_back(as_held(c, mode_of(c, rests)));
  }
  // A step has its end; what rests has none, but where forces on a member jump.
  island.rests = rests;
  if (!rests) island.due = end;
  if (rests)  // until forces jump
    for (const int i : together) island.due = std::min(island.due, step_.members.next_break(i));
  return island;
}

}  // namespace brink
