#include "brink/scheduler/kernel/island_motion.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "brink/core/base/disjoint_sets.h"
#include "brink/core/base/limits.h"
#include "brink/scheduler/islands/driven_surface.h"
#include "brink/scheduler/islands/step_balance.h"
#include "brink/scheduler/islands/tolerances.h"
#include "brink/scheduler/kernel/island_joining.h"
#include "brink/scheduler/kernel/step_places.h"

namespace brink {

namespace {

/// A step lasts this part of the time in which the smallest member falls by its size ...
constexpr double kOfFall = 0.05;
/// ... and moves nobody by more than this part of it.
constexpr double kOfSize = 0.1;
/// A corner so far off another, in units of how far off it lies on it, is beside it; but steps are so many ticks at least.
constexpr double kBesideCorner = 4.0, kTicksOfCorner = 1024.0;
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
/// Contact tolerances that a contact is open before its bodies are let go from modes.
constexpr double kClear = 100.0;
/// Looks along a contact's tangents until it arrives, or passes by.
constexpr int kTangents = 32, kHalvingsOfWay = 60;
/// Impacts of one instant inside an island, at most; what closes then is taken as plastic.
constexpr std::size_t kFirstImpacts = 100, kImpactsEach = 20;
/// No tolerance makes a step shorter than this part of what it would be.
constexpr double kShortest = 1e-4;
/// Contacts hold an island of many bodies at rest that are open by no more than this part of the smallest member's size: some
/// hundredths of what a step of first order leaves places off by.
constexpr double kHolds = 1e-4;
/// A step has held still what is slower than this part of the speed that falling for as long gives; its friction is then within
/// cones a little wider (kWidened).
constexpr double kHeld = 1e-11;
/// By how much a step may miss the gap to a wire without thickness, in touching distances: from half of one, at which a sharp
/// sample meets it, a few such misses do not lead through it.
constexpr double kThinMiss = 0.125;
/// Halving a step makes its change of velocity fall to this part at most, if forces make it.
/// What forces change goes with the step, so half is left at most; what an impact changes stays: 3/4 lies between.
constexpr double kFalls = 0.75;
/// A force below this part of the weight of the heaviest member is none.
constexpr double kNoForce = 1e-9;
/// So many of these together have moved a member: the digits of a coarse solve are some hundreds.
constexpr double kMoved = 1e3;
/// A step that an impact cuts to less than this part is cut short.
constexpr double kWorthwhile = 0.25;
/// Members of an agitated island that are closer than this part of the smallest member's size stay together.
constexpr double kRattles = 0.25;
/// Forces that change with place, velocity or time may change by this part of the largest pull that a step so long may have
/// in half of it, and are asked for again until they do by a millionth of that; each time they come nearer by half at least.
constexpr double kChanges = 0.1, kForcesAgree = 1e-6, kComesNearer = 0.5;
constexpr int kForcePasses = 30;
/// A step under such forces is no longer than so many times the one before.
constexpr double kLonger = 2.0;
/// What meets again within this part of a step has never been apart; so many halvings of that are looked at.
constexpr double kAtOnce = 1.0 / 32.0;
constexpr int kLooksBack = 6;
/// A speed below this part of what the smallest member gains as it falls by its size is none.
constexpr double kNoSpeed = 1e-7;

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
  // what an arc may roll to counts along a step alone: until then its end tells all
  std::erase_if(contacts_, [&](const HeldContact& c) {
    return (c.feature.beside_arc && reach >= 0.0) || (c.feature.goes_on && reach >= 0.0);
  });
  absorbed_ = 0.0;
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
  add_to_problem(known);
}

/// Of each member now, as the step's problem has them: x, y [m/s], angle [rad/s].
std::vector<Vec3> IslandMotion::velocities() const {
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < members_.count(); ++i)
    all.push_back(as_vector(members_.state(static_cast<int>(i)).twist.rounded()));
  return all;
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
  std::vector<Vec3> velocity = velocities();
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
    impacts_in_step_ = impacts_in_step_ || !touches(c);
    each_member(c, [&](int member) { velocity[member] = as_vector(members_.state(member).twist.rounded()); });
    each_member(c, [&](int member) {
      for (const std::size_t k : contacts_of[member]) impact[k] = impact_of(contacts_[k], velocity);
    });
  }
  // set_twist() leaves them to be found, and the length of the step comes from them
  members_.find_speeds();
}

/// True of a sharp corner upon a sharp one: what is round goes over an end in one piece.
bool IslandMotion::is_sharp(const HeldContact& c) const {
  const Outline *carrier = &search_->outline_of(c.pair.body),
                *other = &search_->outline_of(search_->other_owner(c.pair));
  if (!c.feature.sample_on_a) std::swap(carrier, other);
  return carrier->samples[c.feature.sample].radius + other->sites[c.feature.site].radius == 0.0;
}

/// Within a contact tolerance of what its features keep: at a wire without thickness a touch, else 0.
bool IslandMotion::touches(const HeldContact& c) const {
  return c.feature.gap - kept(c.feature) <= search_->limits().tolerance;
}

/// True if the site ends at a corner that touches one of the sample's edges: the sample is far from that corner, and through it as
/// soon as it sinks into the edge by a rounding, which its own contact sees to.
bool IslandMotion::is_kept_by_corner(const HeldContact& c) const {
  if (!c.feature.at_end || touches(c)) return false;
  const Outline &a = search_->outline_of(c.pair.body), &b = search_->outline_of(search_->other_owner(c.pair));
  const auto ends = [](const Sample& corner, int site) {
    return corner.before == site || corner.after == site;
  };
  const Sample& sample = (c.feature.sample_on_a ? a : b).samples[c.feature.sample];
  return std::any_of(contacts_.begin(), contacts_.end(), [&](const HeldContact& o) {
    return o.pair == c.pair && o.feature.sample_on_a != c.feature.sample_on_a &&
           ends(sample, o.feature.site) &&
           ends((o.feature.sample_on_a ? a : b).samples[o.feature.sample], c.feature.site) && touches(o);
  });
}

/// How fast the two close if that is an impact now [m/s], else 0: they touch, or are to meet within the step of an
/// agitated island, and faster than a step takes as plastic.
double IslandMotion::impact_of(const HeldContact& c, const std::vector<Vec3>& velocity) const {
  const double closing = members_.closing_speed(c);
  if (closing <= most_absorbed(c.pair) || c.feature.beside_arc || c.feature.goes_on) return 0.0;
  if (!touches(c)) return !is_kept_by_corner(c) && arrival(c, velocity).time < h_ ? closing : 0.0;
  // at a joint of two floors the tangent at an end bars the way to what slides over it
  if (passes_by(c, 0.0, closing)) return 0.0;
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
  const std::vector<Vec3> velocity = velocities();
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
        return places.gap(contacts_[k], later) - kept(contacts_[k].feature);
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
  const std::vector<Vec3> velocity = velocities();
  for (const HeldContact& c : contacts_) {
    if (!go_on_()) break;
    if (c.feature.beside_arc || c.feature.goes_on) continue;
    const Arrival come = touches(c) ? Arrival{0.0, members_.closing_speed(c)} : arrival(c, velocity);
    if (!(come.time <= h_)) continue;
    if (!touches(c) && come.closing > most_absorbed(c.pair) && !is_kept_by_corner(c))
      // too fast to be taken as plastic: an impact within the step
      first = std::min(first, come.time);
    else
      // plastic in this step, and told (IslandTally::absorbed)
      absorbed_ = std::max(absorbed_, come.closing);
  }
  return first;
}

/// Of the contact's body, and of its other owner.
std::pair<Vec3, Vec3> IslandMotion::velocities_of(const HeldContact& c,
                                                  const std::vector<Vec3>& velocity) const {
  return {velocity_of(members_.place_of(c.pair.body), velocity),
          c.pair.with_site() ? as_vector(members_.other_state(c.pair).twist.rounded())
                             : velocity_of(members_.place_of(c.pair.other_body), velocity)};
}

/// When the first corner that lies on another is beside it [s], if the members go on as they do now: which of their sides meet is
/// another thing then. Infinity: none moves, or none was in a step before that was longer than `shortest`: each has one short step.
double IslandMotion::corners_part_in(double shortest) const {
  if (members_.count() > kModeBodies) return kForever;  // all its steps are of first order
  const std::vector<Vec3> velocity = velocities();
  double first = kForever;
  for (const HeldContact& c : contacts_) {
    const NearFeature& f = c.feature;
    if (!f.at_end || !is_sharp(c) || !(std::abs(f.gap) <= f.one_corner)) continue;
    const HeldContact* before = warm_.find(c);
    if (!before || before->lasted < shortest) continue;  // once
    const auto [of_body, of_other] = velocities_of(c, velocity);
    const Vec2 arm = members_.arm(c).cast<double>();
    const Vec2 apart =
        of_body.head<2>() + cross(of_body[2], arm) - of_other.head<2>() - cross(of_other[2], f.point);
    first = std::min(first, kBesideCorner * f.one_corner / apart.norm());
  }
  // not so soon that the clock cannot tell
  return std::max(first, kTicksOfCorner * std::numeric_limits<double>::epsilon() * std::abs(members_.now()));
}

/// No gap of the two closes faster if the members go on as they do now [m/s]: both centres, and both arms as far from them
/// as a member reaches.
double IslandMotion::fastest_approach(const HeldContact& c, const std::vector<Vec3>& velocity) const {
  const auto [of_body, of_other] = velocities_of(c, velocity);
  const double radius = members_.bounding_radius(members_.place_of(c.pair.body));
  return (of_body - of_other).head<2>().norm() + std::abs(of_body[2]) * radius +
         std::abs(of_other[2]) * (c.feature.point.norm() + radius);
}

/// By how much its gap may be missed [m]: through a wire without thickness nothing comes.
double IslandMotion::most_missed(const NearFeature& f) const {
  return f.thin ? kThinMiss * search_->limits().touch : search_->limits().tolerance;
}

/// When the two features meet if the members go on as they do now. By tangents and secants, which lead to before the root of a
/// convex gap; of one that is not, as of a corner that turns towards a side, they lead past it, and halving leads back.
IslandMotion::Arrival IslandMotion::arrival(const HeldContact& c, const std::vector<Vec3>& velocity) const {
  const double tolerance = search_->limits().tolerance, fastest = fastest_approach(c, velocity);
  const double most = most_missed(c.feature);
  const auto gap_at = [&](double t) { return members_.gap(c, t, velocity) - kept(c.feature); };
  double closing = members_.closing_speed(c), gap = c.feature.gap - kept(c.feature), t = 0.0;
  for (int k = 0; k < kTangents; ++k) {
    if (gap > fastest * (h_ - t)) return {};
    // where the line through the gap reaches 0; where it opens, or the step ends before, it may bend down on the way
    double way = gap / closing;
    const bool within = closing > 0.0 && t + way <= h_;
    if (!within) way = h_ - t;
    if (!(way > 0.0)) return {};
    const double next = gap_at(t + way);
    if (next < -most) {
      if (const double root = root_between(gap_at, t, gap, t + way, most); root > t) {
        closing = std::min((gap - next) / way, fastest);
        t = root;
        break;
      }
    }
    if (!within) return {};
    // the secant's slope: no derivative of the gap is at hand there. What comes past an end is behind a site at once: the
    // gap jumps, and no slope is as steep.
    closing = std::min((gap - next) / way, fastest);
    t += way;
    gap = next;
    if (gap <= tolerance) break;
  }
  return passes_by(c, t, closing) ? Arrival{} : Arrival{t, closing};
}

/// The time after `open`, where the gap is still open, at which it closes: to the contact tolerance before that, and no more than
/// `most` behind it; `open` where it jumps.
template <class Gap>
double IslandMotion::root_between(Gap&& gap_at, double open, double gap, double past, double most) const {
  const double tolerance = search_->limits().tolerance, from = open;
  for (int k = 0; k < kHalvingsOfWay && gap > tolerance; ++k) {
    const double middle = 0.5 * (open + past), there = gap_at(middle);
    if (there < -most) {
      past = middle;
    } else {
      open = middle;
      gap = there;
    }
  }
  return gap > tolerance ? from : open;
}

/// True if what comes to the end of a site does not meet it, but goes by: some tolerances further on it is clear
/// of it.
bool IslandMotion::passes_by(const HeldContact& c, double then, double closing) const {
  const double tolerance = search_->limits().tolerance;
  if (!c.feature.at_end || !(closing > 0.0)) return false;
  const double further = members_.gap(c, then + 4.0 * tolerance / closing, velocities()) - kept(c.feature);
  // some roundings in it where it runs along the next side from there on
  return further > 0.0 || (further > -kMissCounts * tolerance && !c.feature.no_way_by);
}

/// An approach as slow as this rebounds with e v <= a h: it has turned back by the end of the step [m/s].
double IslandMotion::most_absorbed(const PairKey& pair) const {
  const double e = response_->material_of(pair).restitution;
  if (!(e > 0.0)) return kForever;
  return by_modes_ ? IslandModes::slowest_bounce(members_, *search_) : members_.pull() * h_ / e;
}

/// The members with their masses, velocities and forces [N], [N m], and a row for each contact that is listed.
void IslandMotion::make_problem() {
  problem_ = {};
  problem_.velocity = velocities();
  for (std::size_t i = 0; i < members_.count(); ++i) {
    const Body& b = members_.body(static_cast<int>(i));
    // infinity: held (RestProblem)
    problem_.mass.emplace_back(b.lock_x ? kForever : b.mass, b.lock_y ? kForever : b.mass,
                               b.lock_angle ? kForever : b.inertia);
  }
  problem_.force = forces(members_.accelerations());
  // in the order of contacts_: take_forces() leads back by place
  add_to_problem(0);
}

/// Of a site that moves: the body is not abreast of it yet, and may be where it comes to.
bool IslandMotion::is_beside_driven(const HeldContact& c) const {
  return members_.on_moving_site(c) && (c.feature.at_end || c.feature.beside_arc);
}

/// Contacts from that place on, pair after pair.
void IslandMotion::add_to_problem(std::size_t first) {
  const PairKey* looked_at = nullptr;
  std::vector<NearFeature> ahead;  // of that pair
  for (std::size_t k = first; k < contacts_.size(); ++k) {
    const HeldContact& c = contacts_[k];
    if (is_beside_driven(c) && (!looked_at || *looked_at != c.pair)) {
      ahead = members_.features_ahead(c.pair, h_);
      looked_at = &c.pair;
    }
    problem_.contacts.push_back(island_contact(c, ahead));
  }
}

/// On each member [N], [N m].
std::vector<Vec3> IslandMotion::forces(const std::vector<Acceleration>& accelerations) const {
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < accelerations.size(); ++i) {
    const Body& b = members_.body(static_cast<int>(i));
    const Acceleration& a = accelerations[i];
    all.emplace_back(b.mass * a.linear.x(), b.mass * a.linear.y(), b.inertia * a.angular);
  }
  return all;
}

/// By how much the accelerations of any member's points differ at most [m/s^2].
double IslandMotion::largest_change(const std::vector<Vec3>& forces, const std::vector<Vec3>& others) const {
  double most = 0.0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Body& b = members_.body(static_cast<int>(i));
    const Vec3 change = forces[i] - others[i];
    most =
        std::max(most, change.head<2>().norm() / b.mass +
                           std::abs(change[2]) / b.inertia * members_.bounding_radius(static_cast<int>(i)));
  }
  return most;
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
    std::vector<Vec3> along = forces(members_.accelerations_along(h_, problem_.velocity));
    const double off = largest_change(along, problem_.force);
    if (largest_change(along, at_start) > kChanges * most || off > kComesNearer * last) break;
    if (off <= kForcesAgree * most) return outcome;
    last = off;
    problem_.velocity = before;
    problem_.force = std::move(along);
  }
  outcome.solved = false;
  return outcome;
}

/// Geometry at the start of the step; forces of the step before, from which friction bounds come. Of a site that moves geometry is
/// that where it comes to, of `ahead` (features_ahead()): the end of an arc may have gone by.
IslandContact IslandMotion::island_contact(const HeldContact& c,
                                           const std::vector<NearFeature>& ahead) const {
  IslandContact made;
  made.rows = rows_of(c);
  made.gap = c.feature.gap - kept(c.feature);
  made.thin = c.feature.thin;
  // a wire has no inside: what is through it, by however little, is on its other side
  made.tolerance = most_missed(c.feature);
  const Material& material = response_->material_of(c.pair);
  made.friction = material.friction;
  made.rolling_resistance = material.rolling_resistance;
  if (const HeldContact* warm = warm_.find(c)) {
    made.normal_force = warm->normal_force;
    made.tangential_force = warm->tangential_force;
    made.force_lasted = warm->lasted;
  }
  made.at_end = c.feature.at_end || c.feature.beside_arc;
  made.driven = members_.on_moving_site(c);
  // a body that is a member moves by the unknown twists; a site by what it is told
  note_shape(c, made);
  if (made.driven) drive(c, ahead, made);
  return made;
}

/// The mean velocity of its surface along the normal, by what the gap loses where the body stays, and that of its point along the
/// tangent. A point's own along the normal would be no surface's: those of a round drum leave it along chords. What is under the
/// body now counts as the line or the circle that it is, until the step ends; what is beside it, as where it comes to.
void IslandMotion::drive(const HeldContact& c, const std::vector<NearFeature>& ahead,
                         IslandContact& made) const {
  const ExtendedState from = members_.other_state(c.pair), to = members_.other_state(c.pair, h_, {});
  // the site's own motion over the step, as one turn and shift of the point that touches
  const Frame step(
      {(to.position - from.position).cast<double>(), static_cast<double>(to.angle - from.angle)});
  const Vec2 way = step.to_world(c.feature.point) - c.feature.point;
  made.tangential_support = way.dot(perp(c.feature.normal)) / h_;
  if (!is_beside_driven(c)) {
    made.normal_support = advance_of_surface(c.feature, search_->outline_of(search_->other_owner(c.pair)),
                                             static_cast<double>(from.angle), step) /
                          h_;
    return;
  }
  const std::vector<Vec3> stays(members_.count(), Vec3::Zero());
  const double gap = members_.gap(c, h_, stays);
  const auto found = std::find_if(ahead.begin(), ahead.end(), [&](const NearFeature& f) {
    return std::tuple(f.sample_on_a, f.sample, f.site) ==
           std::tuple(c.feature.sample_on_a, c.feature.sample, c.feature.site);
  });
  // not where the site has come over the body, which is on another side of it there
  const bool there = found != ahead.end() && found->normal.dot(c.feature.normal) > 0.0 &&
                     (found->over_joint || std::abs(found->gap - gap) <= search_->limits().tolerance);
  made.normal_support = (there ? c.feature.gap - found->gap : members_.gap(c, 0.0, stays) - gap) / h_;
  if (!there) return;
  HeldContact then = c;
  then.feature = *found;
  then.feature.point += step.origin;  // from where the site is now
  made.rows = rows_of(then);
  const Vec2& point = then.feature.point;
  made.tangential_support = (point - step.to_local(point)).dot(perp(then.feature.normal)) / h_;
}

/// What stands is as a site is, whichever of the two it is: the normal points into what moves then, or away from it.
LastingContact IslandMotion::rows_of(const HeldContact& c) const {
  const int a = members_.place_of(c.pair.body);
  const int b = c.pair.with_site() ? -1 : members_.place_of(c.pair.other_body);
  LastingContact rows = contact_at(a, b, c.feature.normal, members_.arm(c).cast<double>(), c.feature.point);
  if (b >= 0 && members_.is_support(b)) rows.other = -1;
  if (!members_.is_support(a)) return rows;
  rows.body = b;
  rows.normal_on_body = rows.normal_on_other;
  rows.tangent_on_body = rows.tangent_on_other;
  rows.other = -1;
  return rows;
}

/// How the gap behaves along a step. Of a segment it is convex in front of it, so of a wire it is not, nor where there is no
/// way by an end: there what is beside the segment counts as behind it, too. Of an arc it depends on the side.
void IslandMotion::note_shape(const HeldContact& c, IslandContact& made) const {
  const NearFeature& f = c.feature;
  const Outline *of_sample = &search_->outline_of(c.pair.body),
                *of_site = &search_->outline_of(search_->other_owner(c.pair));
  if (!f.sample_on_a) std::swap(of_sample, of_site);
  const Sample& sample = of_sample->samples[f.sample];
  const SiteKind kind = of_site->sites[f.site].kind;
  made.convex = !made.driven && !f.thin && !f.beside_arc && !f.no_way_by && !of_site->container &&
                kind != SiteKind::arc;
  const Site& site = of_site->sites[f.site];
  made.round_site = site.kind == SiteKind::point && site.a == Vec2(Vec2::Zero());
  // the row's body is the one who moves (rows_of)
  made.sample_on_body = f.sample_on_a != members_.is_support(members_.place_of(c.pair.body));
  made.arm = sample.p.norm();
  // from the centre of mass to the point on the site's surface, and on along the normal to the sample
  const Vec2 to_point = f.sample_on_a ? f.point : Vec2(members_.arm(c).cast<double>());
  made.apart = to_point.norm() + std::abs(f.gap) + sample.radius;
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
    if (members_.on_moving_site(c) && touches(c)) stands[members_.place_of(c.pair.body)] = 0;
  std::vector<int> found;
  for (int i = 0; i < static_cast<int>(members_.count()); ++i)
    if (stands[i]) found.push_back(i);
  return found;
}

void IslandMotion::put_to_rest(const std::vector<int>& members) {
  wake_again();
  for (const int i : members) at_rest_[i] = 1;
}

bool IslandMotion::stands(int body) const {
  const int place = members_.place_of(body);
  return members_.is_support(place) || at_rest_[place];
}

/// Contacts hold at rest that are as near as rests() has them.
std::vector<HeldContact> IslandMotion::that_hold() const {
  const double near = std::max(search_->limits().tolerance, kHolds * members_.size());
  std::vector<HeldContact> found;
  for (const HeldContact& c : contacts_) {
    const bool among = stands(c.pair.body) && (c.pair.with_site() || stands(c.pair.other_body));
    if (among && !c.feature.beside_arc && !c.feature.goes_on && c.feature.gap - kept(c.feature) <= near)
      found.push_back(as_held(c, ContactMode::rest));
  }
  return found;
}

/// With what they give: of many, what is told of them balances no more than it has to.
std::vector<HeldContact> IslandMotion::that_lean() const {
  std::vector<HeldContact> found;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const HeldContact& c = contacts_[k];
    if (c.pair.with_site() || stands(c.pair.body) == stands(c.pair.other_body)) continue;
    HeldContact& lean = found.emplace_back(as_held(c, ContactMode::none));
    lean.normal_force = gives_[k].normal;
    lean.tangential_force = gives_[k].tangential;
    // of a support the problem has what is given to the other: the opposite of what the pair's body has
    const bool of_other = members_.is_support(members_.place_of(c.pair.body));
    lean.rolling_torque = of_other ? -gives_[k].rolling : gives_[k].rolling;
  }
  return found;
}

// ---- who stays together

/// A force that is more than a rounding of the heaviest member's weight; also one of friction alone, of which bounds that
/// lag may leave some where nothing presses any more: who is let go must have been moved by nobody.
bool IslandMotion::pushes(const HeldContact& c) const {
  return std::max(c.normal_force, std::abs(c.tangential_force)) > no_force();
}

double IslandMotion::no_force() const { return kNoForce * members_.heaviest() * members_.pull(); }

/// Of all contacts together, by what the step has made of the member's velocity [N].
double IslandMotion::contact_force_on(int member) const {
  return contact_impulse(problem_.mass[member], problem_.force[member],
                         as_vector(members_.state(member).twist.rounded()), problem_.velocity[member], h_) /
         h_;
}

/// True if the two, which touch, would meet again at once if both were let go, in a small part of the step, though a step of
/// constant twists opens their gap: an arc that turns under a body which forces lift, but not as fast as it bends away.
/// `velocity`: that of all members now; it is the same afterwards.
bool IslandMotion::falls_back(const HeldContact& c, std::vector<Vec3>& velocity) const {
  if (!touches(c) || c.feature.goes_on) return false;
  const auto [a, b] = members_.members_of(c.pair);
  const Vec3 of_a = velocity[a], of_b = velocity[b];
  // the way of a time with the mean velocity of a fall is that of the fall
  const auto mean = [&](int member, const Vec3& before, double time) {
    const Acceleration& by = members_.acceleration(member);
    return Vec3(before + 0.5 * time * Vec3(by.linear.x(), by.linear.y(), by.angular));
  };
  // what has sunk already is none that falls
  const double deeper = std::min(c.feature.gap, kept(c.feature)) - search_->limits().touch;
  bool meets = false;
  for (int k = kLooksBack; k >= 0 && !meets; --k) {
    const double time = std::ldexp(h_ * kAtOnce, -k);
    velocity[a] = mean(a, of_a, time);
    velocity[b] = mean(b, of_b, time);
    meets = members_.gap(c, time, velocity) < deeper;
  }
  velocity[a] = of_a;
  velocity[b] = of_b;
  return meets;
}

/// Nothing pushes, but one of the two alone, left to its parabola, could run into the other's step: that has the
/// twist of its end from the start on, which a parabola comes to by and by. Where others push both, each takes steps, and
/// there is no parabola: what rolls along beside a heap, touching nobody, does not keep it awake. By modes, it has just been
/// let go: an open contact is looked at from there on as well as any other, until it is clear of it. And who meets where the
/// step ends: a search as far as that could tell either, by roundings.
bool IslandMotion::stays_near(std::size_t contact, bool both_pushed, std::vector<Vec3>& velocity) const {
  const HeldContact& c = contacts_[contact];
  const double behind = both_pushed && !by_modes_ ? 0.0 : members_.pull() * h_;
  const double tolerance = search_->limits().tolerance;
  if (by_modes_) {
    const double closing = members_.closing_speed(c);
    // a parting of this speed rises kClear tolerances: v^2 / 2 a
    const bool slow = closing >= -std::sqrt(kClear) * IslandModes::slowest_bounce(members_, *search_);
    if (c.feature.gap <= kClear * tolerance && slow) return true;
    return !c.pair.with_site() && (c.feature.gap - h_ * (closing + behind) <= tolerance ||
                                   gaps_at_end_[contact] <= kClear * tolerance);
  }
  if (falls_back(c, velocity) || (captured_ == c.pair && touches(c))) return true;
  // a site takes no step, nor does what is at rest: whoever is let go meets it by the ordinary search
  if (c.pair.with_site() || stands(c.pair.body) || stands(c.pair.other_body)) return false;
  const double closing = members_.closing_speed(c, after(members_.place_of(c.pair.body)).twist,
                                                after(members_.place_of(c.pair.other_body)).twist);
  return c.feature.gap - h_ * (closing + behind) <= tolerance;
}

/// Pairs of members whose bounding discs are so near that they stay together while the island is agitated: who
/// rattles would be back at once.
std::vector<std::pair<int, int>> IslandMotion::neighbours() const {
  const double near = kRattles * members_.size();
  const auto left = [&](int i) {
    return static_cast<double>(members_.state(i).position.x()) - members_.bounding_radius(i);
  };
  std::vector<int> by_left(members_.count());
  std::iota(by_left.begin(), by_left.end(), 0);
  std::sort(by_left.begin(), by_left.end(),
            [&](int a, int b) { return std::pair(left(a), a) < std::pair(left(b), b); });
  std::vector<std::pair<int, int>> found;
  for (std::size_t x = 0; x < by_left.size(); ++x)
    for (std::size_t y = x + 1; y < by_left.size(); ++y) {
      const int a = by_left[x], b = by_left[y];
      const double reach = members_.bounding_radius(a) + members_.bounding_radius(b) + near;
      // those that follow begin farther right still
      if (left(b) > left(a) + 2.0 * members_.bounding_radius(a) + near) break;
      const RealVec apart = members_.state(a).position - members_.state(b).position;
      if (static_cast<double>(apart.norm()) <= reach) found.emplace_back(a, b);
    }
  return found;
}

IslandMotion::Parts IslandMotion::parts(bool rests) const {
  const int count = static_cast<int>(members_.count());
  DisjointSets joined;
  joined.reset(count);
  std::vector<bool> pushed(members_.count(), false), seen(members_.count(), false);
  const auto places = [this](const HeldContact& c) {
    // a site keeps its body in an island, but joins nobody to it; nor does what is at rest
    auto [a, b] = members_.members_of(c.pair);
    if (at_rest_[a]) a = b;
    if (at_rest_[b]) b = a;
    return std::pair(a, b);
  };
  for (const HeldContact& c : contacts_) {
    // at rest all that touch stay together: forces of redundant contacts are one choice of many, and 0 for
    // some
    if (!rests && !pushes(c)) continue;
    const auto [a, b] = places(c);
    pushed[a] = pushed[b] = true;
    joined.unite(a, b);
  }
  // whatever pushed it, as forces that are told are not those that move it (StepOutcome::friction_residual)
  for (int i = 0; i < count && !rests && !by_modes_ && !contacts_.empty(); ++i)
    pushed[i] = pushed[i] || contact_force_on(i) > kMoved * no_force();
  const std::vector<bool> by_others = pushed;
  std::vector<Vec3> velocity = velocities();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const auto [a, b] = places(contacts_[k]);
    if (rests || pushes(contacts_[k]) || !stays_near(k, by_others[a] && by_others[b], velocity)) continue;
    pushed[a] = pushed[b] = true;
    joined.unite(a, b);
  }
  // who leans on those at rest goes on together: what these carry is asked once
  int leans = -1;
  for (const HeldContact& c : contacts_) {
    if (c.pair.with_site() || stands(c.pair.body) == stands(c.pair.other_body)) continue;
    const int a = places(c).first;
    if (!pushed[a]) continue;
    if (leans >= 0) joined.unite(leans, a);
    leans = a;
  }
  if (agitated_ && !rests)
    for (const auto& [a, b] : neighbours()) {
      pushed[a] = pushed[b] = true;
      joined.unite(a, b);
    }
  for (int i = 0; i < count; ++i)
    // springs hold a component together, and an island holds it whole or not at all
    for (const int j : members_.coupled_to(i)) joined.unite(i, j);
  Parts parts;
  // Sets come in the order of their least member. One without a push anywhere is let go, body by body.
  for (int i = 0; i < count; ++i) {
    if (seen[i] || at_rest_[i]) continue;
    std::vector<int> set(joined.of(i).begin(), joined.of(i).end());
    std::sort(set.begin(), set.end());
    for (const int j : set) seen[j] = true;
    if (std::any_of(set.begin(), set.end(), [&](int j) { return pushed[j]; }))
      parts.together.push_back(std::move(set));
    else
      parts.free.insert(parts.free.end(), set.begin(), set.end());
  }
  return parts;
}

/// By the relative velocity of the two points that touch, along the tangent; where that is none, by the relative
/// spin. Without a push it has no mode.
ContactMode IslandMotion::mode_of(const HeldContact& c, bool rests) const {
  if (!pushes(c)) return ContactMode::none;
  if (rests) return ContactMode::rest;
  const auto twist = [this](int body) {
    const int member = members_.place_of(body);
    return by_modes_ ? members_.state(member).twist.rounded()
                     : as_twist(velocity_of(member, problem_.velocity));
  };
  const Twist a = twist(c.pair.body);
  const Twist b =
      c.pair.with_site() ? members_.other_state(c.pair).twist.rounded() : twist(c.pair.other_body);
  // with the twists that the step has: those of its end, or of its beginning by modes
  const Vec2 relative = a.at(members_.arm(c).cast<double>()) - b.at(c.feature.point);
  const double slow = kNoSpeed * std::sqrt(members_.pull() * members_.size());
  if (std::abs(cross(c.feature.normal, relative)) > slow) return ContactMode::slip;
  return std::abs(a.omega - b.omega) * members_.size() > slow ? ContactMode::roll : ContactMode::stick;
}

HeldContact IslandMotion::as_held(const HeldContact& c, ContactMode mode) const {
  HeldContact held = c;
  held.mode = mode;
  held.place = members_.other_state(c.pair).position.cast<double>() + c.feature.point;
  return held;
}

Island IslandMotion::island_of(const std::vector<int>& together, bool rests, double end) const {
  Island island;
  std::vector<char> is_in(members_.count(), 0);
  for (const int i : together) is_in[i] = 1;
  for (const int i : together) island.members.push_back(members_.bodies()[i]);
  // Contacts among these alone, and with what stands: what leads to a member that leaves is searched again.
  const auto has = [&](int body) { return stands(body) || is_in[members_.place_of(body)] != 0; };
  for (const HeldContact& c : contacts_) {
    const auto [a, b] = members_.members_of(c.pair);
    if ((is_in[a] || is_in[b]) && has(c.pair.body) && (c.pair.with_site() || has(c.pair.other_body)))
      island.contacts.push_back(as_held(c, mode_of(c, rests)));
  }
  // A step has its end; what rests has none, but where forces on a member jump.
  island.rests = rests;
  if (!rests) island.due = end;
  if (rests)  // until forces jump
    for (const int i : together) island.due = std::min(island.due, members_.next_break(i));
  return island;
}

}  // namespace brink
