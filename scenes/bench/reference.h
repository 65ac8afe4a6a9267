#pragma once
/// Balls driven by forces onto a floor, their impact times by closed forms in long double: references for the
/// error of integrators. Gaps are from the ball's lowest point to the floor, upward [m].

#include <cmath>
#include <vector>

namespace brink::bench {

/// On a damped spring that pushes it to the floor, shaken: m y'' = -k (y - rest) - c y' + F cos(w t).
/// The default numbers are short binary fractions, so that a world built from them is this very problem.
struct SpringBall {
  long double mass = 1.0L, stiffness = 40.0L, damping = 0.25L;  ///< m [kg], k [N/m], c [N s/m]
  long double rest = -0.25L;                                    ///< gap at rest, without gravity [m]
  long double gravity = static_cast<long double>(9.81);         ///< [m/s^2]; the double of the scene
  long double force = 4.0L, rate = 7.0L;                        ///< F [N], w [rad/s]
  long double restitution = static_cast<long double>(0.95);
  long double height = 1.0L;  ///< gap at t = 0, at rest [m]
};

/// Falling in air with quadratic drag: y'' = -g - (c/m) |y'| y'.
struct BallInAir {
  long double drag = 0.0625L;  ///< c/m [1/m]
  long double gravity = static_cast<long double>(9.81);
  long double restitution = static_cast<long double>(0.9);
  long double height = 4.0L;  ///< gap at t = 0, at rest [m]
};

namespace detail {

struct Height {
  long double value, rate;
};

/// The flight of a SpringBall that began at time t0.
class SpringFlight {
 public:
  SpringFlight(const SpringBall& b, long double t0, const Height& start) : b_(b), t0_(t0) {
    decay_ = 0.5L * b.damping / b.mass;
    turn_ = std::sqrt(b.stiffness / b.mass - decay_ * decay_);
    const Height forced = forced_at(t0);
    a_ = start.value - level() - forced.value;
    c_ = (start.rate - forced.rate + decay_ * a_) / turn_;
  }

  Height at(long double t) const {
    const long double s = t - t0_, e = std::exp(-decay_ * s);
    const long double cosine = std::cos(turn_ * s), sine = std::sin(turn_ * s);
    const Height forced = forced_at(t);
    return {level() + forced.value + e * (a_ * cosine + c_ * sine),
            forced.rate + e * ((c_ * turn_ - decay_ * a_) * cosine - (a_ * turn_ + decay_ * c_) * sine)};
  }

 private:
  long double level() const { return b_.rest - b_.mass * b_.gravity / b_.stiffness; }
  Height forced_at(long double t) const {
    const long double in_phase = b_.stiffness - b_.mass * b_.rate * b_.rate;
    const long double behind = b_.damping * b_.rate;
    const long double size = b_.force / (in_phase * in_phase + behind * behind);
    const long double c = std::cos(b_.rate * t), s = std::sin(b_.rate * t);
    return {size * (in_phase * c + behind * s), size * b_.rate * (behind * c - in_phase * s)};
  }

  const SpringBall& b_;
  long double t0_, decay_, turn_, a_, c_;
};

}  // namespace detail

/// Impact times before `until`. Flights shorter than a millisecond are not looked for.
inline std::vector<double> impact_times(const SpringBall& ball, double until) {
  constexpr long double kLook = 1e-3L;
  std::vector<double> times;
  long double t0 = 0.0L;
  detail::Height start{ball.height, 0.0L};
  for (;;) {
    const detail::SpringFlight flight(ball, t0, start);
    long double high = t0 + kLook;
    while (flight.at(high).value > 0.0L && high < until) high += kLook;
    if (flight.at(high).value > 0.0L) return times;
    long double low = high - kLook;
    for (int k = 0; k < 80; ++k) {
      const long double middle = 0.5L * (low + high);
      (flight.at(middle).value > 0.0L ? low : high) = middle;
    }
    if (high >= until) return times;
    times.push_back(static_cast<double>(high));
    start = {0.0L, -ball.restitution * flight.at(high).rate};
    t0 = high;
  }
}

/// Impact times before `until`: down from height h in acosh(exp(c h)) / sqrt(g c), up with speed v in
/// atan(v / vt) / sqrt(g c) to ln(1 + v^2 / vt^2) / (2 c), with vt = sqrt(g / c).
inline std::vector<double> impact_times(const BallInAir& ball, double until) {
  const long double c = ball.drag, terminal = std::sqrt(ball.gravity / c), rate = std::sqrt(ball.gravity * c);
  std::vector<double> times;
  long double t = 0.0L, height = ball.height;
  for (;;) {
    t += std::acosh(std::exp(c * height)) / rate;
    if (t >= until) return times;
    times.push_back(static_cast<double>(t));
    const long double down = terminal * std::sqrt(-std::expm1(-2.0L * c * height));
    const long double up = ball.restitution * down / terminal;
    t += std::atan(up) / rate;
    height = std::log1p(up * up) / (2.0L * c);
  }
}

}  // namespace brink::bench
