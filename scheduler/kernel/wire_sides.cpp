#include "brink/scheduler/kernel/wire_sides.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/core/shapes/curve_site.h"
#include "brink/scheduler/islands/tolerances.h"

namespace brink {

namespace {

/// Contact tolerances that a sharp sample may be beyond a wire while a run goes on, unless it was so from its start.
constexpr double kSunkInRun = 4.0;
/// A gap is told to this part of the outlines' size.
constexpr double kTold = 8.0 * std::numeric_limits<double>::epsilon();
/// Two normals whose cosine is off one by no more are one, and a pull along a normal below this part of the largest is none.
constexpr double kOneLine = 1e-9;

void turn_over(NearFeature& f) {
  f.normal = -f.normal;
  f.gap = -f.gap;
}

/// As near to a wire as roundings may leave what is upon it [m].
double near_a_wire(const HeldContact& c, const IslandMembers& members) {
  return kSunkOfRadius * members.bounding_radius(members.place_of(c.pair.body));
}

/// True if another contact of the pair, at a point seen from the other's position, has the same tangent line.
bool is_on_line(const HeldContact& c, const Vec2& point, const Vec2& normal, double near) {
  return std::abs(normal.dot(c.feature.normal)) >= 1.0 - kOneLine &&
         std::abs(normal.dot(point - c.feature.point)) <= near;
}

/// Contacts of a pair as near to a wire, along lines that are parallel to that of one of them.
struct Parallel {
  int alike = 0, opposite = 0;  ///< by their normals
  double gaps = 0.0;            ///< the sum, to its side [m]

  void add(const NearFeature& f, double along) {
    ++(along > 0.0 ? alike : opposite);
    gaps += along > 0.0 ? f.gap : -f.gap;
  }
};

/// True if c is on the other side, as its pair's parallel contacts say of which the side is `told`. Who fits between two lines to a
/// rounding has contacts to either side. Where nothing tells any of them, places do, by however little: so that they do
/// not contradict each other, as those of tips that slide against each other on one floor would.
bool is_opposite(const HeldContact& c, const std::vector<HeldContact>& contacts,
                 const std::vector<char>& told, double near) {
  Parallel known, others;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const NearFeature& f = contacts[k].feature;
    if (!(contacts[k].pair == c.pair) || !f.thin || f.at_end || !(std::abs(f.gap) < near)) continue;
    const double along = f.normal.dot(c.feature.normal);
    if (std::abs(along) >= 1.0 - kOneLine) (told[k] ? known : others).add(f, along);
  }
  if (known.alike + known.opposite > 0) return known.alike == 0;
  return others.opposite > 0 && others.gaps < 0.0;
}

/// Normals that lie along one line to this cosine, the other way, are of two sides of one piece, or of two that go on into each other.
constexpr double kOtherSide = -0.9;

/// The circle of an arc that has a contact.
struct Circle {
  Vec2 center = Vec2::Zero();  ///< from the other's position, world axes [m]
  double radius = 0.0;
  bool is_outside = false;  ///< the normal, into the pair's body, leads out of it
};

/// The outline that carries the contact's site, and where it is.
const Outline& wire_of(const HeldContact& c, const WireSides::Known& known) {
  return known.search.outline_of(c.feature.sample_on_a ? known.search.other_owner(c.pair) : c.pair.body);
}
ExtendedState state_of_wire(const HeldContact& c, const WireSides::Known& known) {
  return c.feature.sample_on_a ? known.members.other_state(c.pair)
                               : known.members.state(known.members.place_of(c.pair.body));
}
/// Turned as that is, about the world's origin.
Frame turned(const ExtendedState& state) {
  return Frame(Pose{{0.0, 0.0}, state.seen_from(Vec2::Zero()).pose.angle});
}

std::optional<Circle> circle_of(const HeldContact& c, const WireSides::Known& known) {
  const NearFeature& f = c.feature;
  const Site& site = wire_of(c, known).sites[f.site];
  if (site.kind != SiteKind::arc) return std::nullopt;
  const ExtendedState owner = state_of_wire(c, known);
  const Vec2 center = (owner.position - known.members.other_state(c.pair).position).cast<double>() +
                      turned(owner).direction_to_world(site.center);
  return Circle{center, site.arc_radius, f.normal.dot(f.point - center) > 0.0};
}

bool share_an_end(const Site& a, const Site& b) {
  return a.a == b.b || a.b == b.a || a.a == b.a || a.b == b.b;
}

}  // namespace

void WireSides::expect(const StepCause& cause) {
  run_begins_ = cause.run_begins;
  if (cause.pair) met_.emplace(*cause.pair, *cause.met);
}

void WireSides::remember(std::vector<HeldContact>& contacts, std::size_t first, const Known& known) const {
  std::vector<char> told(contacts.size(), 1);
  for (std::size_t k = first; k < contacts.size(); ++k) told[k] = remember(contacts[k], known);
  for (std::size_t k = first; k < contacts.size(); ++k) {
    if (told[k]) continue;
    HeldContact& c = contacts[k];
    if (is_opposite(c, contacts, told, near_a_wire(c, known.members))) turn_over(c.feature);
    told[k] = 1;
  }
  for (std::size_t k = first; k < contacts.size(); ++k)
    if (contradicts(contacts[k], known)) turn_over(contacts[k].feature);
}

/// True of a contact that is new, or at an end, where one of its pair is that was on the other side in the step before: who comes over a
/// smooth joint, or to the end of an arc, does not change sides.
bool WireSides::contradicts(const HeldContact& c, const Known& known) const {
  const NearFeature& f = c.feature;
  const double near = near_a_wire(c, known.members);
  if (!f.thin || f.upon_corner || !(std::abs(f.gap) < near)) return false;
  // beyond an end and off it the normal is the way to that, which tells no side
  const auto has_side = [&](const NearFeature& g) { return !g.at_end || std::abs(g.gap) < near; };
  const auto was_beside = [&](const HeldContact& contact) {
    const HeldContact* before = known.before.find(contact);
    return before != nullptr && !before->feature.at_end;
  };
  if (!f.at_end && was_beside(c)) return false;
  const Outline& wire = wire_of(c, known);
  const auto on_other_side = [&](const HeldContact& o) {
    return o.pair == c.pair && o.feature.normal.dot(f.normal) < kOtherSide;
  };
  // what goes round a free end changes sides, and what is off the end of a piece by more than a contact
  const bool at_joint = std::abs(f.gap) <= known.search.limits().tolerance &&
                        std::any_of(wire.sites.begin(), wire.sites.end(), [&](const Site& s) {
                          return &s != &wire.sites[f.site] && share_an_end(s, wire.sites[f.site]);
                        });
  if (f.at_end && !at_joint) return false;
  const auto is_next = [&](int site) {
    const Site &a = wire.sites[f.site], &b = wire.sites[site];
    // the sides of a hairpin look at each other, but what is at its end has one place
    return site == f.site || (f.at_end ? share_an_end(a, b) : go_on_smoothly(a, b));
  };
  // of the same sample, with this piece or with the next one
  const auto of_sample = [&](const HeldContact& w) {
    const NearFeature& g = w.feature;
    return on_other_side(w) && g.sample_on_a == f.sample_on_a && g.sample == f.sample && has_side(g) &&
           is_next(g.site);
  };
  return std::any_of(known.before.begin(), known.before.end(), of_sample);
}

/// True if the pair was in no island before: a search leaves nobody nearer to a wire than its level, which is more than roundings.
bool WireSides::comes_from_search(const HeldContact& c, const Known& known) const {
  const double size = known.search.outline_of(c.pair.body).magnitude +
                      known.search.outline_of(known.search.other_owner(c.pair)).magnitude;
  return std::abs(c.feature.gap) > kTold * size &&
         std::none_of(known.before.begin(), known.before.end(),
                      [&](const HeldContact& w) { return w.pair == c.pair; });
}

/// False: nothing tells surely which side it is.
bool WireSides::remember(HeldContact& c, const Known& known) const {
  const Outline& carrier =
      known.search.outline_of(c.feature.sample_on_a ? c.pair.body : known.search.other_owner(c.pair));
  NearFeature& f = c.feature;
  // upon a corner edges tell it, whichever side of the line of a piece it was on before it came there
  if (!f.thin || f.upon_corner || (f.at_end && !f.goes_on) ||
      !(std::abs(f.gap) < kSunkOfRadius * carrier.bounding_radius))
    return true;
  const HeldContact* before = f.at_end ? nullptr : known.before.find(c);
  std::optional<bool> turn;
  if (before != nullptr && !before->feature.at_end)
    turn = before->feature.normal.dot(f.normal) < 0.0;
  else
    turn = f.side_told == SideTold::surely ? false : is_round_a_corner(c, known);
  if (!turn && !run_begins_ && comes_from_search(c, known)) turn = f.gap < 0.0;
  if (!turn && !run_begins_) turn = is_elsewhere_on_circle(c, known);
  if (!turn) turn = is_elsewhere(c, known);
  // no step leaves anybody so deep: it is where it is
  if (!turn && std::abs(f.gap) > kSunkInRun * known.search.limits().tolerance) turn = f.gap < 0.0;
  if (turn.value_or(false)) turn_over(f);
  return turn.has_value();
}

/// Of a sample that was upon the piece before this one, or after it: true if it is on the other side of this one than it was of that,
/// seen along the wire. Who goes over a corner of a wire does not go through it.
std::optional<bool> WireSides::is_round_a_corner(const HeldContact& c, const Known& known) const {
  const NearFeature& f = c.feature;
  const Outline& wire = wire_of(c, known);
  const Frame frame = turned(state_of_wire(c, known));
  const Site& here = wire.sites[f.site];
  const auto is_right = [&](const Site& site, const Vec2& end, const Vec2& normal) {
    return frame.direction_to_world(right_normal(site, end)).dot(normal) > 0.0;
  };
  for (const HeldContact& w : known.before) {
    const NearFeature& g = w.feature;
    if (!(w.pair == c.pair) || g.sample_on_a != f.sample_on_a || g.sample != f.sample || g.site == f.site ||
        !g.thin || g.at_end || !(std::abs(g.gap) < near_a_wire(c, known.members)))
      continue;
    const Site& there = wire.sites[g.site];
    if (here.kind == SiteKind::point || there.kind == SiteKind::point || !share_an_end(here, there)) continue;
    const bool onward = here.a == there.b || here.b == there.a;  // travelled alike
    const Vec2& end = here.a == there.b || here.a == there.a ? here.a : here.b;
    const bool alike = is_right(here, end, f.normal) == is_right(there, end, g.normal);
    return alike != onward;
  }
  return std::nullopt;
}

/// Of an arc on the circle of which another contact of the pair was: true if this one is on the other side than that.
std::optional<bool> WireSides::is_elsewhere_on_circle(const HeldContact& c, const Known& known) const {
  const std::optional<Circle> here = circle_of(c, known);
  if (!here) return std::nullopt;
  const double near = near_a_wire(c, known.members);
  for (const HeldContact& w : known.before) {
    if (!(w.pair == c.pair) || !w.feature.thin || w.feature.at_end || !(std::abs(w.feature.gap) < near))
      continue;
    const std::optional<Circle> there = circle_of(w, known);
    if (there && (there->center - here->center).norm() < near &&
        std::abs(there->radius - here->radius) < near)
      return there->is_outside != here->is_outside;
  }
  return std::nullopt;
}

/// Of a wire of which no place of the other surely tells on which side it is: true if that is the other one. Where a run begins it is
/// what is told at all, or the side to which forces press. Later, who was on one side with another contact along that line
/// has not changed it, nor who has just met it: of the same pair, or else with a site that may go on from this one.
std::optional<bool> WireSides::is_elsewhere(const HeldContact& c, const Known& known) const {
  const IslandMembers& members = known.members;
  const Vec2& n = c.feature.normal;
  if (run_begins_ && c.feature.side_told == SideTold::hardly) return false;
  if (run_begins_) {
    const auto pull_on = [&](int body) {
      const int place = members.place_of(body);
      return members.is_support(place) ? Vec2(Vec2::Zero()) : members.acceleration(place).linear;
    };
    Vec2 pull = pull_on(c.pair.body);
    if (!c.pair.with_site()) pull -= pull_on(c.pair.other_body);
    if (std::abs(n.dot(pull)) > kOneLine * members.pull()) return n.dot(pull) > 0.0;
  }
  const RealVec from = members.other_state(c.pair).position;
  const double near = near_a_wire(c, members);
  for (const bool of_pair : {true, false}) {
    const auto is_asked = [&](const PairKey& pair) {
      return of_pair ? pair == c.pair : pair.body == c.pair.body && pair.with_site() && c.pair.with_site();
    };
    for (const HeldContact& w : known.before)
      if (is_asked(w.pair) && w.feature.thin && !w.feature.at_end) {
        const RealVec to_its = members.other_state(w.pair).position - from;
        if (is_on_line(c, w.feature.point + to_its.cast<double>(), w.feature.normal, near))
          return w.feature.normal.dot(n) < 0.0;
      }
    if (met_ && is_asked(met_->first)) {
      const FeatureContact& met = met_->second;
      if (is_on_line(c, (met.point.cast<Real>() - from).cast<double>(), met.normal, near))
        return met.normal.dot(n) < 0.0;
    }
  }
  return std::nullopt;
}

}  // namespace brink
