/// Islands that rest in part.
///
///   who is slow is held still, as a support of the others, beside what rests already
///   the others take their step
///   forces are found anew that hold what rests against what leans on it now; those that none hold move, and again
///
/// What rests keeps its motion, and the forces that hold it. So a step costs what moves in it, and a ring of what it leans
/// on (RestCheck). Nobody stops by being slow: whoever comes to rest could be stopped within the step by forces within
/// their cones, and is held by such from then on; the implicit step of Moreau ends with a speed of 0 there.
#include <algorithm>
#include <cmath>
#include <utility>

#include "brink/core/base/limits.h"
#include "brink/scheduler/kernel/islands.h"

namespace brink {

namespace {

/// Islands of more members than this rest in part. Those of fewer may move by modes, which want all of them.
constexpr std::size_t kRestTogether = kModeBodies;
/// Contact tolerances up to which features touch in who comes to rest: the last step closed its gaps but for what they open
/// by turning within it.
constexpr double kTouches = 100.0;
/// Times that some of those who were to come to rest are let go after all, before all of them are; and that some of those
/// who rested wake, before all of their island do.
constexpr int kMostRounds = 6, kMostWakings = 12;
/// A member slower than the first of these parts of what forces make of it in a step may come to rest in one; slower than
/// the second it lies still but for what steps correct.
constexpr double kSlow = 0.05, kAsGoodAsStill = 5e-5;
/// Steps, at most, until it is asked again who may come to rest; and how many times sooner where most lie still.
constexpr int kLongestPause = 15, kSooner = 8;
/// A force below this part of the heaviest member's weight is none.
constexpr double kNoForceOfRest = 1e-9;

}  // namespace

/// One that waits for a limit of bounces is not, whatever its size: it has a time of its own.
bool Islands::is_large(const Island& island) {
  return island.rests && island.members.size() > kRestTogether && island.series.body < 0;
}

/// Ascending.
std::vector<int> Islands::supports() const {
  std::vector<int> all;
  for (const auto& [lead, island] : islands_)
    if (is_large(island)) all.insert(all.end(), island.members.begin(), island.members.end());
  std::sort(all.begin(), all.end());
  return all;
}

/// Those whose steps take it for granted that this body stays where it is.
void Islands::gather_leaning(int body, std::set<int>& members) const {
  const auto own = lead_of_.find(body);
  if (own == lead_of_.end() || !islands_.at(own->second).rests) return;
  std::vector<int> leads;
  for (const auto& [lead, island] : islands_) {
    if (island.rests || members.count(lead)) continue;
    const bool leans = std::any_of(island.contacts.begin(), island.contacts.end(), [&](const HeldContact& c) {
      return c.pair.body == body || c.pair.other_body == body;
    });
    if (leans) leads.push_back(lead);
  }
  for (const int lead : leads) gather(lead, members);
}

/// Takes some of an island's members out of it; the others rest on. What is known of the contacts of those goes to `warm`.
void Islands::leave_rest(int lead, const std::vector<int>& bodies, WarmContacts& warm) {
  Island island = std::move(islands_.at(lead));
  islands_.erase(lead);
  const auto leaves = [&](int k) { return std::binary_search(bodies.begin(), bodies.end(), k); };
  std::vector<HeldContact> stay;
  for (const HeldContact& c : island.contacts) {
    const bool a = leaves(c.pair.body), b = !c.pair.with_site() && leaves(c.pair.other_body);
    if (!a && !b) {
      stay.push_back(c);
      continue;
    }
    search_->search_again(c.pair);
    const Feature key{c.pair, c.feature.sample_on_a, c.feature.sample, c.feature.site};
    warm[key] = c;
    if (c.mode != ContactMode::none) taken_out_.emplace(key, c);
    // whose partner is gone
    if (!c.pair.with_site() && a != b && (c.normal_force > 0.0 || c.tangential_force != 0.0))
      shaken_.insert(a ? c.pair.other_body : c.pair.body);
  }
  island.contacts = std::move(stay);
  std::erase_if(island.members, leaves);
  for (const int k : bodies) lead_of_.erase(k), shaken_.erase(k);
  note_change(EventKind::wake, bodies.front()), ++tally_.woken;
  const int now_first = island.members.front();
  for (const int k : island.members) lead_of_[k] = now_first;
  islands_.emplace(now_first, std::move(island));
}

/// Of whom it is asked whether they come to rest: none where that is not worth it, or has not been some steps ago. Where
/// most lie as good as still it is asked sooner, and of those.
std::set<int> Islands::slow_beside(const IslandMotion& motion, IslandPace& pace) const {
  const std::size_t count = motion.members().count();
  const bool many = count > kRestTogether || !motion.members().supports().empty();
  if (!many) return {};
  const std::set<int> still = motion.slow(kAsGoodAsStill);
  const bool most = 2 * still.size() > count;
  pace.pause = std::max(0, pace.pause - (most ? kSooner : 1));
  if (pace.pause > 0) return {};
  return most ? still : motion.slow(kSlow);
}

/// The island that those who are to come to rest would be with everybody at rest whom they touch; `joined`: by least
/// members, the islands that it would take over.
Island Islands::rest_with(const IslandMotion& motion, const std::set<int>& still,
                          std::set<int>& joined) const {
  Island pool;
  pool.rests = true;
  pool.members.assign(still.begin(), still.end());
  IslandMembers members(*world_, *trajectories_, *search_, run_->time(), still, supports());
  pool.contacts = members.contacts(kTouches * search_->limits().tolerance);
  for (const HeldContact& c : pool.contacts)
    for (const int k : {c.pair.body, c.pair.other_body})
      if (k >= 0 && !still.count(k)) joined.insert(lead_of_.at(k));
  for (HeldContact& c : pool.contacts) {
    const RealVec from = members.other_state(c.pair).position;
    c.place = from.cast<double>() + c.feature.point;
    c.lasted = motion.duration();
  }
  for (std::size_t i = 0; i < members.count(); ++i)
    pool.due = std::min(pool.due, members.next_break(static_cast<int>(i)));
  for (const int lead : joined) {
    const Island& other = islands_.at(lead);
    pool.members.insert(pool.members.end(), other.members.begin(), other.members.end());
    pool.contacts.insert(pool.contacts.end(), other.contacts.begin(), other.contacts.end());
    pool.due = std::min(pool.due, other.due);
  }
  std::sort(pool.members.begin(), pool.members.end());
  std::sort(pool.contacts.begin(), pool.contacts.end(),
            [](const HeldContact& a, const HeldContact& b) { return a.order() < b.order(); });
  return pool;
}

namespace {

/// Bodies at rest on which the step's contacts press.
std::set<int> leaned_on(const IslandMotion& motion) {
  std::set<int> bodies;
  for (const HeldContact& c : motion.contacts())
    if (motion.members().leans(c) && (c.normal_force > 0.0 || c.tangential_force != 0.0))
      bodies.insert(motion.members().has(c.pair.body) ? c.pair.other_body : c.pair.body);
  return bodies;
}

}  // namespace

/// On bodies at rest, by everybody who leans on them: in this step, or in one that goes on.
RestLoads Islands::loads(const IslandMotion& motion) const {
  RestLoads loads;
  for (const auto& [lead, island] : islands_) {
    if (island.rests) continue;
    const auto rests = [&](int k) {
      return !std::binary_search(island.members.begin(), island.members.end(), k);
    };
    for (const HeldContact& c : island.contacts)
      if (rests(c.pair.body) || (!c.pair.with_site() && rests(c.pair.other_body))) {
        // where it was at the start of that step, from one that has not moved since
        const Vec2 arm = c.place - trajectories_->body(c.pair.body).motion.pose(run_->time()).position;
        add_load(loads, c, arm.cast<Real>(), rests);
      }
  }
  const IslandMembers& members = motion.members();
  for (const HeldContact& c : motion.contacts())
    if (members.leans(c)) add_load(loads, c, members.arm(c), [&](int k) { return !members.has(k); });
  return loads;
}

/// Of everybody at rest, and of `still`, who come to it with their islands in `pool`: those whom no forces hold. Of those who
/// come to rest two things are asked: that forces can take their momentum within the step, and that forces hold them then.
std::set<int> Islands::cannot_stay(const IslandMotion& motion, const std::set<int>& still, Island& pool,
                                   const std::set<int>& pooled) {
  const RestCheck check(*world_, *trajectories_, *search_, *response_, solver_, run_->time());
  const RestLoads loads = this->loads(motion);
  std::set<int> about = leaned_on(motion), moving;
  about.insert(shaken_.begin(), shaken_.end());
  std::map<int, std::set<int>> of_island;  // what has changed, by who leads it
  std::set<int> of_pool = still;
  for (const int k : about) {
    const auto lead = lead_of_.find(k);
    if (still.count(k) || lead == lead_of_.end() || !islands_.at(lead->second).rests) continue;
    (pooled.count(lead->second) ? of_pool : of_island[lead->second]).insert(k);
  }
  if (!still.empty()) {
    RestLoads with_momentum = loads;
    for (const int k : still) {
      const Twist v = motion.members().twist_as_member(k).rounded();
      const Body& b = world_->bodies[k];
      const double per_time = 1.0 / motion.duration();
      with_momentum.try_emplace(k, Vec3::Zero()).first->second +=
          per_time * Vec3(b.mass * v.velocity.x(), b.mass * v.velocity.y(), b.inertia * v.omega);
    }
    Island tried = pool;
    moving = check.moving(tried, of_pool, with_momentum);
    if (moving.empty()) moving = check.moving(pool, of_pool, loads);
  }
  for (const auto& [lead, changed] : of_island) moving.merge(check.moving(islands_.at(lead), changed, loads));
  return moving;
}

/// Modes of an island at rest, whose forces have been found anew: what presses is a stretch of rest, what does not is none.
void Islands::note_rest_modes(Island& island) {
  double most = 0.0;
  for (const int k : island.members)
    most = std::max(most, world_->bodies[k].mass * trajectories_->acceleration(k).linear.norm());
  for (HeldContact& c : island.contacts) {
    const bool presses = std::max(c.normal_force, std::abs(c.tangential_force)) > kNoForceOfRest * most;
    const ContactMode mode = presses ? ContactMode::rest : ContactMode::none;
    if (mode == c.mode) continue;
    if (c.mode != ContactMode::none) records_->lasted(c);
    c.mode = mode;
    c.since = run_->time();
  }
}

/// With their islands, from now on.
void Islands::come_to_rest(const IslandMotion& motion, const std::set<int>& still, Island pool,
                           const std::set<int>& pooled, std::vector<int>& changed) {
  std::vector<Restart> stopped;
  for (const int k : still) {
    ExtendedState s = trajectories_->state_now(k);
    s.twist = ExtendedTwist();
    stopped.push_back({k, s});
  }
  trajectories_->hold(stopped, changed);
  for (const int lead : pooled) {
    for (const HeldContact& c : islands_.at(lead).contacts)  // they go on
      if (c.mode != ContactMode::none)
        taken_out_.emplace(Feature{c.pair, c.feature.sample_on_a, c.feature.sample, c.feature.site}, c);
    for (const int k : islands_.at(lead).members) lead_of_.erase(k);
    islands_.erase(lead);
  }
  for (HeldContact& c : pool.contacts) c.mode = ContactMode::rest;
  note_change(EventKind::sleep, *still.begin());
  ++tally_.slept;
  if (motion.members().count() > 0) ++tally_.steps;  // beside that of those who move
  put_in(std::move(pool));
}

bool Islands::step_beside_rest(std::set<int>& members, IslandMotion& motion, IslandPace& pace, double h,
                               bool may_rest, std::vector<int>& changed) {
  std::set<int> still = may_rest ? slow_beside(motion, pace) : std::set<int>{}, pooled;
  Island pool;
  bool tried = false;
  const auto moving_of = [&] {
    std::set<int> moving;
    std::set_difference(members.begin(), members.end(), still.begin(), still.end(),
                        std::inserter(moving, moving.end()));
    return moving;
  };
  const auto supports_now = [&] {
    std::vector<int> all = supports();
    all.insert(all.end(), still.begin(), still.end());
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto wake = [&](const std::set<int>& woken) {
    std::set<int> more;
    for (const int k : woken) gather(k, more);
    WarmContacts warm = take_out(more, pace);
    members.insert(more.begin(), more.end());
    motion.reassign(moving_of(), supports_now(), std::move(warm));
  };
  for (int round = 0;; ++round) {
    if (round >= kMostRounds) still.clear();
    pooled.clear();
    if (!still.empty()) {
      pool = rest_with(motion, still, pooled);
      if (pool.members.size() <= kRestTogether || 4 * still.size() < members.size())
        still.clear(), pooled.clear();
    }
    if (!still.empty()) tried = true;
    if (tried || round > 0) motion.reassign(moving_of(), supports_now());
    if (motion.members().count() == 0)
      motion.wait(h);
    else if (!motion.take(h, limits_.tolerance)) {
      // as if nobody came to rest, and none of those rested on whom they lean
      if (still.empty() && !(motion.leans() && round < kMostWakings)) return false;
      if (still.empty()) wake(leaned_on(motion));
      still.clear();
      continue;
    }
    std::set<int> moving;
    // a step that was cut short says nothing of who may rest
    if (!still.empty() && motion.duration() < 0.5 * h)
      moving = still;
    else
      moving = cannot_stay(motion, still, pool, pooled);
    if (moving.empty()) break;
    std::set<int> woken;
    const std::size_t asked = still.size();
    for (const int k : moving)
      if (still.erase(k) == 0) woken.insert(k);
    // where many do not come to rest, more of the others would not without them
    if (4 * still.size() < 3 * asked) still.clear();
    if (round >= kMostWakings)
      for (const int k : std::set<int>(woken))
        woken.insert(islands_.at(lead_of_.at(k)).members.begin(), islands_.at(lead_of_.at(k)).members.end());
    wake(woken);
  }
  shaken_.clear();
  for (auto& [lead, island] : islands_)
    if (is_large(island)) note_rest_modes(island);
  if (!still.empty()) come_to_rest(motion, still, std::move(pool), pooled, changed);
  if (tried) {
    pace.last_pause = still.empty() ? std::min(kLongestPause, 2 * pace.last_pause + 1) : 0;
    pace.pause = pace.last_pause;
  }
  return true;
}

}  // namespace brink
