#include "brink/scheduler/kernel/island_members.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "brink/scheduler/islands/modes/smooth_contact.h"

namespace brink {

IslandMembers::IslandMembers(const World& world, const Trajectories& trajectories,
                             const ContactSearch& search, double now, const std::set<int>& members,
                             const std::set<int>& supports)
    : world_(&world),
      trajectories_(&trajectories),
      search_(&search),
      now_(now),
      count_(members.size()),
      bodies_(members.begin(), members.end()) {
  bodies_.insert(bodies_.end(), supports.begin(), supports.end());
  if (const auto [least, last] = std::minmax_element(bodies_.begin(), bodies_.end());
      least != bodies_.end()) {
    first_ = *least;
    places_.assign(*last - *least + 1, -1);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const int k = bodies_[i];
    places_[k - first_] = static_cast<int>(i);
    states_.push_back(trajectories.state_now(k));
    if (i >= count_) continue;
    accelerations_.push_back(trajectories.acceleration(k));
    const bool constant = trajectories.is_constant(k);
    constant_ = constant_ && constant;
    joined_ = joined_ || (!constant && trajectories.coupled_to(k).size() > 1);
    const double radius = search.outline_of(k).bounding_radius;
    // a mere point has no size: the scene's
    size_ = std::min(size_, radius > 0.0 ? 2.0 * radius : world.length());
    // as speeds are bounded: |a| + |alpha| r
    pulls_.push_back(accelerations_.back().linear.norm() + std::abs(accelerations_.back().angular) * radius);
    pull_ = std::max(pull_, pulls_.back());
    heaviest_ = std::max(heaviest_, world.bodies[k].mass);
  }
  farther_.assign(count(), 0.0);
  find_speeds();
}

/// Also after impacts of this instant, which change twists.
void IslandMembers::find_speeds() {
  speeds_.clear();
  speed_ = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    speeds_.push_back(speed_within(states_[i].twist.rounded(), bounding_radius(static_cast<int>(i))));
    speed_ = std::max(speed_, speeds_.back());
  }
}

IslandMembers::Halfway IslandMembers::accelerations_halfway(double h,
                                                            const std::vector<Vec3>& velocity) const {
  std::vector<BodyState> start, halfway;
  for (int i = 0; i < static_cast<int>(count()); ++i) {
    start.push_back(state(i).rounded());
    halfway.push_back(moved(i, 0.5 * h, velocity).rounded());
    halfway.back().twist = as_twist(velocity[i]);
  }
  Halfway made{std::vector<Acceleration>(count()), std::vector<Acceleration>(count())};
  trajectories_->accelerations(bodies_, now_ + 0.5 * h, halfway, made.there);
  made.along = made.there;
  if (joined_) trajectories_->accelerations_along(bodies_, now_ + 0.5 * h, start, halfway, made.along);
  return made;
}

double IslandMembers::guess_of(int member) const {
  // Its speed with what forces on it make of that in the step, the largest pull of anybody, which contacts
  // may hand on, and a hundredth of the fastest member's speed. Steps are checked against it.
  return reach_ * h_ * (speeds_[member] + pulls_[member] * h_ + pull_ * h_ + 0.01 * speed_);
}

// ---- who is near

/// Members and supports are swept along x by the left edges of their boxes; sites are held against every member.
std::vector<PairKey> IslandMembers::near_pairs(double reach, const GoOn& go_on) const {
  std::vector<PairKey> to;
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    boxes.push_back(box_of(bodies_[i], reach < 0.0 ? reach_of(static_cast<int>(i)) : reach));
  std::vector<int> by_left(bodies_.size());
  std::iota(by_left.begin(), by_left.end(), 0);
  std::sort(by_left.begin(), by_left.end(),
            [&](int a, int b) { return std::pair(boxes[a].low.x(), a) < std::pair(boxes[b].low.x(), b); });
  const bool repeats = world_->periods.any();
  const auto stops = [&] { return go_on && !go_on(); };
  for (std::size_t x = 0; x < by_left.size() && !stops(); ++x)
    for (std::size_t y = x + 1; y < by_left.size(); ++y) {
      const auto [a, b] = std::minmax(by_left[x], by_left[y]);
      // sorted along x: none that follows begins before this one's right edge, either. Images may.
      if (!repeats && boxes[by_left[y]].low.x() > boxes[by_left[x]].high.x()) break;
      if (is_support(a)) continue;  // and so is b
      add_images(to, bodies_[a], boxes[a], bodies_[b], boxes[b]);
    }
  // a site that moves may come towards members, so its box is grown by its own way
  for (int s = 0; s < trajectories_->site_count(); ++s) {
    const int owner = trajectories_->body_count() + s;
    const Box box = box_of(owner, site_way(s));
    for (std::size_t i = 0; i < count_ && !stops(); ++i) add_images(to, bodies_[i], boxes[i], owner, box);
  }
  return to;
}

std::vector<HeldContact> IslandMembers::contacts(double reach, const GoOn& go_on) const {
  return features(near_pairs(reach, go_on), reach, go_on);
}

double IslandMembers::even_for(double h) const {
  bool any = false;
  for (int s = 0; s < trajectories_->site_count(); ++s) any = any || trajectories_->site(s).is_prescribed();
  if (!any) return h;
  double until = now_ + h;
  for (const PairKey& pair : near_pairs(-1.0))
    if (pair.with_site()) until = trajectories_->site(pair.other_site).even_until(now_, until);
  return until < now_ + h ? until - now_ : h;
}

std::vector<HeldContact> IslandMembers::contacts_of(const std::vector<char>& whose, const GoOn& go_on) const {
  std::vector<PairKey> pairs = near_pairs(-1.0, go_on);
  const auto others = [&](const PairKey& pair) {
    const auto [a, b] = members_of(pair);
    return whose[a] == 0 && whose[b] == 0;
  };
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), others), pairs.end());
  return features(pairs, -1.0, go_on);
}

/// Features of a pair's images alone.
std::vector<HeldContact> IslandMembers::features(const std::vector<PairKey>& pairs, double reach,
                                                 const GoOn& go_on) const {
  std::vector<HeldContact> all;
  for (const PairKey& pair : pairs) {
    if (go_on && !go_on()) break;
    const Outline &outline = search_->outline_of(pair.body),
                  &other = search_->outline_of(search_->other_owner(pair));
    for (const NearFeature& f : near_features(outline, states_[place_of(pair.body)], other, other_state(pair),
                                              reach_of(pair, reach), search_->limits().tolerance))
      all.push_back({pair, f, 0.0, 0.0, 0.0});
  }
  // in an order of their own, whatever the boxes: the solver's rounding depends on it
  std::sort(all.begin(), all.end(), in_order);
  return all;
}

std::vector<NearFeature> IslandMembers::features_ahead(const PairKey& pair, double later,
                                                       const std::vector<Vec3>& velocity) const {
  return near_features(search_->outline_of(pair.body), moved(place_of(pair.body), later, velocity),
                       search_->outline_of(search_->other_owner(pair)), other_state(pair, later, velocity),
                       reach_of(pair, -1.0), search_->limits().tolerance);
}

std::vector<HeldContact> IslandMembers::contacts_and_brought(const GoOn& go_on) const {
  const std::vector<PairKey> pairs = near_pairs(-1.0, go_on);
  std::vector<HeldContact> all = features(pairs, -1.0, go_on);
  std::set<ContactKey> listed;
  for (const HeldContact& c : all)
    if (on_moving_site(c)) listed.insert(c.key());
  const std::size_t before = all.size();
  const std::vector<Vec3> stays(count(), Vec3::Zero());
  for (const PairKey& pair : pairs) {
    if (!pair.with_site() || !trajectories_->site(pair.other_site).moves()) continue;
    const RealVec way = other_state(pair, h_, {}).position - other_state(pair).position;
    for (const NearFeature& f : features_ahead(pair, h_, stays)) {
      HeldContact c{pair, f, 0.0, 0.0, 0.0};
      if (listed.count(c.key())) continue;
      c.feature.gap = gap(c, 0.0, stays);
      c.feature.point += way.cast<double>();
      c.feature.at_end = true;
      // what touches now is told by what is listed
      if (c.feature.gap > search_->limits().tolerance) all.push_back(c);
    }
  }
  if (all.size() > before) std::sort(all.begin(), all.end(), in_order);
  return all;
}

/// Up to which gap the pair's features are listed [m].
double IslandMembers::reach_of(const PairKey& pair, double reach) const {
  if (reach >= 0.0) return reach;
  // both may come that far towards each other, and a gap of the tolerance is a contact still
  return search_->limits().tolerance + reach_of(place_of(pair.body)) +
         (pair.with_site() ? site_way(pair.other_site) : reach_of(place_of(pair.other_body)));
}

/// Where an owner may be within `reach` [m] of where it is now.
Box IslandMembers::box_of(int owner, double reach) const {
  const Outline& outline = search_->outline_of(owner);
  const Pose pose = trajectories_->motion_of(owner).pose(now_);
  Box box;
  // a body's bounding disc holds it at any angle; a site may lie far from its frame's origin, so its own
  // box is turned
  if (outline.is_point() || owner < trajectories_->body_count()) {
    box.add(pose.position);
    return box.grown(outline.bounding_radius + reach);
  }
  const Frame frame(pose);
  const Box& own = outline.bounds;
  for (const Vec2& corner :
       {own.low, own.high, Vec2(own.low.x(), own.high.y()), Vec2(own.high.x(), own.low.y())})
    box.add(frame.to_world(corner));
  return box.grown(reach);
}

/// How far a site can come in a step [m].
double IslandMembers::site_way(int s) const {
  const SiteMotion& site = trajectories_->site(s);
  if (!site.moves() || !(h_ > 0.0)) return 0.0;
  const MotionBounds over = site.motion().bounds(now_, now_ + h_);
  return h_ *
         (over.speed() + over.spin() * search_->outline_of(trajectories_->body_count() + s).bounding_radius);
}

/// Of b every image whose box meets that of a, but for those that never meet (ContactSearch::pair_of).
void IslandMembers::add_images(std::vector<PairKey>& to, int a, const Box& box_a, int b,
                               const Box& box_b) const {
  const auto add = [&](const Image& image) {
    if (const auto pair = search_->pair_of(a, b, image)) to.push_back(*pair);
  };
  // solid everywhere beyond its loops: a box does not tell
  if (search_->outline_of(b).container) return add(Image{});
  world_->periods.overlaps(box_a, box_b, add);
}

std::vector<int> IslandMembers::coupled_to(int member) const {
  std::vector<int> places;
  for (const int k : trajectories_->coupled_to(bodies_[member])) places.push_back(place_of(k));
  return places;
}

// ---- where things are

/// A step's motion: constant twists. The member's own forces are in `velocity` already.
ExtendedState IslandMembers::moved(int member, double later, const std::vector<Vec3>& velocity) const {
  ExtendedState s = states_[member];
  if (is_support(member)) return s;
  s.twist = ExtendedTwist(as_twist(velocity[member]));
  return s.moved(later);
}

ExtendedState IslandMembers::other_state(const PairKey& pair) const {
  if (pair.with_site()) return search_->other_state(pair, now_);
  return states_[place_of(pair.other_body)].shifted(search_->shift_of(pair));
}

ExtendedState IslandMembers::other_state(const PairKey& pair, double later,
                                         const std::vector<Vec3>& velocity) const {
  if (pair.with_site()) return search_->other_state(pair, now_ + later);
  return moved(place_of(pair.other_body), later, velocity).shifted(search_->shift_of(pair));
}

OutlineAt IslandMembers::placed(int member, double later, const std::vector<Vec3>& velocity) const {
  return {search_->outline_of(bodies_[member]), moved(member, later, velocity)};
}

OutlineAt IslandMembers::placed_site(int site, double later) const {
  const int owner = trajectories_->body_count() + site;
  return {search_->outline_of(owner), trajectories_->motion_of(owner).extended_state(now_ + later)};
}

/// Of the same two features, wherever they are by then: another one may have come nearer.
double IslandMembers::gap(const HeldContact& c, double later, const std::vector<Vec3>& velocity) const {
  const Outline &a = search_->outline_of(c.pair.body), &b = search_->outline_of(search_->other_owner(c.pair));
  return gap_of(c.feature, a, moved(place_of(c.pair.body), later, velocity), b,
                other_state(c.pair, later, velocity));
}

RealVec IslandMembers::arm(const HeldContact& c) const {
  // the feature's point is seen from the other's position (near_features.h)
  return c.feature.point.cast<Real>() +
         (other_state(c.pair).position - states_[place_of(c.pair.body)].position);
}

double IslandMembers::closing_speed(const HeldContact& c) const {
  return closing_speed(c, states_[place_of(c.pair.body)].twist, other_state(c.pair).twist);
}

double IslandMembers::closing_speed(const HeldContact& c, const ExtendedTwist& of_body,
                                    const ExtendedTwist& of_other) const {
  // the normal points into the body: > 0 where the other comes along it
  const RealVec relative = of_other.at(c.feature.point.cast<Real>()) - of_body.at(arm(c));
  return static_cast<double>(c.feature.normal.cast<Real>().dot(relative));
}

double IslandMembers::fall(const HeldContact& c) const {
  const int body = place_of(c.pair.body);
  const ExtendedState other = other_state(c.pair);
  const std::vector<SmoothContact> shapes =
      smooth_contacts(c.feature, search_->outline_of(c.pair.body), states_[body],
                      search_->outline_of(search_->other_owner(c.pair)), other);
  if (shapes.empty()) return 0.0;
  const Vec3 of_body = free_acceleration(body),
             of_other = c.pair.with_site()
                            ? as_vector(trajectories_->site(c.pair.other_site).motion().rate(now_))
                            : free_acceleration(place_of(c.pair.other_body));
  const BodyState a = states_[body].rounded(), b = other.rounded();
  const bool on_a = c.feature.sample_on_a;
  const ContactRates r = rates_of(shapes.front(), on_a ? a : b, on_a ? b : a);
  return -(r.normal_bend + r.normal_on_sample.dot(on_a ? of_body : of_other) +
           r.normal_on_site.dot(on_a ? of_other : of_body));
}

/// x, y, angle. A locked coordinate has none, whatever forces pull at it; nor has who stands.
Vec3 IslandMembers::free_acceleration(int member) const {
  if (is_support(member)) return Vec3::Zero();
  const Body& b = body(member);
  const Acceleration& by = accelerations_[member];
  return {b.inverse_mass_x() > 0.0 ? by.linear.x() : 0.0, b.inverse_mass_y() > 0.0 ? by.linear.y() : 0.0,
          b.inverse_inertia() > 0.0 ? by.angular : 0.0};
}

}  // namespace brink
