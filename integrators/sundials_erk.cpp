/// Dormand and Prince's pair of orders 5 and 4 (1980) as ERKStep runs it. Pieces are not the solver's interpolant, but
/// the quintic through pose, twist and acceleration at both ends of a step (Hermite): its error, of h^6, is below the
/// step's own, and pieces that meet have one acceleration there.
#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>

#include "brink/integrators/dense_output.h"
#include "brink/integrators/sundials.h"
#include "brink/integrators/sundials_base.h"

namespace brink {

namespace {

/// ERKStep (6.4) gives up where a stage says that it failed, so a stage answers with a rate that fails the
/// error test.
int evaluate_erk(realtype t, N_Vector y, N_Vector rate, void* self) {
  return static_cast<SundialsStepper*>(self)->right_hand_side(
      t, N_VGetArrayPointer(y), N_VGetArrayPointer(rate), SundialsStepper::WhereNotFinite::answer_enormous);
}

/// One explicit Runge-Kutta solver a component; pieces from pose, twist and acceleration at both ends.
class Erk final : public SundialsStepper {
 public:
  Erk(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options, WorkCounters* work)
      : SundialsStepper(std::move(dynamics), options, work), before_(size()), after_(size()) {}
  ~Erk() override { ERKStepFree(&memory_); }

 private:
  int restart_solver() override {
    fresh_ = true;
    return memory_ ? ERKStepReInit(memory_, evaluate_erk, time(), y()) : create();
  }
  int set_stop_time(double stop_time) override { return ERKStepSetStopTime(memory_, stop_time); }

  /// The solver itself, once; later segments only re-initialise it.
  int create() {
    memory_ = ERKStepCreate(evaluate_erk, time(), y(), context());
    if (!memory_) return -1;
    // more trials than the defaults before giving up: forces may have corners
    for (int flag : {ERKStepSetErrHandlerFn(memory_, keep_message, static_cast<SundialsStepper*>(this)),
                     ERKStepSetUserData(memory_, static_cast<SundialsStepper*>(this)),
                     ERKStepSStolerances(memory_, options().tolerance, options().absolute_tolerance),
                     ERKStepSetTableNum(memory_, ARKODE_DORMAND_PRINCE_7_4_5),
                     ERKStepSetMaxErrTestFails(memory_, 40), ERKStepSetMaxHnilWarns(memory_, -1)})
      if (flag != 0) return flag;
    return 0;
  }

  /// ARK_ONE_STEP: returns after one step of its own length, however far the target is.
  int solver_step(double* t) override { return ERKStepEvolve(memory_, first_target(), y(), t, ARK_ONE_STEP); }

  bool append_pieces(double t, std::span<const BodyState> ends) override {
    // The segment began with these: begin_segment() has asked for them.
    if (fresh_) before_.assign(first_accelerations().begin(), first_accelerations().end());
    // One evaluation a step: what was found at the end of a step is the begin of the
    // next, but across a break.
    if (!accelerations(t, ends, after_)) return false;
    fresh_ = false;
    for (int k = 0; k < size(); ++k)
      append(k, quintic_piece(time(), states()[k], before_[k], t, ends[k], after_[k]));
    before_.swap(after_);
    return true;
  }

  void* memory_ = nullptr;
  bool fresh_ = true;  ///< no step since the segment began: before_ is not known
  std::vector<Acceleration> before_, after_;
};

}  // namespace

std::unique_ptr<Integrator> make_erk(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options,
                                     WorkCounters* work) {
  return std::make_unique<Erk>(std::move(dynamics), options, work);
}

}  // namespace brink
