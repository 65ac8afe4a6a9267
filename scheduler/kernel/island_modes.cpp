#include "brink/scheduler/kernel/island_modes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "brink/core/query/gap_bound.h"
#include "brink/core/query/outline_gap.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/scheduler/kernel/states_apart.h"
#include "brink/scheduler/kernel/tolerances.h"

namespace brink {

namespace {

/// Integration steps of one island's step, at most.
constexpr int kMostPieces = 256;
/// Looks at whole outlines along each of them.
constexpr int kLooks = 8;
/// A closed contact's gap may be off by this part of the contact tolerance inside a step, or of what it keeps.
constexpr double kOff = 0.25;
/// Places are rounded to this part of what counts as a touch, at most; and that is no more than so much of the contact tolerance.
constexpr double kRounding = 0.1, kMostTouch = 0.05;
/// An approach slower than this part of the speeds that take part is rounding.
constexpr double kNoApproach = 1e-11;
/// A parting, after an impact.
/// Of the same speeds; a contact that parts no faster stays closed.
constexpr double kNoParting = 1e-9;

/// Two features that touch within this part of the smaller size of each other are at one place.
constexpr double kOnePlace = 1e-6;
/// A vertex that turns by less than this is a joint.
constexpr double kTurns = 1e-6;

/// False for a joint of two pieces that hardly turns, or turns away from what may touch it.
bool is_corner(const Outline& outline, const Sample& sample) {
  // a straight joint, or the bottom of a notch
  if (sample.hollow) return false;
  // an arc's sample is no joint
  if (sample.arc_site >= 0) return true;
  // a solid lies on the left of its outline: only a turn to the left sticks out of it
  if (sample.before >= 0 && sample.after >= 0)
    return cross(direction_at_end(outline.sites[sample.before]),
                 direction_at_start(outline.sites[sample.after])) > kTurns;
  // before and after are of solids (outline.h): a wire's neighbours are looked for by their ends
  const Site *in = nullptr, *out = nullptr;  // of a wire
  for (const Site& s : outline.sites) {
    if (s.kind == SiteKind::point) continue;
    if (s.b == sample.p) in = &s;
    if (s.a == sample.p) out = &s;
  }
  // an end, a bend to either side, or a tip at which the wire turns back
  return !in || !out || std::abs(cross(direction_at_end(*in), direction_at_start(*out))) > kTurns ||
         direction_at_end(*in).dot(direction_at_start(*out)) < 0.0;
}

/// True of an arc's sample, if the arc ends at that place.
bool ends_at(const Outline& outline, const Sample& sample, const Vec2& place) {
  if (sample.arc_site < 0) return false;
  const Site& arc = outline.sites[sample.arc_site];
  return arc.a == place || arc.b == place;
}

/// The polynomial that goes on from a state with its twist, for ever.
PolynomialPiece onward(double t, const BodyState& s) {
  PolynomialPiece piece;
  piece.begin = piece.origin = t;
  piece.end = std::numeric_limits<double>::infinity();
  piece.degree = 1;
  piece.c[0] << s.pose.position, s.pose.angle;
  piece.c[1] << s.twist.velocity, s.twist.omega;
  return piece;
}

}  // namespace

IslandModes::IslandModes(const IslandMembers& members, Trajectories& trajectories,
                         const ContactSearch& search, CollisionResponse& response, const Limits& limits,
                         const WarmContacts& warm)
    : members_(&members),
      trajectories_(&trajectories),
      search_(&search),
      response_(&response),
      limits_(limits),
      warm_(&warm) {}

double IslandModes::slowest_bounce(const IslandMembers& members, const ContactSearch& search) {
  // what rebounds with it rises by v^2 / 2 a, which is the tolerance
  return std::sqrt(2.0 * members.pull() * search.limits().tolerance);
}

bool IslandModes::is_slow(const IslandMembers& members, const ContactSearch& search,
                          const HeldContact& contact, double speed, double times) {
  if (speed <= times * slowest_bounce(members, search)) return true;
  // what slides round in a hollow, or is carried by what turns, is held with no force, or a small one
  const double fall = members.fall(contact);
  return fall > 0.0 && speed <= times * std::sqrt(2.0 * fall * search.limits().tolerance);
}

bool IslandModes::is_shadow(const ContactSearch& search, const HeldContact& c,
                            const std::vector<HeldContact>& all) {
  const Outline &a = search.outline_of(c.pair.body), &b = search.outline_of(search.other_owner(c.pair));
  const Outline &carrier = c.feature.sample_on_a ? a : b, &other = c.feature.sample_on_a ? b : a;
  const Sample& sample = carrier.samples[c.feature.sample];
  const bool sharp = sample.radius + other.sites[c.feature.site].radius == 0.0;
  const double tolerance = search.limits().tolerance;
  // it has no direction, but in a corner in which it cannot pass by
  if (c.feature.at_end && sharp && c.feature.gap <= tolerance) return !c.feature.no_way_by;
  const bool corner = is_corner(carrier, sample);
  // a corner over the inside of a site: nothing says it better
  if (corner && !c.feature.at_end) return false;
  // two places of a round sample that both touch, to the tolerance, where the normal is one
  const double place = std::max(kOnePlace * std::min(a.bounding_radius, b.bounding_radius),
                                corner ? std::sqrt(8.0 * sample.radius * tolerance) : 0.0);
  const auto is_near = [&](const HeldContact& o) {
    Vec2 apart = o.feature.point - c.feature.point;
    if (!(o.pair == c.pair))  // of fixed sites, which are the same at all times
      apart += (search.other_state(o.pair, 0.0).position - search.other_state(c.pair, 0.0).position)
                   .cast<double>();
    return apart.norm() <= place;
  };
  return std::any_of(all.begin(), all.end(), [&](const HeldContact& o) {
    if (o.feature.at_end || o.feature.gap > tolerance) return false;
    // a floor may be made of several sites
    const bool of_floor = corner && o.pair.body == c.pair.body && search.is_on_fixed_site(o.pair) &&
                          search.is_on_fixed_site(c.pair);
    if (!(o.pair == c.pair) && !of_floor) return false;
    // The same corner over the inside of another site; of a joint that is none, an arc that ends there; or, with the roles
    // exchanged, the other's corner there.
    if (o.feature.sample_on_a == c.feature.sample_on_a)
      return corner ? o.feature.sample == c.feature.sample && is_near(o)
                    : !o.feature.beside_arc && ends_at(carrier, carrier.samples[o.feature.sample], sample.p);
    return o.pair == c.pair && is_near(o) && is_corner(other, other.samples[o.feature.sample]);
  });
}

double IslandModes::speed() const {
  // of the fastest point, or of a fall by the size: not 0 where nothing moves yet
  return std::max(members_->speed(), std::sqrt(members_->pull() * members_->size()));
}

/// True if it is so of a contact at the place of this one that has the roles of the two corners exchanged.
template <class Is>
bool IslandModes::any_of_other_corner(const HeldContact& c, const std::vector<HeldContact>& all,
                                      Is&& is) const {
  const double place =
      kOnePlace * std::min(search_->outline_of(c.pair.body).bounding_radius,
                           search_->outline_of(search_->other_owner(c.pair)).bounding_radius);
  return std::any_of(all.begin(), all.end(), [&](const HeldContact& o) {
    return o.pair == c.pair && o.feature.sample_on_a != c.feature.sample_on_a &&
           (o.feature.point - c.feature.point).norm() <= place && is(o.feature);
  });
}

IslandModes::Fit IslandModes::fit() const {
  const std::size_t most =
      members_->are_constant() ? limits_.contacts : std::max(limits_.contacts, kContactsOfChanging);
  if (most == 0 || members_->count() > kModeBodies) return Fit::too_large;
  // far from the origin gaps cannot be kept any more
  if (least_touch() > kMostTouch * search_->limits().tolerance) return Fit::unsuited;
  const std::vector<HeldContact> near = members_->contacts(search_->limits().tolerance);
  const auto counts = [&](const HeldContact& c) {
    return !is_shadow(*search_, c, near) && !is_told_by_other_corner(c, near);
  };
  if (near.size() > most && static_cast<std::size_t>(std::count_if(near.begin(), near.end(), counts)) > most)
    return Fit::too_large;
  // rolling resistance has no mode here, and between corners roundings choose the side
  const bool any_unsuited = std::any_of(near.begin(), near.end(), [&](const HeldContact& c) {
    return (is_corner_on_corner(c) &&
            !any_of_other_corner(c, near, [](const NearFeature& f) { return !f.at_end; })) ||
           response_->material_of(c.pair).rolling_resistance > 0.0;
  });
  return any_unsuited ? Fit::unsuited : Fit::suited;
}

/// True of one of two flush corners, each of which lies on the other's side: they are one contact.
bool IslandModes::is_told_by_other_corner(const HeldContact& c, const std::vector<HeldContact>& all) const {
  return c.feature.no_way_by && !c.feature.sample_on_a &&
         any_of_other_corner(c, all, [](const NearFeature& f) { return f.no_way_by; });
}

/// True of one of two corners at one place of which each lies on a side of the other, where that of the other counts: which it
/// has lain on, or else to which forces press more. And of the one of two sides of a corner on which the other has not lain.
bool IslandModes::is_told_by_other_side(const HeldContact& c) const {
  if (!c.feature.upon_corner || c.feature.at_end) return false;
  const auto was_closed = [&](const HeldContact& contact) {
    const HeldContact* warm = warm_->find(contact);
    return warm && warm->by_modes && is_closed(warm->motion);
  };
  const auto pull_on = [&](int body) -> Vec2 {
    const int place = members_->place_of(body);
    return members_->is_support(place) ? Vec2(Vec2::Zero()) : members_->acceleration(place).linear;
  };
  Vec2 pull = pull_on(c.pair.body);
  if (!c.pair.with_site()) pull -= pull_on(c.pair.other_body);
  const double place =
      kOnePlace * std::min(search_->outline_of(c.pair.body).bounding_radius,
                           search_->outline_of(search_->other_owner(c.pair)).bounding_radius);
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const HeldContact& o) {
    const NearFeature& f = o.feature;
    if (!(o.pair == c.pair) || !f.upon_corner || f.at_end || !((f.point - c.feature.point).norm() <= place))
      return false;
    const bool exchanged = f.sample_on_a != c.feature.sample_on_a;
    // the same corner over the other side of the one that it is upon
    if (!exchanged && (f.sample != c.feature.sample || f.site == c.feature.site)) return false;
    if (was_closed(o) != was_closed(c)) return was_closed(o);
    const double presses = pull.dot(c.feature.normal) - pull.dot(f.normal);
    return exchanged && (presses > 0.0 || (presses == 0.0 && f.sample_on_a));
  });
}

/// Places are doubles in modes: what touches is told from what does not by some of their roundings at least [m].
double IslandModes::least_touch() const {
  double farthest = 0.0;
  for (int i = 0; i < static_cast<int>(members_->count()); ++i)
    farthest = std::max(farthest, members_->state(i).position.cast<double>().norm());
  return std::max(search_->limits().touch, kEpsilon * farthest / kRounding);
}

/// A sharp corner at another: which side meets which is told in their place by roundings alone.
bool IslandModes::is_corner_on_corner(const HeldContact& c) const {
  if (!c.feature.at_end || c.feature.no_way_by) return false;
  const Outline &a = search_->outline_of(c.pair.body), &b = search_->outline_of(search_->other_owner(c.pair));
  const Outline &carrier = c.feature.sample_on_a ? a : b, &other = c.feature.sample_on_a ? b : a;
  const Sample& sample = carrier.samples[c.feature.sample];
  const Site& site = other.sites[c.feature.site];
  if (sample.radius + site.radius > 0.0 || !is_corner(carrier, sample)) return false;
  // where the two are, in the frame of the site's owner
  const ExtendedState of_b = members_->other_state(c.pair),
                      owner = c.feature.sample_on_a ? of_b : members_->state(members_->place_of(c.pair.body));
  const Vec2 place =
      Frame(Pose{{0.0, 0.0}, owner.seen_from(Vec2::Zero()).pose.angle})
          .direction_to_local(c.feature.point + (of_b.position - owner.position).cast<double>());
  const Vec2& end = (place - site.a).squaredNorm() < (place - site.b).squaredNorm() ? site.a : site.b;
  return std::any_of(other.samples.begin(), other.samples.end(),
                     [&](const Sample& s) { return s.arc_site < 0 && s.p == end && is_corner(other, s); });
}

// ---- the problem

bool IslandModes::touches(const HeldContact& c) const {
  const double tolerance = search_->limits().tolerance;
  const HeldContact* warm = warm_->find(c);
  const bool was_closed = warm && warm->by_modes && is_closed(warm->motion);
  // A closed gap keeps what it had to a quarter of the tolerance: one that began at the tolerance must not
  // open by that.
  return c.feature.gap <= (was_closed ? 2.0 : 1.0) * tolerance;
}

/// Features may have several shapes: first the one where the sample is now, then others that it may come to
/// (smooth_contacts). Each is a contact of the problem. `place_` leads from a contact to its present shape, `of_`
/// back from each shape; only the present one can be touching.
void IslandModes::add_contact(const HeldContact& c) {
  // two corners at one place lie on each other by one side
  told_by_other_.push_back(is_told_by_other_side(c));
  if (told_by_other_.back()) {
    place_.push_back(std::numeric_limits<std::size_t>::max());
    return;
  }
  const int a = members_->place_of(c.pair.body);
  const Outline &of_a = search_->outline_of(c.pair.body),
                &of_b = search_->outline_of(search_->other_owner(c.pair));
  int b = 0;
  if (c.pair.with_site()) {
    // one support for each contact, though several may be on one site
    b = problem_.bodies() + static_cast<int>(problem_.supports.size());
    problem_.supports.push_back(trajectories_->site(c.pair.other_site).motion());
  } else {
    b = members_->place_of(c.pair.other_body);
  }
  // A shadow that touches says what another contact says; one that is apart may come to be met by itself.
  // So may an arc that does not face the site yet: its gap is that of its end.
  const bool shadow = !c.feature.beside_arc && is_shadow(*search_, c, contacts_),
             touching = !shadow && !c.feature.beside_arc && touches(c);
  const Vec2 shift = search_->shift_of(c.pair);
  // what a shadow touches now is looked at already, what it may come to is not: a corner that slides on an arc may lie down
  const bool told = c.feature.goes_on || (shadow && c.feature.gap <= search_->limits().tolerance);
  place_.push_back(problem_.contacts.size());
  bool present = true;
  const Outline& carrier = c.feature.sample_on_a ? of_a : of_b;
  const Outline& other = c.feature.sample_on_a ? of_b : of_a;
  const bool of_wire = !carrier.solid && carrier.samples[c.feature.sample].arc_site >= 0;
  // each shape has the friction of the contact, and keeps its gap while it is closed
  for (SmoothContact& shape :
       smooth_contacts(c.feature, of_a, members_->state(a), of_b, members_->other_state(c.pair))) {
    // of the sample's owner against the site's: the image is the other owner's, whichever of the two that
    // is
    shape.offset = c.feature.sample_on_a ? Vec2(-shift) : shift;
    // Two points meet nobody: a side is met before. Nor does a wire's arc meet a corner, which meets the arc, on its own side.
    const bool points = shape.kind == SmoothContact::Kind::circle &&
                        shape.radius + (of_wire ? 0.0 : shape.sample_radius) == 0.0;
    // Of two wires' arcs on one circle the ends and joints say all that there is to say, a quarter turn apart at most; the way
    // between their centres, which is next to none, may turn as it likes.
    const bool of_one_circle = of_wire && !other.solid && shape.kind == SmoothContact::Kind::circle &&
                               shape.hollow &&
                               shape.radius - shape.sample_radius <= search_->limits().tolerance;
    if ((present && told) || points || of_one_circle) {
      if (present) place_.back() = std::numeric_limits<std::size_t>::max();
      present = false;
      continue;
    }
    ModeContact made;
    made.shape = shape;
    made.sample_owner = c.feature.sample_on_a ? a : b;
    made.site_owner = c.feature.sample_on_a ? b : a;
    made.friction = response_->material_of(c.pair).friction;
    // a closed contact keeps the gap that it has; at a wire, which has no inside, never less than a touch
    const bool deep = c.feature.gap < -search_->limits().tolerance;  // as the scene has it
    made.kept = deep ? c.feature.gap : std::max(c.feature.gap, c.feature.thin ? touch_ : 0.0);
    // what begins nearer than a touch, or sunk by less than a tolerance, and opens, has not closed by that
    if (c.feature.thin) {
      made.off = kOff * made.kept;
      made.closes_at = std::clamp(c.feature.gap, -search_->limits().tolerance, touch_);
    }
    // what a sample is not abreast of now it may go by
    made.passes = c.feature.at_end || !present;
    problem_.contacts.push_back(made);
    of_.push_back(place_.size() - 1);
    // a shape that the sample may come to is apart, however near it is
    touching_.push_back(present && touching);
    // the first shape is where the sample is; the others are what it may come to
    present = false;
  }
  if (present) place_.back() = std::numeric_limits<std::size_t>::max();  // it has no one shape
}

/// It holds no states: these change at one time, as what meets meets, and are given with each question.
void IslandModes::make_problem(std::vector<HeldContact> contacts, double h) {
  contacts_ = std::move(contacts);
  problem_ = {};
  touch_ = least_touch();
  impacts_.clear();
  of_.clear();
  place_.clear();
  touching_.clear();
  told_by_other_.clear();
  for (int i = 0; i < static_cast<int>(members_->count()); ++i) {
    const Body& b = members_->body(i);
    problem_.inverse_mass.emplace_back(b.inverse_mass_x(), b.inverse_mass_y(), b.inverse_inertia());
  }
  // of the smallest member: what errors are parts of
  problem_.size = members_->size();
  for (int i = 0; i < static_cast<int>(members_->count()); ++i)
    problem_.jump = std::min(problem_.jump, members_->next_break(i));
  for (const HeldContact& c : contacts_)
    if (c.pair.with_site())
      problem_.jump =
          trajectories_->site(c.pair.other_site).even_until(now_, std::min(problem_.jump, now_ + h));
  problem_.before_jump = std::nextafter(problem_.jump, now_);
  problem_.free = [this](double t, std::span<const BodyState> states, std::span<Acceleration> out) {
    trajectories_->accelerations(members_->bodies(), problem_.before(t), states, out);
  };
  for (const HeldContact& c : contacts_) add_contact(c);
}

// ---- its beginning

/// By the fastest approach of what touches. Velocities are of the sample's owner against the site's: < 0
/// approaches.
IslandModes::Approach IslandModes::approach(const States& states) const {
  const std::vector<ContactRates> rates = rates_at(problem_, now_, states);
  Approach how = Approach::none;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    const double closing = -rates[k].normal_velocity;
    if (!touching_[k] || closing <= kNoApproach * speed()) continue;
    // a slow one is told from a bounce by what it would rise: to four times the tolerance at twice the speed
    if (!is_slow(*members_, *search_, contacts_[of_[k]], closing, 2.0)) return Approach::fast;
    how = Approach::slow;
  }
  return how;
}

/// Everything that touches meets without a rebound. False: nothing says how.
bool IslandModes::meet(States& states) {
  const std::vector<ContactRates> rates = rates_at(problem_, now_, states);
  auto after = plastic_impact(problem_, now_, states, touching_);
  if (!after) return false;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const std::size_t at = place_[k];
    // what is slower is the end of a series of bounces and no event of its own
    if (at < rates.size() && touching_[at] &&
        !is_slow(*members_, *search_, contacts_[k], -rates[at].normal_velocity, 1.0))
      impacts_.push_back(
          {contacts_[k], -rates[at].normal_velocity, after->normal[at], after->tangential[at]});
  }
  states = std::move(after->states);
  return true;
}

/// True of what was apart where the step before began, or beyond an end, and has come to touch without an approach: over a smooth
/// joint, say.
bool IslandModes::has_come(const HeldContact& c) const {
  const HeldContact* warm = warm_->find(c);
  if (!warm || !warm->by_modes || is_closed(warm->next_motion)) return false;
  const NearFeature& before = warm->feature;
  return before.beside_arc || before.goes_on || (before.at_end && !c.feature.at_end) ||
         before.gap > search_->limits().tolerance;
}

/// Those that the step before ended in, if they speak of all that touches.
/// They are void where a contact that touches is new, or where one that was closed does not touch any more.
std::optional<std::vector<MotionMode>> IslandModes::former_modes() const {
  std::vector<MotionMode> modes(problem_.contacts.size(), MotionMode::open);
  std::ptrdiff_t closed = 0;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (place_[k] >= modes.size() || !touching_[place_[k]]) continue;
    const HeldContact* warm = warm_->find(contacts_[k]);
    // new, or not from a step by modes: what it does is to be chosen
    if (!warm || !warm->by_modes || has_come(contacts_[k])) return std::nullopt;
    modes[place_[k]] = warm->next_motion;
    closed += is_closed(warm->next_motion);
  }
  // one that was closed and no longer touches has come apart in another way: the former modes are void
  const auto were_closed = std::count_if(warm_->begin(), warm_->end(), [](const HeldContact& w) {
    return !w.by_modes || is_closed(w.next_motion);
  });
  if (closed != were_closed) return std::nullopt;
  return modes;
}

/// What touches and does not part. Where it meets slowly, or is new, what parts as slowly does not, either: bounces,
/// and the rocking from one corner to the other, come to their end there.
std::vector<bool> IslandModes::closed_now(const States& states, Approach how) const {
  const std::vector<ContactRates> rates = rates_at(problem_, now_, states);
  std::vector<bool> closed(problem_.contacts.size(), false);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const std::size_t at = place_[k];
    if (at >= closed.size() || !touching_[at]) continue;
    const HeldContact* warm = warm_->find(contacts_[k]);
    const bool known = warm && warm->by_modes && !has_come(contacts_[k]),
               was_open = known && !is_closed(warm->motion);
    const bool slowly = how == Approach::slow || (how == Approach::none && !known);
    // open in the step before and touching still: it has just been let go, and only an approach closes it
    if (how == Approach::none && was_open) continue;
    const double parting = rates[at].normal_velocity;
    closed[at] =
        slowly ? is_slow(*members_, *search_, contacts_[k], parting, 2.0) : parting <= kNoParting * speed();
  }
  return closed;
}

// ---- the step

/// States are rounded to double here: fit() has seen that gaps can be kept so.
IslandModes::Outcome IslandModes::take(double now, double h, std::vector<HeldContact> contacts,
                                       bool on_time) {
  now_ = end_ = now;
  double until = now + h;
  States states;
  for (int i = 0; i < static_cast<int>(members_->count()); ++i) {
    states.push_back(members_->state(i).rounded());
    // no integration step may lead over a change too short for it to see
    until = std::min(until, trajectories_->steady_until(members_->bodies()[i]));
  }
  make_problem(std::move(contacts), h);
  until = std::min(until, problem_.jump);
  // such a step is lost in the rounding of the clock
  if (!(until > now)) return Outcome::none;
  const Approach how = approach(states);
  if (how != Approach::none && !meet(states)) return Outcome::none;
  // Where what meets slowly does not stay, as a corner that comes down beside an arc that rolls into it, it parts by that impact.
  arrived_ = -1;
  if (!go_on_from(states, how, until, on_time) &&
      !(how == Approach::slow && go_on_from(states, Approach::fast, until, on_time)) &&
      !go_on_with_arrived(states, how, until))
    return Outcome::none;
  if (!within_reach()) return Outcome::wider;
  return keeps_apart() ? Outcome::moved : Outcome::none;
}

/// From after the impact, if there was one. False: it leads nowhere.
bool IslandModes::go_on_from(const States& states, Approach how, double until, bool on_time) {
  ModeMotion motion(problem_, {limits_.tolerance, kOff * search_->limits().tolerance, touch_, until - now_},
                    now_, states);
  // after an impact velocities are others, and with them modes
  const auto former = on_time && how == Approach::none ? former_modes() : std::nullopt;
  if (!(former ? motion.begin_in(*former) : motion.begin(closed_now(states, how)))) return false;
  begun_ = motion.states();
  return move_on(motion, until) && begins_where_members_are();
}

/// True if the motion begins where the members are, to the contact tolerance: nobody is moved onto contacts.
bool IslandModes::begins_where_members_are() const {
  for (int i = 0; i < static_cast<int>(members_->count()); ++i)
    if (!(states_apart(motion(i).extended_state(now_), members_->state(i), members_->bounding_radius(i)) <=
          search_->limits().tolerance))
      return false;
  return true;
}

/// What arrives right where the step begins touches by then: at a joint that is met to the bit the next arc does not face the site
/// yet, but for a rounding.
bool IslandModes::go_on_with_arrived(const States& states, Approach how, double until) {
  if (arrived_ < 0 || touching_[arrived_]) return false;
  touching_[arrived_] = true;
  return go_on_from(states, how, until, false);
}

ExtendedState IslandModes::let_go(int member) const {
  ExtendedState s = members_->state(member);
  const Twist before = s.twist.rounded(), &after = begun_[member].twist;
  if (after.velocity != before.velocity || after.omega != before.omega) s.twist = ExtendedTwist(after);
  return s;
}

/// Modes and forces from the present time on.
void IslandModes::note(const ModeMotion& motion) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    HeldContact& c = contacts_[k];
    // what it does is to be chosen where it comes to count
    c.by_modes = !told_by_other_[k];
    if (place_[k] >= motion.modes().size()) continue;
    c.motion = c.next_motion = motion.modes()[place_[k]];
    c.normal_force = motion.forces().normal[place_[k]];
    c.tangential_force = motion.forces().tangential[place_[k]];
  }
}

/// To `until`, or to the first event. False: it leads nowhere. Each track is pieces of the integration, then one
/// that goes on for ever with the last twist.
bool IslandModes::move_on(ModeMotion& motion, double until) {
  tracks_.clear();
  for (std::size_t i = 0; i < members_->count(); ++i) tracks_.push_back(std::make_shared<Track>());
  ModeStep step;
  for (int n = 0; n < kMostPieces && motion.time() < until; ++n) {
    // modes may change at the beginning without time going on: the last ones are the step's
    if (!(motion.time() > now_)) note(motion);
    step = motion.step(until);
    for (std::size_t i = 0; i < step.pieces.size(); ++i) tracks_[i]->pieces.push_back(step.pieces[i]);
    // A change ends the island's step: it is an event, from which the next step begins. So does what takes long: in between a
    // signal is heard. Before time goes on modes may be chosen again; any other end leads nowhere.
    const bool chosen_again = step.end == ModeEnd::change && !(motion.time() > now_);
    if (step.end != ModeEnd::step && !chosen_again) break;
  }
  end_ = motion.time();
  if (!(end_ > now_)) {
    if (step.end == ModeEnd::arrival) arrived_ = step.contact;
    return false;
  }
  const bool lost = step.end == ModeEnd::no_modes || step.end == ModeEnd::lost;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    HeldContact& c = contacts_[k];
    c.lasted = end_ - now_;
    const bool arrives = step.end == ModeEnd::arrival && of_[step.contact] == k;
    // its next mode is not known: the next step chooses anew (former_modes)
    if (lost || arrives) c.by_modes = false;
    if (place_[k] >= motion.modes().size()) continue;
    c.next_motion = motion.modes()[place_[k]];
    // those that it began with, in the mode that it had; what presses at the end alone belongs to the island, too
    // (IslandMotion::pushes)
    if (c.normal_force > 0.0) continue;
    c.normal_force = motion.forces().normal[place_[k]];
    c.tangential_force = motion.forces().tangential[place_[k]];
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    // a held motion has no end (Trajectories::follow_own)
    tracks_[i]->pieces.push_back(onward(end_, motion.states()[i]));
  return true;
}

/// True if nobody moves farther than features were listed for.
bool IslandModes::within_reach() const {
  for (int i = 0; i < static_cast<int>(members_->count()); ++i) {
    double way = 0.0;
    for (const PolynomialPiece& p : tracks_[i]->pieces) {
      // the last one has no end (onward)
      if (!(p.end <= end_)) break;
      // bounds, not the ends: a quintic may swing out between them
      const MotionBounds b = p.bounds(p.begin, p.end);
      way += (p.end - p.begin) * (b.speed() + b.spin() * members_->bounding_radius(i));
    }
    if (way > members_->reach_of(i)) return false;
  }
  return true;
}

/// True if no pair of members is deeper in each other than it was, to the contact tolerance, at some places along each piece
/// of the motion: a look at whole outlines, at features that nobody listed as well.
bool IslandModes::keeps_apart() const {
  std::set<double> looks;
  for (const auto& track : tracks_)
    for (const PolynomialPiece& p : track->pieces)
      for (int k = 1; k <= kLooks && p.end <= end_; ++k)
        looks.insert(k == kLooks ? p.end : p.begin + k * (p.end - p.begin) / kLooks);
  const std::vector<PairKey> pairs = members_->near_pairs(-1.0);
  return std::all_of(pairs.begin(), pairs.end(), [&](const PairKey& pair) {
    const double least = std::min(0.0, gap(pair, now_)) - search_->limits().tolerance;
    return std::all_of(looks.begin(), looks.end(), [&](double t) { return gap(pair, t) >= least; });
  });
}

/// Of the pair as it moves in this step [m]; at most a bound below it, where that is more than 0.
double IslandModes::gap(const PairKey& pair, double t) const {
  const auto pose_of = [&](int body) { return motion(members_->place_of(body)).pose(t); };
  const Pose body = pose_of(pair.body);
  Pose other =
      pair.with_site() ? trajectories_->site(pair.other_site).motion().pose(t) : pose_of(pair.other_body);
  other.position += search_->shift_of(pair);
  const Outline &a = search_->outline_of(pair.body), &b = search_->outline_of(search_->other_owner(pair));
  const double bound = gap_at_least(a, body, b, other, 0.0);
  return bound > 0.0 ? bound : outline_gap(a, body, b, other).gap;
}

std::vector<double> IslandModes::gaps_at_end() const {
  std::vector<double> gaps;
  for (const HeldContact& c : contacts_) {
    const auto state_of = [&](int body) { return motion(members_->place_of(body)).extended_state(end_); };
    const ExtendedState other = c.pair.with_site()
                                    ? search_->other_state(c.pair, end_)
                                    : state_of(c.pair.other_body).shifted(search_->shift_of(c.pair));
    gaps.push_back(gap_of(c.feature, search_->outline_of(c.pair.body), state_of(c.pair.body),
                          search_->outline_of(search_->other_owner(c.pair)), other));
  }
  return gaps;
}

/// Of contacts that a step by modes had closed before. One that was open, or is new, has met: that is an impact.
std::vector<IslandModes::Change> IslandModes::changes() const {
  std::vector<Change> changes;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const HeldContact& c = contacts_[k];
    const HeldContact* warm = warm_->find(c);
    if (!warm || !warm->by_modes || warm->motion == c.motion || !is_closed(warm->motion)) continue;
    if (c.motion == MotionMode::stick) changes.push_back({c, EventKind::stick});
    if (is_slip(c.motion)) changes.push_back({c, EventKind::slip});
    if (!is_closed(c.motion)) changes.push_back({c, EventKind::lift});
  }
  return changes;
}

}  // namespace brink
