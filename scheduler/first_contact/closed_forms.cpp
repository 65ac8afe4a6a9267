#include "brink/scheduler/first_contact/closed_forms.h"

#include <algorithm>
#include <boost/container/static_vector.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "brink/core/base/limits.h"
#include "brink/core/shapes/distance.h"
#include "brink/scheduler/first_contact/canonical_time.h"
#include "brink/scheduler/first_contact/pair_kinematics.h"
#include "brink/scheduler/first_contact/straight_discs.h"
#include "brink/scheduler/first_contact/tolerances.h"

namespace brink {

namespace {

/// Outlines of more segments are for the general search: here each is looked at, there an index names a
/// few.
constexpr std::size_t kMostSites = 16;

/// True of a motion that never turns: in its frame a parabola stays a parabola.
bool keeps_angle(const Motion& m) {
  return m.is_ballistic() && m.start().twist.omega == 0.0 && m.acceleration().angular == 0.0;
}

/// True of few segments and nothing else: the distance to the line of each is linear in the place, so its
/// gap to a disc on a parabola is a quadratic of time.
bool only_segments(const Outline& o) {
  return o.sites.size() <= kMostSites && std::all_of(o.sites.begin(), o.sites.end(), [](const Site& s) {
           return s.kind == SiteKind::segment;
         });
}

/// A ballistic motion's places and velocities, with Motion::state's own bits, at hand in a loop.
struct Parabola {
  double origin;
  Vec2 place, velocity, acceleration;

  explicit Parabola(const Motion& m)
      : origin(m.origin()),
        place(m.start().pose.position),
        velocity(m.start().twist.velocity),
        acceleration(m.acceleration().linear) {}
  Vec2 at(double t) const {
    const double s = t - origin;
    return place + s * (velocity + 0.5 * s * acceleration);
  }
  Vec2 velocity_at(double t) const { return velocity + (t - origin) * acceleration; }
};

/// The pair on its common clock s = t - reference.
struct RelativeParabola {
  double reference;
  BodyState a, b;
  Vec2 offset, velocity, acceleration;  ///< a minus b
  double noise;                         ///< rounding of relative velocities [m/s]

  /// Anything with a motion and a velocity_rounding.
  template <class Side>
  RelativeParabola(const Side& ma, const Side& mb) {
    reference = std::max(ma.motion->origin(), mb.motion->origin());
    a = ma.motion->state(reference);
    b = mb.motion->state(reference);
    offset = a.pose.position - b.pose.position;
    velocity = a.twist.velocity - b.twist.velocity;
    acceleration = ma.motion->acceleration().linear - mb.motion->acceleration().linear;
    noise = ma.velocity_rounding + mb.velocity_rounding +
            16.0 * kEpsilon * (a.twist.velocity.lpNorm<1>() + b.twist.velocity.lpNorm<1>());
  }
};

/// The same of two that are told by their centres alone.
struct RelativePath {
  double reference;
  Vec2 place_a, place_b, offset, velocity;
  double noise;

  RelativePath(const Parabola& a, const Parabola& b, double velocity_rounding)
      : reference(std::max(a.origin, b.origin)), place_a(a.at(reference)), place_b(b.at(reference)) {
    const Vec2 velocity_a = a.velocity_at(reference), velocity_b = b.velocity_at(reference);
    offset = place_a - place_b;
    velocity = velocity_a - velocity_b;
    noise = velocity_rounding + 16.0 * kEpsilon * (velocity_a.lpNorm<1>() + velocity_b.lpNorm<1>());
  }
};

/// A rate so near to its rounding may be told as an approach here, and not by the general search.
bool doubtful(double rate, double noise) { return std::abs(rate) <= 8.0 * noise; }

/// When, from s_from on, a gap above its level, on the parabola g, meets it; infinity if never, nothing if
/// the general search must tell. `noise`: rounding of g's slope [m/s]; `deepest`: below -deepest it is no
/// overlap but the far side of a body [m].
std::optional<double> contact_after(const Quadratic& g, double s_from, double noise, double deepest) {
  const double root = falling_root(g);
  const double now = g.at(s_from), slope = g.slope(s_from);
  if (root == kForever) {
    // never: it stays above, or rises since; or it stays below, bent down, and the search knows from where
    return g.second < 0.0 && now >= -deepest ? std::nullopt : std::optional(kForever);
  }
  // ahead, and the only place at which the gap falls through its level
  if (root >= s_from) return doubtful(g.slope(root), noise) ? std::nullopt : std::optional(root);
  if (now < -deepest) return kForever;  // beyond
  if (doubtful(slope, noise)) return std::nullopt;
  if (slope > 0.0) return kForever;  // risen again
  // it falls, past its root and yet above it: which of the two is the rounding?
  return now > 0.0 ? std::nullopt : std::optional(s_from);
}

/// True if a gap that starts at `gap` with the given rate is sure to need no sink_at_start().
bool starts_clear(double gap, double rate, double acceleration, double noise, double tolerance) {
  // deeper it is no start, but the far side of a body
  if (gap >= tolerance || gap < -kOverlapAtStart * tolerance) return true;
  // Rising against `acceleration` all the way, it comes to rate^2 / (2 acceleration), twice what it overlaps or two
  // tolerances: by far more than the half of a sink step that start_sink() asks for.
  return rate > noise && rate * rate >= 4.0 * acceleration * std::max(tolerance, -gap);
}

/// True if the clock can hardly tell such speeds: the search says so.
bool too_fast(const Vec2& velocity, double t, double radius) {
  return !(velocity.norm() * same_instant(t) <= kSlowOfSize * radius);
}

/// Rounding of one place against the other [m], of two parabolas at one time.
class PlaceNoise {
 public:
  PlaceNoise(const Motion& a, const Motion& b) : a_(a, false), b_(b, false) {}
  double operator()(double t, const Vec2& place_a, const Vec2& place_b) const {
    return a_.place(t, place_a) + b_.place(t, place_b);
  }

 private:
  MotionRounding a_, b_;
};

/// True if places with that rounding are told well enough in doubles for what is computed here.
bool near_enough(double place_noise, const SearchLimits& limits) {
  return place_noise <= kFarOfTolerance * limits.tolerance;
}

/// Rounding of a gap [m] between a disc and a site, one seen at q from the other: PairView::gap_rounding().
double gap_noise(double place_noise, const Vec2& q, const Vec2& site) {
  return place_noise + kRoundoff * (6.0 * q.lpNorm<1>() + 2.0 * site.lpNorm<1>());
}

/// The general search's time near the root t, so that it does not matter which of the two a window was given
/// to. Any interval will do that has the crossing and whose ends are beyond twice the rounding (falling_gap.h): the
/// narrowest first.
/// `rounding`: of the gap [m]; `speed`: its own [m/s]. Nothing if there is none: too near the beginning for
/// the gap to have risen above rounding, and not at it.
template <class Gap>
std::optional<double> canonical_root(Gap&& gap, double t, double begin, double rounding, double speed) {
  // where the motions began nothing lies before to bisect from
  if (t <= begin) return gap(begin) <= 0.0 ? std::optional(begin) : std::nullopt;
  const double moment = rounding / speed + 4.0 * ulp(t), sure = 2.0 * rounding;
  for (const double reach : {2.0 * moment, 8.0 * moment, 64.0 * moment})
    if (t - reach > begin && gap(t - reach) > sure && gap(t + reach) < -sure)
      return last_clear_time_by_threes(gap, t - reach, t + reach);
  if (gap(begin) > sure && gap(t + 8.0 * moment) < -sure)
    return last_clear_time(gap, begin, t + 8.0 * moment);
  return std::nullopt;
}

/// True if the root t is after `to` for sure: the general search's time, which alone says whether it is, may be earlier by so
/// much as roundings are worth (canonical_root()). Of what creeps onto what it is pressed on that is not little.
bool is_after(double t, double to, double rounding, double speed) {
  return (t - to) * speed > 64.0 * (rounding + 4.0 * ulp(t) * speed);
}

/// Two centred discs as the general search sees them at time t: the same operations in the same order.
FeatureContact disc_contact(const DiscMover& a, const Parabola& path_a, const DiscMover& b,
                            const Parabola& path_b, double t) {
  const Vec2 at_b = path_b.at(t), offset = path_a.at(t) - at_b;
  const double spin_b =
      b.motion->start().twist.omega + (t - path_b.origin) * b.motion->acceleration().angular;
  const double distance = offset.norm();
  FeatureContact c;
  c.time = t;
  c.sample = c.site = 0;
  c.gap = distance - b.radius - a.radius;
  c.normal = offset * (1.0 / distance);
  c.point = at_b + (offset - c.normal * (c.gap + a.radius));
  c.closing_speed = -c.normal.dot(path_a.velocity_at(t) - Twist{path_b.velocity_at(t), spin_b}.at(offset));
  return c;
}

/// Two centred discs under one acceleration: seen from b, a goes straight on. False: for the general search,
/// where roundings would decide (a start in touch, a graze, a rate within its noise, too far off, too fast).
/// `level_at_start`: tells sink_at_start(), or nothing: then this tells nothing either.
template <class LevelAtStart>
bool discs(const DiscMover& a, const DiscMover& b, double from, double to, const SearchLimits& limits,
           LevelAtStart&& level_at_start, PairAnswer& answer) {
  // Under unequal accelerations the squared distance is of fourth degree in time; two bare points meet at
  // a level of their own (nominal_level()).
  const double reach = b.radius + a.radius;
  if (!(reach > 0.0) || a.motion->acceleration().linear != b.motion->acceleration().linear) return false;
  const Parabola path_a(*a.motion), path_b(*b.motion);
  const RelativePath rel(path_a, path_b, a.velocity_rounding + b.velocity_rounding);
  answer.status = PairAnswer::Status::clear;
  answer.until = to;
  const double speed2 = rel.velocity.squaredNorm(), way = rel.offset.dot(rel.velocity);
  const double distance0 = rel.offset.norm(), s_from = from - rel.reference;
  // of the rate at the beginning: of the velocities, and of the way they are seen along
  const double places = rel.place_a.lpNorm<1>() + rel.place_b.lpNorm<1>();
  const double rate_noise = rel.noise + 4.0 * kRoundoff * places * rel.velocity.lpNorm<1>() / distance0;
  // Seen from each other they go straight on: who parts has parted for good.
  if (way > 8.0 * rate_noise * distance0 && distance0 >= 0.5 * reach) return true;  // they part
  // Touching, and nearer: told here if the straight way leads clearly into the other, in a search from where they
  // began. One that begins moments later would have to look from there.
  const double dip = 0.5 * way * way / (speed2 * distance0);
  const bool in_touch = distance0 - reach < 4.0 * limits.touch && way < 0.0;
  if (in_touch && (s_from > 0.0 || !(dip > 8.0 * limits.touch))) return false;
  // a graze, or not: by a rounding
  if (distance0 - reach < limits.tolerance && doubtful(way / distance0, rate_noise)) return false;
  double level = 0.0;
  if (!starts_clear(distance0 - reach, way / distance0, 0.0, rate_noise, limits.tolerance)) {
    const std::optional<double> told = level_at_start();
    if (!told) return false;
    level = *told;
  }
  const double met = reach + level;
  double s = time_until_within(rel.offset, rel.velocity, met);
  if (!(s >= s_from)) {  // touching at the start, and approaching; or past
    const Vec2 now = rel.offset + s_from * rel.velocity;
    const double rate = now.dot(rel.velocity) / met;
    if (now.norm() <= met + limits.tolerance && doubtful(rate, rel.noise)) return false;
    s = rate < 0.0 ? s_from : kForever;
  }
  double t = std::max(rel.reference + s, from);
  // Here t is when they meet, or infinite.
  // The rounding of places matters where the two are nearest within the window.
  const double nearest = t <= to                    ? t
                         : rel.velocity.isZero(0.0) ? from
                                                    : std::clamp(rel.reference - way / speed2, from, to);
  const double place_noise =
      PlaceNoise(*a.motion, *b.motion)(nearest, path_a.at(nearest), path_b.at(nearest));
  if (!near_enough(place_noise, limits)) return false;
  if (t == kForever) return true;
  const Vec2 then = rel.offset + s * rel.velocity;
  if (t > to && is_after(t, to, gap_noise(place_noise, then, Vec2::Zero()), -then.dot(rel.velocity) / met))
    return true;
  if (too_fast(rel.velocity, t, smallest_radius(a.radius, b.radius))) return false;
  const double closing = -then.dot(rel.velocity) / then.norm();
  if (doubtful(closing, rel.noise)) return false;
  if (closing < 0.0) return true;
  // The general search's own operations in its own order, less the level: bisected, it has the same sign
  // at every double.
  const auto gap = [=](double time) { return (path_a.at(time) - path_b.at(time)).norm() - reach - level; };
  const double rounding = gap_noise(place_noise, then, Vec2::Zero());  // t is the nearest
  const auto root = canonical_root(gap, t, std::max(rel.reference, 0.0), rounding, closing);
  if (!root) return false;
  t = *root;
  if (t > to) return true;
  answer = {PairAnswer::Status::contact, t, disc_contact(a, path_a, b, path_b, t)};
  answer.contact.level = answer.contact.sink = level;
  return true;
}

DiscMover disc_mover(const Mover& m) { return {m.motion, m.outline().sites[0].radius, m.velocity_rounding}; }

/// True if the quadratic stays within [0, length] on [s0, s1].
bool stays_within(const Quadratic& along, double length, double s0, double s1) {
  const auto inside = [&](double s) {
    const double x = along.at(s);
    return x >= 0.0 && x <= length;
  };
  if (!inside(s0) || !inside(s1)) return false;
  if (along.second == 0.0) return true;
  const double turn = -along.rate / along.second;
  // A quadratic is extreme at the ends, or where it turns.
  return turn <= s0 || turn >= s1 || inside(turn);
}

/// A disc on a parabola in the frame of an outline that does not turn, on the clock of RelativeParabola.
struct DiscPath {
  Vec2 q, velocity, acceleration;
  double radius;
  double s_from, s_to;  ///< the window, and a rounding
  double slope_noise;

  Vec2 at(double s) const { return q + s * (velocity + 0.5 * s * acceleration); }
};

/// A segment, the disc's gap to it, and when that closes.
struct SegmentGap {
  const Site* site;
  int index;
  double length;  ///< [m]
  Vec2 tangent;   ///< its direction
  Vec2 normal;    ///< towards the disc
  Quadratic gap;  ///< [m]
  double s;       ///< infinite: never

  /// Bit for bit what the general search sees of a disc of the given radius at q: the gap, and how near the
  /// segment is for choosing among several.
  struct Seen {
    double gap, rank;
  };
  Seen seen(const Vec2& q, double disc_radius, double touch) const {
    const Nearest nearest = nearest_on(*site, q);
    const double side = side_of(*site, nearest, q);
    // as gap_to_neighbours() of the general search ranks them: an interior foot comes before an end that is
    // as near
    const double rank = nearest.distance - site->radius - (nearest.foot == Foot::interior ? touch : 0.0);
    return {side * nearest.distance - (site->radius + disc_radius), rank};
  }
};

/// The gap of the disc to a segment.
/// Of a wire on the side on which the disc is at s_from; ends are left out, and `s` is for meet() to find.
SegmentGap measured(const DiscPath& disc, const Site& site, int index) {
  const Vec2 d = site.b - site.a;
  const double length = d.norm();
  const Vec2 tangent = d / length;
  Vec2 normal = -perp(tangent);  // right of travel: out of a solid
  if (!site.solid && normal.dot(disc.at(disc.s_from) - site.a) < 0.0) normal = -normal;
  return {&site,
          index,
          length,
          tangent,
          normal,
          {normal.dot(disc.q - site.a) - disc.radius - site.radius, normal.dot(disc.velocity),
           normal.dot(disc.acceleration)},
          kForever};
}

/// True if the quadratic stays below -`by`, or above length + `by`, on [s0, s1].
bool stays_beyond(const Quadratic& along, double length, double by, double s0, double s1) {
  const auto before = [&](double s) { return along.at(s) < -by; };
  const auto behind = [&](double s) { return along.at(s) > length + by; };
  const double turn = along.second == 0.0 ? s0 : std::clamp(-along.rate / along.second, s0, s1);
  return (before(s0) && before(s1) && before(turn)) || (behind(s0) && behind(s1) && behind(turn));
}

/// True if a disc that does not speed up stays farther than `reach` from the place on [s0, s1].
bool stays_away(const DiscPath& disc, const Vec2& place, double reach, double s0, double s1) {
  const double way = (disc.q - place).dot(disc.velocity), speed2 = disc.velocity.squaredNorm();
  const double nearest = speed2 > 0.0 ? std::clamp(-way / speed2, s0, s1) : s0;
  return disc.acceleration.isZero(0.0) && (disc.at(nearest) - place).norm() > reach;
}

/// False if it is for the general search: the disc may come to an end of the segment; or, behind the
/// segment's line, its centre does not stay abreast of it.
bool meet(const DiscPath& disc, const SearchLimits& limits, double level, SegmentGap& m) {
  const Site& site = *m.site;
  const double length = m.length;
  const Quadratic along{m.tangent.dot(disc.q - site.a), m.tangent.dot(disc.velocity),
                        m.tangent.dot(disc.acceleration)};
  const Quadratic above{m.gap.value - level, m.gap.rate, m.gap.second};
  // At the reference, which is where one of the two motions began, it touches and comes nearer: a graze or a
  // contact, by a rounding.
  if (above.value < limits.touch && above.value > -limits.tolerance && above.rate < 0.0) return false;
  const auto contact =
      contact_after(above, disc.s_from, disc.slope_noise, disc.radius + site.radius + limits.tolerance);
  if (!contact) return false;
  m.s = *contact;
  const double s_end = std::max(disc.s_from, std::min(m.s, disc.s_to));
  const double now = above.at(disc.s_from);
  const bool leaves = now >= -limits.touch && above.slope(disc.s_from) > 0.0;
  const bool in_front =
      now > limits.touch || (leaves && stays_within(along, length, disc.s_from, disc.s_from));
  // On the line or behind it nothing keeps the ends clear: the centre must be abreast all the way.
  if (!in_front) return stays_within(along, length, disc.s_from, s_end);
  // In front, with above > 0, the disc is clear of the whole line, ends included, until m.s. What counts
  // is where its centre is then: abreast, or on its way past both ends.
  if (m.s > disc.s_to || stays_within(along, length, m.s, m.s)) return true;
  const double reach = disc.radius + site.radius + limits.tolerance;
  const auto away = [&](const Vec2& end) { return stays_away(disc, end, reach, m.s, disc.s_to); };
  const bool passes_by = stays_beyond(along, length, reach, m.s, disc.s_to) || (away(site.a) && away(site.b));
  if (passes_by) m.s = kForever;
  return passes_by;
}

/// A disc and an outline of segments that keeps its angle. Seen in that outline's frame the disc's centre is
/// on a parabola, and each segment's line gives a quadratic; the least root that is abreast of its segment
/// is the contact. False: for the general search, as soon as one of the segments needs it.
bool disc_and_segments(const Mover& disc, const Mover& other, bool disc_is_a, double from, double to,
                       const SearchLimits& limits, SearchScratch& scratch, PairAnswer& answer) {
  const RelativeParabola rel(disc, other);
  const Frame frame(rel.b.pose);
  const double radius = disc.outline().sites[0].radius;
  const DiscPath path{frame.direction_to_local(rel.offset),
                      frame.direction_to_local(rel.velocity),
                      frame.direction_to_local(rel.acceleration),
                      radius,
                      from - rel.reference,
                      to - rel.reference + 4.0 * ulp(to),
                      rel.noise};
  boost::container::static_vector<SegmentGap, kMostSites> gaps;
  double earliest = kForever;
  Vec2 normal = Vec2::Zero();
  // whichever way the normal points: as sink_at_start() has it
  const double bend = rel.acceleration.norm();
  bool clear = true;
  for (const Site& site : other.outline().sites) {
    if (radius + site.radius == 0.0) return false;  // a point on a wire: the search knows its level
    const SegmentGap& m = gaps.emplace_back(measured(path, site, static_cast<int>(gaps.size())));
    clear = clear && starts_clear(m.gap.value, m.gap.rate, bend, rel.noise, limits.tolerance);
  }
  // Asked in the order of the pair, as the general search does: the level must have the same bits.
  const double level = clear       ? 0.0
                       : disc_is_a ? sink_at_start(disc, other, limits, scratch)
                                   : sink_at_start(other, disc, limits, scratch);
  for (SegmentGap& m : gaps) {
    if (!meet(path, limits, level, m)) return false;
    if (m.s < earliest) {
      earliest = m.s;
      normal = m.normal;
    }
  }
  answer = {PairAnswer::Status::clear, to, {}};
  const Parabola parabola(*disc.motion), parabola_of_other(*other.motion);
  double t = std::max(rel.reference + earliest, from);
  const PlaceNoise noise(*disc.motion, *other.motion);
  double place_noise = 0.0;
  // the last of the two stays: rounding at the contact, or at the end
  for (const double time : {from, std::min(t, to)}) {
    place_noise = noise(time, parabola.at(time), parabola_of_other.at(time));
    if (!near_enough(place_noise, limits)) return false;
  }
  if (t == kForever) return true;
  const double speed =
      std::max(-normal.dot(path.velocity + (t - rel.reference) * path.acceleration), rel.noise);
  // no site has coordinates larger than that
  const Vec2 far_off = Vec2::Constant(other.outline().bounding_radius);
  // where roundings decide the general search does: whether a root beyond the window is on its segment was not looked at
  if (t > to) return is_after(t, to, gap_noise(place_noise, path.at(t - rel.reference), far_off), speed);
  const Vec2 at_disc = parabola.at(t), at_other = parabola_of_other.at(t);
  const double rounding = gap_noise(place_noise, at_disc - at_other, far_off);
  const double moment = rounding / speed + 4.0 * ulp(t);
  // segments that are met at the same time to rounding (a notch) count together, as in the general search
  const auto nearest_at = [&](double time) {
    const Vec2 q = frame.direction_to_local(parabola.at(time) - parabola_of_other.at(time));
    double least = kForever;
    std::pair<double, const SegmentGap*> nearest{kForever, nullptr};
    for (const SegmentGap& m : gaps) {
      if (!(m.s <= earliest + 64.0 * moment)) continue;
      const SegmentGap::Seen seen = m.seen(q, radius, limits.touch);
      if (!(seen.rank < least)) continue;
      least = seen.rank;
      nearest = {seen.gap - level, &m};
    }
    return nearest;
  };
  const auto root =
      canonical_root([&](double time) { return nearest_at(time).first; }, t, rel.reference, rounding, speed);
  if (!root) return false;
  t = *root;
  if (t > to) return true;
  // the one that is nearest at the canonical time, which need not be the one with the least root
  const auto [above, met] = nearest_at(t);
  const Vec2 q = frame.direction_to_local(parabola.at(t) - parabola_of_other.at(t));
  if (!can_hold(kRoundoff * (6.0 * q.lpNorm<1>() + 2.0 * other.outline().magnitude), limits.tolerance) ||
      too_fast(path.velocity + (t - rel.reference) * path.acceleration, t,
               smallest_radius(disc.outline(), other.outline())))
    return false;
  const BodyState sd = disc.motion->state(t), so = other.motion->state(t);
  const Vec2 out = frame.direction_to_world(met->normal);
  FeatureContact& c = answer.contact;
  c.time = t;
  c.sample_on_a = disc_is_a;
  c.sample = 0;
  c.site = met->index;
  c.gap = above + level;
  c.level = c.sink = level;
  c.normal = disc_is_a ? out : Vec2(-out);
  c.point = sd.pose.position - out * (radius + c.gap);
  c.closing_speed = -out.dot(sd.twist.velocity - so.twist.velocity);
  answer.status = PairAnswer::Status::contact;
  answer.until = t;
  return true;
}

}  // namespace

double falling_root(const Quadratic& g) {
  // Where g falls through 0 its slope, g.rate + g.second s, is minus the root of the discriminant. With a
  // rate < 0 that s is (root^2 - rate^2) / (-second (root - rate)), in which `second` cancels: nothing is
  // lost where it is small or 0. With a rate >= 0 and a curve that does not bend down, g has fallen in the
  // past, if ever, and rises since.
  const double discriminant = g.rate * g.rate - 2.0 * g.second * g.value;
  if (discriminant < 0.0) return kForever;
  const double root = std::sqrt(discriminant);
  if (g.rate < 0.0) return 2.0 * g.value / (root - g.rate);
  return g.second < 0.0 ? (g.rate + root) / -g.second : kForever;
}

bool has_closed_form(const Mover& a, const Mover& b) {
  if (!a.motion->is_ballistic() || !b.motion->is_ballistic()) return false;
  const bool disc_a = is_centred_disc(a.outline()), disc_b = is_centred_disc(b.outline());
  if (disc_a && disc_b) return true;
  if (disc_a) return keeps_angle(*b.motion) && only_segments(b.outline());
  return disc_b && keeps_angle(*a.motion) && only_segments(a.outline());
}

bool discs_meet(const DiscMover& a, const DiscMover& b, double from, double to, const SearchLimits& limits,
                DiscContact& contact) {
  if (straight_discs_meet(a, b, from, to, limits, contact)) return true;
  PairAnswer answer;
  const auto ask = []() -> std::optional<double> { return std::nullopt; };
  if (!discs(a, b, from, to, limits, ask, answer) || answer.status != PairAnswer::Status::contact)
    return false;
  contact = {answer.contact.time, answer.contact.gap, answer.contact.closing_speed};
  return true;
}

FeatureContact contact_of_discs(const DiscMover& a, const DiscMover& b, double time) {
  return disc_contact(a, Parabola(*a.motion), b, Parabola(*b.motion), time);
}

bool first_contact_in_closed_form(const Mover& a, const Mover& b, double from, double to,
                                  const SearchLimits& limits, SearchScratch& scratch, PairAnswer& answer) {
  if (!has_closed_form(a, b)) return false;
  const bool disc_a = is_centred_disc(a.outline()), disc_b = is_centred_disc(b.outline());
  if (disc_a && disc_b) {
    const auto level = [&] { return std::optional(sink_at_start(a, b, limits, scratch)); };
    const DiscMover disc = disc_mover(a), other = disc_mover(b);
    if (discs(disc, other, from, to, limits, level, answer)) return true;
    // too far from the origin, perhaps: then the pair is looked at from its own place, too
    DiscContact far;
    if (!straight_discs_meet(disc, other, from, to, limits, far)) return false;
    const FeatureContact like = contact_of_discs(disc, other, far.time);
    answer = {PairAnswer::Status::contact, far.time, contact_at(a, b, far.time, like, limits, scratch)};
    return true;
  }
  return disc_a ? disc_and_segments(a, b, true, from, to, limits, scratch, answer)
                : disc_and_segments(b, a, false, from, to, limits, scratch, answer);
}

}  // namespace brink
