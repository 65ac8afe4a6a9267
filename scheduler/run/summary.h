#pragma once
/// How a run ended, and what it came to.

#include <cstdint>
#include <string>

#include "brink/core/base/geometry.h"
#include "brink/core/base/work.h"

namespace brink {

/// How a run ended.
enum class Termination {
  not_run,
  reached_end,  ///< the asked time
  stopped,      ///< by a limit or by the user
  failed,       ///< could not go on: see RunSummary::why
};

/// Starts as "not run", so that a stale summary cannot look good.
struct RunSummary {
  Termination termination = Termination::not_run;
  std::string why;        ///< of stopped and failed: one sentence with the time and the bodies
  double end_time = 0.0;  ///< [s]
  std::uint64_t collisions = 0;
  double wall_seconds = 0.0;                        ///< the simulation alone
  double energy_initial = 0.0, energy_final = 0.0;  ///< [J]
  Vec2 momentum = Vec2::Zero();                     ///< at the end [kg m/s]
  double angular_momentum = 0.0;                    ///< about the world's origin, at the end [kg m^2/s]
  double max_overlap = 0.0;  ///< deepest gap below zero met at any event or frame [m], >= 0
  /// Groups of contacts that no law could part without a loss that their materials do not have: taken
  /// together with restitution 0.
  std::uint64_t groups_taken = 0;
  double energy_taken = 0.0;  ///< by these groups and by rest_speed (rest_energy) [J]
  std::string first_taken;    ///< the first of them: its bodies and time
  /// Bodies that the scene places a hair across a wire, and that were moved to just before it; by how much at most [m].
  int moved_at_start = 0;
  double moved_by = 0.0;
  /// Contacts that lasted (Islands): captured at the end of their bounces; steps that islands took, and how many of them by
  /// modes, others being of order 1, and how many of those were of islands that are small enough for modes; islands that are at rest at the end, and their bodies; the fastest approach that a step took without a rebound [m/s]; how
  /// far friction was from its cone at most, as a part of the largest force there.
  std::uint64_t contacts_lasting = 0, island_steps = 0, steps_by_modes = 0, small_by_steps = 0;
  std::uint64_t islands_at_rest = 0, resting = 0;
  double approach_absorbed = 0.0, friction_residual = 0.0;
  double rest_energy = 0.0;    ///< that the option rest_speed took [J]
  double island_energy = 0.0;  ///< that steps made, in all [J]: by rounding, and by faces that turn
  std::uint64_t state_hash = 0;
  WorkCounters work;

  /// The run file's word: "reached_end", "stopped", "failed: why".
  std::string termination_text() const;
  /// True if the asked time was reached, and nothing on the way was other than the scene says.
  bool sound() const { return termination == Termination::reached_end && groups_taken == 0; }
};

}  // namespace brink
