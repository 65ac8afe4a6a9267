#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "brink/integrators/dense_output.h"
#include "brink/integrators/sundials.h"
#include "brink/integrators/sundials_base.h"

namespace brink {

namespace {

/// CVODE tries a smaller step where the right-hand side says that it failed.
int evaluate_cvode(realtype t, N_Vector y, N_Vector rate, void* self) {
  return static_cast<SundialsStepper*>(self)->right_hand_side(
      t, N_VGetArrayPointer(y), N_VGetArrayPointer(rate), SundialsStepper::WhereNotFinite::say_so);
}

/// What both methods of CVODE share: everything but the solver of their implicit equations.
class Cvode : public SundialsStepper {
 protected:
  Cvode(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options, WorkCounters* work, int method)
      : SundialsStepper(std::move(dynamics), options, work), method_(method) {}
  ~Cvode() override { CVodeFree(&memory_); }

  /// Gives the solver its nonlinear (and linear) solver; 0 if done.
  virtual int attach_solvers(void* memory) = 0;

 private:
  int restart_solver() final { return memory_ ? CVodeReInit(memory_, time(), y()) : create(); }
  int set_stop_time(double stop_time) final { return CVodeSetStopTime(memory_, stop_time); }

  /// The solver itself, once; later segments only re-initialise it.
  int create() {
    memory_ = CVodeCreate(method_, context());
    if (!memory_) return -1;
    // more trials than the defaults before giving up: forces may have corners
    // A braced list is evaluated from left to right, which is the order that CVODE wants, and to its end.
    for (int flag : {CVodeSetErrHandlerFn(memory_, keep_message, static_cast<SundialsStepper*>(this)),
                     CVodeInit(memory_, evaluate_cvode, time(), y()),
                     CVodeSetUserData(memory_, static_cast<SundialsStepper*>(this)),
                     CVodeSStolerances(memory_, options().tolerance, options().absolute_tolerance),
                     CVodeSetMaxErrTestFails(memory_, 40), CVodeSetMaxConvFails(memory_, 40),
                     CVodeSetMaxHnilWarns(memory_, -1), attach_solvers(memory_)})
      if (flag != 0) return flag;
    return 0;
  }

  /// CV_ONE_STEP: returns after one step of its own length, however far the target is.
  int solver_step(double* t) final { return CVode(memory_, first_target(), y(), t, CV_ONE_STEP); }

  /// Dense output from CVODE's history, which holds the last step only: read before the next one.
  bool append_pieces(double t, std::span<const BodyState> ends) final {
    std::vector<PolynomialPiece> pieces(size());
    int order = 0;
    if (CVodeGetLastOrder(memory_, &order) != 0) return false;
    double factorial = 1.0;
    // CVODE's polynomial is of the order of the step, about its end: Taylor's
    // coefficients are its derivatives there.
    for (int k = 0; k <= order; ++k, factorial *= k) {
      // after one step of its own the solver's values are those of its history, to the bit
      if (k > 0 && CVodeGetDky(memory_, t, k, derivative()) != 0) return false;
      const double* d = N_VGetArrayPointer(k > 0 ? derivative() : y());
      for (int body = 0; body < size(); ++body, d += kNumbersPerBody)
        pieces[body].c[k] = Eigen::Vector3d(d[0], d[1], d[2]) / factorial;
    }
    for (int body = 0; body < size(); ++body) {
      PolynomialPiece& piece = pieces[body];
      piece.begin = time();
      piece.end = piece.origin = t;
      piece.degree = order;
      // It meets the accepted states of both ends to the local error only; match_ends() makes pieces C1.
      move_origin(piece, time());
      match_ends(piece, states()[body], ends[body]);
      append(body, piece);
    }
    return true;
  }

  int method_;
  void* memory_ = nullptr;
};

/// Adams-Moulton, orders 1 to 12 as the solver finds best. Fixed-point iteration needs no Jacobian, and converges
/// while a step is short beside 1 / (largest rate of the forces): for forces that are not stiff.
class Adams final : public Cvode {
 public:
  Adams(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options, WorkCounters* work)
      : Cvode(std::move(dynamics), options, work, CV_ADAMS),
        solver_(SUNNonlinSol_FixedPoint(y(), 0, context())) {}
  ~Adams() override { SUNNonlinSolFree(solver_); }

 private:
  int attach_solvers(void* memory) override { return CVodeSetNonlinearSolver(memory, solver_); }
  SUNNonlinearSolver solver_;
};

/// Backward differentiation, orders 1 to 5, for stiff forces: steps go by accuracy where stability would make explicit
/// ones short. CVODE's default Newton iteration; the Jacobian by difference quotients. The matrix is dense, of six
/// rows a body: n bodies cost about (6 n)^3 / 3 multiplications a factorisation.
class Bdf final : public Cvode {
 public:
  Bdf(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options, WorkCounters* work)
      : Cvode(std::move(dynamics), options, work, CV_BDF),
        matrix_(SUNDenseMatrix(kNumbersPerBody * size(), kNumbersPerBody * size(), context())),
        solver_(SUNLinSol_Dense(y(), matrix_, context())) {}
  ~Bdf() override {
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
  }

 private:
  int attach_solvers(void* memory) override { return CVodeSetLinearSolver(memory, solver_, matrix_); }
  SUNMatrix matrix_;
  SUNLinearSolver solver_;
};

}  // namespace

std::unique_ptr<Integrator> make_adams(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options,
                                       WorkCounters* work) {
  return std::make_unique<Adams>(std::move(dynamics), options, work);
}
std::unique_ptr<Integrator> make_bdf(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options,
                                     WorkCounters* work) {
  return std::make_unique<Bdf>(std::move(dynamics), options, work);
}

}  // namespace brink
