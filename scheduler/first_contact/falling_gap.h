#pragma once
/// An interval in which a gap that falls goes through zero once, and no other crossing lies: what a canonical time needs
/// (canonical_time.h). What is computed of the gap may go through zero many times while it is within its rounding of that, so
/// an end is sure only beyond twice the rounding: by more than one it may lie between two of these crossings.

#include <algorithm>
#include <cmath>
#include <optional>

#include "brink/scheduler/first_contact/canonical_time.h"

namespace brink::detail {

/// A gap as it falls at time `t`. `Gap` of its functions: the gap [m] at any time [s].
class FallingGap {
 public:
  /// `now`: the gap at t [m]; it falls at `speed` > 0 [m/s], which changes by no more than `acceleration` >= 0 [m/s^2];
  /// what is computed of it is off by `rounding` > 0 [m].
  FallingGap(double t, double now, double speed, double acceleration, double rounding)
      : t_(t),
        now_(now),
        speed_(speed),
        acceleration_(acceleration),
        rounding_(rounding),
        sure_(2.0 * rounding),
        guess_(t + now / speed),
        off_(std::abs(now) / speed),
        bend_(std::min(1.0, acceleration * off_ / speed) * off_),
        moment_(rounding / speed + 4.0 * ulp(t)) {}

  /// In what time the gap falls by its own rounding, a few ticks of the clock included [s].
  double moment() const { return moment_; }
  /// By when a bent path has met as well, if it meets [s].
  double later() const { return t_ + 4.0 * std::max(0.0, now_) / speed_ + 64.0 * noise(); }

  /// True if by `then` it may have bent up by more than `height` [m] and down again: what is met then may be another crossing.
  bool may_rise_first(double then, double height) const {
    return may_turn() && 0.5 * acceleration_ * (then - t_) * (then - t_) > height;
  }
  /// No sooner than then it rises, but for a thousand ticks of the clock [s].
  double soonest_rise() const {
    const double at_least = 1024.0 * ulp(t_),
                 bends = acceleration_ > 0.0 ? speed_ / acceleration_ : later() - t_;
    return t_ + std::max(at_least, std::min(bends, later() - t_));
  }

  /// The lower end: clear now, or a little before, but not before it rose; none where it never was clear since `floor`.
  template <class Gap>
  std::optional<double> clear_end(Gap&& gap, double floor) const {
    if (now_ <= sure_) {
      std::optional<double> hardly;  // what hops by no more than its rounding is clear of nothing for sure
      double low = std::max(std::min(guess_, t_), floor);
      for (double back = moment_;; back *= 1.25) {
        const double there = gap(low);
        if (there > sure_) return low;
        if (there > rounding_ && !hardly) hardly = low;
        if (low <= floor) return hardly;
        low = std::max(low - back, floor);
      }
    }
    // it falls all the way, as far as it bends: the fewer probes
    const double before = guess_ - 2.0 * noise();
    return before > t_ && gap(before) > sure_ ? before : t_;
  }

  /// The upper end, beyond the surface; `low` where no place beyond it was found.
  struct Beyond {
    double end;
    /// By more than rounding; by twice that, where it goes so deep before the motion ends or it rises.
    bool surely;
  };
  /// No probe lies beyond `last`, where a motion ends.
  template <class Gap>
  Beyond beyond_end(Gap&& gap, double low, double last) const {
    Beyond found{low, false};
    bool done = false;
    const auto look = [&](double t) {
      const double then = std::min(t, last), by = then > low ? -gap(then) : -1.0;
      done = found.surely && then > found.end && by <= rounding_;  // it has risen since
      if (done || !(by >= 0.0) || (found.end > low && by <= rounding_)) return;
      found = {then, by > rounding_};
      done = by > sure_;
    };
    // Where it may turn, Newton's step says nothing: from the earliest time on, or the window would hold what is met
    // later, too.
    if (may_turn())
      for (double ahead = soonest(std::max(std::abs(now_), rounding_)) + 4.0 * ulp(t_);
           !done && ahead < off_ + 2.0 * noise(); ahead *= 2.0)
        look(t_ + ahead);
    // where two points meet, when they are nearest; where a bent path meets it later; and where a tip is grazed, for
    // less than a rounding
    for (const double t :
         {guess_ + 2.0 * noise(), guess_ + 8.0 * noise(), guess_, later(), guess_ + 0.125 * noise(),
          guess_ + 0.25 * noise(), guess_ + 0.5 * noise(), guess_ + noise()})
      if (!done) look(t);
    return found;
  }

 private:
  /// How soon it can fall by so much, if it bends down all the way [s].
  double soonest(double by) const {
    return 2.0 * by / (speed_ + std::sqrt(speed_ * speed_ + 2.0 * acceleration_ * by));
  }
  double noise() const { return moment_ + bend_; }
  /// True if it may turn before it meets: it stops, at the soonest, after it has fallen by speed^2 / (2 acceleration).
  /// What cannot has its crossing before guess_ + 2 noise(), and no other by then.
  bool may_turn() const { return bend_ >= 0.5 * off_; }

  double t_, now_, speed_, acceleration_, rounding_;
  double sure_;   ///< what a computed gap differs from 0 by where the gap itself differs by its rounding [m]
  double guess_;  ///< of Newton's last step [s]
  double off_;    ///< from t to there [s]
  double
      bend_;  ///< how wrong the bending of the gap can make it: the rate changes by a part a off / speed of itself [s]
  double moment_;
};

}  // namespace brink::detail
