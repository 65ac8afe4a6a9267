#include "brink/scheduler/kernel/contact_search.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "brink/core/query/outline_gap.h"
#include "brink/core/shapes/outline_crossing.h"
#include "brink/core/world/straight_joints.h"
#include "brink/scheduler/first_contact/tolerances.h"
#include "brink/scheduler/kernel/tolerances.h"

namespace brink {

namespace {

/// Arcs cross where they are in each other by more than this part of the lesser size: many roundings.
constexpr double kArcsCross = 1e-9;

bool has_arcs(const Outline& outline) {
  return std::any_of(outline.sites.begin(), outline.sites.end(),
                     [](const Site& s) { return s.kind == SiteKind::arc; });
}

/// True if a sharp vertex of one owner may meet a wire without thickness of another.
/// Two sites never meet, so one of the two must be a body.
bool points_may_meet_wires(const std::vector<const Outline*>& outlines, std::size_t bodies) {
  // a vertex without thickness, and a wire without an inside or a thickness
  const auto sharp = [](const Outline* o) {
    return std::any_of(o->samples.begin(), o->samples.end(),
                       [](const Sample& s) { return s.arc_site < 0 && s.radius == 0.0; });
  };
  const auto wire = [](const Outline* o) {
    return std::any_of(o->sites.begin(), o->sites.end(),
                       [](const Site& s) { return !s.solid && s.radius == 0.0; });
  };
  const auto end_of_bodies = outlines.begin() + static_cast<std::ptrdiff_t>(bodies);
  // a body's vertex at any wire, or any vertex at a body's wire
  return (std::any_of(outlines.begin(), end_of_bodies, sharp) &&
          std::any_of(outlines.begin(), outlines.end(), wire)) ||
         (std::any_of(outlines.begin(), outlines.end(), sharp) &&
          std::any_of(outlines.begin(), end_of_bodies, wire));
}

}  // namespace

/// Not to be copied: b.motion may point to `image` beside it.
struct ContactSearch::Sides {
  std::optional<Motion> image;  ///< of the other, where it is one
  Mover a, b;

  Sides(const ContactSearch& search, const PairKey& pair, const BodyTrack& body, const BodyTrack* other)
      : a(search.mover(pair.body, body)),
        b(other ? search.mover(pair.other_body, *other) : search.mover(search.other_owner(pair))) {
    if (pair.image == Image{}) return;
    image = b.motion->displaced(search.shift_of(pair));
    b.motion = &*image;
  }
  /// On their newest motions.
  Sides(const ContactSearch& search, const PairKey& pair)
      : Sides(search, pair, search.trajectories_->body(pair.body),
              pair.with_site() ? nullptr : &search.trajectories_->body(pair.other_body)) {}
  Sides(const Sides&) = delete;
  Sides& operator=(const Sides&) = delete;
};

/// Cost: an index of each distinct outline, and with it a rendered field where it has many sites.
ContactSearch::ContactSearch(const World& world, const SolverOptions& options,
                             const Trajectories& trajectories, RunControl& run)
    : world_(&world),
      trajectories_(&trajectories),
      run_(&run),
      field_(options.field),
      share_fields_(options.share_fields) {
  // relative to the scene, so that its unit of length does not matter
  limits_.tolerance = options.contact_tolerance * world.length();
  limits_.touch = kTouchOfTolerance * limits_.tolerance;
  limits_.closed_forms = options.closed_forms;
  if (options.fields_for_small_shapes) field_.brute_force_below = 0;
  take_outlines(with_straight_joints(world, limits_.tolerance));
}

/// Who does not meet one of two sites may run against the end of the other.
void ContactSearch::set_filter(PairFilter filter) {
  filter_ = std::move(filter);
  std::vector<std::shared_ptr<const Outline>> given;
  for (const FixedSite& s : world_->sites) given.push_back(s.outline);
  take_outlines(filter_ ? given : with_straight_joints(*world_, limits_.tolerance));
}

void ContactSearch::take_outlines(const std::vector<std::shared_ptr<const Outline>>& of_sites) {
  outlines_.clear();
  indices_of_.clear();
  indices_.clear();
  of_sites_ = of_sites;
  std::map<const Outline*, const SiteIndex*> made;
  const auto add = [&](const std::shared_ptr<const Outline>& outline) {
    const SiteIndex*& index = made[outline.get()];
    // by the outline's address: copies of a body share it. The order of the map is never looked at.
    if (!index || !share_fields_) {
      indices_.push_back(make_site_index(outline, field_, &run_->work()));
      index = indices_.back().get();
    }
    outlines_.push_back(outline.get());
    indices_of_.push_back(index);
  };
  for (const Body& b : world_->bodies) add(b.outline);
  for (const std::shared_ptr<const Outline>& outline : of_sites_) add(outline);
  points_meet_wires_ = points_may_meet_wires(outlines_, world_->bodies.size());
  walls_.clear();
  for (int owner = trajectories_->body_count(); owner < trajectories_->owner_count(); ++owner)
    walls_.push_back(StraightWall::of(outline_of(owner), trajectories_->motion_of(owner)));
}

/// Bodies come first among owners, so of two owners that may meet the lower one is a body.
std::optional<PairKey> ContactSearch::pair_of(int a, int b, const Image& image) const {
  const int n = trajectories_->body_count();
  // the image of b that a meets is seen from b the image of a as far the other way
  if (a > b) return pair_of(b, a, -image);
  if (a >= n || a == b || !may_meet(a, b)) return std::nullopt;
  return b < n ? PairKey{a, b, -1, image} : PairKey{a, -1, b - n, image};
}

/// Of the motion as it is: a held body's twist may be that of its step's end (Trajectories::state_now).
ExtendedState ContactSearch::other_state(const PairKey& pair, double t) const {
  const ExtendedState state = trajectories_->motion_of(other_owner(pair)).extended_state(t);
  return pair.image == Image{} ? state : state.shifted(shift_of(pair));
}

std::string ContactSearch::name_of(const PairKey& pair) const {
  return fmt::format(
      "'{}' on '{}'", world_->bodies[pair.body].name,
      pair.with_site() ? world_->sites[pair.other_site].name : world_->bodies[pair.other_body].name);
}

/// A site counts as held: between it and what an island holds gaps are kept to the tolerance, no better (Mover).
Mover ContactSearch::mover(int owner) const {
  const int n = trajectories_->body_count();
  if (owner < n) return mover(owner, trajectories_->body(owner));
  // no resolve has computed a site's velocity
  return {indices_of_[owner], &trajectories_->site(owner - n).motion(), 0.0, true};
}

/// The certificate names the versions of the two motions: it is stale as soon as one of them ends.
std::optional<Certificate> ContactSearch::search(const PairKey& pair, const BodyTrack& body,
                                                 const BodyTrack* other, double from, double to,
                                                 const Instalment& instalment) {
  if (is_left_out(pair)) return std::nullopt;
  const Sides sides(*this, pair, body, other);
  // of simultaneous resolves one may be a rounding ahead
  from = std::max({from, sides.a.motion->begin(), sides.b.motion->begin()});
  if (from > to) return std::nullopt;
  const double end = std::min(to, std::max(from, instalment.until));
  const TraceScope scope(run_->trace(), {TraceKind::search, pair.body, other_owner(pair), from, end});
  SearchLimits limits = limits_;
  // the answer "undecided" at the cap is what makes an instalment
  if (instalment.most_steps > 0) {
    limits.max_iterations = instalment.most_steps;
    limits.needed_until = instalment.needed_until;
  }
  WorkCounters& work = run_->work();
  const StageTimer::Sampled timed(run_->timer(), work.seconds_search, timed_);
  const PairAnswer* const ahead =
      ahead_
          ? ahead_->answer({pair, body.version, other ? other->version : 0, from, end, instalment.most_steps},
                           instalment.needed_until, work)
          : nullptr;
  PairAnswer answer = ahead ? *ahead : first_contact(sides.a, sides.b, from, end, limits, scratch_, work);
  if (answer.status == PairAnswer::Status::clear) {
    if (end == to) return std::nullopt;
    answer = {PairAnswer::Status::undecided, end, {}};
  }
  Certificate c;
  c.time = answer.until;
  c.pair = pair;
  c.version_body = body.version;
  // a site is never resolved, and has no versions
  c.version_other = other ? other->version : 0;
  c.contact = answer.contact;
  ++work.certificates_issued;
  if (answer.status == PairAnswer::Status::undecided) {
    c.kind = Certificate::Kind::undecided;
    c.why = answer.why;
    ++work.certificates_undecided;
  }
  return c;
}

void ContactSearch::let_help(Helpers* helpers) {
  ahead_ = helpers ? std::make_unique<SearchAhead>(*helpers, limits_) : nullptr;
}

/// Not of two discs, whose closed form is found sooner than handed over, nor of motions that may grow meanwhile, or that
/// an island's step ends.
bool ContactSearch::expect_search(const PairKey& pair, double from, double to, int most_steps) {
  if (!ahead_ || (outline_of(pair.body).is_point() && outline_of(other_owner(pair)).is_point())) return false;
  const BodyTrack& body = trajectories_->body(pair.body);
  const BodyTrack* const other = pair.with_site() ? nullptr : &trajectories_->body(pair.other_body);
  const auto lasts = [](const BodyTrack& b) { return b.component == BodyTrack::kFree; };
  if (!lasts(body) || (other ? !lasts(*other) : !is_on_fixed_site(pair))) return false;
  const Sides sides(*this, pair, body, other);
  from = std::max({from, sides.a.motion->begin(), sides.b.motion->begin()});
  if (from > to) return false;
  return ahead_->expect({pair, body.version, other ? other->version : 0, from, to, most_steps}, sides.a,
                        sides.b);
}

/// Counted if it is told: else search() is asked, and counts.
bool ContactSearch::search_discs(const PairKey& pair, double radius, double other_radius, double from,
                                 double to, DiscContact& contact) {
  WorkCounters& work = run_->work();
  const StageTimer::Sampled timed(run_->timer(), work.seconds_search, timed_);
  const BodyTrack &a = trajectories_->body(pair.body), &b = trajectories_->body(pair.other_body);
  // of simultaneous resolves one may be a rounding ahead
  from = std::max(from, std::max(a.motion.origin(), b.motion.origin()));
  if (from > to) return false;
  const auto meet = [&](const Motion& other) {
    return discs_meet({&a.motion, radius, a.velocity_rounding}, {&other, other_radius, b.velocity_rounding},
                      from, to, limits_, contact);
  };
  if (!(pair.image == Image{} ? meet(b.motion) : meet(b.motion.displaced(shift_of(pair))))) return false;
  ++work.pair_searches;
  ++work.closed_forms;
  ++work.certificates_issued;
  return true;
}

/// Looked at again as the search sees the pair, which may be from its own place: the closed form tells about where the normal is.
FeatureContact ContactSearch::contact_of_discs(const PairKey& pair, double radius, double other_radius,
                                               double time) {
  const BodyTrack &a = trajectories_->body(pair.body), &b = trajectories_->body(pair.other_body);
  const Sides sides(*this, pair, a, &b);
  const FeatureContact like =
      brink::contact_of_discs({sides.a.motion, radius, a.velocity_rounding},
                              {sides.b.motion, other_radius, b.velocity_rounding}, time);
  return contact_at(sides.a, sides.b, time, like, limits_, scratch_);
}

bool ContactSearch::search_wall(const PairKey& pair, double radius, double from, double to,
                                WallContact& contact) {
  WorkCounters& work = run_->work();
  const StageTimer::Sampled timed(run_->timer(), work.seconds_search, timed_);
  const BodyTrack& disc = trajectories_->body(pair.body);
  from = std::max(from, disc.motion.origin());
  if (from > to || !straight_wall_met({&disc.motion, radius, disc.velocity_rounding},
                                      *walls_[pair.other_site], from, to, limits_, contact))
    return false;
  ++work.pair_searches;
  ++work.closed_forms;
  ++work.certificates_issued;
  return true;
}

FeatureContact ContactSearch::contact_with_wall(const PairKey& pair, const WallContact& contact) {
  FeatureContact like;
  like.time = contact.time;
  like.sample = like.site = 0;
  like.normal = contact.normal;
  return contact_at(mover(pair.body), mover(other_owner(pair)), contact.time, like, limits_, scratch_);
}

std::vector<Certificate> ContactSearch::simultaneous(const Certificate& c, const BodyTrack& body,
                                                     const BodyTrack* other) {
  std::vector<Certificate> others;
  const Sides sides(*this, c.pair, body, other);
  // what approaches as slowly as that is rounding of those speeds, and no search finds it
  const double rounding =
      std::max(kApproaches * c.contact.closing_speed, sides.a.velocity_rounding + sides.b.velocity_rounding);
  for (const FeatureContact& f :
       touching_features(sides.a, sides.b, c.time, limits_.touch, limits_, scratch_)) {
    // the found one's sample at any site: a vertex in a corner is one contact here
    if (f.sample == c.contact.sample && f.sample_on_a == c.contact.sample_on_a) continue;
    if (f.closing_speed <= rounding) continue;
    // time and versions of the one that was found: all are one instant
    others.push_back(c);
    others.back().contact = f;
  }
  return others;
}

std::vector<FeatureContact> ContactSearch::touching(const PairKey& pair, double tolerance, double t) {
  const Sides sides(*this, pair);
  return touching_features(sides.a, sides.b, t, tolerance, limits_, scratch_);
}

double ContactSearch::gap(const PairKey& pair, double t, double at_most) {
  const Sides sides(*this, pair);
  return pair_gap(sides.a, sides.b, t, limits_, scratch_, at_most);
}

/// Samples do not see bars that cross, with no vertex of either in the other: boundaries do. Cost: all pairs of
/// sites.
std::optional<Contact> ContactSearch::crossing(const PairKey& pair, double t, double gap) const {
  // the gap of a disc's one sample is the whole distance
  if (outline_of(pair.body).is_point() || outline_of(other_owner(pair)).is_point()) return std::nullopt;
  const ExtendedState at = trajectories_->body(pair.body).motion.extended_state(t),
                      other = other_state(pair, t);
  const Vec2 base = other.position.cast<double>();  // far away, nothing of what is between them is lost
  const Outline &a = outline_of(pair.body), &b = outline_of(other_owner(pair));
  const Pose pose_a = at.seen_from(base).pose, pose_b = other.seen_from(base).pose;
  OutlineCrossing crossing = deepest_crossing(a, pose_a, b, pose_b, gap);
  // of arcs that cross with no end of either in the other
  if (crossing.depth <= 0.0 && (has_arcs(a) || has_arcs(b)))
    if (const OutlineGap seen = outline_gap(a, pose_a, b, pose_b);
        seen.gap < -kArcsCross * std::min(a.bounding_radius, b.bounding_radius))
      crossing = {-seen.gap, seen.point_b, seen.normal};
  if (crossing.depth <= 0.0) return std::nullopt;
  // boundaries that cross name no features: sample and site stay -1
  FeatureContact f;
  f.time = t;
  f.point = base + crossing.point;
  f.normal = crossing.normal;
  f.gap = -crossing.depth;
  return world_contact(pair, f);
}

Contact world_contact(const PairKey& pair, const FeatureContact& f) {
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

}  // namespace brink
