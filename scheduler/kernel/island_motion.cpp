#include "brink/scheduler/kernel/island_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "brink/core/base/limits.h"
#include "brink/scheduler/islands/tolerances.h"
#include "brink/scheduler/kernel/island_joining.h"
#include "brink/scheduler/kernel/step_places.h"
#include "brink/scheduler/kernel/step_rows.h"

namespace brink {

namespace {

/// A step lasts this part of the time in which the smallest member falls by its size ...
constexpr double kOfFall = 0.05;
/// ... and moves nobody by more than this part of it.
constexpr double kOfSize = 0.1;
/// Steps until a corner is beside another are so many ticks at least.
constexpr double kTicksOfCorner = 1024.0;
/// However slow all are, a step is no longer [s]: what sites do in it is followed beforehand.
constexpr double kLongestStep = 100.0;
/// Features are listed as far as bodies come in so many steps; where impulses take one farther, so many times as far as that.
/// By modes a list reaches so many times as far for all.
constexpr double kReach = 2.0, kWider = 4.0;
/// At most so many times.
constexpr int kWidenings = 6;
/// Where forces balance now, and will not for long, nothing tells how far they lead: a wider list reaches to this part of the
/// smallest member's size first.
constexpr double kUnforeseen = 1e-3;
/// A list reaches to 512 times the guess. Where that does not do, a step is halved, down to 2^-16 of its length.
constexpr double kFarthest = 512.0;
constexpr int kHalvings = 16;
/// Impacts of one instant inside an island, at most; what closes then is taken as plastic.
constexpr std::size_t kFirstImpacts = 100, kImpactsEach = 20;
/// No tolerance makes a step shorter than this part of what it would be.
constexpr double kShortest = 1e-4;
/// A step has held still what is slower than this part of the speed that falling for as long gives; its friction is then within
/// cones a little wider (kWidened).
constexpr double kHeld = 1e-11;
/// Halving a step makes its change of velocity fall to this part at most, if forces make it.
/// What forces change goes with the step, so half is left at most; what an impact changes stays: 3/4 lies between.
constexpr double kFalls = 0.75;
/// A step that an impact cuts to less than this part is cut short.
constexpr double kWorthwhile = 0.25;
/// Forces that change with place, velocity or time may change by this part of the largest pull that a step so long may have
/// in half of it, and are asked for again until they do by a millionth of that; each time they come nearer by half at least.
constexpr double kChanges = 0.1, kForcesAgree = 1e-6, kComesNearer = 0.5;
constexpr int kForcePasses = 30;
/// Two normals are opposite where their cosine is below minus this.
constexpr double kOpposite = 1.0 - 1e-6;
/// A step under such forces is no longer than so many times the one before.
constexpr double kLonger = 2.0;

}  // namespace

/// It is used once, for one instant, in this order: who joins, impacts, then rest or a step, and who stays
/// together. `h_` is the length that is looked ahead by, and in the end that of the step; `contacts_` are the
/// features of the last look, with forces once there are some.
IslandMotion::IslandMotion(IslandMembers members, const ContactSearch& search, CollisionResponse& response,
                           ConeQp& solver, IslandTally& tally, WarmContacts warm, GoOn go_on)
    : members_(std::move(members)),
      search_(&search),
      response_(&response),
      solver_(&solver),
      tally_(&tally),
      at_rest_(members_.count(), 0),
      warm_(std::move(warm)),
      go_on_(go_on ? std::move(go_on) : GoOn([] { return true; })) {}

/// Of the members as they are now: impacts change speeds, and with them the answer.
double IslandMotion::longest() const {
  const double pull = members_.pull(), speed = members_.speed();
  // the time of the fall is sqrt(2 size / pull): but for the root of 2
  const double fall = pull > 0.0 ? kOfFall * std::sqrt(members_.size() / pull) : kForever;
  const double way = speed > 0.0 ? std::min(kOfSize * members_.size() / speed, kLongestStep) : kForever;
  return std::min(fall, way);
}

double IslandMotion::even_for(double h) {
  members_.look_ahead(h, kReach);
  return members_.even_for(h);
}

std::vector<int> IslandMotion::joining(const World& world, Trajectories& trajectories, double now) {
  h_ = longest();
  // no step will be taken, so nobody is met in one
  if (!(h_ < kForever)) return {};
  members_.look_ahead(h_, kReach);
  // an agitated island takes impacts where its step begins, so it takes in who comes fast, too
  return brink::joining(
      world, trajectories, *search_, members_, now, h_,
      [this](const PairKey& pair) { return agitated_ ? kForever : most_absorbed(pair); }, go_on_);
}

/// Lists features anew, up to a gap of `reach` [m]; < 0: as far as the step may lead (IslandMembers::contacts).
/// What a step absorbs is found anew with them.
void IslandMotion::list(double reach) {
  const bool along_step = reach < 0.0 && !by_modes_;
  contacts_ = along_step ? members_.contacts_and_brought(go_on_) : members_.contacts(reach, go_on_);
  remember_sides(0);
  drop_contradicted();
  // what an arc may roll to counts along a step alone: until then its end tells all
  std::erase_if(contacts_, [&](const HeldContact& c) {
    return (c.feature.beside_arc && reach >= 0.0) || (c.feature.goes_on && reach >= 0.0) ||
           (c.feature.over_hump && by_modes_);
  });
  absorbed_ = 0.0;
}

/// A corner of wire that is upon the end of another wire which lies along one of its sides is on either side of that by a rounding.
/// Where the end's own contact, or another's at that place, pushes against what was chosen, the two would squeeze the wire.
void IslandMotion::drop_contradicted() {
  const double one_place = search_->limits().tolerance;
  const auto contradicts = [&](const NearFeature& other, const NearFeature& f) {
    return other.thin && !other.upon_corner && (other.point - f.point).norm() <= one_place &&
           other.normal.dot(f.normal) < -kOpposite;
  };
  const auto is_contradicted = [&](const HeldContact& c) {
    return c.feature.thin && c.feature.upon_corner &&
           std::any_of(contacts_.begin(), contacts_.end(), [&](const HeldContact& o) {
             return o.pair == c.pair && contradicts(o.feature, c.feature);
           });
  };
  if (std::none_of(contacts_.begin(), contacts_.end(), is_contradicted)) return;
  std::vector<HeldContact> kept;
  for (const HeldContact& c : contacts_)
    if (!is_contradicted(c)) kept.push_back(c);
  contacts_ = std::move(kept);
}

/// Those who come farther with these velocities than features are listed: theirs, as far as they come several times. Not of
/// one who would go beyond all measure: the step is to be shorter then.
void IslandMotion::list_farther(const std::vector<Vec3>& velocity) {
  std::vector<char> far(members_.count(), 0);
  for (int i = 0; i < static_cast<int>(members_.count()); ++i) {
    const double way = way_in_step(i, velocity);
    const double most = std::max(kFarthest * members_.guess_of(i), kOfSize * members_.size());
    if (way <= members_.reach_of(i) || way > most) continue;
    far[i] = 1;
    members_.look_farther(i, kWider * way);
  }
  if (std::find(far.begin(), far.end(), 1) == far.end()) return;
  std::set<ContactKey> listed;
  for (const HeldContact& c : contacts_) listed.insert(c.key());
  const std::size_t known = contacts_.size();
  for (const HeldContact& c : members_.contacts_of(far, go_on_))
    if (listed.insert(c.key()).second) contacts_.push_back(c);
  remember_sides(known);
  rows().add(contacts_, problem_);
}

// ---- impacts of this instant

/// While something closes too fast to be taken as plastic, the fastest collides by its own law, and the contacts of
/// its two bodies are looked at again. Cost of an impact: a look at one number of each contact for the fastest, and
/// a closing speed for each contact of the two.
void IslandMotion::pass_on_impacts(const Impact& told) {
  // what a step would absorb, and what would arrive in it, depends on its length
  h_ = longest();
  // of an agitated island what would meet within a step, of any other what touches
  members_.look_ahead(agitated_ ? h_ : 0.0, kReach);
  list(agitated_ ? -1.0 : search_->limits().tolerance);
  // after an impact only contacts of its two bodies close differently: the others are not asked again
  std::vector<std::vector<std::size_t>> contacts_of(members_.count());
  const auto each_member = [&](const HeldContact& c, auto&& visit) {
    const auto [a, b] = members_.members_of(c.pair);
    visit(a);
    if (b != a) visit(b);
  };
  std::vector<Vec3> velocity = members_.velocities();
  std::vector<double> impact;  // how fast each contact closes that is an impact now
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (!go_on_()) return;
    impact.push_back(impact_of(contacts_[k], velocity));
    each_member(contacts_[k], [&](int member) { contacts_of[member].push_back(k); });
  }
  // Impacts of one instant may go on without end (a body between two others): what is left then is
  // plastic.
  for (std::size_t n = 0; n < kFirstImpacts + kImpactsEach * contacts_.size(); ++n) {
    const auto fastest = std::max_element(impact.begin(), impact.end());
    if (fastest == impact.end() || !(*fastest > 0.0) || !go_on_()) break;
    const HeldContact& c = contacts_[static_cast<std::size_t>(fastest - impact.begin())];
    collide(c, *fastest, told);
    // taken before it came: it would have cut the step
    impacts_in_step_ = impacts_in_step_ || !approach().touches(c);
    each_member(c, [&](int member) { velocity[member] = as_vector(members_.state(member).twist.rounded()); });
    each_member(c, [&](int member) {
      for (const std::size_t k : contacts_of[member]) impact[k] = impact_of(contacts_[k], velocity);
    });
  }
  // set_twist() leaves them to be found, and the length of the step comes from them
  members_.find_speeds();
}

/// How fast the two close if that is an impact now [m/s], else 0: they touch, or are to meet within the step of an
/// agitated island, and faster than a step takes as plastic.
double IslandMotion::impact_of(const HeldContact& c, const std::vector<Vec3>& velocity) const {
  const double closing = members_.closing_speed(c);
  if (c.feature.beside_arc || c.feature.goes_on || absorbs(c, closing)) return 0.0;
  if (!approach().touches(c))
    return !approach().is_kept_by_corner(c, contacts_) && approach().arrival(c, velocity, h_).time < h_
               ? closing
               : 0.0;
  // at a joint of two floors the tangent at an end bars the way to what slides over it
  if (approach().passes_by(c, velocity, 0.0, closing)) return 0.0;
  // by modes another contact says better what a shadow says: one impact for one place
  return by_modes_ && IslandModes::is_shadow(*search_, c, contacts_) ? 0.0 : closing;
}

/// A member as the impulse law sees it; locks are in its inverse masses. `arm`: contact point minus centre of mass
/// [m].
ImpulseSide IslandMotion::side_of(int member, const RealVec& arm) const {
  const Body& b = members_.body(member);
  return {members_.state(member).twist, arm, b.inverse_mass_x(), b.inverse_mass_y(), b.inverse_inertia()};
}

bool IslandMotion::any_impacts() {
  h_ = longest();
  members_.look_ahead(0.0, kReach);
  list(search_->limits().tolerance);
  const std::vector<Vec3> velocity = members_.velocities();
  return std::any_of(contacts_.begin(), contacts_.end(),
                     [&](const HeldContact& c) { return impact_of(c, velocity) > 0.0; });
}

/// One impact in extended precision. Twists change, places do not. A site yields to nothing: its inverse masses are
/// 0.
void IslandMotion::collide(const HeldContact& c, double closing, const Impact& told) {
  const int a = members_.place_of(c.pair.body);
  const int b = c.pair.with_site() ? -1 : members_.place_of(c.pair.other_body);
  const RealVec other_arm = c.feature.point.cast<Real>();
  const ExtendedState other = members_.other_state(c.pair);
  // the feature's point is seen from the other's position: it is that side's arm
  const ImpulseResult r =
      resolve_impulse(side_of(a, members_.arm(c)),
                      b < 0 ? ImpulseSide{other.twist, other_arm, 0.0, 0.0, 0.0} : side_of(b, other_arm),
                      c.feature.normal.cast<Real>(), response_->material_of(c.pair));
  // find_speeds() is due: the caller does so once, after the last impact
  members_.set_twist(a, r.body);
  if (b >= 0) members_.set_twist(b, r.other);
  told(c, other.position, closing, r);
}

// ---- rest

bool IslandMotion::rests(double rest_speed) {
  const double tolerance = search_->limits().tolerance, pull = members_.pull(), speed = members_.speed();
  // An implicit step of 2 v / a can stop it, and moves nobody by more than v * 2 v / a: within the
  // tolerance.
  const bool fades = 2.0 * speed * speed <= tolerance * pull;
  if (!(pull > 0.0) || !(fades || speed <= rest_speed)) return false;
  const int count = static_cast<int>(members_.count());
  // forces that change with time or place would have to be balanced ever anew
  if (!members_.are_constant()) return false;
  // the forces that are found are noted as means over so long (take_forces)
  h_ = longest();
  members_.look_ahead(0.0, kReach);
  // Of many, what will carry them comes closer for ever, each time by a part: so near it holds.
  list(members_.count() > kFewMembers ? std::max(tolerance, kHolds * members_.size()) : tolerance);
  for (const HeldContact& c : contacts_)
    // who stands on a site that moves is not at rest
    if (members_.on_moving_site(c)) return false;
  if (!go_on_()) return false;
  make_problem();
  if (fades && !can_stop(tolerance)) return false;
  if (!stays_at_rest(*solver_, problem_, go_on_)) {
    // A step has held many still by the friction that sweeps found, which is off by some hundredths of the largest force: it
    // would hold them for ever.
    const bool held = count > static_cast<int>(kFewMembers) && !warm_.empty() && speed <= kHeld * pull * h_;
    if (!held) return false;
    for (IslandContact& c : problem_.contacts) c.friction *= kWidened;
    if (!stays_at_rest(*solver_, problem_, go_on_)) return false;
    // told as that of steps is: by how much friction is beyond its cone, of the largest force
    double beyond = 0.0, most = 0.0;
    for (const IslandContact& c : problem_.contacts) {
      most = std::max(most, c.normal_force);
      beyond = std::max(beyond, std::abs(c.tangential_force) - c.friction / kWidened * c.normal_force);
    }
    if (most > 0.0) tally_->friction_residual = std::max(tally_->friction_residual, beyond / most);
  }
  take_forces();
  // what fades is less than the tolerance times a weight; what the option rest_speed stops may be more,
  // and is told
  if (!fades) tally_->energy_of_rest += kinetic_energy();
  // to the bit: what is still has no search and no step (Motion::is_still)
  for (int i = 0; i < count; ++i) members_.set_twist(i, ExtendedTwist());
  return true;
}

/// True if contacts can take what is left of the members' speed within `way` [m]: where nothing holds it, as on ice, it does not
/// fade, however slow. What forces would hide in a rounding of them is nothing.
bool IslandMotion::can_stop(double way) {
  const double speed = members_.speed(), pull = members_.pull();
  if (speed * speed <= kNoForce * pull * way) return true;
  IslandStep stopping = problem_;
  for (std::size_t i = 0; i < members_.count(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!std::isinf(stopping.mass[i][k]))
        stopping.force[i][k] += stopping.mass[i][k] * problem_.velocity[i][k] * speed / way;
  return stays_at_rest(*solver_, stopping, go_on_);
}

/// Of all members [J].
double IslandMotion::kinetic_energy() const {
  double twice = 0.0;
  for (int i = 0; i < static_cast<int>(members_.count()); ++i) {
    const Twist v = members_.state(i).twist.rounded();
    twice += members_.body(i).mass * v.velocity.squaredNorm() + members_.body(i).inertia * v.omega * v.omega;
  }
  return 0.5 * twice;
}

// ---- steps

/// Modes decide how long the step is. It is tried again only where a member left the features that were listed.
bool IslandMotion::take(IslandModes& modes, double now, double h, bool on_time) {
  if (!by_modes_ || !(h < kForever)) return false;
  double reach = kReach, least = 0.0;
  for (int widening = 0; widening <= kWidenings; ++widening, reach *= kWider) {
    h_ = h;
    members_.look_ahead(h_, reach);
    for (int i = 0; i < static_cast<int>(members_.count()); ++i) members_.look_farther(i, least);
    least = std::max(kUnforeseen * members_.size(), kWider * least);
    list(-1.0);
    const IslandModes::Outcome outcome = modes.take(now, h, contacts_, on_time);
    // farther than features were listed: with a longer list, from the same states
    if (outcome == IslandModes::Outcome::wider) continue;
    if (outcome == IslandModes::Outcome::none) return false;
    // with the modes and forces that they have from here on
    contacts_ = modes.contacts();
    gaps_at_end_ = modes.gaps_at_end();
    h_ = modes.end() - now;
    return true;
  }
  return false;
}

/// Tries until a step is accepted: one that ends at an impact, one short enough for `tolerance`, one of half the
/// length where there is no solution.
bool IslandMotion::take(double h, double tolerance) {
  // from here on the length of the step says which approach is plastic (most_absorbed)
  by_modes_ = false;
  contacts_.clear();
  if (!(h < kForever)) return true;  // nothing moves or pulls: nobody needs anybody
  double change_before = kForever;
  if (!members_.are_constant()) h = std::min(h, kLonger * expected_);
  const double shortest = kShortest * h, pull = members_.pull();
  // h^2 a / 2 = tolerance for a body that falls: what places may be off in a step that begins at rest
  if (tolerance > 0.0 && pull > 0.0) h = std::clamp(std::sqrt(2.0 * tolerance / pull), shortest, h);
  // the length that is tried and the list of features go together
  const auto look = [&](double step) {
    h_ = step;
    members_.look_ahead(h_, kReach);
    list(-1.0);
  };
  const double worthwhile = kWorthwhile * h;
  // Each turn returns, or shortens the step, and that ends: `shortest` bounds what the tolerance asks for, kHalvings
  // the others.
  for (int halving = 0; halving <= kHalvings && go_on_();) {
    look(asked_ = h);
    if (const double off = corners_part_in(shortest); off < h) look(h = off);
    if (const double first = next_arrival(); first < h) {  // an impact ends the step
      impacts_in_step_ = impacts_in_step_ || first < worthwhile;
      // up to the impact, with which the next step begins; features are listed for the shorter way
      if (!agitated_) look(h = first);
    }
    make_problem();
    const auto gaps = [this](const std::vector<Vec3>& velocity) -> GapAlong {
      return [this, places = StepPlaces(members_, velocity)](std::size_t k, double later) mutable {
        return places.gap(contacts_[k], later) - approach().kept(contacts_[k].feature);
      };
    };
    const StepOutcome outcome = take_under_forces(gaps);
    closes_in_ = outcome.no_room ? site_that_closes_in() : -1;
    // work is counted of every try, all else of the step that is taken
    tally_->factorisations += outcome.factorisations;
    // looked at after the solver: contacts may hand on more speed than anybody had
    const bool within = outcome.solved && stays_within_reach();
    // what forces change falls with the step; what does not is an impact
    // Half of what the change of velocity moves it is what a place may be off.
    const double change = within ? change_of_speed() : 0.0, off = 0.5 * h_ * change;
    if (tolerance > 0.0 && off > tolerance && h_ > shortest && change <= kFalls * change_before) {
      change_before = change;
      // off goes with the square of the step; at least halved, so that it ends
      h = std::max(h_ * std::clamp(0.9 * std::sqrt(tolerance / off), 0.1, 0.5), shortest);
      continue;
    }
    if (within) {
      tally_->friction_residual = std::max(tally_->friction_residual, outcome.friction_residual);
      tally_->energy_won += outcome.won;
      tally_->absorbed = std::max(tally_->absorbed, absorbed_);
      take_forces();
      return true;
    }
    ++halving;
    h *= 0.5;
  }
  return false;
}

/// Of the sites that move the one that comes deepest into where somebody is in the step, or -1.
int IslandMotion::site_that_closes_in() const {
  int site = -1;
  double deepest = -kForever;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    if (!members_.on_moving_site(contacts_[k])) continue;
    const IslandContact& c = problem_.contacts[k];
    const double deep = h_ * c.normal_support - std::max(c.gap, 0.0);
    if (deep > deepest) site = contacts_[k].pair.other_site, deepest = deep;
  }
  return site;
}

/// When the first feature comes that closes too fast to be taken as plastic [s]; infinity: none. What touches
/// has been dealt with.
double IslandMotion::next_arrival() {
  double first = kForever;
  const std::vector<Vec3> velocity = members_.velocities();
  for (const HeldContact& c : contacts_) {
    if (!go_on_()) break;
    if (c.feature.beside_arc || c.feature.goes_on) continue;
    const FeatureArrival come = approach().touches(c) ? FeatureArrival{0.0, members_.closing_speed(c)}
                                                      : approach().arrival(c, velocity, h_);
    if (!(come.time <= h_)) continue;
    if (!approach().touches(c) && !absorbs(c, come.closing) && !approach().is_kept_by_corner(c, contacts_))
      // too fast to be taken as plastic: an impact within the step
      first = std::min(first, come.time);
    else
      // plastic in this step, and told (IslandTally::absorbed)
      absorbed_ = std::max(absorbed_, come.closing);
  }
  return first;
}

/// When the first corner that lies on another is beside it [s], if the members go on as they do now: which of their sides meet is
/// another thing then. Infinity: none moves, or none was in a step before that was longer than `shortest`: each has one short step.
double IslandMotion::corners_part_in(double shortest) const {
  if (members_.count() > kModeBodies) return kForever;  // all its steps are of first order
  const std::vector<Vec3> velocity = members_.velocities();
  double first = kForever;
  for (const HeldContact& c : contacts_) {
    const HeldContact* before = warm_.find(c);
    if (!before || before->lasted < shortest) continue;  // once
    first = std::min(first, approach().corner_parts_in(c, velocity));
  }
  // not so soon that the clock cannot tell
  return std::max(first, kTicksOfCorner * std::numeric_limits<double>::epsilon() * std::abs(members_.now()));
}

/// With a row for each contact that is listed, in their order: take_forces() leads back by place.
void IslandMotion::make_problem() {
  problem_ = rows().members_alone();
  rows().add(contacts_, problem_);
}

/// Approaches as slow as this are taken without a rebound [m/s].
double IslandMotion::most_absorbed(const PairKey& pair) const {
  return bounces_by_modes(pair) ? IslandModes::slowest_bounce(members_, *search_)
                                : rows().most_absorbed(pair);
}

bool IslandMotion::bounces_by_modes(const PairKey& pair) const {
  return by_modes_ && response_->material_of(pair).restitution > 0.0;
}

/// The same of one contact.
bool IslandMotion::absorbs(const HeldContact& c, double closing) const {
  return closing <= most_absorbed(c.pair) ||
         (bounces_by_modes(c.pair) && IslandModes::is_slow(members_, *search_, c, closing, 1.0));
}

/// A step of h_ under the forces that its members have halfway, with the twists of the step: these are found by asking for them
/// again with what they make, until that changes nothing. So a step wins nothing from a spring, as it wins nothing from
/// gravity: what it takes is the force's work along its way. Not solved where forces change by so much in the step that
/// they do not come to an end, or that an explicit look at them says little.
StepOutcome IslandMotion::take_under_forces(const GapsAlong& gaps) {
  const auto solve = [&] {
    return take_step(*solver_, problem_, h_, search_->limits().tolerance, gaps, go_on_,
                     [this](const std::vector<Vec3>& velocity) { list_farther(velocity); });
  };
  if (members_.are_constant()) return solve();
  const std::vector<Vec3> before = problem_.velocity, at_start = problem_.force;
  const double most = kOfFall * kOfFall * members_.size() / (h_ * h_);  // longest() has no larger pull
  StepOutcome outcome;
  double last = kForever;
  for (int pass = 0; pass < kForcePasses; ++pass) {
    const int so_far = outcome.factorisations;
    outcome = solve();
    outcome.factorisations += so_far;
    if (!outcome.solved) return outcome;
    const IslandMembers::Halfway halfway = members_.accelerations_halfway(h_, problem_.velocity);
    std::vector<Vec3> along = forces_of(members_, halfway.along);
    const double off = largest_change(members_, along, problem_.force);
    if (largest_change(members_, along, at_start) > kChanges * most || off > kComesNearer * last) break;
    if (off <= kForcesAgree * most) return outcome;
    last = off;
    problem_.velocity = before;
    problem_.force = std::move(along);
    problem_.spending = forces_of(members_, halfway.there);
  }
  outcome.solved = false;
  return outcome;
}

/// The farthest that any point of it comes [m].
double IslandMotion::way_in_step(int member, const std::vector<Vec3>& velocity) const {
  return h_ * speed_within(as_twist(velocity[member]), members_.bounding_radius(member));
}

/// True if nobody moves farther than features were listed for.
bool IslandMotion::stays_within_reach() const {
  for (int i = 0; i < static_cast<int>(members_.count()); ++i)
    if (!(way_in_step(i, problem_.velocity) <= members_.reach_of(i)))
      return false;  // no number is not within
  return true;
}

/// The most that the step changes the velocity of any member's points [m/s].
double IslandMotion::change_of_speed() const {
  double most = 0.0;
  for (int i = 0; i < static_cast<int>(members_.count()); ++i) {
    const Vec3 change = problem_.velocity[i] - as_vector(members_.state(i).twist.rounded());
    most = std::max(most, change.head<2>().norm() + std::abs(change[2]) * members_.bounding_radius(i));
  }
  return most;
}

/// From the problem back to the contacts, which come into order: means over the step, with which the next one starts.
void IslandMotion::take_forces() {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    contacts_[k].normal_force = problem_.contacts[k].normal_force;
    contacts_[k].tangential_force = problem_.contacts[k].tangential_force;
    contacts_[k].lasted = h_;
  }
  std::vector<std::size_t> by_order(contacts_.size());
  std::iota(by_order.begin(), by_order.end(), 0);
  std::sort(by_order.begin(), by_order.end(),
            [&](std::size_t a, std::size_t b) { return in_order(contacts_[a], contacts_[b]); });
  std::vector<HeldContact> ordered;
  gives_.clear();
  for (const std::size_t k : by_order) {
    ordered.push_back(contacts_[k]);
    gives_.push_back(problem_.contacts[k].gives);
  }
  contacts_ = std::move(ordered);
}

ExtendedState IslandMotion::after(int member) const {
  ExtendedState s = members_.state(member);
  s.twist = ExtendedTwist(as_twist(problem_.velocity[member]));
  return s;
}

// ---- who stands

IslandParting IslandMotion::parting() const {
  return IslandParting({members_, *search_, at_rest_, contacts_, gives_, gaps_at_end_, problem_, h_,
                        by_modes_, agitated_, captured_});
}

/// Of whom the step has begun and ends with no speed but what a solver leaves, and nothing that moves by itself carries or pulls.
std::vector<int> IslandMotion::still() const {
  const double slow = kHeld * members_.pull() * h_;
  std::vector<char> stands(members_.count(), 0);
  for (int i = 0; i < static_cast<int>(members_.count()); ++i) {
    const double radius = members_.bounding_radius(i);
    stands[i] = members_.coupled_to(i).size() == 1 && members_.speed_of(i) <= slow &&
                speed_within(as_twist(problem_.velocity[i]), radius) <= slow;
  }
  for (const HeldContact& c : contacts_)
    if (members_.on_moving_site(c) && approach().touches(c)) stands[members_.place_of(c.pair.body)] = 0;
  std::vector<int> found;
  for (int i = 0; i < static_cast<int>(members_.count()); ++i)
    if (stands[i]) found.push_back(i);
  return found;
}

void IslandMotion::put_to_rest(const std::vector<int>& members) {
  wake_again();
  for (const int i : members) at_rest_[i] = 1;
}

}  // namespace brink
