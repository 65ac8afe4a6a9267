#pragma once
/// Accelerations and contact forces while nobody changes its mode.
///
///   M (a - f) = sum of forces p n + q t,   J_n a + bend = 0 where closed,   J_t a + bend = 0 where it sticks,
///   q = -+ mu p where it slips
///
/// Rows may be redundant (four legs): accelerations are unique then, forces are some that there are. Sources:
/// Glocker 2001, "Set-valued force laws"; Pfeiffer & Glocker 1996, "Multibody dynamics with unilateral contacts".

#include "brink/scheduler/islands/modes/mode_problem.h"

namespace brink {

struct ModeForces {
  bool consistent = true;                  ///< false: no accelerations keep these contacts so
  Eigen::VectorXd acceleration;            ///< x, y [m/s^2], angle [rad/s^2] of each body
  std::vector<double> normal, tangential;  ///< of each contact, on the sample's owner [N]; 0 where open
  /// How far forces are inside what they may be, as a part of the largest; < 0: these modes do not hold, and
  /// `worst` says of which contact: its normal force or (stick) its friction.
  double margin = 0.0;
  int worst = -1;
};

/// Cost: about (3 rows)^3 flops. Margins cost as much again and are left out where not asked for.
ModeForces forces_in(const ModeProblem& problem, const ModeMoment& moment,
                     const std::vector<MotionMode>& modes, bool with_margin = true);

/// The states with positions moved onto gap = kept of all closed contacts, and then velocities onto v_n = 0, and
/// v_t = 0 where it sticks: by least change in the mass metric. Supports move as they do at t. None where a closed contact is off
/// by more than kOnContact of the size: nobody is moved that far.
std::optional<std::vector<BodyState>> projected(const ModeProblem& problem, double t,
                                                std::vector<BodyState> states,
                                                const std::vector<MotionMode>& modes);

}  // namespace brink
