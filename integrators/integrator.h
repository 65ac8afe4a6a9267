#pragma once
/// Integrators: make the motions of one component, piece after piece, from its own history alone.

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "brink/core/base/dynamics.h"
#include "brink/core/base/work.h"
#include "brink/integrators/motion.h"

namespace brink {

struct IntegratorOptions {
  double tolerance = 1e-10;           ///< relative, adaptive integrators
  double absolute_tolerance = 1e-12;  ///< in SI units, adaptive integrators
  double step = 0.001;                ///< [s], fixed-step integrators

  /// True if usable; else writes which option, its value and what is allowed into *error.
  bool is_valid(std::string* error) const;
};

/// How far an extend() got.
struct Extent {
  enum class Status { reached, unfinished, failed };
  Status status = Status::reached;
  double end = 0.0;  ///< motions cover up to here
  std::string why;   ///< of a failure: step floor reached, error test failed, right-hand side not finite ...
};

/// Integrates one component (see Dynamics). Solver steps depend on start() and on the component's own
/// dynamics alone: never on how far, or how often, or in what instalments extend() was asked to go. That is
/// what makes different schedules agree.
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Begins afresh at time t with one state a body; motions made before stay valid for those who hold them.
  /// @throws BadInput if t or a state is not finite, or the number of states is not the number of bodies.
  virtual void start(double t, std::span<const BodyState> states) = 0;

  /// Extends every motion to cover at least time t, in one instalment of at most `most_steps` steps (>= 1);
  /// "unfinished" where they did not suffice: ask again to go on. Steps are the integrator's own: the end may
  /// lie beyond t. A failure is lasting: motions end at its time, and asking beyond it again gives the same
  /// answer until start().
  /// @pre start() was called. @throws BadInput if t is not finite (closed forms also reach infinity).
  virtual Extent extend(double t, std::uint64_t most_steps) = 0;
  /// The same without a limit.
  Extent extend(double t) { return extend(t, std::numeric_limits<std::uint64_t>::max()); }

  /// Nobody will ask the motions for a time before t any more: memory may be given back.
  virtual void forget_before(double t) = 0;

  /// Motion of the component's body k, from the last start() to the last extend(); it grows with later
  /// extend()s. Taken before the first, it covers the starting time alone and does not grow.
  virtual Motion motion(int k) const = 0;
};

/// One line of `brink list integrators`.
struct IntegratorInfo {
  std::string_view name;
  std::string_view summary;
};
/// Every integrator by name, `auto` first.
std::span<const IntegratorInfo> integrators();

/// Makes the integrator called `name` for `dynamics` (kept). `work`, if given, outlives it and is counted
/// into. `auto` is a parabola where Dynamics::constant(), closed-form drag where linear_drag().valid, else
/// `erk`.
/// @throws BadInput on an unknown name (naming those allowed), bad options, or `ballistic` where the dynamics
/// have no closed form.
std::unique_ptr<Integrator> make_integrator(std::string_view name, std::shared_ptr<Dynamics> dynamics,
                                            const IntegratorOptions& options, WorkCounters* work = nullptr);

}  // namespace brink
