/// What the SUNDIALS methods share (Hindmarsh et al. 2005): one internal step of the solver at a time, as far as it
/// likes, and a piece of dense output for it. The solver's error test is on the weighted root mean square of all its
/// numbers, with weights 1 / (tolerance |y_i| + absolute_tolerance): bodies of one component share their steps.
#include "brink/integrators/sundials_base.h"

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <new>

namespace brink {

namespace {

/// A rate that no error test passes. Where the weight of a tiny absolute tolerance makes its square infinite,
/// that fails it as well.
constexpr double kEnormous = 1e60;

/// The solver's vector: x, y, angle, vx, vy, omega of each body in turn.
void pack(std::span<const BodyState> states, double* y) {
  for (const BodyState& s : states) {
    const double numbers[] = {s.pose.position.x(),  s.pose.position.y(),  s.pose.angle,
                              s.twist.velocity.x(), s.twist.velocity.y(), s.twist.omega};
    y = std::copy(std::begin(numbers), std::end(numbers), y);
  }
}

void unpack(const double* y, std::span<BodyState> states) {
  for (BodyState& s : states) {
    s = {{{y[0], y[1]}, y[2]}, {{y[3], y[4]}, y[5]}};
    y += 6;
  }
}

}  // namespace

SundialsStepper::SundialsStepper(std::shared_ptr<Dynamics> dynamics, const IntegratorOptions& options,
                                 WorkCounters* work)
    : SteppingIntegrator(std::move(dynamics), work),
      options_(options),
      scratch_states_(size()),
      ends_(size()),
      scratch_accelerations_(size()),
      first_(size()) {
  if (SUNContext_Create(nullptr, &context_) != 0) throw std::bad_alloc();
  y_ = N_VNew_Serial(kNumbersPerBody * size(), context_);
  derivative_ = N_VNew_Serial(kNumbersPerBody * size(), context_);
  if (!y_ || !derivative_) throw std::bad_alloc();
  // Sums of many vectors in one pass instead of one a term: the same operations in the same order. All the solver's
  // vectors are copies of this one.
  N_VEnableFusedOps_Serial(y_, SUNTRUE);
}

/// Solvers of derived classes are freed by then; the context goes last, as the vectors belong to it.
SundialsStepper::~SundialsStepper() {
  N_VDestroy(y_);
  N_VDestroy(derivative_);
  SUNContext_Free(&context_);
}

int SundialsStepper::right_hand_side(double t, const double* y, double* rate,
                                     WhereNotFinite where_not_finite) {
  unpack(y, scratch_states_);
  try {
    if (!accelerations(t, scratch_states_, scratch_accelerations_)) {
      // 1 asks for a smaller step: a trial that went too far does not end the motion.
      if (where_not_finite == WhereNotFinite::say_so) return 1;
      for (Acceleration& a : scratch_accelerations_) a = {Vec2::Constant(kEnormous), kEnormous};
    }
  } catch (const std::exception& error) {  // it must not pass through the solver's C code
    message_ = error.what();
    return -1;
  }
  for (int k = 0; k < size(); ++k, y += kNumbersPerBody) {
    const Acceleration& a = scratch_accelerations_[k];
    // Poses change by twists, twists by accelerations.
    rate = std::copy(y + 3, y + 6, rate);
    *rate++ = a.linear.x();
    *rate++ = a.linear.y();
    *rate++ = a.angular;
  }
  return 0;
}

/// The solver's history says nothing of forces after a jump: it starts afresh, with the first derivative given.
bool SundialsStepper::begin_segment() {
  pack(states(), N_VGetArrayPointer(y_));
  message_.clear();
  // Before the solver: at the start no smaller step helps, and this says which body and where.
  if (!accelerations(time(), states(), first_)) return fail(why());
  stop_ = time();  // no stop is set: limit_step() sets one before the first step
  if (restart_solver() == 0) return true;
  return fail("the solver cannot start: " + message_);
}

/// No step crosses a break, nor goes farther than the forces are known to change evenly. Asked at every step:
/// what is known reaches farther the later it is asked, and steps that are short enough never end at its end.
bool SundialsStepper::limit_step() {
  // the largest number stands for "never": it also clears a stop time left from before
  const double stop = std::min({steady_until(), segment_end(), std::numeric_limits<double>::max()});
  // The solver keeps its stop time until it is there.
  if (stop == stop_) return true;
  stop_ = stop;
  return set_stop_time(stop) == 0 ||
         fail("the solver cannot stop at t = " + time_text(stop) + ": " + message_);
}

/// One internal step, whose length is the solver's own choice within limit_step(). A step that was made is kept even
/// if it leads beyond what was asked for: the next question finds it there.
bool SundialsStepper::step() {
  if (!limit_step()) return false;
  double t = time();
  const int flag = solver_step(&t);
  // A step that does not move t would repeat for ever.
  if (flag < 0 || !(t > time())) {
    std::string what =
        flag < 0 ? "the solver gave up: " + message_ : "its steps became too small to move time";
    // what the forces said comes first: the solver's own words only say that its steps failed
    return fail(why().empty() ? what : why() + "; " + what);
  }
  unpack(N_VGetArrayPointer(y_), ends_);
  for (int k = 0; k < size(); ++k)
    if (!is_in_range(ends_[k]))
      return fail("the state of body " + std::to_string(k) + " of the component overflows");
  // Pieces before accept(): they ask for the begin of the step, which is still the present state.
  if (!append_pieces(t, ends_)) return fail("no dense output: " + (why().empty() ? message_ : why()));
  return accept(t, ends_);
}

}  // namespace brink
