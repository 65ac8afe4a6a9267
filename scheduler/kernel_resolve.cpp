/// The kernel's resolves: one collision at a time, and the endings it cannot pass.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/core/contacts/impulse.h"
#include "brink/scheduler/canonical_time.h"
#include "brink/scheduler/kernel.h"

namespace brink {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Collisions of one instant that are taken to be without end: a row of n touching bodies can need n^2 / 2.
std::uint64_t endless_group(std::size_t bodies) {
  return 2000 + 10 * static_cast<std::uint64_t>(bodies) * bodies;
}

ImpulseSide body_side(const Body& body, const BodyState& state, const Vec2& point) {
  return {state.twist, point - state.pose.position, body.inverse_mass_x(), body.inverse_mass_y(),
          body.inverse_inertia()};
}

ImpulseSide site_side(const BodyState& state, const Vec2& point) {
  return {state.twist, point - state.pose.position, 0.0, 0.0, 0.0};
}

/// Sum of the speeds that a side's velocity at the contact is made of [m/s].
double speed_of(const ImpulseSide& side) {
  return side.twist.velocity.lpNorm<1>() + std::abs(side.twist.omega) * side.arm.norm();
}

/// The state now of a motion that has twist `after` and meets the old one `delay` from now.
BodyState deflected(BodyState s, const Twist& after, double delay) {
  s.pose.position += delay * (s.twist.velocity - after.velocity);
  s.pose.angle += delay * (s.twist.omega - after.omega);
  s.twist = after;
  return s;
}

/// The state a moment later, to first order: for moments shorter than a rounding of the clock.
BodyState moved(BodyState s, double moment) {
  s.pose.position += moment * s.twist.velocity;
  s.pose.angle += moment * s.twist.omega;
  return s;
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

void Kernel::set_rounding(int k, double magnitude) {
  BodyTrack& b = bodies_[k];
  const double rounding = 16.0 * kEpsilon * magnitude;
  // within one instant velocities are differences of larger ones: the largest rounding stays
  b.velocity_rounding = std::abs(time_ - b.resolved_at) <= same_instant(time_)
                            ? std::max(b.velocity_rounding, rounding)
                            : rounding;
  b.resolved_at = time_;
}

bool Kernel::thin(const PairKey& pair, const FeatureContact& f) const {
  const Outline &a = mover(pair.body).outline(), &b = other_mover(pair).outline();
  const Outline &samples = f.sample_on_a ? a : b, &sites = f.sample_on_a ? b : a;
  return !sites.sites[f.site].solid && sites.sites[f.site].radius + samples.samples[f.sample].radius == 0.0;
}

double Kernel::delay_to_contact(const PairKey& pair, const FeatureContact& found) const {
  const double late = thin(pair, found) ? 0.0 : 4.0 * ulp(time_);
  return found.closing_speed > 0.0 ? std::clamp(found.gap / found.closing_speed, -late, late) : 0.0;
}

ImpulseResult Kernel::respond(const PairKey& pair, const FeatureContact& found, double delay,
                              double& magnitude) {
  const Body& body = world_.bodies[pair.body];
  const BodyState state = moved(this->state(pair.body, time_), delay);
  const BodyState other_state = moved(
      pair.with_site() ? site_motion(pair.other_site).state(time_) : this->state(pair.other_body, time_),
      delay);
  const FeatureContact f =
      delay == 0.0 ? found
                   : contact_in(mover(pair.body), other_mover(pair), state, other_state, found, scratch_);
  const ImpulseSide side = body_side(body, state, f.point);
  const ImpulseSide other_side = pair.with_site()
                                     ? site_side(other_state, f.point)
                                     : body_side(world_.bodies[pair.other_body], other_state, f.point);
  const Material material = combined(
      world_, body.material,
      pair.with_site() ? world_.sites[pair.other_site].material : world_.bodies[pair.other_body].material);
  const auto law = options_.response == "reflection" ? resolve_reflection : resolve_impulse;
  const ImpulseResult result = law(side, other_side, f.normal, material);
  magnitude = std::max(speed_of(side), speed_of(other_side));
  // an approach that the law does not see was rounding, all of it
  if (result.kind == ImpulseKind::separating) magnitude += f.closing_speed / kEpsilon;
  return result;
}

bool Kernel::deflect(const PairKey& pair, const ImpulseResult& result, double delay,
                     std::vector<int>& changed) {
  std::vector<std::pair<int, Twist>> touched{{pair.body, result.body}};
  if (!pair.with_site()) touched.emplace_back(pair.other_body, result.other);
  std::vector<int> components;
  for (const auto& [k, twist] : touched)
    if (components.empty() || components.front() != bodies_[k].component)
      components.push_back(bodies_[k].component);
  for (const int index : components) {
    Coupled& c = components_[index];
    std::vector<BodyState> states;
    for (const int j : c.component.bodies) {
      states.push_back(this->state(j, time_));
      for (const auto& [k, after] : touched)
        if (k == j) states.back() = deflected(states.back(), after, delay);
    }
    start_component(c, time_, std::move(states));
    if (!cover(c, time_)) return false;
    for (const int j : c.component.bodies) {
      ++bodies_[j].version;
      changed.push_back(j);
    }
  }
  return true;
}

bool Kernel::resolve(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed) {
  const double delay = delay_to_contact(pair, found);
  double magnitude = 0.0;
  const ImpulseResult result = respond(pair, found, delay, magnitude);
  if (result.kind == ImpulseKind::jam) {
    stop(Termination::failed, fmt::format("{} at t = {:.17g}: neither side can move", name_of(pair), time_));
    return false;
  }
  set_rounding(pair.body, magnitude);
  if (!pair.with_site()) set_rounding(pair.other_body, magnitude);
  if (!deflect(pair, result, delay, changed)) return false;

  Event event;
  event.seq = seq_++;
  event.contact = world_contact(pair, found);
  event.contact.time = last_event_ = std::max(last_event_, time_);
  event.impulse_n = result.normal;
  event.impulse_t = result.tangential;
  note_overlap(found.gap);
  count_collision(pair);
  if (recorder_ && run_.record_events) recorder_->event(event);
  return judge_endings(pair, event.contact);
}

void Kernel::count_collision(const PairKey& pair) {
  ++work_.collisions;
  ++(pair.with_site() ? work_.collisions_body_site : work_.collisions_body_body);
}

bool Kernel::judge_endings(const PairKey& pair, const Contact& contact) {
  if (const auto zeno = zeno_.collided(pair, time_, contact.closing_speed)) {
    Event event;
    event.seq = seq_++;
    event.kind = EventKind::zeno;
    event.contact = contact;
    event.contact.time = zeno->limit_time;
    if (recorder_ && run_.record_events) recorder_->event(event);
    stop(Termination::failed,
         fmt::format(
             "Zeno at t = {:.15g} after {} bounces of {}: a contact that lasts begins, and those are not in "
             "this release",
             zeno->limit_time, zeno->bounces, name_of(pair)));
    return false;
  }
  if (time_ - instant_ > 2.0 * same_instant(time_)) {
    instant_ = time_;
    in_instant_ = 0;
  }
  if (++in_instant_ > endless_group(bodies_.size())) {
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
  const std::uint64_t done = work_.search_iterations + 4 * work_.collisions;
  if (halt_ || done - polled_ < between) return !halt_;
  polled_ = done;
  if (run_.progress && !run_.progress(time_, work_.collisions)) stop(Termination::stopped, "on request");
  return !halt_;
}

void Kernel::give_up(const Certificate& c) {
  Event event;
  event.seq = seq_++;
  event.kind = EventKind::undecided;
  event.contact = world_contact(c.pair, c.contact);
  event.contact.time = c.time;
  if (recorder_ && run_.record_events) recorder_->event(event);
  stop(Termination::failed,
       fmt::format("undecided at t = {:.17g}: the search for first contact of {} makes no headway "
                   "(is something too fast for the clock?)",
                   c.time, name_of(c.pair)));
}

}  // namespace brink
