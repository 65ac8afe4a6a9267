#include "brink/scheduler/kernel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "brink/core/base/error.h"
#include "brink/core/contacts/impulse.h"
#include "brink/scheduler/broad_phase.h"
#include "brink/scheduler/canonical_time.h"
#include "brink/scheduler/closed_forms.h"
#include "brink/scheduler/stage_clock.h"

namespace brink {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kTouchOfTolerance = 1e-3;  ///< touch / contact tolerance

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

BodyState held(const Body& body, BodyState s) {
  if (body.lock_x) s.twist.velocity.x() = 0.0;
  if (body.lock_y) s.twist.velocity.y() = 0.0;
  if (body.lock_angle) s.twist.omega = 0.0;
  return s;
}

}  // namespace

Kernel::Kernel(World world, SolverOptions options)
    : world_(std::move(world)), options_(std::move(options)), random_(options_.seed) {
  world_.check();
  std::string error;
  if (!options_.is_valid(&error)) throw BadInput(error);
  limits_.tolerance = options_.contact_tolerance * world_.length();
  limits_.touch = kTouchOfTolerance * limits_.tolerance;
  limits_.closed_forms = options_.skip_closed_forms;
  zeno_ = ZenoWatch(limits_.tolerance);

  bodies_.resize(world_.bodies.size());
  for (Component& c : make_components(world_)) {
    Coupled coupled{std::move(c), nullptr, 0.0, {}};
    const int index = static_cast<int>(components_.size());
    std::vector<BodyState> states;
    for (std::size_t i = 0; i < coupled.component.bodies.size(); ++i) {
      BodyTrack& track = bodies_[coupled.component.bodies[i]];
      track.component = index;
      track.place_in_component = static_cast<int>(i);
      const Body& body = world_.bodies[coupled.component.bodies[i]];
      states.push_back(held(body, body.initial));
    }
    coupled.integrator = make_integrator(options_.integrator, coupled.component.dynamics,
                                         options_.integrator_options(), &work_);
    components_.push_back(std::move(coupled));
    start_component(components_.back(), 0.0, std::move(states));
    cover(components_.back(), 0.0);
  }
  work_.component_resets = 0;  // first starts are no resets
  for (const FixedSite& site : world_.sites) sites_.emplace_back(site);
  make_indices();
  if (options_.detector == "pass") passes_ = std::make_unique<PassRenderer>(options_.field, &work_);
}

Kernel::~Kernel() = default;

void Kernel::make_indices() {
  FieldOptions field = options_.field;
  if (!options_.skip_fields) field.brute_force_below = 0;
  std::map<const Outline*, const SiteIndex*> made;
  const auto index_of = [&](const std::shared_ptr<const Outline>& outline) {
    const SiteIndex*& index = made[outline.get()];
    if (!index || !options_.skip_shared_fields) {
      indices_.push_back(make_site_index(outline, field, &work_));
      index = indices_.back().get();
    }
    return index;
  };
  for (const Body& b : world_.bodies) body_index_.push_back(index_of(b.outline));
  for (const FixedSite& s : world_.sites) site_index_.push_back(index_of(s.outline));
}

// -- motions
// --------------------------------------------------------------------------------------------------------

void Kernel::start_component(Coupled& c, double t, std::vector<BodyState> states) {
  c.started = t;
  c.start_states = std::move(states);
  c.integrator->start(t, c.start_states);
  ++work_.component_resets;
}

void Kernel::fetch_motions(const Coupled& c) {
  for (std::size_t i = 0; i < c.component.bodies.size(); ++i)
    bodies_[c.component.bodies[i]].motion = c.integrator->motion(static_cast<int>(i));
}

bool Kernel::cover(Coupled& c, double t) {
  const Extent extent = c.integrator->extend(t);
  if (extent.status == Extent::Status::reached) {
    fetch_motions(c);
    return true;
  }
  stop(Termination::failed,
       fmt::format("motion of '{}' stopped at t = {:.17g}: {}",
                   world_.bodies[c.component.bodies.front()].name, extent.end, extent.why));
  return false;
}

bool Kernel::extend_motions(double t) {
  const StageClock clock(work_.seconds_motion);
  for (Coupled& c : components_)
    if (bodies_[c.component.bodies.front()].motion.end() < t && !cover(c, t)) return false;
  for (std::size_t s = 0; s < sites_.size(); ++s)
    if (const std::string why = sites_[s].extend(t); !why.empty()) {
      stop(Termination::failed, fmt::format("motion of site '{}': {}", world_.sites[s].name, why));
      return false;
    }
  return true;
}

std::vector<BodyState> Kernel::states(double t) const {
  std::vector<BodyState> all;
  all.reserve(bodies_.size());
  for (const BodyTrack& b : bodies_) all.push_back(b.motion.state(t));
  return all;
}

void Kernel::advance_all(double t) {
  if (t > time_) work_.advances += bodies_.size();
  time_ = t;
}

void Kernel::back_up_all(double t) {
  if (t < time_) {
    work_.backups += bodies_.size();
    work_.body_seconds_thrown_away += (time_ - t) * static_cast<double>(bodies_.size());
  }
  time_ = t;
}

// -- passes
// ---------------------------------------------------------------------------------------------------------

const Motion& Kernel::motion_of(int owner) const {
  const int n = body_count();
  return owner < n ? bodies_[owner].motion : sites_[owner - n].motion();
}

const Outline& Kernel::outline_of(int owner) const {
  const int n = body_count();
  return owner < n ? *world_.bodies[owner].outline : *world_.sites[owner - n].outline;
}

std::optional<PairKey> Kernel::pair_of(int a, int b) const {
  const int n = body_count();
  if (a > b) std::swap(a, b);
  if (a >= n || a == b) return std::nullopt;
  return b < n ? PairKey{a, b, -1} : PairKey{a, -1, b - n};
}

Mover Kernel::mover(int body) const {
  return {body_index_[body], &bodies_[body].motion, bodies_[body].velocity_rounding};
}
Mover Kernel::site_mover(int site) const { return {site_index_[site], &sites_[site].motion(), 0.0}; }
Mover Kernel::other_mover(const PairKey& pair) const {
  return pair.with_site() ? site_mover(pair.other_site) : mover(pair.other_body);
}

void Kernel::refresh_boxes(double from, double to, bool all) {
  const int n = body_count();
  if (all) {
    boxes_.resize(owner_count());
    box_versions_.assign(n, 0);
    for (int k = n; k < owner_count(); ++k) {
      const SiteMotion& site = sites_[k - n];
      if (site.moves() || outline_of(k).container) {
        boxes_[k] = swept_box(outline_of(k), site.motion(), from, to);
      } else {  // a still site: its own box, not a disc's
        const Outline placed = transformed(outline_of(k), site.motion().pose(from));
        boxes_[k] = placed.bounds.grown(1e-12 * (placed.bounds.low.norm() + placed.bounds.high.norm()));
      }
    }
  }
  for (int k = 0; k < n; ++k) {
    if (!all && box_versions_[k] == bodies_[k].version) continue;
    boxes_[k] = swept_box(outline_of(k), bodies_[k].motion, from, to);
    box_versions_[k] = bodies_[k].version;
  }
}

std::vector<PairKey> Kernel::near_pairs(double from, double to) {
  ++work_.horizons;
  work_.passes += bodies_.size();
  refresh_boxes(from, to, true);
  std::vector<PairKey> pairs;
  const auto add = [&](int a, int b) {
    if (const auto pair = pair_of(a, b)) pairs.push_back(*pair);
  };
  if (passes_) {
    for (int k = 0; k < body_count(); ++k) {
      const auto seen = pairs_by_pass(k, from, to);
      pairs.insert(pairs.end(), seen.begin(), seen.end());
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  } else if (options_.skip_broad_phase) {
    for (const auto& [a, b] : overlapping_pairs(boxes_)) add(a, b);
  } else {
    for (int a = 0; a < body_count(); ++a)
      for (int b = a + 1; b < owner_count(); ++b) add(a, b);
  }
  return pairs;
}

std::vector<PairKey> Kernel::near_pairs_of(int body, double from, double to) {
  ++work_.passes;
  if (passes_) return pairs_by_pass(body, from, to);
  refresh_boxes(from, to, false);
  std::vector<PairKey> pairs;
  for (int other = 0; other < owner_count(); ++other)
    if (!options_.skip_broad_phase || boxes_[other].overlaps(boxes_[body]))
      if (const auto pair = pair_of(body, other)) pairs.push_back(*pair);
  return pairs;
}

std::vector<PairKey> Kernel::pairs_by_pass(int body, double from, double to) {
  std::vector<PlacedOutline> scene;
  double travel = 0.0;  // of any point of anything else before `to`
  for (int k = 0; k < owner_count(); ++k) {
    scene.push_back({&outline_of(k), motion_of(k).pose(from), static_cast<std::uint32_t>(k)});
    if (k == body) continue;
    const MotionBounds b = motion_of(k).bounds(from, to);
    const double reach =
        outline_of(k).container ? outline_of(k).bounds.extent().norm() : outline_of(k).bounding_radius;
    travel = std::max(travel, (b.speed() + b.spin() * reach) * (to - from));
  }
  const Box window = swept_box(outline_of(body), motion_of(body), from, to);
  std::vector<PairKey> pairs;
  for (const std::uint32_t owner :
       passes_->near_owners(window, travel + limits_.tolerance, scene, static_cast<std::uint32_t>(body))
           .owners)
    if (const auto pair = pair_of(body, static_cast<int>(owner))) pairs.push_back(*pair);
  return pairs;
}

std::optional<Certificate> Kernel::search(const PairKey& pair, double from, double to) {
  const Mover a = mover(pair.body), b = other_mover(pair);
  // of simultaneous resolves one may be a rounding ahead
  from = std::max({from, a.motion->begin(), b.motion->begin()});
  if (from > to) return std::nullopt;
  const PairAnswer answer = first_contact(a, b, from, to, limits_, scratch_, work_);
  if (answer.status == PairAnswer::Status::clear) return std::nullopt;
  Certificate c;
  c.time = answer.until;
  c.pair = pair;
  c.version_body = bodies_[pair.body].version;
  c.version_other = pair.with_site() ? 0 : bodies_[pair.other_body].version;
  c.contact = answer.contact;
  ++work_.certificates_issued;
  if (answer.status == PairAnswer::Status::undecided) {
    c.kind = Certificate::Kind::undecided;
    ++work_.certificates_undecided;
  }
  return c;
}

std::vector<Certificate> Kernel::simultaneous(const Certificate& c) {
  std::vector<Certificate> others;
  const auto features =
      touching_features(mover(c.pair.body), other_mover(c.pair), c.time, limits_.touch, scratch_);
  for (const FeatureContact& f : features) {
    if (f.sample == c.contact.sample && f.sample_on_a == c.contact.sample_on_a) continue;
    if (f.closing_speed <= 1e-12 * c.contact.closing_speed) continue;
    others.push_back(c);
    others.back().contact = f;
  }
  return others;
}

bool Kernel::fresh(const Certificate& c) const {
  return c.version_body == bodies_[c.pair.body].version &&
         (c.pair.with_site() || c.version_other == bodies_[c.pair.other_body].version);
}

std::vector<FeatureContact> Kernel::touching(const PairKey& pair, double tolerance) {
  return touching_features(mover(pair.body), other_mover(pair), time_, tolerance, scratch_);
}

// -- resolving
// ------------------------------------------------------------------------------------------------------

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

bool Kernel::resolve(const PairKey& pair, const FeatureContact& found, std::vector<int>& changed) {
  // The exact moment of contact lies a fraction of a rounding of the clock away. The collision is resolved
  // there, and the new motion is the one that passes through that moment, so that long runs do not drift by
  // roundings of time. Not at a wire without thickness: it is met a little before, and must not be found on
  // its other side.
  const double late = thin(pair, found) ? 0.0 : 4.0 * ulp(time_);
  const double delay =
      found.closing_speed > 0.0 ? std::clamp(found.gap / found.closing_speed, -late, late) : 0.0;
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
  const auto respond = options_.response == "reflection" ? resolve_reflection : resolve_impulse;
  const ImpulseResult result = respond(side, other_side, f.normal, material);
  if (result.kind == ImpulseKind::jam) {
    stop(Termination::failed, fmt::format("{} at t = {:.17g}: neither side can move", name_of(pair), time_));
    return false;
  }

  double magnitude = 0.0;
  for (const ImpulseSide* s : {&side, &other_side})
    magnitude = std::max(magnitude, s->twist.velocity.lpNorm<1>() + std::abs(s->twist.omega) * s->arm.norm());
  if (result.kind == ImpulseKind::separating) magnitude += f.closing_speed / kEpsilon;  // less than it seemed

  std::vector<std::pair<int, Twist>> touched{{pair.body, result.body}};
  if (!pair.with_site()) touched.emplace_back(pair.other_body, result.other);
  std::vector<int> restarted;
  for (const auto& [k, twist] : touched) {
    Coupled& c = components_[bodies_[k].component];
    std::vector<BodyState> states;
    for (const int j : c.component.bodies) {
      states.push_back(this->state(j, time_));
      for (const auto& [i, after] : touched)
        if (i == j) states.back() = deflected(states.back(), after, delay);
    }
    set_rounding(k, magnitude);
    if (std::find(restarted.begin(), restarted.end(), bodies_[k].component) != restarted.end()) continue;
    restarted.push_back(bodies_[k].component);
    start_component(c, time_, std::move(states));
    for (const int j : c.component.bodies) {
      ++bodies_[j].version;
      changed.push_back(j);
    }
  }
  for (const int k : restarted)
    if (!cover(components_[k], time_)) return false;

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

void Kernel::displace(int k, const Vec2& shift) {
  Coupled& c = components_[bodies_[k].component];
  std::vector<BodyState> states;
  for (const int j : c.component.bodies) {
    states.push_back(state(j, time_));
    if (j == k) states.back().pose.position += shift;
  }
  start_component(c, time_, std::move(states));
  cover(c, time_);
  for (const int j : c.component.bodies) ++bodies_[j].version;
}

void Kernel::stop(Termination termination, std::string why) {
  if (!halt_) halt_ = Halt{termination, std::move(why)};
}

}  // namespace brink
