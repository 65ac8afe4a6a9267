#pragma once
/// A piece of one body's trajectory: where it is at any time of an interval, and how wild it can be inside a
/// part of it.

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "brink/core/base/extended.h"
#include "brink/core/base/geometry.h"

namespace brink {

/// Enclosures of a motion's rates over a sub-interval: each rate stays within `radius` of its centre.
/// Differences of two bodies' centres keep relative bounds tight (two falling bodies: relative acceleration
/// 0).
struct MotionBounds {
  Vec2 velocity = Vec2::Zero();      ///< centre [m/s]
  double velocity_radius = 0.0;      ///< [m/s]
  Vec2 acceleration = Vec2::Zero();  ///< centre [m/s^2]
  double acceleration_radius = 0.0;  ///< [m/s^2]
  double omega = 0.0;                ///< centre [rad/s]
  double omega_radius = 0.0;         ///< [rad/s]
  double alpha = 0.0;                ///< bound of |angular acceleration| [rad/s^2]

  double speed() const { return velocity.norm() + velocity_radius; }
  double spin() const { return std::abs(omega) + omega_radius; }
};

/// One polynomial piece of dense output on [begin, end]: pose(t) = sum_k c[k] (t - origin)^k over (x, y,
/// angle).
struct PolynomialPiece {
  static constexpr int kMaxDegree = 13;
  double begin = 0.0, end = 0.0;
  double origin = 0.0;
  int degree = 0;
  std::array<Eigen::Vector3d, kMaxDegree + 1> c = none();  // {} would leave them as they are

  BodyState state(double t) const;
  Acceleration acceleration(double t) const;
  MotionBounds bounds(double from, double to) const;

 private:
  static std::array<Eigen::Vector3d, kMaxDegree + 1> none() {
    std::array<Eigen::Vector3d, kMaxDegree + 1> zeros;
    zeros.fill(Eigen::Vector3d::Zero());
    return zeros;
  }
};

/// Consecutive pieces of one body, each beginning where the last ended, pose and twist continuous (C1)
/// between them. Integrators append; motions read.
struct Track {
  std::vector<PolynomialPiece> pieces;

  double begin() const { return begun_.value_or(pieces.front().begin); }
  double end() const { return pieces.back().end; }
  /// @throws std::logic_error where the piece has been forgotten: no answer is better than a wrong one.
  const PolynomialPiece& at(double t) const;
  /// Gives up pieces that end before t, but for the last kRemembered of them, if that is half of all: nobody will ask for them
  /// any more. begin() stays.
  void forget_before(double t);
  /// Up to when a piece is at most kRemembered after that of `begin`; infinity: so far all are.
  double remembered_until(double begin) const;
  /// When the piece begins that is kRemembered before that of t, or the first. @pre t has not been given up
  double remembered_from(double t) const;

  /// Pieces that lie so few before a time that may be asked for are there, whenever others were given up.
  static constexpr std::ptrdiff_t kRemembered = 512;

 private:
  std::optional<double> begun_;  ///< where the first piece began that is gone [s]
};

/// A motion covers [begin(), end()] (end may be infinite) and is a value: copying it copies no trajectory.
/// The twist is always the exact derivative of the pose.
class Motion {
 public:
  /// A body that stays where it is, for ever.
  static Motion still(const Pose& pose, double t0 = 0.0);
  /// Constant acceleration from `start` at t0, valid to t1: closed form. `low` is what start's rounding left
  /// over: only extended_state() sees it.
  static Motion ballistic(double t0, const BodyState& start, const Acceleration& acceleration,
                          double t1 = std::numeric_limits<double>::infinity(), const BodyState& low = {});
  /// Linear drag, dv/dt = drive - linear v (and the same for the angle), in closed form. @pre rates >= 0
  /// [1/s].
  static Motion drag(double t0, const BodyState& start, const Acceleration& drive, double linear,
                     double angular, double t1 = std::numeric_limits<double>::infinity());
  /// Dense output of an integrator; `track` may grow behind the motion's back. @pre not empty.
  static Motion dense(std::shared_ptr<const Track> track);
  /// Consecutive closed-form motions, each beginning where the last ends; the chain may grow behind the
  /// motion's back. At a join the later one answers. @pre not empty, none of them dense or a chain.
  static Motion chain(std::shared_ptr<const std::vector<Motion>> pieces);

  /// The same motion elsewhere: every pose moved by `by` [m]. Of a parabola, moved in extended precision.
  Motion displaced(const Vec2& by) const;

  Motion() = default;

  /// Begins again at t0, under the acceleration it has. @pre is_ballistic().
  void start_anew(double t0, const BodyState& start, const BodyState& low) {
    t0_ = t0;
    start_ = start;
    low_ = low;
  }

  /// What the rounding of its start left over: only extended_state() sees it.
  void keep_low(const Pose& low) { low_.pose = low; }

  double begin() const { return kind_ <= Kind::drag ? t0_ : begin_of_pieces(); }
  double end() const;
  /// Up to when `begin` can be asked for as well, however long the motion was followed, and whatever of it was given up
  /// (Track::forget_before): a function of the motion alone [s].
  double remembered_until(double begin) const;
  /// From when on it can be asked for as long as t may be, whatever of it was given up: a function of the motion alone [s].
  double remembered_from(double t) const;
  /// False for a time that cannot be asked for any more.
  bool remembers(double t) const { return remembered_until(t) >= t; }

  /// @pre begin() <= t <= end(). Cost: a few flops (ballistic), an exponential or two (drag), a binary search
  /// and Horner (dense).
  BodyState state(double t) const;
  Pose pose(double t) const { return state(t).pose; }
  /// state(t)'s position, to the bit; quicker of a parabola.
  Vec2 place(double t) const {
    if (!is_ballistic()) return state(t).pose.position;
    const double s = t - t0_;
    return start_.pose.position + s * (start_.twist.velocity + 0.5 * s * drive_.linear);
  }
  Twist twist(double t) const { return state(t).twist; }

  /// The exact derivative of twist(t); where pieces of dense output meet, that of the later one.
  Acceleration rate(double t) const;

  /// The state in extended precision: of a parabola from the low-order part of its start on, of anything else
  /// state(t) beside it.
  ExtendedState extended_state(double t) const;
  /// Its twist alone: cheaper.
  ExtendedTwist extended_twist(double t) const;

  /// Enclosures over [from, to]. @pre begin() <= from <= to <= end().
  MotionBounds bounds(double from, double to) const;

  /// True for a parabola (uniform acceleration, `still` included): closed forms may use start() and
  /// acceleration().
  bool is_ballistic() const { return kind_ == Kind::ballistic; }
  /// True for what stands where it is, for ever.
  bool is_still() const {
    return is_ballistic() && start_.twist.velocity.isZero(0.0) && start_.twist.omega == 0.0 && !has_drive();
  }
  /// [begin, end] of the one formula that answers at t: of the later one, where two meet. @pre begin() <= t <= end()
  std::pair<double, double> piece_at(double t) const;
  /// The pieces of dense output; null: a closed form.
  const Track* track() const { return kind_ == Kind::dense ? other_->track.get() : nullptr; }
  double origin() const { return begin(); }
  const BodyState& start() const { return start_; }
  const BodyState& start_low() const { return low_; }
  const Acceleration& acceleration() const { return drive_; }

 private:
  enum class Kind : unsigned char { ballistic, drag, dense, chain };
  double begin_of_pieces() const;
  bool has_drive() const { return !drive_.linear.isZero(0.0) || drive_.angular != 0.0; }
  const Motion& link(double t) const;  ///< of a chain: the last that begins at or before t

  Kind kind_ = Kind::ballistic;
  double t0_ = 0.0;
  double t1_ = std::numeric_limits<double>::infinity();
  BodyState start_, low_;
  Acceleration drive_;
  /// What a parabola does without.
  struct Other {
    double linear = 0.0, angular = 0.0;  ///< rates of drag [1/s]
    std::shared_ptr<const Track> track;
    std::shared_ptr<const std::vector<Motion>> chain;
    Vec2 offset = Vec2::Zero();  ///< of a track or chain that is displaced [m]
  };
  std::shared_ptr<const Other> other_;
};

}  // namespace brink
