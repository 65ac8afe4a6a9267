/// The kernel's beginnings and its motions.
#include "brink/scheduler/kernel/kernel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "brink/core/base/error.h"
#include "brink/core/world/recentred.h"
#include "brink/scheduler/first_contact/tolerances.h"

namespace brink {

namespace {

constexpr double kMostPairs = 1e7;  ///< that are kept at once: 400 MB

/// @throws BadInput where every pair is to be looked at, and there are too many to keep.
void check_pairs(const World& world, const SolverOptions& options) {
  const auto bodies = static_cast<double>(world.bodies.size()),
             sites = static_cast<double>(world.sites.size());
  const double pairs = bodies * (0.5 * bodies + sites);
  if (options.skip_broad_phase || options.policy == "body_clocks" || pairs <= kMostPairs) return;
  throw BadInput(
      fmt::format("solver: skip_broad_phase = false, and {} bodies and {} sites make {:.3g} pairs; allowed "
                  "without a broad phase: up to {:.0e}",
                  bodies, sites, pairs, kMostPairs));
}

/// True if a sharp vertex of one owner may meet a wire without thickness of another.
bool points_may_meet_wires(const std::vector<const Outline*>& outlines, std::size_t bodies) {
  const auto sharp = [](const Outline* o) {
    return std::any_of(o->samples.begin(), o->samples.end(),
                       [](const Sample& s) { return s.arc_site < 0 && s.radius == 0.0; });
  };
  const auto wire = [](const Outline* o) {
    return std::any_of(o->sites.begin(), o->sites.end(),
                       [](const Site& s) { return !s.solid && s.radius == 0.0; });
  };
  const auto end_of_bodies = outlines.begin() + static_cast<std::ptrdiff_t>(bodies);
  return (std::any_of(outlines.begin(), end_of_bodies, sharp) &&
          std::any_of(outlines.begin(), outlines.end(), wire)) ||
         (std::any_of(outlines.begin(), outlines.end(), sharp) &&
          std::any_of(outlines.begin(), end_of_bodies, wire));
}

BodyState held(const Body& body, BodyState s) {
  if (body.lock_x) s.twist.velocity.x() = 0.0;
  if (body.lock_y) s.twist.velocity.y() = 0.0;
  if (body.lock_angle) s.twist.omega = 0.0;
  return s;
}

/// The box of a still site where it stands; empty if it moves, or is everywhere.
Box still_box(const FixedSite& site, bool moves) {
  if (moves || site.outline->container) return {};
  const Box box = transformed(*site.outline, site.pose).bounds;
  return box.grown(1e-12 * (box.low.norm() + box.high.norm()));
}

void raise_version(BodyTrack& b) { b.version = std::max(b.version, b.last_undone) + 1; }

}  // namespace

Kernel::Kernel(World world, SolverOptions options)
    : world_(std::move(world)), options_(std::move(options)), random_(options_.seed) {
  world_.check();
  std::string error;
  if (!options_.is_valid(&error)) throw BadInput(error);
  if (world_.periods.any() && options_.detector != "field")
    throw BadInput("solver: detector = \"" + options_.detector +
                   "\" in a periodic world; allowed there: \"field\"");
  check_pairs(world_, options_);
  limits_.tolerance = options_.contact_tolerance * world_.length();
  limits_.touch = kTouchOfTolerance * limits_.tolerance;
  reflects_ = options_.response == "reflection";
  limits_.closed_forms = options_.skip_closed_forms;
  zeno_ = ZenoWatch(limits_.tolerance);

  for (FixedSite& s : world_.sites) {
    const Vec2 as_written = s.pose.position;
    s = recentred(s);
    frames_moved_.push_back(s.pose.position - as_written);
  }
  for (const Body& b : world_.bodies) outlines_.push_back(b.outline.get());
  for (const FixedSite& s : world_.sites) outlines_.push_back(s.outline.get());
  points_meet_wires_ = points_may_meet_wires(outlines_, world_.bodies.size());
  bodies_.resize(world_.bodies.size());
  for (Component& c : make_components(world_)) add_component(std::move(c));
  work_.component_resets = 0;  // first starts are no resets
  for (const FixedSite& site : world_.sites) {
    sites_.emplace_back(site);
    still_boxes_.push_back(still_box(site, sites_.back().moves()));
  }
  site_failures_.resize(sites_.size());
  make_indices();
  if (options_.detector == "pass") passes_ = std::make_unique<PassRenderer>(options_.field, &work_);
  if (options_.detector == "depth") depth_ = std::make_unique<DepthDetector>(world_, options_, &work_);
}

Kernel::~Kernel() = default;

void Kernel::add_component(Component component) {
  const auto initial = [&](int k) { return held(world_.bodies[k], world_.bodies[k].initial); };
  const Dynamics& dynamics = *component.dynamics;
  const bool closed = options_.integrator == "auto" || options_.integrator == "ballistic";
  if (closed && dynamics.size() == 1 && dynamics.constant() && std::isinf(dynamics.next_break(0.0))) {
    const int k = component.bodies.front();
    const BodyState state = initial(k);
    Acceleration acceleration;
    dynamics.accelerations(0.0, {&state, 1}, {&acceleration, 1});
    bodies_[k].motion = Motion::ballistic(0.0, state, acceleration);
    return;
  }
  std::vector<BodyState> states;
  for (const int k : component.bodies) {
    bodies_[k].component = static_cast<int>(components_.size());
    bodies_[k].place_in_component = static_cast<int>(states.size());
    states.push_back(initial(k));
  }
  Coupled coupled{std::move(component), nullptr, 0.0, {}, {}};
  coupled.integrator =
      make_integrator(options_.integrator, coupled.component.dynamics, options_.integrator_options(), &work_);
  components_.push_back(std::move(coupled));
  start_component(components_.back(), 0.0, std::move(states));
}

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

void Kernel::start_component(Coupled& c, double t, std::vector<BodyState> states) {
  c.started = t;
  c.start_states = std::move(states);
  c.integrator->start(t, c.start_states);
  fetch_motions(c);
  if (std::isfinite(c.failure.time)) {
    c.failure = {};
    find_reach();
  }
  ++work_.component_resets;
}

void Kernel::advance_pair(const PairKey& pair, double t) {
  work_.advances += pair.with_site() ? 1 : 2;
  time_ = t;
  if (!run_.trace) return;
  for (const int k : {pair.body, pair.other_body})
    if (k >= 0) run_.trace->mark({TraceKind::advance, k, -1, std::min(bodies_[k].motion.begin(), t), t});
}

std::vector<BodyState> Kernel::states(double t) const {
  std::vector<BodyState> all;
  all.reserve(bodies_.size());
  for (const BodyTrack& b : bodies_) all.push_back(b.motion.state(t));
  return all;
}

void Kernel::advance_all(double t) {
  if (t > time_) {
    work_.advances += bodies_.size();
    trace_all(TraceKind::advance, time_, t);
  }
  time_ = t;
}

void Kernel::trace_all(TraceKind kind, double from, double to) const {
  if (!run_.trace) return;
  for (int k = 0; k < body_count(); ++k) run_.trace->mark({kind, k, -1, from, to});
}

void Kernel::back_up_all(double t) {
  if (t < time_) {
    work_.backups += bodies_.size();
    work_.body_seconds_thrown_away += (time_ - t) * static_cast<double>(bodies_.size());
    trace_all(TraceKind::back_up, time_, t);
  }
  time_ = t;
}

void Kernel::advance(std::span<const int> bodies, double from, double t) {
  work_.advances += bodies.size();
  time_ = t;
  if (!run_.trace) return;
  for (const int k : bodies) run_.trace->mark({TraceKind::advance, k, -1, from, t});
}

void Kernel::back_up(std::span<const int> bodies, double from, double t) {
  work_.backups += bodies.size();
  work_.body_seconds_thrown_away += (from - t) * static_cast<double>(bodies.size());
  time_ = t;
  if (!run_.trace) return;
  for (const int k : bodies) run_.trace->mark({TraceKind::back_up, k, -1, from, t});
}

void Kernel::restart_free(int k, const BodyState& start, const BodyState& low) {
  bodies_[k].motion.start_anew(time_, start, low);
  raise_version(bodies_[k]);
  ++work_.component_resets;
}

bool Kernel::restart(std::span<const Restart> touched) {
  const BodyTrack& first = bodies_[touched.front().body];
  if (first.component < 0) {
    restart_free(touched.front().body, touched.front().state.rounded(), touched.front().state.low());
    return true;
  }
  Coupled& c = components_[first.component];
  std::vector<BodyState> states;
  for (const int j : c.component.bodies) {
    states.push_back(state(j, time_));
    raise_version(bodies_[j]);
  }
  for (const Restart& r : touched) states[bodies_[r.body].place_in_component] = r.state.rounded();
  start_component(c, time_, std::move(states));
  return true;
}

void Kernel::displace(int k, const Vec2& shift) {
  const Restart moved{k, bodies_[k].motion.extended_state(time_).shifted(shift)};
  restart({&moved, 1});
}

void Kernel::stop(Termination termination, std::string why) {
  if (!halt_) halt_ = Halt{termination, std::move(why)};
}

}  // namespace brink
