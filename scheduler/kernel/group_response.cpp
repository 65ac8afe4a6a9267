#include "brink/scheduler/kernel/group_response.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "brink/core/contacts/group.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/kernel/tolerances.h"
#include "brink/scheduler/resolve/joint_contacts.h"

namespace brink {

namespace {

/// A contact of the group. They are sorted by order(), so that laws see the same list whichever was found first.
struct Touch {
  PairKey pair;
  FeatureContact contact;

  auto order() const { return std::tuple(pair.order(), contact.site, contact.sample, contact.sample_on_a); }
};

}  // namespace

class GroupResponse::Group {
 public:
  Group(GroupResponse& parts, const PairKey& pair, const FeatureContact& found)
      : parts_(parts), found_{pair, found} {}

  /// Up to the law's answer nothing of the world is changed: a halt before leaves it as it was.
  std::optional<GroupOutcome> resolve(GroupLaw law, std::vector<int>& changed) {
    if (!collect()) return std::nullopt;
    place();
    result_ = ask(law);
    // Joint contacts have other normals than the one that was found (two corners), and by those nothing
    // may approach. If the found approach is no rounding, leaving it would find it again at this instant,
    // for ever.
    if (!pushed() && !found_is_rounding() && add_as_found()) result_ = ask(law);
    if (result_.status == GroupResult::Status::stopped) return std::nullopt;
    if (result_.status == GroupResult::Status::jam) {
      parts_.run_.stop(
          Termination::failed,
          fmt::format("{} at t = {:.17g}: a group of {} contact(s) that no finite impulses can part",
                      parts_.search_.name_of(found_.pair), now(), group_.size()));
      return std::nullopt;
    }
    note_touched();
    push_apart();
    if (!restart(changed)) return std::nullopt;
    return outcome();
  }

 private:
  double now() const { return parts_.run_.time(); }

  /// Impulses at all contacts at once. What is asked twice is asked of the same twists: a law changes
  /// nothing.
  GroupResult ask(GroupLaw law) {
    const GoOn go_on = [this] { return parts_.run_.poll(); };
    if (law == GroupLaw::collapsed)
      if (auto plastic = collapse(go_on)) return *std::move(plastic);
    if (law != GroupLaw::complementarity) return resolve_reflections(members_, contacts_, go_on);
    GroupResult together = resolve_together(members_, contacts_, go_on);
    // what bounces between two that stand can rebound from either, not from both at once
    return together.status == GroupResult::Status::jam ? resolve_reflections(members_, contacts_, go_on)
                                                       : together;
  }

  /// Without a rebound, which is what losses without end come to, and friction coupled: nothing approaches afterwards.
  std::optional<GroupResult> collapse(const GoOn& go_on) {
    // An elastic contact that lost its rebound would lose energy that its material keeps: then all
    // reflect.
    const auto loses = [](const GroupContact& c) { return c.material.restitution < 1.0; };
    if (!std::all_of(contacts_.begin(), contacts_.end(), loses)) return std::nullopt;
    for (GroupContact& c : contacts_) c.material.restitution = 0.0;
    return resolve_plastic(members_, contacts_, go_on);
  }

  /// From body to body: whoever touches one of the group is of it. False on a halt.
  bool collect() {
    if (!place_boxes()) return false;
    add_found();
    std::vector<int> reached;
    std::vector<bool> is_reached(parts_.trajectories_.body_count(), false);
    const auto reach = [&](const PairKey& pair) {
      for (const int k : {pair.body, pair.other_body}) {
        if (k < 0 || is_reached[k]) continue;
        is_reached[k] = true;
        reached.push_back(k);
      }
    };
    // a pair is met from both of its bodies, and looked at from the first
    std::set<PairKey> seen;
    reach(found_.pair);
    // `reached` grows while it is gone through. Cost: a look at every owner's box for each body of the group.
    for (std::size_t i = 0; i < reached.size(); ++i) {
      if (!parts_.run_.poll()) return false;
      for (int owner = 0; owner < parts_.trajectories_.owner_count(); ++owner)
        parts_.near_.each_image_near(boxes_[reached[i]].grown(parts_.search_.limits().tolerance), owner,
                                     boxes_[owner], [&](const Image& image) {
                                       const auto pair = parts_.search_.pair_of(reached[i], owner, image);
                                       if (pair && seen.insert(*pair).second && add_touching(*pair))
                                         reach(*pair);
                                     });
    }
    add_found_corner();
    // one order, whichever contact was found first
    std::sort(group_.begin(), group_.end(),
              [](const Touch& a, const Touch& b) { return a.order() < b.order(); });
    return true;
  }

  /// Where every owner is now. False on a halt: of bodies with clocks of their own, some may not have come so
  /// far.
  bool place_boxes() {
    for (int owner = 0; owner < parts_.trajectories_.owner_count(); ++owner) {
      if (owner < parts_.trajectories_.body_count() && !parts_.trajectories_.cover_body(owner, now()))
        return false;
      boxes_.push_back(parts_.near_.box_at(owner, now()));
    }
    return true;
  }

  /// Adds the pair's contacts; true if it has any.
  bool add_touching(const PairKey& pair) {
    const SearchLimits& limits = parts_.search_.limits();
    // a search has found that this pair touches, whatever is seen of it now
    bool any = pair == found_.pair;
    const std::size_t first = group_.size();
    for (const FeatureContact& f : parts_.search_.touching(pair, limits.tolerance, now())) {
      // Of this instant: it touches to rounding, or closes within what counts as one instant.
      // Features of a wire meet at their level, some roundings before the gap is 0.
      const double above = f.gap - f.level;
      if (above > limits.touch && above > f.closing_speed * same_instant(now())) continue;
      any = true;
      for (const FeatureContact& joint : joint(pair, f)) add_unless_there(pair, joint, first);
    }
    return any;
  }

  /// All that the sample of this contact touches, not the nearest site alone (joint_contacts.h).
  std::vector<FeatureContact> joint(const PairKey& pair, const FeatureContact& f) const {
    return joint_contacts(parts_.search_.outline_of(pair.body),
                          parts_.trajectories_.motion_of(pair.body).extended_state(now()),
                          parts_.search_.outline_of(parts_.search_.other_owner(pair)),
                          parts_.search_.other_state(pair, now()), f, parts_.search_.limits().tolerance);
  }

  /// What the contact that was found is made of.
  void add_found() {
    for (const FeatureContact& f : joint(found_.pair, found_.contact)) group_.push_back({found_.pair, f});
  }

  /// Corners that meet can be found where no face is approached. Then the contact is taken as it was found,
  /// unless the pair is parting anyway.
  void add_found_corner() {
    const double speed = found_.contact.closing_speed;
    const auto of_pair = [&](const Touch& t) { return t.pair == found_.pair; };
    const auto approaches = [&](const Touch& t) { return of_pair(t) && t.contact.closing_speed > 0.0; };
    const auto parts = [&](const Touch& t) {
      return !of_pair(t) || t.contact.closing_speed < -kParting * speed;
    };
    if (std::any_of(group_.begin(), group_.end(), approaches)) return;
    if (!std::all_of(group_.begin(), group_.end(), parts)) group_.push_back(found_);
  }

  /// Contacts of the pair are those from `first` on, and those of the found one.
  void add_unless_there(const PairKey& pair, const FeatureContact& f, std::size_t first) {
    const auto same = [&](const Touch& t) {
      return t.pair == pair &&
             (t.contact.point - f.point).norm() <= kSamePlace * parts_.search_.limits().tolerance &&
             t.contact.normal.dot(f.normal) >= 1.0 - kSameNormal;
    };
    // A pair is met once, so its contacts are the last ones; only those of the found pair lie in front as
    // well.
    const auto from = group_.begin() + static_cast<std::ptrdiff_t>(pair == found_.pair ? 0 : first);
    if (std::none_of(from, group_.end(), same)) group_.push_back({pair, f});
  }

  /// Twists, normals and arms at the moment of contact: what the laws are asked with.
  void place() {
    std::set<int> bodies;
    for (const Touch& t : group_)
      for (const int k : {t.pair.body, t.pair.other_body})
        if (k >= 0) bodies.insert(k);
    bodies_.assign(bodies.begin(), bodies.end());
    // all of the group are taken to the moment of the contact that was found: one moment for one instant
    const Touch& first = told_by();
    delay_ = parts_.response_.delay_to_contact(first.contact, geometry(first));
    for (const int k : bodies_) {
      const Body& b = parts_.world_.bodies[k];
      members_.push_back({state(k).twist, b.inverse_mass_x(), b.inverse_mass_y(), b.inverse_inertia()});
    }
    for (const Touch& t : group_) contacts_.push_back(contact(t));
  }

  /// At the moment of contact; of a held body with what its step has brought by now.
  ExtendedState state(int body) const { return parts_.trajectories_.state_now(body).moved(delay_); }
  ExtendedState other_state(const Touch& t) const {
    return parts_.search_.other_state(t.pair, now()).moved(delay_);
  }
  /// Point, normal and gap of the same features at that moment.
  ExtendedContact geometry(const Touch& t) const {
    return contact_in(parts_.search_.outline_of(t.pair.body),
                      parts_.search_.outline_of(parts_.search_.other_owner(t.pair)), state(t.pair.body),
                      other_state(t), t.contact);
  }
  /// Of a body among those of the group.
  int index_of(int body) const {
    return static_cast<int>(std::lower_bound(bodies_.begin(), bodies_.end(), body) - bodies_.begin());
  }

  /// As the laws have it. A site is no body of the group: what moves is its point, as it is told.
  GroupContact contact(const Touch& t) const {
    const ExtendedContact c = geometry(t);
    const ExtendedState other = other_state(t);
    const RealVec other_arm = c.point - other.position;
    GroupContact made;
    made.body = index_of(t.pair.body);
    made.normal = c.normal;
    made.arm = c.point - state(t.pair.body).position;
    if (t.pair.with_site()) {
      made.other_point_velocity = other.twist.at(other_arm);
    } else {
      made.other = index_of(t.pair.other_body);
      made.other_arm = other_arm;
    }
    made.material = parts_.response_.material_of(t.pair);
    return made;
  }

  /// The fastest that any of the bodies' points may be [m/s].
  double top_speed() const {
    double speed = 0.0;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const ExtendedTwist& t = members_[k].twist;
      speed = std::max(
          speed, static_cast<double>(t.velocity.lpNorm<1>() +
                                     abs(t.omega) * parts_.search_.outline_of(bodies_[k]).bounding_radius));
    }
    return speed;
  }

  /// False: by the law's normals nothing approaches.
  bool pushed() const {
    return std::any_of(result_.normal.begin(), result_.normal.end(), [](Real p) { return p > 0; });
  }

  /// True if velocities' rounding may have made the approach that was found.
  bool found_is_rounding() const { return found_.contact.closing_speed <= kPartsOfSpeed * top_speed(); }

  /// True of the contact that was found, where it is one of the group.
  bool is_found(const Touch& t) const {
    return t.pair == found_.pair && t.order() == found_.order() &&
           t.contact.normal.dot(found_.contact.normal) >= 1.0 - kSameNormal;
  }

  /// Whose gap tells the moment of contact. Two corners that meet have no normal but that of their way; the contacts
  /// that they make have, and of those the first, since several corners may meet in one instant and any may be found.
  const Touch& told_by() const {
    const auto found = [&](const Touch& t) { return is_found(t); };
    if (std::any_of(group_.begin(), group_.end(), found)) return found_;
    const auto approaches = [&](const Touch& t) {
      return t.pair == found_.pair && t.contact.closing_speed > 0.0;
    };
    const auto first = std::find_if(group_.begin(), group_.end(), approaches);
    return first == group_.end() ? found_ : *first;
  }

  /// Adds the contact as it was found; false if it is there.
  bool add_as_found() {
    if (std::any_of(group_.begin(), group_.end(), [&](const Touch& t) { return is_found(t); })) return false;
    group_.push_back(found_);
    contacts_.push_back(contact(found_));
    return true;
  }

  /// What one body is resolved by: its contact, and since when it flew.
  void note_touched() {
    since_last_.assign(bodies_.size(), std::numeric_limits<double>::infinity());
    touched_.assign(bodies_.size(), false);
    // where the law pushes nobody the found pair stands in for the group
    const bool any = pushed();
    double speed = top_speed();
    // An approach that the law does not see was rounding, all of it; but not of held bodies, of which the
    // search sees the twist of their step's end (CollisionResponse::change).
    const auto held = [&](int body) { return body >= 0 && parts_.trajectories_.is_held(body); };
    if (!any && !held(found_.pair.body) && !held(found_.pair.other_body))
      speed += found_.contact.closing_speed / kEpsilon;
    for (std::size_t k = 0; k < group_.size(); ++k) {
      // Where nothing pushes, the found pair's contacts are told all the same, without impulse: a search
      // has found a collision, and versions must rise for it not to be found again.
      if (result_.normal[k] > 0 || (!any && group_[k].pair == found_.pair)) events_.push_back(k);
    }
    for (const std::size_t k : events_) {
      const PairKey& pair = group_[k].pair;
      touch(pair.body, parts_.search_.other_owner(pair), speed);
      if (!pair.with_site()) touch(pair.other_body, pair.body, speed);
    }
  }

  /// The body begins anew; `partner`, `speed`: see CollisionResponse::note_resolve().
  void touch(int body, int partner, double speed) {
    const int k = index_of(body);
    // once for each body: a second note_resolve() of this instant would find that no time has gone by
    if (!touched_[k]) since_last_[k] = parts_.response_.note_resolve(body, partner, speed);
    touched_[k] = true;
  }

  /// What two solids are pushed apart by may be more than the level that is left before a wire: nobody who touches one
  /// is pushed towards it.
  void push_apart() {
    ways_.assign(bodies_.size(), RealVec::Zero());
    const auto at_wire = [&](std::size_t k) { return group_[k].contact.nominal() > 0.0; };
    for (const std::size_t k : events_)
      if (!at_wire(k)) push_apart(k);
    for (std::size_t k = 0; k < group_.size(); ++k) {
      if (!at_wire(k)) continue;
      const PairKey& pair = group_[k].pair;
      RealVec none = RealVec::Zero();
      RealVec &way = ways_[index_of(pair.body)],
              &of_other = pair.with_site() ? none : ways_[index_of(pair.other_body)];
      // the normal points into the body: the two would come nearer to each other
      if (contacts_[k].normal.dot(way - of_other) < 0) way = of_other = RealVec::Zero();
    }
    for (const std::size_t k : events_)
      if (at_wire(k)) push_apart(k);
  }

  /// A body of several contacts goes by the sum of their ways.
  void push_apart(std::size_t k) {
    const auto& [pair, contact] = group_[k];
    const auto [way, way_of_other] = parts_.response_.push_apart(pair, contact, contacts_[k].normal);
    ways_[index_of(pair.body)] += way;
    if (!pair.with_site()) ways_[index_of(pair.other_body)] += way_of_other;
  }

  /// The law's twists, the ways of those that have sunk, and a motion for each. False: the watch has seen what must
  /// not be.
  bool restart(std::vector<int>& changed) {
    std::map<int, std::vector<Restart>> by_component;  // a free body is one of its own
    // Bodies of one component are restarted together, as each restart starts its integrator.
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      // whom nothing pushed goes on as before: its certificates hold
      if (!touched_[i]) continue;
      if (!parts_.watch_.flight(bodies_[i], now())) return false;
      const int body = bodies_[i], component = parts_.trajectories_.body(body).component;
      ExtendedState after = state(body);
      after.twist = result_.twists[i];
      after.position += ways_[i];
      // a motion from now that passes through the moment of contact
      // free and held bodies get keys of their own, below those of components
      by_component[component < 0 ? -1 - body : component].push_back({body, after.moved(-delay_)});
    }
    for (const auto& [component, touched] : by_component) parts_.trajectories_.restart(touched, changed);
    return std::all_of(events_.begin(), events_.end(), [&](std::size_t k) {
      return parts_.watch_.resolved(group_[k].pair, group_[k].contact, delay_);
    });
  }

  /// Of one whom nothing pushed, as it was.
  EventSide side(int body) const {
    EventSide side = parts_.trajectories_.last_restart(body);
    if (!touched_[index_of(body)]) side.before = side.after.twist;
    return side;
  }

  /// A collision for each contact that is told of, in the group's order.
  GroupOutcome outcome() const {
    GroupOutcome told;
    told.endless = result_.status == GroupResult::Status::endless;
    told.delay = delay_;
    told.lost = told.endless ? static_cast<double>(result_.lost) : 0.0;
    for (const std::size_t k : events_) {
      const PairKey& pair = group_[k].pair;
      // The flight of the two has lasted since their last collision: no shorter than the shorter time.
      double since_last = since_last_[index_of(pair.body)];
      if (!pair.with_site()) since_last = std::min(since_last, since_last_[index_of(pair.other_body)]);
      told.collisions.push_back({pair,
                                 group_[k].contact,
                                 static_cast<double>(result_.normal[k]),
                                 static_cast<double>(result_.tangential[k]),
                                 delay_,
                                 since_last,
                                 {},
                                 side(pair.body),
                                 pair.with_site() ? EventSide{} : side(pair.other_body)});
    }
    return told;
  }

  GroupResponse& parts_;
  Touch found_;
  std::vector<Box> boxes_;  ///< of every owner
  std::vector<Touch> group_;
  std::vector<int> bodies_;  ///< ascending
  Real delay_ = 0;           ///< from now to the moment of contact [s]
  std::vector<GroupBody> members_;
  std::vector<GroupContact> contacts_;
  GroupResult result_;
  std::vector<std::size_t> events_;  ///< contacts that are told of, as indices into group_
  std::vector<bool> touched_;
  std::vector<RealVec> ways_;       ///< by which what has sunk is pushed out [m]
  std::vector<double> since_last_;  ///< time since each touched body was last resolved [s]
};

std::optional<GroupOutcome> GroupResponse::resolve(const PairKey& pair, const FeatureContact& found,
                                                   GroupLaw law, std::vector<int>& changed) {
  return Group(*this, pair, found).resolve(law, changed);
}

}  // namespace brink
