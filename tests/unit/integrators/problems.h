#pragma once
/// Problems with known answers for the integrator tests: small Dynamics written out here, with no core/world
/// behind them.

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "brink/core/base/dynamics.h"

namespace brink::problems {

/// A Dynamics from a function.
class Given : public Dynamics {
 public:
  using Function = std::function<void(double, std::span<const BodyState>, std::span<Acceleration>)>;
  Given(int size, Function function) : size_(size), function_(std::move(function)) {}
  int size() const override { return size_; }
  void accelerations(double t, std::span<const BodyState> s, std::span<Acceleration> out) const override {
    function_(t, s, out);
  }

 private:
  int size_;
  Function function_;
};

/// Two equal masses on a spring of rest length L: relative motion is a planar oscillator with a stretch that
/// swings. Energy, momentum and angular momentum are conserved.
inline constexpr double kStiffness = 3.0, kRestLength = 1.0;
inline std::shared_ptr<Dynamics> spring_pair() {
  return std::make_shared<Given>(2, [](double, std::span<const BodyState> s, std::span<Acceleration> out) {
    const Vec2 span = s[1].pose.position - s[0].pose.position;
    const Vec2 force = kStiffness * (span.norm() - kRestLength) / span.norm() * span;
    out[0] = {force, 0.0};
    out[1] = {-force, 0.0};
  });
}
inline std::vector<BodyState> spring_pair_start() {
  return {{{{0.0, 0.0}, 0.0}, {{0.1, 0.3}, 0.5}}, {{{1.3, 0.2}, 1.0}, {{0.2, -0.6}, -0.25}}};
}
inline double spring_pair_energy(std::span<const BodyState> s) {
  const double stretch = (s[1].pose.position - s[0].pose.position).norm() - kRestLength;
  return 0.5 * (s[0].twist.velocity.squaredNorm() + s[1].twist.velocity.squaredNorm()) +
         0.5 * kStiffness * stretch * stretch;
}

/// A spring of rest length 0 between the body and the origin: x = A cos(w t + phase) in each coordinate,
/// exactly.
inline constexpr double kOmega = 2.0;
inline std::shared_ptr<Dynamics> oscillator() {
  return std::make_shared<Given>(1, [](double, std::span<const BodyState> s, std::span<Acceleration> out) {
    out[0] = {-kOmega * kOmega * s[0].pose.position, -kOmega * kOmega * s[0].pose.angle};
  });
}
inline BodyState oscillator_state(double t) {
  const double c = std::cos(kOmega * t), s = std::sin(kOmega * t);
  return {{{c, 0.5 * s}, 0.25 * c + s}, {{-kOmega * s, 0.5 * kOmega * c}, kOmega * (c - 0.25 * s)}};
}

/// Kepler: a = -r / |r|^3 with semi-major axis 1 and eccentricity e; at t = 0 nearest to the centre.
inline constexpr double kEccentricity = 0.3;
inline std::shared_ptr<Dynamics> kepler() {
  return std::make_shared<Given>(1, [](double, std::span<const BodyState> s, std::span<Acceleration> out) {
    const double r = s[0].pose.position.norm();
    out[0] = {-s[0].pose.position / (r * r * r), 0.0};
  });
}
/// From Kepler's equation t = E - e sin E by Newton's method.
inline BodyState kepler_state(double t) {
  const double e = kEccentricity, b = std::sqrt(1.0 - e * e);
  double anomaly = t;
  for (int i = 0; i < 50; ++i)
    anomaly -= (anomaly - e * std::sin(anomaly) - t) / (1.0 - e * std::cos(anomaly));
  const double c = std::cos(anomaly), s = std::sin(anomaly), rate = 1.0 / (1.0 - e * c);
  return {{{c - e, b * s}, 0.0}, {{-s * rate, b * c * rate}, 0.0}};
}
inline double kepler_energy(const BodyState& s) {
  return 0.5 * s.twist.velocity.squaredNorm() - 1.0 / s.pose.position.norm();
}

/// A thrown spinning body with linear drag 0.4 1/s on the way and 0.7 1/s on the spin, under gravity.
inline constexpr double kLinearDrag = 0.4, kAngularDrag = 0.7, kGravity = -9.81;
inline std::shared_ptr<Dynamics> spinning_drag() {
  return std::make_shared<Given>(1, [](double, std::span<const BodyState> s, std::span<Acceleration> out) {
    out[0] = {Vec2(0.0, kGravity) - kLinearDrag * s[0].twist.velocity, -kAngularDrag * s[0].twist.omega};
  });
}
inline BodyState spinning_drag_state(double t) {
  const double vx = 3.0, vy = 4.0, omega = 12.0, k = kLinearDrag, terminal = kGravity / k;
  const double faded = -std::expm1(-k * t), turned = -std::expm1(-kAngularDrag * t);
  return {{{vx * faded / k, terminal * t + (vy - terminal) * faded / k}, omega * turned / kAngularDrag},
          {{vx * (1.0 - faded), terminal + (vy - terminal) * (1.0 - faded)}, omega * (1.0 - turned)}};
}

/// Uniform gravity, and a thrust of 5 m/s^2 in x and 3 rad/s^2 from `from` to `to`: piecewise constant.
class Thrusted : public Dynamics {
 public:
  Thrusted(double from, double to, bool tell_constant)
      : from_(from), to_(to), tell_constant_(tell_constant) {}
  int size() const override { return 1; }
  void accelerations(double t, std::span<const BodyState>, std::span<Acceleration> out) const override {
    const bool on = t >= from_ && t < to_;
    out[0] = {{on ? 5.0 : 0.0, kGravity}, on ? 3.0 : 0.0};
  }
  double next_break(double t) const override {
    if (t < from_) return from_;
    return t < to_ ? to_ : std::numeric_limits<double>::infinity();
  }
  bool constant() const override { return tell_constant_; }

 private:
  double from_, to_;
  bool tell_constant_;
};

/// Largest difference between two states, poses and twists alike.
inline double difference(const BodyState& a, const BodyState& b) {
  return std::max(
      {(a.pose.position - b.pose.position).cwiseAbs().maxCoeff(), std::abs(a.pose.angle - b.pose.angle),
       (a.twist.velocity - b.twist.velocity).cwiseAbs().maxCoeff(), std::abs(a.twist.omega - b.twist.omega)});
}

}  // namespace brink::problems
