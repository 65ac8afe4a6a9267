#pragma once
/// Few bodies with contacts that last, moved on to any accuracy: accelerations under contact forces, integrated.
///
///   choose modes (choose_modes.h)
///   until the time asked for
///     a step of Dormand & Prince 5(4); places back onto their gaps, velocities onto v_n = 0 (mass metric)
///     shorter, where its error or a gap inside it is too large
///     a force out of its cone, a slip that ends, a feature left, an open contact that closes:
///       the step ends there, to rounding; modes are chosen again from a look a little ahead
///
/// Each step's motion is the quintic Hermite interpolant of places, velocities and accelerations. Sources: Dormand &
/// Prince 1980; Hairer, Lubich & Wanner 2006, IV.4 (projection); Acary & Brogliato 2008, chapter 8 (event-driven).

#include "brink/scheduler/islands/modes/choose_modes.h"
#include "brink/scheduler/islands/modes/mode_arrival.h"
#include "brink/scheduler/islands/modes/mode_step.h"

namespace brink {

struct ModeLimits {
  double tolerance = 1e-10;      ///< error of a step: of the problem's size, its speed, and a radian
  double gap_tolerance = 1e-10;  ///< what a closed contact's gap may be off inside a step [m]
  double touch = 1e-13;          ///< what a gap may be below zero by rounding [m]
  double longest = 0.1;          ///< step [s], > 0
};

/// Why a step ended where it did.
enum class ModeEnd {
  step,      ///< it is one of several
  change,    ///< a contact changed its mode: see modes()
  range,     ///< a closed contact comes to the end of its feature: `contact` of the end
  arrival,   ///< an open contact closes
  hovers,    ///< an open contact stays so near that nobody can tell soon enough what comes of it
  no_modes,  ///< no modes were found, or they changed without end: nothing is done
  lost,      ///< no step is short enough: forces that are not finite, or contacts that contradict each other
};

struct ModeStep {
  ModeEnd end = ModeEnd::step;
  int contact = -1;
  std::vector<PolynomialPiece>
      pieces;  ///< of each body, from the former time to time(); none where it is the same
};

class ModeMotion {
 public:
  /// At time t. `known`: which contacts may be closed. What is given must outlive it.
  ModeMotion(const ModeProblem& problem, const ModeLimits& limits, double t, std::vector<BodyState> states);

  /// Chooses modes; contacts with `closed` may be closed: what is left of their v_n is taken away. False: none are
  /// found.
  bool begin(const std::vector<bool>& closed);
  /// Goes on in modes that were chosen before. False: they contradict each other.
  bool begin_in(const std::vector<MotionMode>& modes);
  /// One step towards `until` > time(). After range, arrival, no_modes and lost it cannot go on.
  ModeStep step(double until);

  double time() const { return t_; }
  const std::vector<BodyState>& states() const { return states_; }
  const std::vector<MotionMode>& modes() const { return modes_; }
  /// At time(), in these modes.
  const ModeForces& forces() const { return forces_; }

 private:
  /// What no longer holds at a moment, and the least of all rooms there: < 0 where something fails.
  struct Look {
    enum class What : unsigned char { force, slip, range } what = What::force;
    int contact = -1;
    double room = 1.0;
  };
  using States = std::vector<BodyState>;

  bool put_on_contacts();
  double find_step(double until, States& end, std::vector<PolynomialPiece>& pieces);
  double error_of(const ModeTrial& trial) const;
  /// None where that is off its contacts (projected()).
  std::optional<States> after(double h) const {
    return projected(problem_, t_ + h, try_step(problem_, modes_, t_, states_, h).states, modes_);
  }
  Look look_at(double t, const States& states) const;
  bool gaps_hold(const std::vector<PolynomialPiece>& pieces, double h) const;
  bool fails_within(double h, const std::vector<PolynomialPiece>& pieces, double& clear, Look& failed) const;
  void close_in(const std::vector<PolynomialPiece>& pieces, double& clear, double crossed, double room,
                Look& failed) const;
  double arrive(double h, int contact) const;
  std::vector<PolynomialPiece> pieces_to(double end, const States& states) const;
  bool change(const Look& failed);
  std::vector<ContactKnown> known_now(const Look& failed) const;
  void set_scales();
  void accept(double end, States states);

  const ModeProblem& problem_;
  ModeLimits limits_;
  double t_;
  States states_;
  std::vector<MotionMode> modes_;
  ModeForces forces_;
  double h_ = 0.0;  ///< of the next step [s]
  double size_ = 1.0, speed_ = 1.0;
  int changes_ = 0;  ///< since time went on
};

}  // namespace brink
