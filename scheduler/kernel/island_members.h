#pragma once
/// Bodies of one island at one instant, and everything that is near them.

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "brink/core/base/go_on.h"
#include "brink/core/base/limits.h"
#include "brink/core/contacts/cone_qp.h"
#include "brink/scheduler/kernel/contact_search.h"
#include "brink/scheduler/kernel/island.h"
#include "brink/scheduler/kernel/trajectories.h"

namespace brink {

/// The most that any point within `radius` [m] of the centre of mass has [m/s].
inline double speed_within(const Twist& v, double radius) {
  return v.velocity.norm() + std::abs(v.omega) * radius;
}

/// A twist as a column: x, y [m/s], angle [rad/s].
inline Vec3 as_vector(const Twist& v) { return {v.velocity.x(), v.velocity.y(), v.omega}; }
inline Vec3 as_vector(const Acceleration& a) { return {a.linear.x(), a.linear.y(), a.angular}; }
inline Twist as_twist(const Vec3& v) { return {{v.x(), v.y()}, v.z()}; }

/// The members' states now and what pulls at them. Members are named by their place in bodies(). Supports are bodies at rest that
/// members may lean on in a step: they are met as sites are that do not move, and have the places behind the members.
class IslandMembers {
 public:
  /// What is given must outlive it. @pre all are held (Trajectories::hold).
  IslandMembers(const World& world, const Trajectories& trajectories, const ContactSearch& search, double now,
                const std::set<int>& members, const std::set<int>& supports = {});

  std::size_t count() const { return count_; }                ///< of members
  const std::vector<int>& bodies() const { return bodies_; }  ///< members ascending, then supports
  bool is_support(int place) const { return place >= static_cast<int>(count_); }
  /// Places of the members that the pair has; with a site or a support one of them twice.
  std::pair<int, int> members_of(const PairKey& pair) const {
    const int a = place_of(pair.body), b = pair.with_site() ? a : place_of(pair.other_body);
    return {is_support(a) ? b : a, is_support(b) ? a : b};
  }
  const Body& body(int member) const { return world_->bodies[bodies_[member]]; }
  /// @pre it is one of them
  int place_of(int body) const { return places_[body - first_]; }
  bool has(int body) const {
    const int last = first_ + static_cast<int>(places_.size());
    return body >= first_ && body < last && place_of(body) >= 0;
  }
  const ExtendedState& state(int member) const { return states_[member]; }
  const Acceleration& acceleration(int member) const { return accelerations_[member]; }
  const std::vector<Acceleration>& accelerations() const { return accelerations_; }
  /// Of each member now: x, y [m/s], angle [rad/s].
  std::vector<Vec3> velocities() const {
    std::vector<Vec3> all;
    for (const ExtendedState& s : states_) all.push_back(as_vector(s.twist.rounded()));
    all.resize(count_);
    return all;
  }
  /// Where members have these: what stands has none.
  Vec3 velocity_of(int place, const std::vector<Vec3>& velocity) const {
    return is_support(place) ? Vec3(Vec3::Zero()) : velocity[place];
  }
  /// Gives a member another twist; find_speeds() is due then.
  void set_twist(int member, const ExtendedTwist& twist) { states_[member].twist = twist; }
  void find_speeds();

  double size() const { return size_; }    ///< of the smallest [m]
  double speed() const { return speed_; }  ///< of the fastest point [m/s]
  double speed_of(int member) const { return speeds_[member]; }
  double pull() const { return pull_; }          ///< the largest acceleration of a point by forces [m/s^2]
  double heaviest() const { return heaviest_; }  ///< [kg]
  double bounding_radius(int member) const { return search_->outline_of(bodies_[member]).bounding_radius; }
  /// Steps of h [s] are looked ahead from now on: bodies come as far as they may in `reach` of them.
  void look_ahead(double h, double reach) {
    h_ = h, reach_ = reach;
    farther_.assign(count(), 0.0);
  }
  /// Until then this one may come so far [m].
  void look_farther(int member, double way) { farther_[member] = std::max(farther_[member], way); }
  /// How far a member may come in a step [m]: a guess, and no less than look_farther() was told.
  double reach_of(int member) const {
    return is_support(member) ? 0.0 : std::max(guess_of(member), farther_[member]);
  }
  double guess_of(int member) const;
  /// Where it may come in a step.
  Box box(int member) const { return box_of(bodies_[member], reach_of(member)); }

  /// Every near feature of the members, among each other and with sites, in order. Features are listed up to
  /// a gap of `reach` [m]; < 0: as far as a step may lead. Not all where GoOn says no. Cost: members sorted along x,
  /// times sites.
  std::vector<HeldContact> contacts(double reach, const GoOn& go_on = {}) const;
  /// As far as a step may lead, of those in which one takes part of whom `whose` is not 0.
  std::vector<HeldContact> contacts_of(const std::vector<char>& whose, const GoOn& go_on = {}) const;
  /// Those of one pair where its site has come to `later` [s] into the step, and its body with `velocity` (as of other_state);
  /// points are seen from there.
  std::vector<NearFeature> features_ahead(const PairKey& pair, double later,
                                          const std::vector<Vec3>& velocity) const;
  /// As far as a step may lead, and with them what sites bring within the look-ahead: as such a contact is now, at the end of its
  /// site.
  std::vector<HeldContact> contacts_and_brought(const GoOn& go_on = {}) const;
  /// Pairs of members, and with sites, that may come nearer to each other than that: all of which features are listed.
  std::vector<PairKey> near_pairs(double reach, const GoOn& go_on = {}) const;

  /// The state of the pair's other owner, where its image is; a time `later` [s] into the step, where members
  /// move with `velocity` (x, y [m/s], angle [rad/s]), and sites as they do. @pre sites are covered as far.
  ExtendedState other_state(const PairKey& pair) const;
  ExtendedState other_state(const PairKey& pair, double later, const std::vector<Vec3>& velocity) const;
  ExtendedState moved(int member, double later, const std::vector<Vec3>& velocity) const;
  /// The same with its outline, of a member or a site itself, whichever image of it is met.
  OutlineAt placed(int member, double later, const std::vector<Vec3>& velocity) const;
  OutlineAt placed_site(int site, double later) const;
  Vec2 shift_of(const PairKey& pair) const { return search_->shift_of(pair); }
  /// The gap of the contact's features then [m].
  double gap(const HeldContact& contact, double later, const std::vector<Vec3>& velocity) const;
  double now() const { return now_; }
  /// How fast the two features approach now [m/s].
  double closing_speed(const HeldContact& contact) const;
  /// The same if they had these twists.
  double closing_speed(const HeldContact& contact, const ExtendedTwist& of_body,
                       const ExtendedTwist& of_other) const;
  /// The acceleration with which the gap of the two closes where no contact pushes [m/s^2]: by forces, by how the two surfaces
  /// bend under what slides along them, and by how sites move; < 0: it opens. 0 where they have no one shape. Cost: some 500 flops.
  double fall(const HeldContact& contact) const;
  /// Contact point minus the body's centre of mass [m].
  RealVec arm(const HeldContact& contact) const;
  bool on_moving_site(const HeldContact& contact) const {
    return contact.pair.with_site() && trajectories_->site(contact.pair.other_site).moves();
  }
  /// When forces on the member next jump [s]; whether until then all members' depend on nothing; who is coupled to it.
  double next_break(int member) const { return trajectories_->next_break(bodies_[member]); }
  bool are_constant() const { return constant_; }
  /// How long a step of h [s] may be for the motions of near sites, see SiteMotion::even_until. @pre sites are covered as far.
  double even_for(double h) const;
  /// What forces make of the members' motion in the middle of a step of h [s] that they take with these twists: where they are
  /// then, whose work is what is stored less; and along the lines of the step's start, which takes no angular momentum.
  struct Halfway {
    std::vector<Acceleration> there, along;
  };
  Halfway accelerations_halfway(double h, const std::vector<Vec3>& velocity) const;
  std::vector<int> coupled_to(int member) const;

 private:
  Box box_of(int owner, double reach) const;
  double site_way(int site) const;
  void add_images(std::vector<PairKey>& to, int a, const Box& box_a, int b, const Box& box_b) const;
  double reach_of(const PairKey& pair, double reach) const;
  Vec3 free_acceleration(int member) const;
  std::vector<HeldContact> features(const std::vector<PairKey>& pairs, double reach, const GoOn& go_on) const;

  const World* world_;
  const Trajectories* trajectories_;
  const ContactSearch* search_;
  double now_;
  double h_ = 0.0, reach_ = 0.0;
  std::size_t count_ = 0;
  int first_ = 0;  ///< the least of them
  std::vector<int> bodies_;
  std::vector<int> places_;  ///< of every body from the first to the last of them; -1: it is none
  std::vector<ExtendedState> states_;
  std::vector<Acceleration> accelerations_;
  std::vector<double> speeds_, pulls_;  ///< [m/s], [m/s^2], of any point of each
  std::vector<double> farther_;         ///< of each, what look_farther() was told [m]
  bool constant_ = true;
  bool joined_ = false;  ///< some by springs
  double size_ = kForever, speed_ = 0.0, pull_ = 0.0, heaviest_ = 0.0;
};

}  // namespace brink
