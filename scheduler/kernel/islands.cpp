#include "brink/scheduler/kernel/islands.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "brink/core/base/disjoint_sets.h"
#include "brink/scheduler/first_contact/canonical_time.h"

namespace brink {

namespace {

/// A step lasts this part of the time in which the smallest member falls by its size ...
constexpr double kOfFall = 0.05;
/// ... and moves nobody by more than this part of it.
constexpr double kOfSize = 0.1;
/// Features are listed as far as bodies come in so many steps; where impulses take one farther, in more.
constexpr double kReach = 2.0, kWider = 4.0;
constexpr int kWidenings = 4;
constexpr int kHalvings = 16;
/// Impacts of one instant inside an island, at most; what closes then is taken as plastic.
constexpr std::size_t kFirstImpacts = 100, kImpactsEach = 20;
/// A force below this part of the weight of the heaviest member is none.
constexpr double kNoForce = 1e-9;

double speed_of(const Twist& v, double radius) { return v.velocity.norm() + std::abs(v.omega) * radius; }

Vec3 as_vector(const Twist& v) { return {v.velocity.x(), v.velocity.y(), v.omega}; }
Twist as_twist(const Vec3& v) { return {{v.x(), v.y()}, v.z()}; }

}  // namespace

/// One step of some members, from its start to the islands that come of it.
class Islands::Step {
 public:
  Step(Islands& of, const std::set<int>& members)
      : of_(of), now_(of.run_->time()), members_(members.begin(), members.end()) {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const int k = members_[i];
      place_[k] = static_cast<int>(i);
      states_.push_back(of_.trajectories_->state_now(k));
      accelerations_.push_back(of_.trajectories_->acceleration(k));
      const double radius = of_.search_->outline_of(k).bounding_radius;
      const double size = radius > 0.0 ? 2.0 * radius : of_.world_->length();
      size_ = std::min(size_, size);
      const double pull =
          accelerations_.back().linear.norm() + std::abs(accelerations_.back().angular) * radius;
      pulls_.push_back(pull);
      pull_ = std::max(pull_, pull);
      heaviest_ = std::max(heaviest_, of_.world_->bodies[k].mass);
    }
    find_speeds();
  }

  /// How long a step may be [s]; infinity: nothing moves or pulls.
  double longest() const {
    const double fall = pull_ > 0.0 ? kOfFall * std::sqrt(size_ / pull_) : kForever;
    const double way = speed_ > 0.0 ? kOfSize * size_ / speed_ : kForever;
    return std::min(fall, way);
  }

  /// A collision goes on through contacts of this instant: the one that closes fastest first, each by its own
  /// law, until none closes faster than what a step takes as plastic.
  void pass_on_impacts() {
    h_ = longest();
    list_contacts(of_.search_->limits().tolerance);
    for (std::size_t k = 0; k < kFirstImpacts + kImpactsEach * contacts_.size(); ++k) {
      const HeldContact* fastest = nullptr;
      double most = 0.0;
      for (const HeldContact& c : contacts_) {
        const double closing = closing_speed(c.pair, c.feature);
        if (closing <= most || closing <= most_absorbed(c.pair)) continue;
        most = closing;
        fastest = &c;
      }
      if (!fastest) break;
      collide(*fastest, most);
    }
    find_speeds();
  }

  /// True if the members can be taken to be at rest: what is left of their motion is gone within the contact
  /// tolerance, and their contacts hold them.
  bool rests() {
    const double tolerance = of_.search_->limits().tolerance;
    if (!(pull_ > 0.0) || 2.0 * speed_ * speed_ > tolerance * pull_) return false;
    for (const int k : members_)
      if (!of_.trajectories_->is_constant(k)) return false;
    h_ = longest();
    list_contacts(tolerance);
    for (const HeldContact& c : contacts_)
      if (c.pair.with_site() && of_.trajectories_->site(c.pair.other_site).moves()) return false;
    make_problem();
    if (!stays_at_rest(of_.solver_, problem_)) return false;
    take_forces();
    for (ExtendedState& s : states_) s.twist = ExtendedTwist();
    return true;
  }

  /// Takes a step of `h` at most, and less where that does not do. False: not even the shortest does.
  bool take(double h) {
    for (int halving = 0, widening = 0; halving <= kHalvings;) {
      h_ = h;
      list_contacts(-1.0);
      if (const double arrival = next_arrival(); arrival < h) {  // an impact ends the step
        h = h_ = arrival;
        list_contacts(-1.0);
      }
      make_problem();
      const StepOutcome outcome =
          take_step(of_.solver_, problem_, h, of_.search_->limits().tolerance,
                    [this](std::size_t k, double moment, const std::vector<Vec3>& velocity) {
                      return gap_along(k, moment, velocity);
                    });
      of_.tally_.factorisations += outcome.factorisations;
      if (outcome.solved && !stays_within_reach() && ++widening <= kWidenings) {
        reach_ *= kWider;
        continue;
      }
      if (!outcome.solved || !stays_within_reach()) {
        ++halving;
        h *= 0.5;
        continue;
      }
      of_.tally_.friction_residual = std::max(of_.tally_.friction_residual, outcome.friction_residual);
      of_.tally_.energy_won += outcome.won;
      of_.tally_.absorbed = std::max(of_.tally_.absorbed, absorbed_);
      take_forces();
      return true;
    }
    return false;
  }

  void warm(WarmForces forces) { warm_ = std::move(forces); }

  /// Members that push each other are islands; those that nothing pushes are let go, as they were. Bodies
  /// whose motion changed are appended to `changed`.
  void part(bool rests, std::vector<int>& changed) {
    DisjointSets joined;
    joined.reset(static_cast<int>(members_.size()));
    std::vector<bool> pushed(members_.size(), false);
    for (const HeldContact& c : contacts_) {
      if (!rests && !pushes(c) && !stays_near(c)) continue;
      const int a = place_.at(c.pair.body), b = c.pair.with_site() ? a : place_.at(c.pair.other_body);
      pushed[a] = pushed[b] = true;
      joined.unite(a, b);
    }
    for (const int k : members_)
      for (const int j : of_.trajectories_->coupled_to(k)) joined.unite(place_.at(k), place_.at(j));
    std::vector<Restart> held;
    std::vector<int> free;
    std::vector<bool> seen(members_.size(), false);
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (seen[i]) continue;
      std::vector<int> set(joined.of(static_cast<int>(i)).begin(), joined.of(static_cast<int>(i)).end());
      std::sort(set.begin(), set.end());
      const bool together = std::any_of(set.begin(), set.end(), [&](int j) { return pushed[j]; });
      for (const int j : set) {
        seen[j] = true;
        if (!together) free.push_back(members_[j]);
        if (together) held.push_back({members_[j], rests ? states_[j] : after(j)});
      }
      if (together) put_in(set, rests);
    }
    std::vector<Restart> as_they_are;
    for (const int k : free) as_they_are.push_back({k, states_[place_.at(k)]});
    of_.trajectories_->hold(held, changed);
    of_.trajectories_->hold(as_they_are, changed);
    of_.trajectories_->release(free, changed);
    if (!rests)
      for (const Restart& r : held)
        of_.trajectories_->note_step(r.body, {now_, now_ + h_, states_[place_.at(r.body)].twist.rounded()});
  }

 private:
  void find_speeds() {
    speeds_.clear();
    speed_ = 0.0;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const double radius = of_.search_->outline_of(members_[i]).bounding_radius;
      speeds_.push_back(speed_of(states_[i].twist.rounded(), radius));
      speed_ = std::max(speed_, speeds_.back());
    }
  }

  ImpulseSide side_of(int member, const RealVec& arm) const {
    const Body& b = of_.world_->bodies[members_[member]];
    return {states_[member].twist, arm, b.inverse_mass_x(), b.inverse_mass_y(), b.inverse_inertia()};
  }

  /// Contact point minus the body's centre of mass [m].
  RealVec arm_of(const HeldContact& c) const {
    return c.feature.point.cast<Real>() +
           (other_state(c.pair).position - states_[place_.at(c.pair.body)].position);
  }

  void collide(const HeldContact& c, double closing) {
    const int a = place_.at(c.pair.body), b = c.pair.with_site() ? -1 : place_.at(c.pair.other_body);
    const RealVec other_arm = c.feature.point.cast<Real>();
    const ImpulseSide other =
        b < 0 ? ImpulseSide{other_state(c.pair).twist, other_arm, 0.0, 0.0, 0.0} : side_of(b, other_arm);
    const ImpulseResult r = resolve_impulse(side_of(a, arm_of(c)), other, c.feature.normal.cast<Real>(),
                                            of_.response_->material_of(c.pair));
    states_[a].twist = r.body;
    if (b >= 0) states_[b].twist = r.other;
    of_.note_impact(c, other_state(c.pair).position, closing, r);
  }

  static constexpr double kForever = std::numeric_limits<double>::infinity();

  /// The state from which a member moves through the step.
  ExtendedState after(int member) const {
    ExtendedState s = states_[member];
    s.twist = ExtendedTwist(as_twist(problem_.velocity[member]));
    return s;
  }

  void put_in(const std::vector<int>& set, bool rests) {
    Island island;
    for (const int i : set) island.members.push_back(members_[i]);
    const auto has = [&](int body) { return std::binary_search(set.begin(), set.end(), place_.at(body)); };
    for (const HeldContact& c : contacts_)
      if (has(c.pair.body) && (c.pair.with_site() || has(c.pair.other_body))) island.contacts.push_back(c);
    island.rests = rests;
    island.due = rests ? next_break(set) : now_ + h_;
    of_.put_in(std::move(island));
  }

  /// When forces on those members next jump [s].
  double next_break(const std::vector<int>& set) const {
    double next = kForever;
    for (const int i : set) next = std::min(next, of_.trajectories_->next_break(members_[i]));
    return next;
  }

  /// A force that is more than a rounding of the heaviest member's weight.
  bool pushes(const HeldContact& c) const { return c.normal_force > kNoForce * heaviest_ * pull_; }

  /// Nothing pushes, but one of the two alone, left to its parabola, could run into the other's step.
  bool stays_near(const HeldContact& c) const {
    return !c.pair.with_site() && c.feature.gap <= pull_ * h_ * h_ &&
           closing_speed(c.pair, c.feature) >= -pull_ * h_;
  }

  double reach_of(int member) const {
    return reach_ * h_ * (speeds_[member] + pulls_[member] * h_ + pull_ * h_ + 0.01 * speed_);
  }

  ExtendedState other_state(const PairKey& pair) const {
    if (pair.with_site()) return of_.search_->other_state(pair, now_);
    return states_[place_.at(pair.other_body)].shifted(of_.search_->shift_of(pair));
  }

  Box box_of(int owner, double reach) const {
    const Outline& outline = of_.search_->outline_of(owner);
    const Pose pose = of_.trajectories_->motion_of(owner).pose(now_);
    Box box;
    if (outline.is_point() || owner < static_cast<int>(of_.world_->bodies.size())) {
      box.add(pose.position);
      return box.grown(outline.bounding_radius + reach);
    }
    const Frame frame(pose);
    for (const Vec2& corner :
         {outline.bounds.low, outline.bounds.high, Vec2(outline.bounds.low.x(), outline.bounds.high.y()),
          Vec2(outline.bounds.high.x(), outline.bounds.low.y())})
      box.add(frame.to_world(corner));
    return box.grown(reach);
  }

  /// Every near pair of the members, among each other and with sites; `reach` < 0: as far as a step may lead.
  void list_contacts(double reach) {
    contacts_.clear();
    absorbed_ = 0.0;
    const int bodies = of_.trajectories_->body_count();
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < members_.size(); ++i)
      boxes.push_back(box_of(members_[i], reach < 0.0 ? reach_of(static_cast<int>(i)) : reach));
    std::vector<int> by_left(members_.size());
    std::iota(by_left.begin(), by_left.end(), 0);
    std::sort(by_left.begin(), by_left.end(),
              [&](int a, int b) { return std::pair(boxes[a].low.x(), a) < std::pair(boxes[b].low.x(), b); });
    const bool repeats = of_.world_->periods.any();
    for (std::size_t x = 0; x < by_left.size(); ++x)
      for (std::size_t y = x + 1; y < by_left.size(); ++y) {
        const int a = by_left[x], b = by_left[y];
        if (!repeats && boxes[b].low.x() > boxes[a].high.x()) break;
        add_images(members_[std::min(a, b)], boxes[std::min(a, b)], members_[std::max(a, b)],
                   boxes[std::max(a, b)], reach);
      }
    for (int s = 0; s < of_.trajectories_->site_count(); ++s) {
      const Box box = box_of(bodies + s, site_way(s));
      for (std::size_t i = 0; i < members_.size(); ++i)
        add_images(members_[i], boxes[i], bodies + s, box, reach);
    }
    std::sort(contacts_.begin(), contacts_.end(),
              [](const HeldContact& a, const HeldContact& b) { return a.order() < b.order(); });
  }

  void add_images(int a, const Box& box_a, int b, const Box& box_b, double reach) {
    if (of_.search_->outline_of(b).container) return add_pair(a, b, Image{}, reach);
    of_.world_->periods.overlaps(box_a, box_b, [&](const Image& image) { add_pair(a, b, image, reach); });
  }

  /// How far a site can come in a step [m].
  double site_way(int s) const {
    if (!of_.trajectories_->site(s).moves()) return 0.0;
    return kReach * h_ * site_speed(s);
  }
  double site_speed(int s) const {
    const Twist v = of_.trajectories_->site(s).motion().twist(now_);
    return speed_of(v, of_.search_->outline_of(of_.trajectories_->body_count() + s).bounding_radius);
  }

  void add_pair(int a, int b, const Image& image, double reach) {
    const auto pair = of_.search_->pair_of(a, b, image);
    if (!pair) return;
    const int i = place_.at(pair->body);
    double far = reach;
    if (reach < 0.0)
      far = of_.search_->limits().tolerance + reach_of(i) +
            (pair->with_site() ? site_way(pair->other_site) : reach_of(place_.at(pair->other_body)));
    const ExtendedState other = other_state(*pair);
    const Outline &outline = of_.search_->outline_of(pair->body),
                  &other_outline = of_.search_->outline_of(of_.search_->other_owner(*pair));
    const std::vector<NearFeature> features = near_features(outline, states_[i], other_outline, other, far);
    if (features.empty()) return;
    for (const NearFeature& f : features) contacts_.push_back({*pair, f, 0.0, 0.0, 0.0});
  }

  double closing_speed(const PairKey& pair, const NearFeature& f) const {
    const ExtendedState& a = states_[place_.at(pair.body)];
    const ExtendedState b = other_state(pair);
    const RealVec arm = f.point.cast<Real>() + (b.position - a.position);
    return static_cast<double>(f.normal.cast<Real>().dot(b.twist.at(f.point.cast<Real>()) - a.twist.at(arm)));
  }

  /// When the first feature comes that closes too fast to be taken as plastic, seen along its tangent [s];
  /// infinity: none. What touches has been dealt with.
  double next_arrival() {
    double first = kForever;
    absorbed_ = 0.0;
    for (const HeldContact& c : contacts_) {
      const double closing = closing_speed(c.pair, c.feature), gap = c.feature.gap - kept(c.feature);
      if (gap > closing * h_) continue;
      if (closing > most_absorbed(c.pair) && gap > of_.search_->limits().tolerance)
        first = std::min(first, gap / closing);
      else
        absorbed_ = std::max(absorbed_, closing);
    }
    return first;
  }

  /// An approach as slow as this would be back within the step [m/s].
  double most_absorbed(const PairKey& pair) const {
    const double e = of_.response_->material_of(pair).restitution;
    return e > 0.0 ? pull_ * h_ / e : kForever;
  }

  void make_problem() {
    problem_ = {};
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const Body& b = of_.world_->bodies[members_[i]];
      problem_.mass.emplace_back(b.lock_x ? kForever : b.mass, b.lock_y ? kForever : b.mass,
                                 b.lock_angle ? kForever : b.inertia);
      problem_.velocity.push_back(as_vector(states_[i].twist.rounded()));
      const Acceleration& a = accelerations_[i];
      problem_.force.emplace_back(b.mass * a.linear.x(), b.mass * a.linear.y(), b.inertia * a.angular);
    }
    for (const HeldContact& c : contacts_) problem_.contacts.push_back(island_contact(c));
  }

  IslandContact island_contact(const HeldContact& c) const {
    IslandContact made;
    const ExtendedState other = other_state(c.pair);
    const int a = place_.at(c.pair.body);
    const Vec2 arm = (c.feature.point.cast<Real>() + (other.position - states_[a].position)).cast<double>();
    const int b = c.pair.with_site() ? -1 : place_.at(c.pair.other_body);
    made.rows = contact_at(a, b, c.feature.normal, arm, c.feature.point);
    made.gap = c.feature.gap - kept(c.feature);
    made.friction = of_.response_->material_of(c.pair).friction;
    const auto warm = warm_.find({c.pair, c.feature.sample_on_a, c.feature.sample, c.feature.site});
    if (warm != warm_.end()) std::tie(made.normal_force, made.force_lasted) = warm->second;
    if (c.pair.with_site() && of_.trajectories_->site(c.pair.other_site).moves()) {
      const Vec2 v = of_.trajectories_->site(c.pair.other_site).motion().twist(now_).at(c.feature.point);
      made.normal_support = v.dot(c.feature.normal);
      made.tangential_support = v.dot(perp(c.feature.normal));
    }
    return made;
  }

  /// What is left between a sharp sample and a wire without thickness, that its side may be told [m].
  double kept(const NearFeature& f) const { return f.thin ? of_.search_->limits().touch : 0.0; }

  ExtendedState moved(int member, double moment, const std::vector<Vec3>& velocity) const {
    ExtendedState s = states_[member];
    s.twist = ExtendedTwist(as_twist(velocity[member]));
    return s.moved(moment);
  }

  double gap_along(std::size_t k, double moment, const std::vector<Vec3>& velocity) const {
    const HeldContact& c = contacts_[k];
    const Outline &a = of_.search_->outline_of(c.pair.body),
                  &b = of_.search_->outline_of(of_.search_->other_owner(c.pair));
    ExtendedState other = other_state(c.pair);
    if (!c.pair.with_site())
      other = moved(place_.at(c.pair.other_body), moment, velocity).shifted(of_.search_->shift_of(c.pair));
    else if (of_.trajectories_->site(c.pair.other_site).moves())
      other = other.moved(moment);
    return gap_of(c.feature, a, moved(place_.at(c.pair.body), moment, velocity), b, other) - kept(c.feature);
  }

  /// True if nobody moves farther than features were listed for.
  bool stays_within_reach() const {
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const double radius = of_.search_->outline_of(members_[i]).bounding_radius;
      if (h_ * speed_of(as_twist(problem_.velocity[i]), radius) > reach_of(static_cast<int>(i))) return false;
    }
    return true;
  }

  void take_forces() {
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      contacts_[k].normal_force = problem_.contacts[k].normal_force;
      contacts_[k].tangential_force = problem_.contacts[k].tangential_force;
      contacts_[k].lasted = h_;
    }
  }

  Islands& of_;
  double now_;
  double h_ = 0.0, reach_ = kReach;
  std::vector<int> members_;
  std::map<int, int> place_;  ///< of each member
  std::vector<ExtendedState> states_;
  std::vector<Acceleration> accelerations_;
  std::vector<double> speeds_, pulls_;  ///< [m/s], [m/s^2], of any point of each
  double size_ = kForever, speed_ = 0.0, pull_ = 0.0, heaviest_ = 0.0, absorbed_ = 0.0;
  WarmForces warm_;  ///< normal forces of the step before
  std::vector<HeldContact> contacts_;
  IslandStep problem_;
};

Islands::Islands(const World& world, Trajectories& trajectories, ContactSearch& search,
                 CollisionResponse& response, Records& records, RunControl& run)
    : world_(&world),
      trajectories_(&trajectories),
      search_(&search),
      response_(&response),
      records_(&records),
      run_(&run) {}

void Islands::gather(int body, std::set<int>& members) const {
  if (members.count(body)) return;
  const auto lead = lead_of_.find(body);
  const std::vector<int> with =
      lead != lead_of_.end() ? islands_.at(lead->second).members : std::vector{body};
  members.insert(with.begin(), with.end());
  for (const int k : with)
    for (const int j : trajectories_->coupled_to(k)) gather(j, members);
}

WarmForces Islands::take_out(const std::set<int>& members) {
  WarmForces forces;
  for (const int k : members) {
    const auto found = islands_.find(k);
    if (found == islands_.end()) continue;
    if (found->second.rests) note_change(EventKind::wake, k), ++tally_.woken;
    for (const HeldContact& c : found->second.contacts) {
      search_->search_again(c.pair);
      forces[{c.pair, c.feature.sample_on_a, c.feature.sample, c.feature.site}] = {c.normal_force, c.lasted};
    }
    for (const int j : found->second.members) lead_of_.erase(j);
    islands_.erase(found);
  }
  return forces;
}

void Islands::put_in(Island island) {
  for (const HeldContact& c : island.contacts) search_->leave_out(c.pair);
  const int lead = island.members.front();
  for (const int k : island.members) lead_of_[k] = lead;
  islands_[lead] = std::move(island);
}

void Islands::find_next() {
  next_step_ = std::numeric_limits<double>::infinity();
  for (const auto& [lead, island] : islands_) next_step_ = std::min(next_step_, island.due);
}

/// An island, by its least member, comes to rest or is woken.
void Islands::note_change(EventKind kind, int lead) {
  FeatureContact none;
  none.time = run_->time();
  none.point = trajectories_->body(lead).motion.pose(run_->time()).position;
  records_->ending(kind, {lead, -1, -1, {}}, none, std::max(run_->time(), records_->last_event()));
}

/// An impact inside an island is a collision like any other.
void Islands::note_impact(const HeldContact& c, const RealVec& from, double closing, const ImpulseResult& r) {
  WorkCounters& work = run_->work();
  ++work.collisions;
  ++(c.pair.with_site() ? work.collisions_body_site : work.collisions_body_body);
  FeatureContact f;
  f.time = run_->time();
  f.sample_on_a = c.feature.sample_on_a;
  f.sample = c.feature.sample;
  f.site = c.feature.site;
  f.point = (from + c.feature.point.cast<Real>()).cast<double>();
  f.normal = c.feature.normal;
  f.closing_speed = closing;
  f.gap = c.feature.gap;
  records_->event(EventKind::collision, c.pair, f, r.normal, r.tangential, 0);
}

bool Islands::begin_step(const std::set<int>& members, double longest, std::vector<int>& changed) {
  auto forces = take_out(members);
  std::vector<Restart> as_they_are;
  for (const int k : members)
    if (!trajectories_->is_held(k))
      as_they_are.push_back({k, trajectories_->body(k).motion.extended_state(run_->time())});
  std::vector<int> held;
  trajectories_->hold(as_they_are, held);
  Step step(*this, members);
  step.warm(std::move(forces));
  step.pass_on_impacts();
  const bool rests = step.rests();
  if (!rests && !step.take(std::min(longest, step.longest()))) {
    run_->stop(
        Termination::failed,
        fmt::format("an island of {} bodies, '{}' the first, finds no step at t = {:.17g} that keeps its "
                    "contacts",
                    members.size(), world_->bodies[*members.begin()].name, run_->time()));
    trajectories_->release(std::vector<int>(members.begin(), members.end()), changed);
    find_next();
    return false;
  }
  ++tally_.steps;
  if (rests) note_change(EventKind::sleep, *members.begin()), ++tally_.slept;
  step.part(rests, changed);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  find_next();
  return run_->poll();
}

bool Islands::capture(const PairKey& pair, const FeatureContact& contact, double limit,
                      std::vector<int>& changed) {
  std::set<int> members;
  gather(pair.body, members);
  if (!pair.with_site()) gather(pair.other_body, members);
  ++tally_.captured;
  const double left = limit - run_->time();
  const bool later = left > same_instant(limit);
  if (!later) records_->ending(EventKind::zeno, pair, contact, records_->last_event());
  if (!begin_step(members, later ? left : std::numeric_limits<double>::infinity(), changed)) return false;
  const auto lead = lead_of_.find(pair.body);
  if (!later || lead == lead_of_.end()) return true;
  Island& island = islands_.at(lead->second);
  if (!island.rests && std::abs(island.due - limit) > same_instant(limit)) return true;
  if (island.due <= limit && island.rests) return true;
  island.then = island.due;
  island.due = limit;
  island.series = pair;
  island.series_contact = contact;
  find_next();
  return true;
}

int Islands::next_island() const {
  return std::find_if(islands_.begin(), islands_.end(),
                      [&](const auto& i) { return i.second.due == next_step_; })
      ->first;
}

bool Islands::step(std::vector<int>& changed) {
  Island& island = islands_.at(next_island());
  if (island.series.body >= 0)
    records_->ending(EventKind::zeno, island.series, island.series_contact,
                     std::max(island.due, records_->last_event()));
  if (std::exchange(island.series.body, -1) >= 0 && island.rests) {  // it has come to rest before
    island.due = island.then;
    find_next();
    return run_->poll();
  }
  const std::vector<int> members = island.members;
  return begin_step({members.begin(), members.end()}, std::numeric_limits<double>::infinity(), changed);
}

bool Islands::collided(const PairKey& pair, std::vector<int>& changed) {
  std::set<int> members;
  gather(pair.body, members);
  if (!pair.with_site()) gather(pair.other_body, members);
  return begin_step(members, std::numeric_limits<double>::infinity(), changed);
}

bool Islands::disturbed(int body, std::vector<int>& changed) {
  std::set<int> members;
  gather(body, members);
  return begin_step(members, std::numeric_limits<double>::infinity(), changed);
}

Islands::Saved Islands::saved() const {
  Saved all{{}, tally_};
  for (const auto& [lead, island] : islands_) all.islands.push_back(island);
  return all;
}

void Islands::restore(const Saved& saved) {
  for (const auto& [lead, island] : islands_)
    for (const HeldContact& c : island.contacts) search_->search_again(c.pair);
  islands_.clear();
  lead_of_.clear();
  for (const Island& island : saved.islands) put_in(island);
  tally_ = saved.tally;
  find_next();
}

}  // namespace brink
