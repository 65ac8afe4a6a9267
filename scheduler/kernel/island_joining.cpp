#include "brink/scheduler/kernel/island_joining.h"

#include <algorithm>

namespace brink {

namespace {

/// Others may give a member so much of the fastest one's speed in the step. Who joins for that and is met by nobody is let go
/// as it was; who is met and had not joined cuts the step.
constexpr double kPassedOn = 0.1;
/// ... but of two islands no more than so many times the fastest one's of both.
constexpr double kCalm = 2.0;

/// One body beside an island.
class Outsider {
 public:
  Outsider(const World& world, const Trajectories& trajectories, const ContactSearch& search,
           const IslandMembers& members, int body, double now, double h)
      : world_(world),
        search_(search),
        members_(members),
        body_(body),
        h_(h),
        state_(trajectories.state_now(body)),
        going_(trajectories.body(body).motion.twist(now)) {
    const BodyState rounded = state_.rounded();
    const double radius = search.outline_of(body).bounding_radius;
    const double speed =
        std::max(speed_within(rounded.twist, radius), speed_within(going_.rounded(), radius));
    // the members' largest pull stands for its own
    member_gains_ = members.pull() * h + kPassedOn * members.speed();
    // Of two islands that hardly move nobody will fall freely in the step: what rolls slowly beside a heap, touching nobody, is
    // not taken into it, nor does it wake it.
    if (trajectories.is_held(body))
      member_gains_ = std::min(member_gains_, kCalm * std::max(speed, members.speed()));
    reach_ = h * (speed + member_gains_);
    box_.add(rounded.pose.position);
    box_ = box_.grown(radius + reach_ + search.limits().tolerance);
  }

  const Box& box() const { return box_; }

  /// True if it comes to touch any member, `boxes` being where those may come in the step.
  bool joins(const std::vector<Box>& boxes, const MostAbsorbed& most_absorbed) const {
    for (int member = 0; member < static_cast<int>(boxes.size()); ++member) {
      bool touches = false;
      world_.periods.overlaps(boxes[member], box_, [&](const Image& image) {
        touches = touches || comes_to(member, image, most_absorbed);
      });
      if (touches) return true;
    }
    return false;
  }

 private:
  /// Where a member goes with the step's last twist from its start on, this one comes to it by and by.
  bool comes_to(int member, const Image& image, const MostAbsorbed& most_absorbed) const {
    // which puts the lower body first: the outsider may be on either side
    const auto pair = search_.pair_of(members_.bodies()[member], body_, image);
    if (!pair) return false;
    const bool member_first = pair->body != body_;
    const Vec2 shift = search_.shift_of(*pair);
    const ExtendedState &of_member = members_.state(member), a = member_first ? of_member : state_,
                        b = (member_first ? state_ : of_member).shifted(shift);
    const double most = most_absorbed(*pair);
    const double far = search_.limits().tolerance + reach_ + members_.reach_of(member);
    for (const NearFeature& f :
         near_features(search_.outline_of(pair->body), a, search_.outline_of(pair->other_body), b, far,
                       search_.limits().tolerance)) {
      const RealVec arm = f.point.cast<Real>() + (b.position - a.position);
      const RealVec normal = f.normal.cast<Real>(), other_arm = f.point.cast<Real>();
      const double closing = static_cast<double>(normal.dot(b.twist.at(other_arm) - a.twist.at(arm)));
      // the contacts of its own island may stop the member within the step, and an outsider that another island
      // holds has the last twist of a step already
      const RealVec& arm_of_outsider = member_first ? other_arm : arm;
      const double sign = member_first ? 1.0 : -1.0;
      const auto towards = [&](const ExtendedTwist& v, const RealVec& at) {
        return sign * static_cast<double>(normal.dot(v.at(at)));
      };
      const double of_outsider =
          std::max(towards(state_.twist, arm_of_outsider), towards(going_, arm_of_outsider));
      const double of_the_member = std::min(0.0, towards(of_member.twist, member_first ? arm : other_arm));
      const double may_close = of_outsider - of_the_member;
      // What closes faster is an impact and meets the island by itself, but where it would graze a corner: that it goes over
      // is told by the contacts of the island. What parts now may still be caught up with.
      // The gap that is left is that of the step's end, closing by as much as the two may.
      if (f.gap - h_ * (may_close + member_gains_) > search_.limits().tolerance) continue;
      if (closing <= most || grazes(f, *pair, a, b)) return true;
    }
    return false;
  }

  /// True if the feature touches a side within the contact tolerance of its end.
  bool grazes(const NearFeature& f, const PairKey& pair, const ExtendedState& a,
              const ExtendedState& b) const {
    const Site& site = search_.outline_of(f.sample_on_a ? pair.other_body : pair.body).sites[f.site];
    if (site.kind != SiteKind::segment) return false;
    const ExtendedState& owner = f.sample_on_a ? b : a;
    const Vec2 point = Frame(Pose{{0.0, 0.0}, static_cast<double>(owner.angle)})
                           .direction_to_local(f.point - (owner.position - b.position).cast<double>());
    const double along = (site.b - site.a).normalized().dot(point - site.a),
                 length = (site.b - site.a).norm();
    return std::min(along, length - along) <= search_.limits().tolerance;
  }

  const World& world_;
  const ContactSearch& search_;
  const IslandMembers& members_;
  int body_;
  double h_, reach_ = 0.0;
  /// A member has its last twist from the start on, ahead of the present one by what forces and others make in the step [m/s].
  double member_gains_ = 0.0;
  ExtendedState state_;
  ExtendedTwist going_;  ///< of its motion: of one that another island holds that of the end of its step
  Box box_;
};

/// True of what stands still, so far away that nobody comes to it in the step: as most of the world does where a heap is at rest.
/// It may be given a speed by members, as any outsider. `all`: where these come in the step.
bool stands_far_off(const World& world, const Trajectories& trajectories, const ContactSearch& search,
                    const IslandMembers& members, int body, double h, const Box& all) {
  const Motion& motion = trajectories.body(body).motion;
  if (world.periods.any() || !motion.is_still()) return false;
  const ExtendedTwist twist = trajectories.twist_now(body);
  if (!twist.velocity.isZero(0.0) || twist.omega != 0.0) return false;
  const double gains = members.pull() * h + kPassedOn * members.speed();
  Box box;
  box.add(motion.start().pose.position);
  return !all.overlaps(
      box.grown(search.outline_of(body).bounding_radius + h * gains + search.limits().tolerance));
}

}  // namespace

/// Each outsider is asked by itself: one that touches another outsider alone comes with the next call, when that
/// one is a member.
std::vector<int> joining(const World& world, Trajectories& trajectories, const ContactSearch& search,
                         const IslandMembers& members, double now, double h,
                         const MostAbsorbed& most_absorbed, const GoOn& go_on) {
  std::vector<Box> boxes;
  Box all;
  for (int i = 0; i < static_cast<int>(members.count()); ++i) {
    boxes.push_back(members.box(i));
    all.add(boxes.back());
  }
  std::vector<int> found;
  for (int k = 0; k < trajectories.body_count(); ++k) {
    if (members.has(k)) continue;
    // bodies with clocks of their own may not have been followed so far
    if (!trajectories.cover_body(k, now) || (go_on && !go_on())) return {};
    if (stands_far_off(world, trajectories, search, members, k, h, all)) continue;
    const Outsider outsider(world, trajectories, search, members, k, now, h);
    bool near = false;
    // first against the whole island: nearly all of the world is far from it
    world.periods.overlaps(all, outsider.box(), [&](const Image&) { near = true; });
    if (near && outsider.joins(boxes, most_absorbed)) found.push_back(k);
  }
  return found;
}

}  // namespace brink
