#pragma once
/// What drives a group of coupled bodies: the interface between forces (core/world) and integrators.

#include <limits>
#include <span>
#include <string>

#include "brink/core/base/geometry.h"

namespace brink {

/// The equations of motion of one *component*: bodies coupled by forces, or a single body.
/// Accelerations are a function of time and of the states of these bodies alone.
class Dynamics {
 public:
  virtual ~Dynamics() = default;

  /// Number of bodies of the component.
  virtual int size() const = 0;

  /// Writes the acceleration of every body at time t [s]. @pre states.size() == out.size() == size().
  virtual void accelerations(double t, std::span<const BodyState> states,
                             std::span<Acceleration> out) const = 0;

  /// The same, but what two bodies do to each other acts along their line in the states `lines` (arms included), as large as it is at
  /// `states`: so it takes no angular momentum from a step that begins at `lines`.
  virtual void accelerations_along(double t, std::span<const BodyState> lines,
                                   std::span<const BodyState> states, std::span<Acceleration> out) const {
    (void)lines;
    accelerations(t, states, out);
  }

  /// Which of the accelerations' causes is not finite at time t, in words that name it; empty where all are, or where
  /// nothing is known of them.
  virtual std::string not_finite(double t, std::span<const BodyState> states) const {
    (void)t;
    (void)states;
    return {};
  }

  /// The first time > t at which the right-hand side jumps (a thrust that starts or stops), or infinity.
  /// Integrators stop a step there and start afresh.
  virtual double next_break(double t) const {
    (void)t;
    return std::numeric_limits<double>::infinity();
  }

  /// A time > t up to which the right-hand side is certain to change evenly with the time itself, as far as
  /// that is known: adaptive integrators step no farther, so that nothing short is stepped over. Infinity
  /// where it does not depend on the time between breaks. A function of t alone, which may be remembered for the next t.
  virtual double steady_until(double t) {
    (void)t;
    return std::numeric_limits<double>::infinity();
  }

  /// True if, between breaks, accelerations do not depend on the states or on time (uniform gravity, a
  /// constant thrust): motion is then a parabola in closed form.
  virtual bool constant() const { return false; }

  /// The closed form of linear drag: dv/dt = g - linear v, d(omega)/dt = a - angular omega, for a component
  /// of one body, valid between breaks from time t on.
  struct LinearDrag {
    bool valid = false;
    double linear = 0.0;   ///< [1/s]
    double angular = 0.0;  ///< [1/s]
    Acceleration drive;    ///< acceleration at rest
  };
  virtual LinearDrag linear_drag(double t) const {
    (void)t;
    return {};
  }
};

}  // namespace brink
