/// Four kinds behind one face. A parabola holds all that it needs, and drag its start and drive; rates of
/// drag, the track of dense output and the links of a chain stand behind one shared pointer, so that copies
/// share them. Tracks and chains grow while motions look at them: what is asked is what is there by then.
#include "brink/integrators/motion.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "brink/core/base/elementary.h"

namespace brink {

namespace {

/// x'' = drive - k x' after time s: displacement and rate.
struct Relaxed {
  double moved;
  double rate;
};

/// (z - (1 - e^-z)) / z^2; its Taylor series 1/2 - z/6 + z^2/24 - ... where the difference would cancel.
double mean_rise(double z) {
  // z - (1 - e^-z) is about z^2 / 2: at 0.5 the difference still has all but three of its bits.
  if (z > 0.5) return (z - (1.0 - exponential(-z))) / (z * z);
  // Alternating, with terms that fall: what is left out is less than the last term.
  double term = 0.5, sum = 0.5;
  for (int k = 3; std::abs(term) > 1e-18; ++k) sum += term *= -z / k;
  return sum;
}

/// (1 - e^-z) / z.
double mean_decay(double z) { return z > 0.5 ? (1.0 - exponential(-z)) / z : 1.0 - z * mean_rise(z); }

/// One coordinate under linear drag. @pre k >= 0 [1/s], s >= 0 [s].
Relaxed relax(double rate0, double drive, double k, double s) {
  const double z = k * s, decay = mean_decay(z);
  // with v = v0 e^-kt + (drive / k)(1 - e^-kt), integrated once; never divided by k, which may be 0
  return {s * (rate0 * decay + s * (drive * mean_rise(z))), rate0 * exponential(-z) + s * (drive * decay)};
}

/// Smallest disc-like enclosure that holds both.
void merge(Vec2& center, double& radius, const Vec2& other_center, double other_radius) {
  const double distance = (other_center - center).norm();
  // one of the discs may hold the other already
  if (distance + other_radius <= radius) return;
  if (distance + radius <= other_radius) {
    center = other_center;
    radius = other_radius;
    return;
  }
  // the disc whose diameter runs from the far side of the one to the far side of the other
  const double merged = 0.5 * (distance + radius + other_radius);
  center += (other_center - center) * ((merged - radius) / distance);
  // a little wider, for the roundings of the new centre and radius
  radius = merged * (1.0 + 1e-15);
}

/// `into` grows until it encloses the rates of both.
void merge(MotionBounds& into, const MotionBounds& b) {
  merge(into.velocity, into.velocity_radius, b.velocity, b.velocity_radius);
  merge(into.acceleration, into.acceleration_radius, b.acceleration, b.acceleration_radius);
  const double low = std::min(into.omega - into.omega_radius, b.omega - b.omega_radius);
  const double high = std::max(into.omega + into.omega_radius, b.omega + b.omega_radius);
  into.omega = 0.5 * (low + high);
  into.omega_radius = 0.5 * (high - low);
  into.alpha = std::max(into.alpha, b.alpha);
}

}  // namespace

BodyState PolynomialPiece::state(double t) const {
  const double s = t - origin;
  // Place and angle apart, as in bounds().
  Vec2 place = c[degree].head<2>(), velocity = Vec2::Zero();
  double angle = c[degree].z(), omega = 0.0;
  // Horner for value and derivative at once: the twist is the exact derivative of this polynomial.
  for (int k = degree - 1; k >= 0; --k) {
    velocity = velocity * s + place;
    omega = omega * s + angle;
    place = place * s + c[k].head<2>();
    angle = angle * s + c[k].z();
  }
  return {{place, angle}, {velocity, omega}};
}

/// p'' by Horner: coefficient k of it is k (k - 1) c[k] at power k - 2.
Acceleration PolynomialPiece::acceleration(double t) const {
  const double s = t - origin;
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  for (int k = degree; k >= 2; --k) value = value * s + (k * (k - 1.0)) * c[k];
  return {value.head<2>(), value.z()};
}

namespace {

/// The degree is known when this is compiled: loops without counters, twice as fast.
template <int degree>
MotionBounds bounds_of(const PolynomialPiece& piece, double from, double to) {
  const auto& c = piece.c;
  // Taylor coefficients about the middle by repeated synthetic division, then sums of absolute values. Place and
  // angle apart: two coordinates fill a register. The pose itself, coefficient 0, is not asked for.
  const double h = 0.5 * (to - from), s = 0.5 * (from + to) - piece.origin;
  std::array<Vec2, degree + 1> place;
  std::array<double, degree + 1> angle;
  for (int k = 1; k <= degree; ++k) {
    place[k] = c[k].head<2>();
    angle[k] = c[k].z();
  }
  for (int i = 0; i < degree; ++i) {
    Vec2 above = place[degree];
    double angle_above = angle[degree];
    for (int k = degree - 1; k >= std::max(i, 1); --k) {
      above = place[k] += s * above;
      angle_above = angle[k] += s * angle_above;
    }
  }
  MotionBounds b;
  if constexpr (degree < 1) return b;
  b.velocity = place[1];
  b.omega = angle[1];
  if constexpr (degree < 2) return b;
  // |p'(u) - p'(0)| <= sum of k |m_k| h^(k-1) for |u| <= h, and likewise for p''
  // Degree 2 gives p'' no radius: it is constant.
  Vec2 rate_radius = 2.0 * h * place[2].cwiseAbs(), second_radius = Vec2::Zero();
  double alpha_radius = 0.0;
  b.omega_radius = 2.0 * h * std::abs(angle[2]);
  double power = h;  // h^(k-2)
  for (int k = 3; k <= degree; ++k, power *= h) {
    const double of_rate = k * (power * h), of_second = k * (k - 1) * power;
    rate_radius += of_rate * place[k].cwiseAbs();
    second_radius += of_second * place[k].cwiseAbs();
    b.omega_radius += of_rate * std::abs(angle[k]);
    alpha_radius += of_second * std::abs(angle[k]);
  }
  b.velocity_radius = rate_radius.norm();
  b.acceleration = 2.0 * place[2];
  b.acceleration_radius = second_radius.norm();
  b.alpha = 2.0 * std::abs(angle[2]) + alpha_radius;
  return b;
}

}  // namespace

MotionBounds PolynomialPiece::bounds(double from, double to) const {
  static constexpr auto of_degree = []<int... kDegree>(std::integer_sequence<int, kDegree...>) {
    return std::array{&bounds_of<kDegree>...};
  }
  (std::make_integer_sequence<int, kMaxDegree + 1>());
  return of_degree[static_cast<std::size_t>(degree)](*this, from, to);
}

const PolynomialPiece& Track::at(double t) const {
  // the last piece that begins at or before t
  auto it = std::upper_bound(pieces.begin(), pieces.end(), t,
                             [](double time, const PolynomialPiece& p) { return time < p.begin; });
  if (it != pieces.begin()) return *std::prev(it);
  // Before the first piece: by rounding, and the first piece goes on; or it was forgotten.
  if (begun_) throw std::logic_error("a motion was asked for a time that it has forgotten");
  return *it;
}

void Track::forget_before(double t) {
  constexpr std::ptrdiff_t fewest = 1024;  // worth the moving of the others
  if (pieces.empty()) return;
  // A piece that ends at t itself stays, as t may still be asked for; and the last one, from which the motion goes on.
  const auto kept = std::partition_point(pieces.begin(), std::prev(pieces.end()),
                                         [&](const PolynomialPiece& p) { return p.end < t; });
  const std::ptrdiff_t gone = kept - pieces.begin() - kRemembered;
  // Erasing moves all that is kept. Done when half is gone, its cost a piece does not depend on the length.
  if (gone < fewest || 2 * gone < std::ssize(pieces)) return;
  // Before the erasing: begin() asks the first piece, or what was kept of an earlier one.
  begun_ = begin();
  pieces.erase(pieces.begin(), pieces.begin() + gone);
}

double Track::remembered_until(double begin) const {
  // the piece that at() answers with
  const auto after = std::upper_bound(pieces.begin(), pieces.end(), begin,
                                      [](double time, const PolynomialPiece& p) { return time < p.begin; });
  if (after == pieces.begin() && begun_) return -std::numeric_limits<double>::infinity();  // given up
  const std::ptrdiff_t next = std::max<std::ptrdiff_t>(after - pieces.begin(), 1) + kRemembered;
  return next < std::ssize(pieces) ? pieces[next].begin : std::numeric_limits<double>::infinity();
}

double Track::remembered_from(double t) const {
  const auto after = std::upper_bound(pieces.begin(), pieces.end(), t,
                                      [](double time, const PolynomialPiece& p) { return time < p.begin; });
  const std::ptrdiff_t piece = after - pieces.begin() - 1 - kRemembered;
  return pieces[std::max<std::ptrdiff_t>(piece, 0)].begin;
}

Motion Motion::still(const Pose& pose, double t0) { return ballistic(t0, {pose, {}}, {}); }

Motion Motion::ballistic(double t0, const BodyState& start, const Acceleration& acceleration, double t1,
                         const BodyState& low) {
  Motion m;
  m.low_ = low;
  m.t0_ = t0;
  m.t1_ = t1;
  m.start_ = start;
  m.drive_ = acceleration;
  return m;
}

Motion Motion::drag(double t0, const BodyState& start, const Acceleration& drive, double linear,
                    double angular, double t1) {
  Motion m = ballistic(t0, start, drive, t1);
  m.kind_ = Kind::drag;
  Other other;
  other.linear = linear;
  other.angular = angular;
  m.other_ = std::make_shared<const Other>(std::move(other));
  return m;
}

Motion Motion::chain(std::shared_ptr<const std::vector<Motion>> pieces) {
  Motion m;
  m.kind_ = Kind::chain;
  Other other;
  other.chain = std::move(pieces);
  m.other_ = std::make_shared<const Other>(std::move(other));
  return m;
}

double Motion::begin_of_pieces() const {
  return kind_ == Kind::dense ? other_->track->begin() : other_->chain->front().t0_;
}
double Motion::end() const {
  if (kind_ == Kind::dense) return other_->track->end();
  return kind_ == Kind::chain ? other_->chain->back().t1_ : t1_;
}

std::pair<double, double> Motion::piece_at(double t) const {
  if (kind_ == Kind::dense) {
    const PolynomialPiece& piece = other_->track->at(t);
    return {piece.begin, piece.end};
  }
  if (kind_ == Kind::chain) return {link(t).t0_, link(t).t1_};
  return {begin(), end()};
}

double Motion::remembered_until(double begin) const {
  return kind_ == Kind::dense ? other_->track->remembered_until(begin)
                              : std::numeric_limits<double>::infinity();
}

double Motion::remembered_from(double t) const {
  return kind_ == Kind::dense ? other_->track->remembered_from(t) : begin();
}

const Motion& Motion::link(double t) const {
  // as Track::at(): at a join the later piece answers
  auto it = std::upper_bound(other_->chain->begin(), other_->chain->end(), t,
                             [](double time, const Motion& m) { return time < m.t0_; });
  return it == other_->chain->begin() ? *it : *std::prev(it);
}

Motion Motion::dense(std::shared_ptr<const Track> track) {
  Motion m;
  m.kind_ = Kind::dense;
  Other other;
  other.track = std::move(track);
  m.other_ = std::make_shared<const Other>(std::move(other));
  return m;
}

BodyState Motion::state(double t) const {
  const double s = t - t0_;
  switch (kind_) {
    // Position and angle as s (v + s a / 2), which place() in motion.h repeats operation by operation.
    case Kind::ballistic:
      return {{start_.pose.position + s * (start_.twist.velocity + 0.5 * s * drive_.linear),
               start_.pose.angle + s * (start_.twist.omega + 0.5 * s * drive_.angular)},
              {start_.twist.velocity + s * drive_.linear, start_.twist.omega + s * drive_.angular}};
    case Kind::drag: {
      // The rate is one for x and y: along any direction the velocity obeys the same equation.
      const Relaxed x = relax(start_.twist.velocity.x(), drive_.linear.x(), other_->linear, s);
      const Relaxed y = relax(start_.twist.velocity.y(), drive_.linear.y(), other_->linear, s);
      const Relaxed turn = relax(start_.twist.omega, drive_.angular, other_->angular, s);
      return {{start_.pose.position + Vec2(x.moved, y.moved), start_.pose.angle + turn.moved},
              {{x.rate, y.rate}, turn.rate}};
    }
    case Kind::chain:
    case Kind::dense:
      break;
  }
  // Pieces know nothing of the offset, which is the motion's own.
  BodyState state = kind_ == Kind::chain ? link(t).state(t) : other_->track->at(t).state(t);
  state.pose.position += other_->offset;
  return state;
}

/// An offset does not show in it, nor in bounds(): both are of rates alone.
Acceleration Motion::rate(double t) const {
  switch (kind_) {
    case Kind::ballistic:
      return drive_;
    case Kind::drag: {
      const Twist now = twist(t);
      return {drive_.linear - other_->linear * now.velocity, drive_.angular - other_->angular * now.omega};
    }
    case Kind::chain:
      return link(t).rate(t);
    case Kind::dense:
      break;
  }
  return other_->track->at(t).acceleration(t);
}

Motion Motion::displaced(const Vec2& by) const {
  Motion m = *this;
  // Pieces are shared and stay where they are; an offset is added to what they answer.
  if (kind_ == Kind::dense || kind_ == Kind::chain) {
    Other other = *other_;
    other.offset += by;
    m.other_ = std::make_shared<const Other>(std::move(other));
    return m;
  }
  // Closed forms go by their start: it is moved, with what its rounding has left over.
  const ExtendedState moved = ExtendedState(start_, low_).shifted(by);
  m.start_ = moved.rounded();
  m.low_ = moved.low();
  return m;
}

ExtendedState Motion::extended_state(double t) const {
  // Known to the rounding of state(t); low_ is what the motion was given beside it.
  if (kind_ != Kind::ballistic) return {state(t), low_};
  // as state(t), operation for operation, with the low-order part of the start, in two doubles
  const Real s = static_cast<Real>(t) - t0_;
  ExtendedState e(start_, low_);
  // what adds nothing is left out: the sums are the same bits
  if (s == 0 || is_still()) return e;
  if (!has_drive()) {
    e.position += s * e.twist.velocity;
    if (e.twist.omega != 0) e.angle += s * e.twist.omega;
    return e;
  }
  const RealVec a = drive_.linear.cast<Real>();
  const Real alpha = drive_.angular;
  e.position += s * (e.twist.velocity + Real(0.5) * s * a);
  e.angle += s * (e.twist.omega + Real(0.5) * s * alpha);
  e.twist.velocity += s * a;
  e.twist.omega += s * alpha;
  return e;
}

ExtendedTwist Motion::extended_twist(double t) const {
  if (kind_ != Kind::ballistic) return extended_state(t).twist;
  ExtendedTwist w = ExtendedState(start_, low_).twist;
  if (!has_drive()) return w;
  const Real s = static_cast<Real>(t) - t0_;
  w.velocity += s * drive_.linear.cast<Real>();
  w.omega += s * Real(drive_.angular);
  return w;
}

MotionBounds Motion::bounds(double from, double to) const {
  MotionBounds b;
  switch (kind_) {
    case Kind::ballistic: {
      // the velocity is linear in time: its centre is that of the middle, its radius the
      // change over half the way
      const double middle = 0.5 * (from + to) - t0_, half = 0.5 * (to - from);
      b.velocity = start_.twist.velocity + middle * drive_.linear;
      b.omega = start_.twist.omega + middle * drive_.angular;
      const double linear2 = drive_.linear.squaredNorm();
      if (linear2 > 0.0) b.velocity_radius = half * std::sqrt(linear2);
      b.omega_radius = half * std::abs(drive_.angular);
      // constant, so that its radius stays 0
      b.acceleration = drive_.linear;
      b.alpha = std::abs(drive_.angular);
      return b;
    }
    case Kind::drag: {  // rates relax monotonically: each lies between its values at the ends
      const Twist start = twist(from), end = twist(to);
      // v goes along a straight line towards drive / k, and dv/dt = drive - k v along one towards 0:
      // each lies in the disc that has its values at the two ends for a diameter.
      const auto rate = [&](const Twist& w) -> Vec2 { return drive_.linear - other_->linear * w.velocity; };
      b.velocity = 0.5 * (start.velocity + end.velocity);
      b.velocity_radius = 0.5 * (end.velocity - start.velocity).norm();
      b.acceleration = 0.5 * (rate(start) + rate(end));
      b.acceleration_radius = 0.5 * (rate(end) - rate(start)).norm();
      b.omega = 0.5 * (start.omega + end.omega);
      b.omega_radius = 0.5 * std::abs(end.omega - start.omega);
      b.alpha = std::max(std::abs(drive_.angular - other_->angular * start.omega),
                         std::abs(drive_.angular - other_->angular * end.omega));
      return b;
    }
    case Kind::chain: {
      // Accelerations may jump where pieces meet: each has an enclosure of its own, and one holds them all.
      const Motion* piece = &link(from);
      const Motion* last = &link(to);
      b = piece->bounds(from, std::min(to, piece->t1_));
      while (piece != last) {
        ++piece;
        merge(b, piece->bounds(piece->t0_, std::min(to, piece->t1_)));
      }
      return b;
    }
    case Kind::dense:
      break;
  }
  // Pieces lie one after another, from the one that answers for `from` to the one that answers for `to`; what
  // merge() makes of their enclosures holds in each.
  const PolynomialPiece* piece = &other_->track->at(from);
  const PolynomialPiece* last = &other_->track->at(to);
  b = piece->bounds(from, std::min(to, piece->end));
  while (piece != last) {
    ++piece;
    merge(b, piece->bounds(piece->begin, std::min(to, piece->end)));
  }
  return b;
}

}  // namespace brink
