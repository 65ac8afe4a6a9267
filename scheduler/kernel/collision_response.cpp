#include "brink/scheduler/kernel/collision_response.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/tolerances.h"
#include "brink/scheduler/kernel/tolerances.h"

namespace brink {

namespace {

/// Times a speed that is known to roundings: no more than that speed.
constexpr double kLessByRoundings = 1.0 - 1e-9;
/// What is pushed off a wire comes nearer to another one by so much of what is left before that at most.
constexpr double kOfRoom = 0.25;

/// It gives way by its mass and inertia, but for its locks. `point`: of the contact, in the world [m].
ImpulseSide body_side(const Body& body, const ExtendedState& state, const RealVec& point) {
  return {state.twist, point - state.position, body.inverse_mass_x(), body.inverse_mass_y(),
          body.inverse_inertia()};
}

/// It gives way to nothing; its twist is what a moving site does at the contact.
ImpulseSide site_side(const ExtendedState& state, const RealVec& point) {
  return {state.twist, point - state.position, 0.0, 0.0, 0.0};
}

/// Sum of the speeds that a side's velocity at the contact is made of [m/s].
double speed_of(const ImpulseSide& side) {
  const Twist twist = side.twist.rounded();
  return twist.velocity.lpNorm<1>() + std::abs(twist.omega) * side.arm.cast<double>().norm();
}

/// By how much the speed of the body's point there differs between two states of one moment and another [m/s].
double change_of_speed(const ExtendedState& now, const ExtendedState& then, const RealVec& point) {
  const ExtendedTwist change{now.twist.velocity - then.twist.velocity, now.twist.omega - then.twist.omega};
  return speed_of({change, point - now.position, 0.0, 0.0, 0.0});
}

/// How fast a contact comes to open as its bodies turn, whatever forces do, where they go on with these twists [m/s^2]: as its normal
/// turns, and its point goes on along them.
double opens_by_turning(const ExtendedContact& c, const ImpulseSide& body, const ImpulseSide& other,
                        const ImpulseResult& after) {
  const Twist a = after.body.rounded(), b = after.other.rounded();
  const Vec2 n = c.normal.cast<double>();
  const Vec2 slides = a.at(body.arm.cast<double>()) - b.at(other.arm.cast<double>());
  const Vec2 arms_turn =
      cross(a.omega, Vec2(c.point_rate - a.velocity)) - cross(b.omega, Vec2(c.point_rate - b.velocity));
  return c.turn_rate * perp(n).dot(slides) + n.dot(arms_turn);
}

/// The state `delay` later of what moves so. What forces do to it in so short a while counts on a parabola alone:
/// elsewhere an integrator is off by far more.
ExtendedState later(const ExtendedState& s, Real delay, const Motion& motion) {
  ExtendedState then = s.moved(delay);
  if (!motion.is_ballistic() || motion.is_still()) return then;
  const Acceleration& by = motion.acceleration();
  // what adds nothing is left out: the sums are the same bits
  if (!by.linear.isZero(0)) then.twist.velocity += delay * by.linear.cast<Real>();
  if (by.angular != 0.0) then.twist.omega += delay * by.angular;
  return then;
}

/// The state now of a motion that meets the old one, now in `s`, `delay` from now, where its twist changes
/// from `before` to `after`.
ExtendedState deflected(ExtendedState s, const ExtendedTwist& before, const ExtendedTwist& after,
                        Real delay) {
  // s + delay before = s' + delay after: at the moment of contact both motions are at one place
  const RealVec velocity = after.velocity - before.velocity;
  const Real omega = after.omega - before.omega;
  s.position -= delay * velocity;
  s.angle -= delay * omega;
  s.twist.velocity += velocity;
  s.twist.omega += omega;
  return s;
}

/// A contact that a picture shows is resolved as it was seen: there are no features to look at again.
ExtendedContact as_seen(const FeatureContact& f) {
  return {f.point.cast<Real>(), f.normal.cast<Real>(), f.gap, f.closing_speed};
}

}  // namespace

/// How a collision is resolved.
struct CollisionResponse::Change {
  ImpulseResult impulse;
  Real delay = 0;                   ///< from now to the moment of contact [s]
  ExtendedState body, other;        ///< states now; of the other where its image is
  CertificateWatch::Moment moment;  ///< of contact, with the twists before
  double magnitude = 0.0;           ///< the largest speed that took part [m/s]
};

CollisionResponse::CollisionResponse(const World& world, const SolverOptions& options,
                                     Trajectories& trajectories, ContactSearch& search, const NearPairs& near,
                                     CertificateWatch& watch, RunControl& run)
    : world_(&world),
      trajectories_(&trajectories),
      search_(&search),
      near_(&near),
      watch_(&watch),
      run_(&run),
      reflects_(options.response == "reflection") {
  for (int k = 0; k < static_cast<int>(world.bodies.size()); ++k) plain_.push_back(plain_disc(k));
  for (int s = 0; s < static_cast<int>(world.sites.size()); ++s) plain_walls_.push_back(plain_wall(s));
  if (!search.points_meet_wires()) return;
  const auto thin = [](const Site& site) {
    return !site.solid && site.radius == 0.0 && site.kind != SiteKind::point;
  };
  for (int owner = 0; owner < trajectories.owner_count(); ++owner) {
    const std::vector<Site>& sites = search.outline_of(owner).sites;
    if (std::any_of(sites.begin(), sites.end(), thin)) wires_.push_back(owner);
  }
}

/// What disc_rebound() asks before it knows the pair.
CollisionResponse::PlainDisc CollisionResponse::plain_disc(int k) const {
  const Body& body = world_->bodies[k];
  const Outline& outline = search_->outline_of(k);
  const bool plain = is_centred_disc(outline) && outline.sites[0].radius == outline.bounding_radius &&
                     outline.bounding_radius > 0.0 && !body.lock_x && !body.lock_y && body.mass > 0.0 &&
                     !reflects_ && !search_->points_meet_wires();
  return plain ? PlainDisc{1.0 / body.mass, outline.bounding_radius, body.material} : PlainDisc{};
}

/// What wall_rebound() asks before it knows the disc.
CollisionResponse::PlainWall CollisionResponse::plain_wall(int s) const {
  if (reflects_ || search_->points_meet_wires() || !search_->is_straight_wall(s)) return {};
  const int owner = trajectories_->body_count() + s;
  const Motion& motion = trajectories_->motion_of(owner);
  const Site& site = search_->outline_of(owner).sites[0];
  const ExtendedState stands = motion.extended_state(motion.origin());
  return {
      true, {stands.to_world(site.a), stands.to_world(site.b), site.radius, {}}, world_->sites[s].material};
}

/// Combined when the pair's two materials first meet, and kept.
const Material& CollisionResponse::material_of(const PairKey& pair) {
  const int other =
      pair.with_site() ? world_->sites[pair.other_site].material : world_->bodies[pair.other_body].material;
  return materials_.of(*world_, world_->bodies[pair.body].material, other);
}

/// By the pair's material alone, not by this collision: a series of bounces has an end if its collisions take
/// something of the approach.
BounceLoss CollisionResponse::loss_of(const PairKey& pair) {
  const Material& m = material_of(pair);
  // slip or spin of another value take energy, or give it: a series of bounces may come to an end
  if (reflects_) return m.slip == 1.0 && m.spin == 1.0 ? BounceLoss::none : BounceLoss::some;
  if (m.restitution == 0.0) return BounceLoss::all;
  // with e = 1 friction may still take energy, from a sliding that it does not stop whatever the tangential restitution
  return m.restitution < 1.0 || m.friction > 0.0 ? BounceLoss::some : BounceLoss::none;
}

double CollisionResponse::gap_rounding(const PairKey& pair) const {
  return 2.0 * kEpsilon *
         (search_->outline_of(pair.body).magnitude +
          search_->outline_of(search_->other_owner(pair)).magnitude);
}

double CollisionResponse::note_resolve(int k, int partner, double magnitude) {
  BodyTrack& b = trajectories_->body(k);
  const double now = run_->time();
  const double since_last =
      b.resolved_at < 0.0 ? std::numeric_limits<double>::infinity() : now - b.resolved_at;
  // An approach that is no faster than this is none to the search (Mover), so that it does not find the
  // same contact again.
  const double rounding = 16.0 * kEpsilon * magnitude;
  // within one instant velocities are differences of larger ones: the largest rounding stays
  b.velocity_rounding =
      std::abs(since_last) <= same_instant(now) ? std::max(b.velocity_rounding, rounding) : rounding;
  b.resolved_at = now;
  b.streak = b.last_partner == partner ? b.streak + 1 : 1;
  b.last_partner = partner;
  return since_last;
}

Real CollisionResponse::delay_to_contact(const FeatureContact& found, const ExtendedContact& c) const {
  if (found.seen || search_->points_meet_wires() || !(c.closing > 0)) return 0;
  // The contact is told at the last double before its gap is closed: the rest of that rounding, and what
  // the gap was computed wrong by. A closing speed next to 0 would ask for more than that means.
  const Real late = 4.0 * ulp(run_->time());
  return std::clamp((c.gap - found.level) / c.closing, -late, late);
}

/// The features are looked at where the pair is now, which tells how long it is to the moment of contact, and moved on
/// to that, where the law is asked. The states that are returned are those of now, for motions that begin now.
CollisionResponse::Change CollisionResponse::change(const PairKey& pair, const FeatureContact& found,
                                                    const Material& material) {
  Change r;
  const double now = run_->time();
  r.body = trajectories_->state_now(pair.body);
  r.other = search_->other_state(pair, now);
  // of one that an island holds what its step has brought by now
  if (!pair.with_site() && trajectories_->is_held(pair.other_body))
    r.other.twist = trajectories_->state_now(pair.other_body).twist;
  const ExtendedContact at_present =
      found.seen ? as_seen(found)
                 : contact_in(search_->outline_of(pair.body), search_->outline_of(search_->other_owner(pair)),
                              r.body, r.other, found);
  r.delay = delay_to_contact(found, at_present);
  const ExtendedContact c = at_present.moved(r.delay.high());
  r.moment = {later(r.body, r.delay, trajectories_->motion_of(pair.body)),
              later(r.other, r.delay, trajectories_->motion_of(search_->other_owner(pair))), c.gap};
  const auto& [body, other, gap] = r.moment;
  const ImpulseSide side = body_side(world_->bodies[pair.body], body, c.point);
  const ImpulseSide other_side = pair.with_site()
                                     ? site_side(other, c.point)
                                     : body_side(world_->bodies[pair.other_body], other, c.point);
  const auto law = reflects_ ? resolve_reflection : resolve_impulse;
  r.impulse = law(side, other_side, c.normal, material);
  r.magnitude = std::max(speed_of(side), speed_of(other_side));
  // What forces change from now to the moment of contact, or the reverse, is no approach, nor is what turning does.
  if (r.delay != 0) {
    const double closes = 2.0 * r.delay.high() * opens_by_turning(at_present, side, other_side, r.impulse);
    r.magnitude += (change_of_speed(r.body, body, c.point) + change_of_speed(r.other, other, c.point) +
                    std::max(0.0, closes)) /
                   kEpsilon;
  }
  // an approach that the law does not see was rounding, all of it
  const bool held = trajectories_->is_held(pair.body) ||
                    (!pair.with_site() && trajectories_->is_held(pair.other_body));  // by state_now()
  // It raises velocity_rounding above the approach, so that no search finds it again. Of held bodies the
  // search sees the twist of their step's end, the law what they have come to by now: those may well
  // differ in earnest.
  if (r.impulse.kind == ImpulseKind::separating && !held)
    r.magnitude += std::max(0.0, found.closing_speed) / kEpsilon;
  // what has sunk is pushed out as the new motions begin, along the normal at the moment of contact
  const auto [way, way_of_other] = push_apart(pair, found, c.normal);
  const bool solids = !(found.nominal() > 0.0);
  r.body.position += way * part_of_push(pair.body, way, solids);
  if (!pair.with_site())
    r.other.position += way_of_other * part_of_push(pair.other_body, way_of_other, solids);
  return r;
}

/// What is pushed comes no nearer to a wire that it touches, too, than by a part of what is left before that: levels differ, and the push
/// off one may be more than another. Two solids may stay as deep as they are.
double CollisionResponse::part_of_push(int body, const RealVec& way, bool solids) {
  const double room = room_before_wire(body, way);
  if (!std::isfinite(room)) return 1.0;
  return solids ? 0.0 : std::clamp(kOfRoom * room / static_cast<double>(way.norm()), 0.0, 1.0);
}

std::pair<RealVec, RealVec> CollisionResponse::push_apart(const PairKey& pair, const FeatureContact& found,
                                                          const RealVec& n) {
  const RealVec none = RealVec::Zero();
  // of a picture's contact nobody knows how deep it is to roundings
  if (found.seen || !(found.sunk() > 0.0)) return {none, none};
  // An island's steps are off by more than a wire's level, and make up for it themselves: a push of two solids by
  // that much would lead past the wire on which one of them stands. Off a wire a push is less than its level, though another's may be
  // less (part_of_push).
  const bool held =
      trajectories_->is_held(pair.body) || (!pair.with_site() && trajectories_->is_held(pair.other_body));
  if (held && !(found.nominal() > 0.0)) return {none, none};
  const auto given = [&](int body) {
    const Body& b = world_->bodies[body];
    return RealVec(b.inverse_mass_x() * n.x(), b.inverse_mass_y() * n.y());
  };
  const RealVec of_body = given(pair.body), of_other = pair.with_site() ? none : given(pair.other_body);
  const Real sum = n.dot(of_body) + n.dot(of_other);
  if (!(sum > 0)) return {none, none};
  const double e = material_of(pair).restitution;
  // 1 - e^2 is the part of the energy along the normal that the collision takes
  const Real by = push_of(found.sunk(), found.nominal(), search_->limits().tolerance, 1.0 - e * e);
  return {of_body * (by / sum), -of_other * (by / sum)};
}

/// The least gap to a wire without thickness that is in that way, and touched already, be it the body's own or another's [m];
/// infinity: none is. What is pushed by may be more than the level that is left before it.
double CollisionResponse::room_before_wire(int body, const RealVec& way) {
  double room = kForever;
  if (wires_.empty() || way.isZero(0)) return room;
  const double now = run_->time(), touch = search_->limits().touch;
  const Vec2 along = way.cast<double>();
  const auto leads = [&](const PairKey& pair) {
    const double sign = pair.body == body ? 1.0 : -1.0;  // normals point into the pair's first
    const std::vector<FeatureContact> touched = search_->touching(pair, touch, now);
    for (const FeatureContact& f : touched)
      if (f.nominal() > 0.0 && sign * f.normal.dot(along) < 0.0) room = std::min(room, std::max(f.gap, 0.0));
  };
  const Box box = near_->box_at(body, now).grown(touch);
  const auto look_at = [&](int owner) {
    if (owner == body || !search_->may_meet(body, owner)) return;
    if (owner < trajectories_->body_count() && !trajectories_->cover_body(owner, now)) return;
    near_->each_image_near(box, owner, near_->box_at(owner, now), [&](const Image& image) {
      if (const auto pair = search_->pair_of(body, owner, image)) leads(*pair);
    });
  };
  if (!std::binary_search(wires_.begin(), wires_.end(), body)) {
    for (const int wire : wires_) look_at(wire);
    return room;
  }
  for (int owner = 0; owner < trajectories_->owner_count(); ++owner) look_at(owner);
  return room;
}

/// Begins the motions that lead through the moment of contact with the twists that the law gave.
void CollisionResponse::deflect(const PairKey& pair, const Change& r, std::vector<int>& changed) {
  const Restart body{pair.body, deflected(r.body, r.moment.body.twist, r.impulse.body, r.delay)};
  if (pair.with_site()) return trajectories_->restart({&body, 1}, changed);
  const Restart both[] = {
      body,
      {pair.other_body,
       deflected(r.other, r.moment.other.twist, r.impulse.other, r.delay).shifted(-search_->shift_of(pair))}};
  const int component = trajectories_->body(pair.body).component;
  // in one component: two restarts would be two motions, the first of them with one side's new twist alone
  if (component >= 0 && component == trajectories_->body(pair.other_body).component)
    return trajectories_->restart(both, changed);
  trajectories_->restart({both, 1}, changed);
  trajectories_->restart({both + 1, 1}, changed);
}

/// The body if it is a disc in free flight, else none.
DiscSide CollisionResponse::free_disc(int k) const {
  const Body& body = world_->bodies[k];
  const bool bare =
      trajectories_->is_free(k) && is_centred_disc(search_->outline_of(k)) && !body.lock_x && !body.lock_y;
  // the bounding radius of a centred disc is its radius
  return {bare ? &trajectories_->body(k).motion : nullptr, body.outline->bounding_radius, 1.0 / body.mass};
}

/// The response now if a free disc meets another, or a straight wall, without friction: a quick way to what
/// change() says.
std::optional<DiscRebound> CollisionResponse::disc_rebound(const PairKey& pair, const FeatureContact& found,
                                                           const Material& material) {
  // where the general response has no delay to the moment of contact, this one must have none either
  if (found.seen || reflects_ || search_->points_meet_wires()) return std::nullopt;
  if (material.friction != 0.0) return std::nullopt;
  if (pair.with_site()) return wall_rebound(pair, found, material);
  const DiscSide a = free_disc(pair.body), b = free_disc(pair.other_body);
  if (!a.motion || !b.motion || a.radius + b.radius == 0.0) return std::nullopt;
  const double now = run_->time();
  return rebound(a, b, search_->shift_of(pair), now, 4.0 * ulp(now), found.level, material.restitution);
}

/// The same of a free disc beside a straight wall that stands. What has a case of its own is left to change().
std::optional<DiscRebound> CollisionResponse::wall_rebound(const PairKey& pair, const FeatureContact& found,
                                                           const Material& material) {
  const int other = search_->other_owner(pair);
  const Site& site = search_->outline_of(other).sites[found.site];
  const DiscSide disc = free_disc(pair.body);
  // of a closed form: the disc's centre over a straight side that stands, not over a corner or an arc
  if (!disc.motion || !found.sample_on_a || site.kind != SiteKind::segment) return std::nullopt;
  // a bare point on a bare line has no normal of its own there; what has sunk is pushed apart by the
  // general response
  if (disc.radius + site.radius == 0.0 || found.sunk() > 0.0) return std::nullopt;
  if (!trajectories_->motion_of(other).is_still()) return std::nullopt;
  const double now = run_->time();
  const ExtendedState stands = search_->other_state(pair, now);
  const WallSide wall{stands.to_world(site.a), stands.to_world(site.b), site.radius, found.normal};
  return rebound(disc, wall, now, 4.0 * ulp(now), found.level, material.restitution);
}

/// The limit of bounces in closed form, where both sides fly under constant accelerations between them: the
/// next flight lasts 2 e v / a, each one after e times as long. `e`: the pair's restitution.
ForeseenLimit CollisionResponse::foresee(const PairKey& pair, const FeatureContact& found, double e,
                                         Real delay) {
  const Motion &motion = trajectories_->motion_of(pair.body),
               &other = trajectories_->motion_of(search_->other_owner(pair));
  if (!(e < 1.0) || !motion.is_ballistic() || !other.is_ballistic()) return {};
  // what presses the two together [m/s^2]
  const double pull = -found.normal.dot(motion.acceleration().linear - other.acceleration().linear);
  if (!(pull > 0.0)) return {};
  const double late = static_cast<double>(delay), v = found.closing_speed + pull * late;
  // what a rounding of the gap takes to fall comes back with every bounce
  const double rounding = 4.0 * search_->limits().touch / (v * (1.0 - e));
  // 2 e v / a (1 + e + e^2 + ...)
  return {run_->time() + (late + 2.0 * e * v / (pull * (1.0 - e))), rounding};
}

/// Notes what its bodies came to. @pre both have been restarted by it.
void CollisionResponse::note_sides(Outcome& outcome) const {
  if (!trajectories_->keeps_twists_before()) return;
  const PairKey& pair = outcome.pair;
  outcome.body = trajectories_->last_restart(pair.body);
  if (!pair.with_site()) outcome.other = trajectories_->last_restart(pair.other_body);
}

/// Collides as collide() does, with a rebound that is known: the same notes, watches and new motions.
std::optional<Outcome> CollisionResponse::part(const PairKey& pair, const FeatureContact& found,
                                               const Material& material, const DiscRebound& discs,
                                               std::vector<int>& changed) {
  const auto start = [&](int k, int partner, const DiscRebound::Start& after) {
    changed.push_back(k);
    const double since_last = note_resolve(k, partner, discs.magnitude);
    trajectories_->restart_free(k, after.state, after.low);
    return since_last;
  };
  double since_last = start(pair.body, search_->other_owner(pair), discs.a);
  if (!pair.with_site()) since_last = std::min(since_last, start(pair.other_body, pair.body, discs.b));
  if (!watch_->discs_resolved(pair, discs.gap)) return std::nullopt;
  std::optional<Outcome> outcome{{pair, found, discs.impulse, 0.0, discs.delay, since_last,
                                  foresee(pair, found, material.restitution, discs.delay)}};
  // after both have begun anew: it asks how they came out
  note_sides(*outcome);
  return outcome;
}

/// Without friction; and low flights are remembered, as they may be a series that has an end. `last`: when one of the two was
/// last resolved [s], below 0: never.
bool CollisionResponse::may_rebound_plainly(const Material& material, const DiscContact& found,
                                            double last) const {
  const double since_last = last < 0.0 ? std::numeric_limits<double>::infinity() : run_->time() - last;
  return material.friction == 0.0 &&
         (!(material.restitution < 1.0) || ZenoWatch::is_high(found.closing_speed * kLessByRoundings,
                                                              since_last, search_->limits().tolerance));
}

/// Of the flight that ends now: false if it was seen to lead through a wire, which ends the run.
bool CollisionResponse::has_flown(int k, const Motion& motion) {
  return watch_->is_clear_flight(k, motion.start().pose.position, motion.place(run_->time())) ||
         watch_->flight(k, run_->time());
}

/// Whatever may yet say no comes before the first change.
bool CollisionResponse::collide_discs(const PairKey& pair, const DiscContact& found) {
  const PlainDisc &a = plain_[pair.body], &b = plain_[pair.other_body];
  const Material& material = materials_.of(*world_, a.material, b.material);
  const double now = run_->time();
  const BodyTrack &track_a = trajectories_->body(pair.body), &track_b = trajectories_->body(pair.other_body);
  if (!may_rebound_plainly(material, found, std::max(track_a.resolved_at, track_b.resolved_at))) return false;
  if (!rebound({&track_a.motion, a.radius, a.inverse_mass}, {&track_b.motion, b.radius, b.inverse_mass},
               search_->shift_of(pair), now, 4.0 * ulp(now), 0.0, material.restitution, after_))
    return false;
  if (!has_flown(pair.body, track_a.motion) || !has_flown(pair.other_body, track_b.motion)) return true;
  note_resolve(pair.body, pair.other_body, after_.magnitude);
  trajectories_->restart_free(pair.body, after_.a.state, after_.a.low);
  note_resolve(pair.other_body, pair.body, after_.magnitude);
  trajectories_->restart_free(pair.other_body, after_.b.state, after_.b.low);
  watch_->discs_resolved(pair, after_.gap);
  return true;
}

bool CollisionResponse::collide_with_wall(const PairKey& pair, const WallContact& found) {
  const PlainDisc& disc = plain_[pair.body];
  PlainWall& wall = plain_walls_[pair.other_site];
  const Material& material = materials_.of(*world_, disc.material, wall.material);
  const double now = run_->time();
  const BodyTrack& track = trajectories_->body(pair.body);
  if (!may_rebound_plainly(material, found, track.resolved_at)) return false;
  wall.side.normal = found.normal;
  if (!rebound({&track.motion, disc.radius, disc.inverse_mass}, wall.side, now, 4.0 * ulp(now), 0.0,
               material.restitution, after_))
    return false;
  if (!has_flown(pair.body, track.motion)) return true;
  note_resolve(pair.body, search_->other_owner(pair), after_.magnitude);
  trajectories_->restart_free(pair.body, after_.a.state, after_.a.low);
  watch_->discs_resolved(pair, after_.gap);
  return true;
}

std::optional<Outcome> CollisionResponse::collide(const PairKey& pair, const FeatureContact& found,
                                                  std::vector<int>& changed) {
  const double now = run_->time();
  // before anything is restarted: the flight is the one that ends here
  if (!watch_->flight(pair.body, now) || (!pair.with_site() && !watch_->flight(pair.other_body, now)))
    return std::nullopt;
  const Material& material = material_of(pair);
  // a disc that does not approach has no rebound: change() and the watch judge that, below
  if (const auto discs = disc_rebound(pair, found, material))
    return part(pair, found, material, *discs, changed);
  const Change r = change(pair, found, material);
  if (!watch_->approaches(pair, found.closing_speed, kPartsOfSpeed * r.magnitude)) return std::nullopt;
  if (r.impulse.kind == ImpulseKind::jam) {
    run_->stop(Termination::failed,
               fmt::format("{} at t = {:.17g}: neither side can move", search_->name_of(pair), now));
    return std::nullopt;
  }
  // their flight has lasted no less than the shorter of the times since either was resolved
  double since_last = note_resolve(pair.body, search_->other_owner(pair), r.magnitude);
  if (!pair.with_site())
    since_last = std::min(since_last, note_resolve(pair.other_body, pair.body, r.magnitude));
  deflect(pair, r, changed);
  if (!watch_->resolved(pair, found, r.delay, found.seen ? nullptr : &r.moment)) return std::nullopt;
  std::optional<Outcome> outcome{{pair, found, r.impulse.normal, r.impulse.tangential, r.delay, since_last,
                                  foresee(pair, found, material.restitution, r.delay)}};
  note_sides(*outcome);
  return outcome;
}

}  // namespace brink
