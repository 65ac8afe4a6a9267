#pragma once
/// The margins of the search for first contact, all in one place. Each is a function of the two motions and
/// of time alone, never of where a search began: so that every search finds the same contact.
///
/// A gap is computed with some rounding `nu` (gap_rounding). Three margins keep it from mattering:
///   - a thin wire has no inside that would tell that it was crossed; so it is met at a *level* of at least
///     8 nu before it (nominal_level): what stays beyond the level is never in doubt about its side; nor is it
///     where places are seen in extended precision now and in doubles a moment later: nu is that of doubles there;
///   - a pair that starts touching, pressed together or all but at rest, has its next contact when it has
///     sunk by a *sink step* of at least 2.5 nu (sink_step), of a wire's level by no more than kThinSinks: so
///     every contact is a crossing of its level from clear above, and what has sunk is pushed out again as it
///     is resolved, off a wire by less than is left of the level;
///   - steps of the search end at half the *band* (the contact tolerance, or what the clock cannot tell
///     apart), never on the surface.
/// Where nu is not small beside the contact tolerance the search does not tell a contact but says so
/// (PairAnswer::Why::place): nothing is missed, as the level then lies beyond nu.

#include <algorithm>
#include <cmath>
#include <limits>

#include "brink/integrators/motion.h"

namespace brink {

/// Unit roundoff of double: half the distance from 1 to the next.
inline constexpr double kRoundoff = 0.5 * std::numeric_limits<double>::epsilon();
/// The same of Real, in which start states are kept.
inline constexpr double kRealRoundoff = 0.5 * static_cast<double>(std::numeric_limits<Real>::epsilon());

/// Gaps below this part of the contact tolerance are touching.
inline constexpr double kTouchOfTolerance = 1e-3;

/// Outlines may overlap by so many contact tolerances where they start; what is deeper is refused, or not the
/// start of this pair.
inline constexpr double kOverlapAtStart = 1e4;

/// Bound on the rounding of start + s (rate + s / 2 bent), `now` in the end, in arithmetic of unit roundoff
/// u: four roundings of the way, one of the sum. All numbers are sums of sizes. None of what stands still and
/// is a double (`low`: what its start's rounding left over). What moves is taken to be rounded right where it begins,
/// though it is exact there: levels and margins would jump a moment later.
struct WayRounding {
  double low, rate, bent;

  double operator()(double s, double now, double u) const {
    const double way = std::abs(s) * (rate + 0.5 * std::abs(s) * bent);
    return rate + bent + low > 0.0 ? u * (4.0 * way + now) : 0.0;
  }
};

/// Bounds on the rounding of a motion's places and angles, in double precision, at hand for many times.
/// Dense output is as exact as its coefficients: eight roundings of the place, joins of pieces among them.
class MotionRounding {
 public:
  /// `turns`: false for what looks the same at any angle, whose rounding is none.
  explicit MotionRounding(const Motion& m, bool turns = true)
      : parabola_(m.is_ballistic()),
        turns_(turns),
        origin_(m.origin()),
        place_{m.start_low().pose.position.lpNorm<1>(), m.start().twist.velocity.lpNorm<1>(),
               m.acceleration().linear.lpNorm<1>()},
        angle_{std::abs(m.start_low().pose.angle), std::abs(m.start().twist.omega),
               std::abs(m.acceleration().angular)} {}

  /// Of its place at time t, `now` [m].
  double place(double t, const Vec2& now, double u = kRoundoff) const {
    return parabola_ ? place_(t - origin_, now.lpNorm<1>(), u) : 8.0 * kRoundoff * now.lpNorm<1>();
  }
  /// Of its angle at time t, `now` [rad].
  double angle(double t, double now, double u = kRoundoff) const {
    if (!turns_) return 0.0;
    return parabola_ ? angle_(t - origin_, std::abs(now), u) : 8.0 * kRoundoff * std::abs(now);
  }

 private:
  bool parabola_, turns_;
  double origin_;
  WayRounding place_, angle_;
};

/// Sine of an angle between an edge and a face, or of a pull beside its size, that roundings may make of none: far more
/// than those of directions (some 1e-15), far less than an angle that a scene means.
inline constexpr double kParallel = 1e-6;

/// Places are taken relative to the pair, in extended precision, where their rounding in double is more than
/// this part of the contact tolerance.
inline constexpr double kFarOfTolerance = 1.0 / 1024.0;

/// True if gaps of that rounding can be held to the contact tolerance; of features that meet at the given
/// level; pressed: though the pair sinks a few steps more.
inline bool can_hold(double rounding, double tolerance, double level = 0.0, bool pressed = false) {
  return std::max(rounding, 2.0 * level) <= tolerance && (!pressed || 16.0 * rounding <= tolerance);
}

/// The gap at which features meet that start apart [m]: 0; thin, a sharp sample and a wire without thickness:
/// so far before it; where gaps cannot be held to the tolerance: as far before as they may be wrong.
inline double nominal_level(double touch, double tolerance, double rounding, bool thin) {
  if (thin) return std::max(0.5 * touch, 8.0 * rounding);
  return can_hold(rounding, tolerance) ? 0.0 : 2.0 * rounding;
}

/// The highest at which thin ones meet that are seen in double precision, or finer [m]: where they lie at this gap, no
/// rounding of their places puts them on a wire's other side.
inline double thin_level_at_most(double touch, double tolerance) {
  return nominal_level(touch, tolerance, kFarOfTolerance * tolerance, true);
}

/// What moves more than this part of its radius within one instant (same_instant()) is too fast to be told.
inline constexpr double kSlowOfSize = 1e-3;

/// How far a pair that is pressed together sinks until that is a contact again [m].
inline double sink_step(double touch, double rounding) { return std::max(0.125 * touch, 2.5 * rounding); }

/// How far a pair sinks at most below the level before a wire, and how far it is pushed out again at most, in units of
/// that level (3 nu of 8, where nu decides): so the next contact is a crossing from more than nu above, and no push leads
/// past another wire, of whose level 5 nu are left, too.
inline constexpr double kThinSinks = 3.0 / 8.0;

/// How far features are pushed apart that have sunk into each other by `sunk` > 0 [m], as they collide: as
/// far as the loss of energy, as a part of it, pays for the way: at least as much was won on it; thin ones, whatever the
/// loss, as their next sink needs it: all of it.
inline double push_of(double sunk, double nominal, double tolerance, double loss) {
  return nominal > 0.0 ? std::min(sunk, kThinSinks * nominal) : std::min(loss * sunk, 0.5 * tolerance);
}

/// The gap at which features meet of a pair that may have sunk by `sink` <= 0 [m].
inline double level_of(double nominal, double sink) {
  return std::max(nominal + sink, nominal > 0.0 ? (1.0 - kThinSinks) * nominal : sink);
}

/// The level at which a pair that starts touching meets [m], below its nominal one (0): `gap` and `rate` are
/// the least at the start, less nominal levels; `noise` bounds the rounding of the rate, `acceleration` the
/// bending of the gap. A pair that leaves (that rises by half a step at least) is met where it starts, to a
/// multiple of a step, or bounces would sink by a rounding each; or at the nominal level if it rises above that. One
/// that does not is met one step below its start.
inline double start_sink(double gap, double rate, double noise, double acceleration, double step) {
  const double rise = rate <= noise        ? 0.0
                      : acceleration > 0.0 ? 0.5 * rate * rate / acceleration
                                           : std::numeric_limits<double>::infinity();
  if (gap + rise >= 0.5 * step) return 0.0;
  if (rise < 0.5 * step) return gap - step;
  return step * std::floor((gap + std::min(0.5 * step, rise - 0.5 * step)) / step);
}

}  // namespace brink
