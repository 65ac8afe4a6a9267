/// The kernel's resolves: one collision at a time, and the endings it cannot pass.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/core/contacts/impulse.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/tolerances.h"
#include "brink/scheduler/kernel/kernel.h"
#include "brink/scheduler/resolve/disc_rebound.h"
#include "brink/scheduler/resolve/extended_contact.h"

namespace brink {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// A contact that parts faster than this part of the speeds that take part is none; slower is rounding.
constexpr double kPartsOfSpeed = 1e-6;
/// In an instant of so many the next are taken together, however many bodies there are: it takes seconds.
constexpr std::uint64_t kLongestInstant = 200000;

ImpulseSide body_side(const Body& body, const ExtendedState& state, const RealVec& point) {
  return {state.twist, point - state.position, body.inverse_mass_x(), body.inverse_mass_y(),
          body.inverse_inertia()};
}

ImpulseSide site_side(const ExtendedState& state, const RealVec& point) {
  return {state.twist, point - state.position, 0.0, 0.0, 0.0};
}

/// Sum of the speeds that a side's velocity at the contact is made of [m/s].
double speed_of(const ImpulseSide& side) {
  return static_cast<double>(side.twist.velocity.lpNorm<1>() + std::abs(side.twist.omega) * side.arm.norm());
}

/// The state now of a motion that has twist `after` and meets the old one, now in `s`, `delay` from now.
ExtendedState deflected(ExtendedState s, const ExtendedTwist& after, Real delay) {
  s.position += delay * (s.twist.velocity - after.velocity);
  s.angle += delay * (s.twist.omega - after.omega);
  s.twist = after;
  return s;
}

/// A contact that a picture shows: its particle is no feature of the outlines, to be looked at more closely.
ExtendedContact as_seen(const FeatureContact& f) {
  return {f.point.cast<Real>(), f.normal.cast<Real>(), f.gap, f.closing_speed};
}

}  // namespace

Contact Kernel::world_contact(const PairKey& pair, const FeatureContact& f) const {
  Contact c;
  c.time = f.time;
  c.body = pair.body;
  c.other_body = pair.other_body;
  c.other_site = pair.other_site;
  c.site = f.site;
  c.sample = f.sample;
  c.sample_on_body = f.sample_on_a;
  c.point = f.point;
  c.normal = f.normal;
  c.closing_speed = f.closing_speed;
  c.gap = f.gap;
  return c;
}

std::string Kernel::name_of(const PairKey& pair) const {
  return fmt::format(
      "'{}' on '{}'", world_.bodies[pair.body].name,
      pair.with_site() ? world_.sites[pair.other_site].name : world_.bodies[pair.other_body].name);
}

/// How a collision is resolved.
struct Kernel::Response {
  ImpulseResult impulse;
  Real delay = 0;             ///< from now to the moment of contact [s]
  ExtendedState body, other;  ///< states now; of the other where its image is
  double magnitude = 0.0;     ///< the largest speed that took part [m/s]
};

double Kernel::note_resolve(int k, int partner, double magnitude) {
  BodyTrack& b = bodies_[k];
  const double rest = b.resolved_at < 0.0 ? std::numeric_limits<double>::infinity() : time_ - b.resolved_at;
  const double rounding = 16.0 * kEpsilon * magnitude;
  // within one instant velocities are differences of larger ones: the largest rounding stays
  b.velocity_rounding =
      std::abs(rest) <= same_instant(time_) ? std::max(b.velocity_rounding, rounding) : rounding;
  b.resolved_at = time_;
  b.streak = b.last_partner == partner ? b.streak + 1 : 1;
  b.last_partner = partner;
  return rest;
}

Real Kernel::delay_to_contact(const FeatureContact& found, const ExtendedContact& c) const {
  if (points_meet_wires_ || !(c.closing > 0)) return 0;
  const Real late = 4.0 * ulp(time_);
  return std::clamp((c.gap - found.level) / c.closing, -late, late);
}

Kernel::Response Kernel::respond(const PairKey& pair, const FeatureContact& found) const {
  Response r;
  r.body = bodies_[pair.body].motion.extended_state(time_);
  r.other = other_state(pair, time_);
  const Outline &outline = outline_of(pair.body), &other_outline = outline_of(other_owner(pair));
  ExtendedContact c = depth_ ? as_seen(found) : contact_in(outline, other_outline, r.body, r.other, found);
  r.delay = depth_ ? Real(0) : delay_to_contact(found, c);
  const ExtendedState body = r.body.moved(r.delay), other = r.other.moved(r.delay);
  if (!depth_) c = contact_in(outline, other_outline, body, other, found);
  const Body& definition = world_.bodies[pair.body];
  const ImpulseSide side = body_side(definition, body, c.point);
  const ImpulseSide other_side = pair.with_site() ? site_side(other, c.point)
                                                  : body_side(world_.bodies[pair.other_body], other, c.point);
  const Material& material = material_of(pair);
  const auto law = reflects_ ? resolve_reflection : resolve_impulse;
  r.impulse = law(side, other_side, c.normal, material);
  r.magnitude = std::max(speed_of(side), speed_of(other_side));
  // an approach that the law does not see was rounding, all of it
  if (r.impulse.kind == ImpulseKind::separating) r.magnitude += std::max(0.0, found.closing_speed) / kEpsilon;
  if (!depth_) {
    const auto [way, way_of_other] = push_apart(pair, found, c.normal);
    r.body.position += way;
    r.other.position += way_of_other;
  }
  return r;
}

/// What has sunk is pushed out again. The sides move as an impulse along the normal would move their centres.
std::pair<RealVec, RealVec> Kernel::push_apart(const PairKey& pair, const FeatureContact& found,
                                               const RealVec& n) const {
  const RealVec none = RealVec::Zero();
  if (!(found.sunk() > 0.0)) return {none, none};
  const auto given = [&](int body) {
    const Body& b = world_.bodies[body];
    return RealVec(b.inverse_mass_x() * n.x(), b.inverse_mass_y() * n.y());
  };
  const RealVec of_body = given(pair.body), of_other = pair.with_site() ? none : given(pair.other_body);
  const Real sum = n.dot(of_body) + n.dot(of_other);
  if (!(sum > 0)) return {none, none};
  const double e = material_of(pair).restitution;
  const Real by = push_of(found.sunk(), found.nominal(), limits_.tolerance, 1.0 - e * e);
  return {of_body * (by / sum), -of_other * (by / sum)};
}

bool Kernel::deflect(const PairKey& pair, const Response& r, std::vector<int>& changed) {
  const Restart both[] = {
      {pair.body, deflected(r.body, r.impulse.body, r.delay)},
      {pair.other_body, deflected(r.other, r.impulse.other, r.delay).shifted(-shift_of(pair))}};
  if (pair.with_site()) return restart_noted({both, 1}, changed);
  const int component = bodies_[pair.body].component;
  if (component >= 0 && component == bodies_[pair.other_body].component) return restart_noted(both, changed);
  return restart_noted({both, 1}, changed) && restart_noted({both + 1, 1}, changed);
}

bool Kernel::restart_noted(std::span<const Restart> touched, std::vector<int>& changed) {
  const int k = touched.front().body, component = bodies_[k].component;
  if (component < 0) {
    changed.push_back(k);
  } else {
    const std::vector<int>& members = components_[component].component.bodies;
    changed.insert(changed.end(), members.begin(), members.end());
  }
  return restart(touched);
}

std::uint64_t Kernel::endless_group() const {
  const std::uint64_t bodies = bodies_in_instant_.count() + 2;  // a row may have ends yet to be reached
  return 2000 + std::min(10 * bodies * bodies, kLongestInstant);
}

void Kernel::count_in_instant(const PairKey& pair) {
  if (time_ - instant_ > 2.0 * same_instant(time_)) {
    instant_ = time_;
    in_instant_ = 0;
    bodies_in_instant_.clear();
  }
  ++in_instant_;
  bodies_in_instant_.add(pair);
}

void Kernel::note_taken(const PairKey& pair, double lost) {
  if (!(lost > 0.0)) return;
  if (taken_.count++ == 0) {
    taken_.first = pair;
    taken_.time = time_;
  }
  taken_.energy += lost;
}

bool Kernel::collapsed() const {
  return !depth_ && in_instant_ > endless_group() && time_ - instant_ <= 2.0 * same_instant(time_);
}

bool Kernel::resolve(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed) {
  if (watched_) hold_to_known(time_);
  if (options_.takes_together() || collapsed()) {
    roll_back_all();
    return resolve_group(pair, found, changed);
  }
  const auto outcome = settle(pair, found, changed);
  return outcome && tell(*outcome);
}

const Material& Kernel::material_of(const PairKey& pair) const {
  const int other =
      pair.with_site() ? world_.sites[pair.other_site].material : world_.bodies[pair.other_body].material;
  return pair_materials_.of(world_, world_.bodies[pair.body].material, other);
}

std::optional<DiscRebound> Kernel::disc_rebound(const PairKey& pair, double level) const {
  if (pair.with_site() || depth_ || reflects_ || points_meet_wires_) return std::nullopt;
  const auto side = [&](int k) {
    const Body& body = world_.bodies[k];
    const bool bare = is_free(k) && is_centred_disc(outline_of(k)) && !body.lock_x && !body.lock_y;
    return DiscSide{bare ? &bodies_[k].motion : nullptr, body.outline->bounding_radius, 1.0 / body.mass};
  };
  const DiscSide a = side(pair.body), b = side(pair.other_body);
  const Material& material = material_of(pair);
  if (!a.motion || !b.motion || a.radius + b.radius == 0.0 || material.friction != 0.0) return std::nullopt;
  return rebound(a, b, shift_of(pair), time_, 4.0 * ulp(time_), level, material.restitution);
}

std::optional<Outcome> Kernel::settle(const PairKey& pair, const FeatureContact& found,
                                      std::vector<int>& changed) {
  if (!check_flight(pair.body, time_) || (!pair.with_site() && !check_flight(pair.other_body, time_)))
    return std::nullopt;
  if (const auto discs = disc_rebound(pair, found.level)) {
    double rest = note_resolve(pair.body, pair.other_body, discs->magnitude);
    rest = std::min(rest, note_resolve(pair.other_body, pair.body, discs->magnitude));
    restart_free(pair.body, discs->a.state, discs->a.low);
    restart_free(pair.other_body, discs->b.state, discs->b.low);
    changed.push_back(pair.body);
    changed.push_back(pair.other_body);
    if (const double depth = -discs->gap; checked_ && depth > allowed_overlap()) {
      report_overlap(pair, depth, time_, "overlaps");
      return std::nullopt;
    }
    return Outcome{pair, found, discs->impulse, 0.0, discs->delay, rest};
  }
  const Response response = respond(pair, found);
  if (checked_ && found.closing_speed < -kPartsOfSpeed * response.magnitude) {
    report_overlap(pair, 0.0, time_, "is said to meet, but parts from");
    return std::nullopt;
  }
  if (response.impulse.kind == ImpulseKind::jam) {
    stop(Termination::failed, fmt::format("{} at t = {:.17g}: neither side can move", name_of(pair), time_));
    return std::nullopt;
  }
  double rest = note_resolve(pair.body, other_owner(pair), response.magnitude);
  if (!pair.with_site()) rest = std::min(rest, note_resolve(pair.other_body, pair.body, response.magnitude));
  if (!deflect(pair, response, changed) || !check_resolved(pair, found, response.delay)) return std::nullopt;
  return Outcome{pair, found, response.impulse.normal, response.impulse.tangential, response.delay, rest};
}

bool Kernel::tell(const Outcome& outcome) {
  const std::uint64_t seq = seq_++;
  last_event_ = std::max(last_event_, time_);
  note_overlap(outcome.contact.gap);
  count_collision(outcome.pair);
  if (records_events()) {
    Event event;
    event.seq = seq;
    event.contact = world_contact(outcome.pair, outcome.contact);
    event.contact.time = last_event_;
    event.contact.time_low = static_cast<double>(time_ - last_event_ + outcome.delay);
    event.impulse_n = outcome.impulse_n;
    event.impulse_t = outcome.impulse_t;
    recorder_->event(event);
  }
  return judge_endings(outcome);
}

void Kernel::record_ending(EventKind kind, const Outcome& outcome, double time) {
  const std::uint64_t seq = seq_++;
  if (!records_events()) return;
  Event event;
  event.seq = seq;
  event.kind = kind;
  event.contact = world_contact(outcome.pair, outcome.contact);
  event.contact.time = time;
  recorder_->event(event);
}

void Kernel::count_collision(const PairKey& pair) {
  ++work_.collisions;
  ++(pair.with_site() ? work_.collisions_body_site : work_.collisions_body_body);
  if (!run_.trace) return;
  run_.trace->mark({TraceKind::collision, pair.body, other_owner(pair), time_, time_});
  if (!pair.with_site()) run_.trace->mark({TraceKind::collision, pair.other_body, pair.body, time_, time_});
}

BounceLoss Kernel::loss_of(const PairKey& pair) const {
  const Material& m = material_of(pair);
  if (reflects_) return m.slip == 1.0 && m.spin == 1.0 ? BounceLoss::none : BounceLoss::some;
  if (m.restitution == 0.0) return BounceLoss::all;
  const bool rubs = m.friction > 0.0 && m.tangential_restitution < 1.0;
  return m.restitution < 1.0 || rubs ? BounceLoss::some : BounceLoss::none;
}

bool Kernel::judge_endings(const Outcome& outcome) {
  const PairKey& pair = outcome.pair;
  // flights lower than a pixel say nothing about a Zeno limit
  const double closing = outcome.contact.closing_speed;
  if (const auto zeno = depth_ ? std::nullopt
                               : zeno_.collided({pair, outcome.contact}, time_, closing, loss_of(pair),
                                                outcome.rest, outcome.contact.sink < 0.0)) {
    record_ending(EventKind::zeno, outcome, zeno->limit_time);
    stop(Termination::failed,
         fmt::format(
             "Zeno at t = {:.15g} after {} bounces of {}: a contact that lasts begins, and those are not in "
             "this release",
             zeno->limit_time, std::max<std::uint64_t>(zeno->bounces, certain(pair.body).streak),
             name_of(pair)));
    return false;
  }
  count_in_instant(pair);
  if (in_instant_ == endless_group() + 1) {
    record_ending(EventKind::group, outcome, last_event_);
  } else if (in_instant_ > 2 * endless_group()) {
    stop(Termination::failed,
         fmt::format("a group of collisions at t = {:.15g} does not end ({} so far, the last {})", time_,
                     in_instant_, name_of(pair)));
    return false;
  }
  if (options_.max_collisions > 0 && work_.collisions >= options_.max_collisions) {
    stop(Termination::stopped,
         fmt::format("max_collisions = {} reached at t = {:.15g}", options_.max_collisions, time_));
    return false;
  }
  return poll();
}

bool Kernel::poll() {
  constexpr std::uint64_t between = 4096;
  const std::uint64_t done = work_.search_iterations + 4 * work_.collisions + 64 * work_.passes + integrated_;
  if (halt_ || (done - polled_ < between && !ask_.due())) return !halt_;
  polled_ = done;
  if (run_.progress && !run_.progress(time_, work_.collisions)) stop(Termination::stopped, "on request");
  return !halt_;
}

namespace {

std::string reason(PairAnswer::Why why, const std::string& pair, double length) {
  switch (why) {
    case PairAnswer::Why::place:
      return fmt::format(
          "{} are close, but too far from the origin, or turned too often, for their gap to be told "
          "to solver.contact_tolerance of the scene's length, {:.3g} m",
          pair, length);
    case PairAnswer::Why::speed:
      return fmt::format(
          "{} are close, but too fast for the clock: they move more than a thousandth of their "
          "size within one instant (7e-15 s, or 32 of its roundings)",
          pair);
    case PairAnswer::Why::steps:
      break;
  }
  return fmt::format("the search for first contact of {} makes no headway", pair);
}

}  // namespace

void Kernel::give_up(const Certificate& c) {
  // all up to there is told
  roll_back_all();
  if (extend_motions(c.time)) {
    record_frames(c.time);
    advance_all(std::max(time_, c.time));
  }
  Event event;
  event.seq = seq_++;
  event.kind = EventKind::undecided;
  event.contact = world_contact(c.pair, c.contact);
  event.contact.time = c.time;
  if (records_events()) recorder_->event(event);
  stop(Termination::failed,
       fmt::format("undecided at t = {:.17g}: {}", c.time, reason(c.why, name_of(c.pair), world_.length())));
}

}  // namespace brink
