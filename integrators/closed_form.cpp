#include "brink/integrators/closed_form.h"

#include <cmath>

#include "brink/core/base/error.h"
#include "brink/integrators/stepping.h"

namespace brink {

namespace {

/// A piece of closed form from break to break of the forces. Where there is no break ahead there is one
/// piece, to infinity, and motions are that piece itself; else they are chains, which grow as time goes on.
class ClosedForm final : public Integrator {
 public:
  ClosedForm(std::shared_ptr<Dynamics> dynamics, WorkCounters* work)
      : dynamics_(std::move(dynamics)), work_(work) {}

  void start(double t, std::span<const BodyState> states) override {
    check_start(*dynamics_, t, states);
    time_ = t;
    states_.assign(states.begin(), states.end());
    // known from the start, so that what kind of motion it is never depends on how far was asked
    chained_ = std::isfinite(dynamics_->next_break(t));
    chains_.clear();
    for (std::size_t k = 0; k < states_.size(); ++k)
      chains_.push_back(std::make_shared<std::vector<Motion>>());
    failure_.clear();
  }

  using Integrator::extend;
  Extent extend(double t, std::uint64_t most_steps) override {
    // Infinity is allowed here, unlike for integrators that step: the last piece reaches it.
    if (std::isnan(t)) check_finite_time(t);
    for (std::uint64_t n = 0; time_ < t && failure_.empty() && n < most_steps; ++n) next_piece();
    return extent_at(time_, t, failure_);
  }

  /// A piece lasts from break to break of the forces: there are few.
  void forget_before(double) override {}

  Motion motion(int k) const override {
    // A lone piece never grows: it may be given away as a value, and closed forms of contacts then apply to
    // it.
    const auto& chain = chains_.at(k);
    // before the first extend(): the starting time alone
    if (chain->empty()) return Motion::ballistic(time_, states_[k], {}, time_);
    return chained_ ? Motion::chain(chain) : chain->front();
  }

 private:
  /// The pieces of all bodies up to the next break; fails where none can be made.
  void next_piece() {
    const double end = dynamics_->next_break(time_);
    // it would make a piece without length, and no progress
    if (!(end > time_)) {
      failure_ = "no closed form goes on from t = " + time_text(time_) +
                 ": the forces' next break is at t = " + time_text(end) + ", which is not later";
      return;
    }
    const std::vector<Motion> pieces = pieces_until(end);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      chains_[k]->push_back(pieces[k]);
      // The next piece starts where this one ends: pose and twist go on without a jump.
      if (std::isfinite(end)) states_[k] = pieces[k].state(end);
    }
    if (pieces.empty()) {
      failure_ = "no closed form goes on from t = " + time_text(time_) + ": the acceleration is not finite";
      return;
    }
    time_ = end;
    if (work_) ++work_->solver_steps;
  }

  /// One motion a body from now to `end`; empty where the forces are not finite.
  std::vector<Motion> pieces_until(double end) {
    std::vector<Motion> pieces;
    if (work_) ++work_->right_hand_sides;
    // What is not constant has linear drag, which Dynamics knows of single bodies only: states_[0] is all.
    if (!dynamics_->constant()) {
      // asked at each break: a thrust that starts or stops changes the drive
      const Dynamics::LinearDrag drag = dynamics_->linear_drag(time_);
      const bool finite = is_finite(drag.drive) && std::isfinite(drag.linear) && std::isfinite(drag.angular);
      if (drag.valid && finite)
        pieces.push_back(Motion::drag(time_, states_[0], drag.drive, drag.linear, drag.angular, end));
      return pieces;
    }
    std::vector<Acceleration> a(states_.size());
    dynamics_->accelerations(time_, states_, a);
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (!is_finite(a[k])) return {};
      pieces.push_back(Motion::ballistic(time_, states_[k], a[k], end));
    }
    return pieces;
  }

  std::shared_ptr<Dynamics> dynamics_;
  WorkCounters* work_;
  double time_ = 0.0;
  bool chained_ = false;
  std::vector<BodyState> states_;  ///< at time_, while that is finite
  std::vector<std::shared_ptr<std::vector<Motion>>> chains_;
  std::string failure_;
};

}  // namespace

bool has_closed_form(const Dynamics& dynamics) {
  // What kind of forces there are does not depend on the time: asked at 0, it holds for ever.
  return dynamics.constant() || (dynamics.size() == 1 && dynamics.linear_drag(0.0).valid);
}

std::unique_ptr<Integrator> make_closed_form(std::shared_ptr<Dynamics> dynamics, WorkCounters* work) {
  return std::make_unique<ClosedForm>(std::move(dynamics), work);
}

}  // namespace brink
