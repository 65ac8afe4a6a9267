#pragma once
/// From a scene to a run file: what `brink run` does, as one call.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/run/recorder.h"

namespace brink {

struct RunRequest {
  std::filesystem::path dir;        ///< DIR/run.db is written; made if need be
  std::optional<double> until;      ///< [s]; else the scene's duration
  bool resume = false;              ///< go on with DIR/run.db from its last checkpoint
  int threads = 1;                  ///< as RunOptions has it; a resume may have others
  double checkpoint_seconds = 1.0;  ///< as RunOptions has it
  std::filesystem::path trace;      ///< write the scheduler's timeline there; empty: none
  double load_seconds = 0.0;  ///< spent on reading the scene; what run_scene itself takes to plan is added
  /// Called when the run file is open and the simulation begins: from now on what is done is worth keeping.
  /// May be empty.
  std::function<void()> begins;
  /// Called now and then; return false to stop. May be empty.
  std::function<bool(double t, std::uint64_t collisions)> progress;
  /// Told of every event. May be empty.
  std::function<void(const Event&)> happened;
  /// The run waits, its rows committed, while this is true; asked after every event and now and then. May be empty.
  std::function<bool()> waits;
};

struct RunReport {
  RunSummary summary;
  std::string json;                    ///< summary_to_json of it
  std::filesystem::path file;          ///< the run file
  std::optional<double> resumed_from;  ///< [s]
  /// Nothing was left to do: `json` is the stored one, `summary` its end and groups_taken alone.
  bool finished_before = false;
};

/// The scene that the run in `run_file` was of, as its file has it: text and overrides, then `more` of them.
/// @throws BadInput where it does not say; SceneFaults; IoError.
Scene scene_of_run(const std::filesystem::path& run_file, const std::vector<std::string>& more = {});

/// Runs `scene` and writes the run file. However the simulation ends, the file is closed with that ending.
/// @throws BadInput for a scene or request that cannot run; IoError where the file cannot be written.
RunReport run_scene(const Scene& scene, const RunRequest& request);

/// The summary as one line of JSON: termination, end_time, collisions, wall_seconds, load_seconds,
/// energy_initial, energy_final, momentum_x, momentum_y, angular_momentum, max_overlap, groups_taken,
/// energy_taken, first_taken (text, empty where none was), moved_at_start, moved_by, contacts_lasting, island_steps, steps_by_modes,
/// small_by_steps, islands_at_rest, resting, approach_absorbed, friction_residual, island_energy, rest_energy, state_hash (16 hexadecimal digits), work{...}.
/// Numbers read back to the same bits.
std::string summary_to_json(const RunSummary& summary, double load_seconds);

}  // namespace brink
