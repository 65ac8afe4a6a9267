#pragma once
/// What the SUNDIALS integrators share: context, state vector, right-hand side, messages. No SUNDIALS header
/// is needed to read this: its handles are pointers to structs that are only named here.

#include "brink/integrators/stepping.h"

struct _generic_N_Vector;
struct _SUNContext;

namespace brink {

class SundialsStepper : public SteppingIntegrator {
 public:
  SundialsStepper(const SundialsStepper&) = delete;
  SundialsStepper& operator=(const SundialsStepper&) = delete;

  /// What right_hand_side() does where a force is not finite: says so (> 0), or answers with an enormous
  /// rate.
  enum class WhereNotFinite { say_so, answer_enormous };
  /// The right-hand side; 0, > 0 for "try a smaller step", < 0 for "give up".
  int right_hand_side(double t, const double* y, double* rate, WhereNotFinite where_not_finite);
  /// A solver's message, instead of printing it: the last one goes into the failure's why. `self` is a SundialsStepper.
  static void keep_message(int, const char*, const char*, char* message, void* self) {
    static_cast<SundialsStepper*>(self)->message_ = message;
  }

 protected:
  static constexpr int kNumbersPerBody = 6;

  SundialsStepper(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options, WorkCounters* work);
  ~SundialsStepper() override;

  /// Makes or re-initialises the solver at time() with y; 0 if done.
  virtual int restart_solver() = 0;
  /// Lets the solver's steps end there at the latest; 0 if done. It holds until the solver comes there.
  virtual int set_stop_time(double stop_time) = 0;
  /// One step of the solver's own length: y and *t become its end; < 0 if it failed.
  virtual int solver_step(double* t) = 0;
  /// Appends every body's piece for the step from time() to t that ends at `ends`; false if it failed.
  virtual bool append_pieces(double t, std::span<const BodyState> ends) = 0;

  _SUNContext* context() const { return context_; }
  _generic_N_Vector* y() const { return y_; }
  _generic_N_Vector* derivative() const { return derivative_; }  ///< scratch
  double first_target() const { return time() + 1.0; }  ///< only the first step's length is chosen by it
  const IntegratorOptions& options() const { return options_; }
  std::span<const Acceleration> first_accelerations() const { return first_; }  ///< at the segment's begin

 private:
  bool begin_segment() final;
  bool step() final;
  bool limit_step();

  IntegratorOptions options_;
  _SUNContext* context_ = nullptr;
  _generic_N_Vector* y_ = nullptr;
  _generic_N_Vector* derivative_ = nullptr;
  std::vector<BodyState> scratch_states_, ends_;
  std::vector<Acceleration> scratch_accelerations_, first_;
  std::string message_;
  double stop_ = 0.0;  ///< no step goes beyond this [s]
};

}  // namespace brink
