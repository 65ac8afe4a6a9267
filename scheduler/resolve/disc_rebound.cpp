/// Written once for any kind of product (double_double.h), and compiled for processors with fused products, too: the
/// same bits in two thirds of the time.
#include "brink/scheduler/resolve/disc_rebound.h"

#include <algorithm>
#include <cmath>

#include "brink/core/base/double_double_pair.h"
#include "brink/scheduler/resolve/tolerances.h"

namespace brink {

namespace {

// All of it in the caller, so that it is compiled for the caller's processor.
#define BRINK_INLINE [[gnu::always_inline]] inline

template <class Number>
struct PairOf;
template <class Product>
struct PairOf<BasicDoubleDouble<Product>> {
  using Type = DoubleDoublePair<Product>;
  using OfTwo = DoubleDoublePairs<Product>;
};
/// A plane's vector of two doubles a coordinate.
template <class Number>
using Pair = typename PairOf<Number>::Type;
/// One of each of two discs.
template <class Number>
using Pairs = typename PairOf<Number>::OfTwo;

/// The same kind of number, of which every operation looks whether its range is left.
template <class Number>
struct LookingOf;
template <class Product>
struct LookingOf<BasicDoubleDouble<Product>> {
  using Type = BasicDoubleDouble<Product>;
};
template <class Product>
struct LookingOf<BasicDoubleDouble<error_free::InRange<Product>>> {
  using Type = BasicDoubleDouble<Product>;
};
template <class Number>
using Looking = typename LookingOf<Number>::Type;

/// What is asked of a pair.
enum class Told { rebound, none, not_here };

/// Sizes that are neither 0 nor far from any that occur. Of ways, times, velocities, masses and rates of such sizes no
/// product and no quotient below leaves the range of two doubles: 2^955 at most.
constexpr double kLeastPlain = 0x1p-150, kMostPlain = 0x1p150;

BRINK_INLINE bool is_plain(double x) {
  const double size = __builtin_fabs(x);
  const bool least = size >= kLeastPlain, most = size <= kMostPlain;
  return least & most;
}
template <class Product>
BRINK_INLINE bool is_plain(const DoubleDoublePair<Product>& x) {
  return x.lies_between(kLeastPlain, kMostPlain);
}

/// A wall's way along one axis: 0 of a wall along the other. A product with 0 leaves no range either: it is 0, and so
/// is its error, and what it is added to is none.
BRINK_INLINE bool is_plain_or_zero(double x) { return x == 0.0 || is_plain(x); }

/// Where a disc is at one time, from its start and what rounding left over of it.
template <class Number>
struct Moving {
  Pair<Number> place, velocity;

  BRINK_INLINE Moving(const Pair<Number>& at, const Pair<Number>& by) : place(at), velocity(by) {}
  /// Where it starts.
  BRINK_INLINE explicit Moving(const Motion& m)
      : place(from(m.start().pose.position, m.start_low().pose.position)),
        velocity(from(m.start().twist.velocity, m.start_low().twist.velocity)) {}
  BRINK_INLINE Moving(const Motion& m, double t) : Moving(m) {
    const Number since = Number::sum(t, -m.origin());
    const double ax = m.acceleration().linear.x(), ay = m.acceleration().linear.y();
    // without forces the velocity stays, and half of the products are saved
    if (ax == 0.0 && ay == 0.0) {
      place = place + velocity * since;
      return;
    }
    const Pair<Number> gained(since * ax, since * ay);
    place = place + (velocity + gained * 0.5) * since;
    velocity = velocity + gained;
  }

 private:
  BRINK_INLINE static Pair<Number> from(const Vec2& high, const Vec2& low) {
    return {Number(high.x(), low.x()), Number(high.y(), low.y())};
  }
};

/// Where two discs are, side by side.
template <class Number>
struct MovingDiscs {
  Pairs<Number> places, velocities;

  BRINK_INLINE MovingDiscs(const Moving<Number>& a, const Moving<Number>& b)
      : places(a.place, b.place), velocities(a.velocity, b.velocity) {}
  /// Without forces.
  BRINK_INLINE static MovingDiscs straight(const Motion& a, const Motion& b, double t) {
    MovingDiscs both{Moving<Number>(a), Moving<Number>(b)};
    both.places =
        both.places + both.velocities.times(Number::sum(t, -a.origin()), Number::sum(t, -b.origin()));
    return both;
  }
};

/// True of a motion without forces whose numbers make Moving no product out of range.
BRINK_INLINE bool is_plain(const Motion& m, double time) {
  const Vec2 &at = m.start().pose.position, &velocity = m.start().twist.velocity;
  const bool near = std::max(std::abs(at.x()), std::abs(at.y())) <= kMostPlain,
             free = m.acceleration().linear.isZero(0.0);
  const bool x = is_plain(velocity.x()), y = is_plain(velocity.y()), since = is_plain(time - m.origin());
  return near & free & x & y & since;
}

/// @pre without looks at ranges: is_plain() of both.
template <class Number>
BRINK_INLINE MovingDiscs<Number> moving_discs(const Motion& a, const Motion& b, double t) {
  if constexpr (Number::kLooks) return {Moving<Number>(a, t), Moving<Number>(b, t)};
  return MovingDiscs<Number>::straight(a, b, t);
}

/// A value as a double and what that leaves over.
template <class Number>
BRINK_INLINE void split(const Number& value, double& high, double& low) {
  high = value.high();
  low = value.low();
}

template <class Product>
BRINK_INLINE void split(const DoubleDoublePair<Product>& value, Vec2& high, Vec2& low) {
  split(value.x(), high.x(), low.x());
  split(value.y(), high.y(), low.y());
}

/// The start at `time` of the parabola that goes through that place with that velocity.
template <class Number>
BRINK_INLINE void start_at(const Motion& before, double time, const Pair<Number>& place,
                           const Pair<Number>& velocity, DiscRebound::Start& start) {
  BodyState &s = start.state, &low = start.low;
  split(place, s.pose.position, low.pose.position);
  split(velocity, s.twist.velocity, low.twist.velocity);
  // Without friction nothing turns at the rim: angle and spin go on as they were.
  const BodyState &high = before.start(), &rest = before.start_low();
  const double alpha = before.acceleration().angular;
  using Angle = Looking<Number>;  // what turns without acceleration makes products that are 0
  const Angle angle(high.pose.angle, rest.pose.angle), omega(high.twist.omega, rest.twist.omega);
  if (omega == 0.0 && alpha == 0.0) {
    split(angle, s.pose.angle, low.pose.angle);
    s.twist.omega = low.twist.omega = 0.0;
    return;
  }
  const Angle since = Angle::sum(time, -before.origin()), gained = since * alpha;
  split(angle + since * (omega + gained * 0.5), s.pose.angle, low.pose.angle);
  split(omega + gained, s.twist.omega, low.twist.omega);
}

/// The start at `time` of the parabola on which `disc` passes, with its velocity changed by `change`, through the place
/// where it was `delay` from then.
template <class Number>
BRINK_INLINE void start_after(const Motion& motion, double time, const Moving<Number>& disc,
                              const Pair<Number>& change, double delay, DiscRebound::Start& start) {
  // Both parabolas have the same acceleration. So they are at one place `delay` from now if their places
  // now differ by what their velocities make of it.
  start_at<Number>(motion, time, disc.place.plus(-(change.x().high() * delay), -(change.y().high() * delay)),
                   disc.velocity + change, start);
}

/// The same of two at once.
template <class Number>
BRINK_INLINE void start_after(const DiscSide& a, const DiscSide& b, double time,
                              const MovingDiscs<Number>& discs, const Pairs<Number>& changes, double delay,
                              DiscRebound& r) {
  const Pair<Number> of_a = changes.first(), of_b = changes.second();
  const Pairs<Number> places = discs.places.plus(-(of_a.x().high() * delay), -(of_a.y().high() * delay),
                                                 -(of_b.x().high() * delay), -(of_b.y().high() * delay));
  const Pairs<Number> velocities = discs.velocities + changes;
  start_at<Number>(*a.motion, time, places.first(), velocities.first(), r.a);
  start_at<Number>(*b.motion, time, places.second(), velocities.second(), r.b);
}

/// Sum of the speeds at a disc's edge.
BRINK_INLINE double speed_of(const DiscRebound::Start& s, double speed, double radius) {
  return speed + std::abs(s.state.twist.omega) * radius;
}

/// With d = x_a - x_b and w = v_a - v_b at `time`:
///   delay   (|d| - r_a - r_b - level) / closing,  closing = -d.w / |d|
///   c       d + delay w, the centres' way apart at the moment of contact
///   f       -(1 + e) c.w / (c.c (1 / m_a + 1 / m_b)), the impulse over |c|
///   after   v_a + f c / m_a  and  v_b - f c / m_b
/// Accelerations are the same before and after, so the velocities of `time` change by as much as those of the
/// moment of contact. The delay is a few ticks of the clock: a double tells it, and what it adds to d, to more than
/// all digits of d; what an acceleration adds to the way goes with its square.
template <class Number>
BRINK_INLINE Told rebound_of_discs(const DiscSide& a, const DiscSide& b, const Vec2& shift, double time,
                                   double latest, double level, double restitution, DiscRebound& r) {
  if (!Number::kLooks && !(is_plain(*a.motion, time) && is_plain(*b.motion, time))) return Told::not_here;
  const auto discs = moving_discs<Number>(*a.motion, *b.motion, time);
  Pair<Number> d = discs.places.first() - discs.places.second();
  const Pair<Number> w = discs.velocities.first() - discs.velocities.second();
  if (shift.x() != 0.0 || shift.y() != 0.0) d = d.plus(-shift.x(), -shift.y());
  if (!Number::kLooks && !(is_plain(d) && is_plain(w))) return Told::not_here;
  const Number distance2 = d.dot(d), way = d.dot(w);
  const double distance = std::sqrt(distance2.high()), closing = -way.high() / distance;
  if (!(closing > 0) || !(a.inverse_mass + b.inverse_mass > 0.0)) return Told::none;
  const Number reach = Number::sum(a.radius, b.radius) + level;
  const Number masses = Number::sum(a.inverse_mass, b.inverse_mass);
  // a difference of squares, so that nothing cancels in double
  const double above = (distance2 - reach * reach).high() / (distance + reach.high());
  const double delay = std::clamp(above / closing, -latest, latest);
  r.delay = delay;
  r.gap = level + (above - delay * closing);
  const Pair<Number> c = d.plus(w.x().high() * delay, w.y().high() * delay);
  const Vec2 pull = a.motion->acceleration().linear - b.motion->acceleration().linear;
  const double speed2 = w.x().high() * w.x().high() + w.y().high() * w.y().high();
  // c.w with the relative velocity of the moment of contact, and c.c
  const Number rate = way + delay * (speed2 + (d.x().high() * pull.x() + d.y().high() * pull.y()));
  // turned round within the delay: no impulse is due
  if (!(rate.high() < 0)) return Told::none;
  if (!Number::kLooks && !(is_plain(c) && is_plain(reach.high()) && is_plain(rate.high()) &&
                           is_plain(a.inverse_mass) && is_plain(b.inverse_mass)))
    return Told::not_here;
  const Number square = distance2 + delay * (2.0 * way.high() + delay * speed2);
  // The rate is that of the moment of contact, and -restitution times it the one after.
  const Number force = -(Number::sum(1.0, restitution) * rate) / (square * masses);
  r.impulse = force.high() * std::sqrt(square.high());
  const Pair<Number> push = c * force;
  start_after<Number>(a, b, time, discs, Pairs<Number>(push, push).times(a.inverse_mass, -b.inverse_mass),
                      delay, r);
  r.magnitude = std::max(speed_of(r.a, discs.velocities.first().size(), a.radius),
                         speed_of(r.b, discs.velocities.second().size(), b.radius));
  return Told::rebound;
}

/// As above with 1 / m_b = 0 and v_b = 0; the gap is the distance from the wall's middle line, less half its
/// thickness and the disc's radius. m: across the wall, to the disc, as long as the wall; after: v - (1 + e) m.v / m.m m.
template <class Number>
BRINK_INLINE Told rebound_of_wall(const DiscSide& disc, const WallSide& wall, double time, double latest,
                                  double level, double restitution, DiscRebound& r) {
  const auto number = [](const Real& of) __attribute__((always_inline)) {
    return Number(of.high(), of.low());
  };
  if (!Number::kLooks && !is_plain(*disc.motion, time)) return Told::not_here;
  const Moving<Number> at(*disc.motion, time);
  const Pair<Number> begin(number(wall.begin.x()), number(wall.begin.y())),
      way = Pair<Number>(number(wall.end.x()), number(wall.end.y())) - begin, d = at.place - begin;
  if (!Number::kLooks &&
      !(is_plain_or_zero(way.x().high()) && is_plain_or_zero(way.y().high()) && is_plain(at.place) &&
        is_plain(d) && is_plain_or_zero(wall.radius) && is_plain(disc.radius)))
    return Told::not_here;
  const Number length2 = way.dot(way), along = d.dot(way);
  // 0 and length^2 are the ends: beyond them an end is nearest
  if (!(along > 0.0) || !(along < length2)) return Told::none;
  // The wall's normal is (y, -x) of its way, or the opposite: the one that points to the disc.
  Pair<Number> m(way.y(), -way.x());
  const double side = m.x().high() * wall.normal.x() + m.y().high() * wall.normal.y();
  if (side < 0.0) m = -m;
  const Number length = sqrt(length2);
  // Abreast, but met with a normal that is not the wall's: the contact is with an end, to rounding.
  if (std::abs(side) < kSameDirection * length.high()) return Told::none;
  const Number rate_now = m.dot(at.velocity);
  if (!(rate_now.high() < 0)) return Told::none;
  if (!Number::kLooks && !is_plain(rate_now.high())) return Told::not_here;
  // its normal is the same wherever the disc is abreast of it: nothing is looked at again after the delay
  const double gap = ((m.dot(d) - length * wall.radius - length * disc.radius) / length).high();
  const double closing = -rate_now.high() / length.high();
  const double delay = std::clamp((gap - level) / closing, -latest, latest);
  r.delay = delay;
  r.gap = gap - delay * closing;
  const Vec2& pull = disc.motion->acceleration().linear;
  const Number rate = rate_now + delay * (m.x().high() * pull.x() + m.y().high() * pull.y());
  if (!(rate.high() < 0)) return Told::none;
  if (!Number::kLooks && !is_plain(rate.high())) return Told::not_here;
  const Number change = -(Number::sum(1.0, restitution) * rate) / length2;
  r.impulse = change.high() * length.high() / disc.inverse_mass;
  start_after(*disc.motion, time, at, m * change, delay, r.a);
  r.magnitude = speed_of(r.a, at.velocity.size(), disc.radius);
  return Told::rebound;
}

#undef BRINK_INLINE

#if defined(__x86_64__) && !defined(__FP_FAST_FMA)

using FusedNumber = BasicDoubleDouble<error_free::Fused>;
using FusedInRange = BasicDoubleDouble<error_free::InRange<error_free::Fused>>;

[[gnu::target("fma")]] Told fused_in_range(const DiscSide& a, const DiscSide& b, const Vec2& shift,
                                           double time, double latest, double level, double restitution,
                                           DiscRebound& r) {
  return rebound_of_discs<FusedInRange>(a, b, shift, time, latest, level, restitution, r);
}

[[gnu::target("fma")]] Told fused_rebound(const DiscSide& a, const DiscSide& b, const Vec2& shift,
                                          double time, double latest, double level, double restitution,
                                          DiscRebound& r) {
  return rebound_of_discs<FusedNumber>(a, b, shift, time, latest, level, restitution, r);
}

[[gnu::target("fma")]] Told fused_in_range(const DiscSide& disc, const WallSide& wall, double time,
                                           double latest, double level, double restitution, DiscRebound& r) {
  return rebound_of_wall<FusedInRange>(disc, wall, time, latest, level, restitution, r);
}

[[gnu::target("fma")]] Told fused_rebound(const DiscSide& disc, const WallSide& wall, double time,
                                          double latest, double level, double restitution, DiscRebound& r) {
  return rebound_of_wall<FusedNumber>(disc, wall, time, latest, level, restitution, r);
}

#endif

/// First as if nothing could leave its range; where something may, once more.
Told rebound_of(const DiscSide& a, const DiscSide& b, const Vec2& shift, double time, double latest,
                double level, double restitution, DiscRebound& r) {
#if defined(__x86_64__) && !defined(__FP_FAST_FMA)
  if (error_free::has_fused_products) {
    const Told told = fused_in_range(a, b, shift, time, latest, level, restitution, r);
    if (told != Told::not_here) return told;
    return fused_rebound(a, b, shift, time, latest, level, restitution, r);
  }
#endif
  return rebound_of_discs<Real>(a, b, shift, time, latest, level, restitution, r);
}

Told rebound_of(const DiscSide& disc, const WallSide& wall, double time, double latest, double level,
                double restitution, DiscRebound& r) {
#if defined(__x86_64__) && !defined(__FP_FAST_FMA)
  if (error_free::has_fused_products) {
    const Told told = fused_in_range(disc, wall, time, latest, level, restitution, r);
    if (told != Told::not_here) return told;
    return fused_rebound(disc, wall, time, latest, level, restitution, r);
  }
#endif
  return rebound_of_wall<Real>(disc, wall, time, latest, level, restitution, r);
}

}  // namespace

bool rebound(const DiscSide& a, const DiscSide& b, const Vec2& shift, double time, double latest,
             double level, double restitution, DiscRebound& result) {
  return rebound_of(a, b, shift, time, latest, level, restitution, result) == Told::rebound;
}

std::optional<DiscRebound> rebound(const DiscSide& a, const DiscSide& b, const Vec2& shift, double time,
                                   double latest, double level, double restitution) {
  std::optional<DiscRebound> r(std::in_place);  // written where it is returned
  if (!rebound(a, b, shift, time, latest, level, restitution, *r)) r.reset();
  return r;
}

std::optional<DiscRebound> rebound(const DiscSide& disc, const WallSide& wall, double time, double latest,
                                   double level, double restitution) {
  std::optional<DiscRebound> r(std::in_place);
  if (!rebound(disc, wall, time, latest, level, restitution, *r)) r.reset();
  return r;
}

bool rebound(const DiscSide& disc, const WallSide& wall, double time, double latest, double level,
             double restitution, DiscRebound& result) {
  return rebound_of(disc, wall, time, latest, level, restitution, result) == Told::rebound;
}

}  // namespace brink
