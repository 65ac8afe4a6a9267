/// Methods of one step length, for comparison and for forces that adaptive methods are too careful with:
///
///   a segment, from the start or a break of the forces to the next break:
///     step n ends at origin + n h; the last ends with the segment, however short it is then
///     between its two ends a motion is the cubic through both states
///
/// The step does not depend on what is asked for, so a motion is the same whoever asked how far.
#include "brink/integrators/fixed_step.h"

#include "brink/integrators/dense_output.h"
#include "brink/integrators/stepping.h"

namespace brink {

namespace {

using States = std::vector<BodyState>;
using Accelerations = std::vector<Acceleration>;

/// One step of x' = twist, v' = a from `from`: every method here is made of these.
BodyState moved(const BodyState& from, const Twist& twist, const Acceleration& a, double h) {
  return {{from.pose.position + h * twist.velocity, from.pose.angle + h * twist.omega},
          {from.twist.velocity + h * a.linear, from.twist.omega + h * a.angular}};
}

/// What the three methods share: where steps end, and pieces from their end states. A method only says where
/// a step leads. A segment ends at a break of the forces, and steps are counted afresh from there.
class FixedStep : public SteppingIntegrator {
 protected:
  FixedStep(std::shared_ptr<Dynamics> dynamics, double step, WorkCounters* work)
      : SteppingIntegrator(std::move(dynamics), work), step_(step), end_(size()), a_(size()) {}

  /// Writes the states after h into `end`. False where an acceleration is not finite.
  virtual bool advance(double t, std::span<const BodyState> from, double h, States& end) = 0;

  Accelerations& scratch() { return a_; }

 private:
  bool begin_segment() final {
    origin_ = time();
    taken_ = 0;
    return true;
  }

  bool step() final {
    // A product, not a sum: after a million steps t is off by one rounding, not by a million.
    double t = origin_ + static_cast<double>(++taken_) * step_;
    // A rest of less than a millionth of a step would be a step of its own, of nothing but rounding.
    if (t > segment_end() - 1e-6 * step_) t = segment_end();
    // The step is below the spacing of doubles at this time.
    if (!(t > time())) return fail("step " + time_text(step_) + " s is lost in rounding");
    if (!advance(time(), states(), t - time(), end_)) return fail(why());
    // all are asked before any goes on: after a failure the tracks of a component end together
    for (int k = 0; k < size(); ++k)
      if (!is_in_range(end_[k]))
        return fail("the state of body " + std::to_string(k) + " of the component overflows");
    for (int k = 0; k < size(); ++k) append(k, cubic_piece(time(), states()[k], t, end_[k]));
    return accept(t, end_);
  }

  double step_;          ///< [s]
  double origin_ = 0.0;  ///< of the segment [s]
  long taken_ = 0;       ///< steps since the origin
  States end_;
  Accelerations a_;
};

/// x += h v, v += h a, both from the start of the step. Of an oscillator of frequency w it makes the energy grow by
/// the factor 1 + (w h)^2 a step: a baseline, not a method to use.
class Euler final : public FixedStep {
 public:
  Euler(std::shared_ptr<Dynamics> dynamics, double step, WorkCounters* work)
      : FixedStep(std::move(dynamics), step, work) {}

 private:
  bool advance(double t, std::span<const BodyState> from, double h, States& end) override {
    Accelerations& a = scratch();
    if (!accelerations(t, from, a)) return false;
    for (std::size_t k = 0; k < end.size(); ++k) end[k] = moved(from[k], from[k].twist, a[k], h);
    return true;
  }
};

/// v += h a, then x += h v with the new v: symplectic (Hairer, Lubich & Wanner 2006, I.1.2). Its order is 1 as well, but
/// the energy of an oscillator swings about its value instead of growing, as long as w h < 2.
class SemiImplicitEuler final : public FixedStep {
 public:
  SemiImplicitEuler(std::shared_ptr<Dynamics> dynamics, double step, WorkCounters* work)
      : FixedStep(std::move(dynamics), step, work) {}

 private:
  bool advance(double t, std::span<const BodyState> from, double h, States& end) override {
    Accelerations& a = scratch();
    if (!accelerations(t, from, a)) return false;
    for (std::size_t k = 0; k < end.size(); ++k) {
      // The twist at the end, by which the pose is then moved.
      const Twist twist = moved(from[k], {}, a[k], h).twist;
      end[k] = moved(from[k], twist, a[k], h);
    }
    return true;
  }
};

/// The classic fourth-order method (Kutta 1901). Four evaluations a step; the error of a step falls with h^5.
class Rk4 final : public FixedStep {
 public:
  Rk4(std::shared_ptr<Dynamics> dynamics, double step, WorkCounters* work)
      : FixedStep(std::move(dynamics), step, work), stage_(size()), sums_(size()) {}

 private:
  /// Weighted mean of the stages' rates.
  struct Sum {
    Twist twist;
    Acceleration acceleration;
    void add(double weight, const Twist& w, const Acceleration& a) {
      twist.velocity += weight * w.velocity;
      twist.omega += weight * w.omega;
      acceleration.linear += weight * a.linear;
      acceleration.angular += weight * a.angular;
    }
  };

  bool advance(double t, std::span<const BodyState> from, double h, States& end) override {
    // Stage i + 1 starts from the step's begin with the rates of stage i alone, so that
    // nodes serve as the tableau.
    static constexpr double nodes[] = {0.0, 0.5, 0.5, 1.0};
    static constexpr double weights[] = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
    Accelerations& a = scratch();
    stage_.assign(from.begin(), from.end());
    sums_.assign(end.size(), {});
    for (int i = 0; i < 4; ++i) {
      if (!accelerations(t + nodes[i] * h, stage_, a)) return false;
      for (std::size_t k = 0; k < end.size(); ++k) {
        sums_[k].add(weights[i], stage_[k].twist, a[k]);
        if (i < 3) stage_[k] = moved(from[k], stage_[k].twist, a[k], nodes[i + 1] * h);
      }
    }
    for (std::size_t k = 0; k < end.size(); ++k)
      // Poses go by the mean twist of the stages and twists by their mean acceleration.
      end[k] = moved(from[k], sums_[k].twist, sums_[k].acceleration, h);
    return true;
  }

  /// Scratch, kept so that no step allocates.
  States stage_;
  std::vector<Sum> sums_;
};

}  // namespace

std::unique_ptr<Integrator> make_euler(std::shared_ptr<Dynamics> dynamics, double step, WorkCounters* work) {
  return std::make_unique<Euler>(std::move(dynamics), step, work);
}
std::unique_ptr<Integrator> make_semi_implicit_euler(std::shared_ptr<Dynamics> dynamics, double step,
                                                     WorkCounters* work) {
  return std::make_unique<SemiImplicitEuler>(std::move(dynamics), step, work);
}
std::unique_ptr<Integrator> make_rk4(std::shared_ptr<Dynamics> dynamics, double step, WorkCounters* work) {
  return std::make_unique<Rk4>(std::move(dynamics), step, work);
}

}  // namespace brink
