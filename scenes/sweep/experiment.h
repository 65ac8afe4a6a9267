#pragma once
/// An experiment: base scenes, and the axes along which their options are varied. Every combination is one run.
///
///     title    = "Policies and orders on a gas"
///     scenes   = ["../gallery/break_shot.toml"]     # from the experiment's own folder
///     policies = ["global_backup", "fixed_step"]    # the axis solver.policy
///     orders   = ["index", "random"]                # the axis solver.order
///     seeds    = 5                                  # the axis world.seed: 1..5, or an array
///     [axes]
///     solver.step = [1e-3, 1e-4]                    # any key of the scene file, by its dotted path as in --set
///     [set]
///     output.frame_interval = 0.0                   # the same in every run
///
/// docs/sweep.md has the whole format.

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "brink/scenes/scene/scene.h"

namespace brink {

/// One option that is varied.
struct SweepAxis {
  std::string name;                 ///< column of the tables: "scene", "policy", "order", "seed", or the path
  std::string path;                 ///< dotted, as in --set; empty for "scene"
  std::vector<std::string> values;  ///< for people: strings without quotes
};

/// One combination of values.
struct SweepRun {
  std::string key;  ///< 16 hexadecimal digits: equal for runs of the same scene, options and Brink version
  std::filesystem::path scene;
  std::vector<std::string> overrides;  ///< "PATH=VALUE", as `brink run --set` takes them
  std::vector<std::string> values;     ///< one an axis
};

/// What the plot shows. Runs that differ in other axes are drawn as their median and range.
struct SweepPlot {
  std::string x;               ///< an axis
  std::string series;          ///< an axis, or empty: one line
  std::vector<std::string> y;  ///< columns (sweep_columns()), one panel each
};

struct Experiment {
  std::filesystem::path path;
  std::set<std::filesystem::path> files;  ///< all that was read for it: its own, scenes and their data files
  std::string title;
  std::optional<double> until;  ///< [s]; none: each scene's duration
  double seconds_limit = 0.0;   ///< wall seconds after which a run is stopped; 0: none
  std::vector<SweepAxis> axes;  ///< scene, policy, order, those of [axes] in the file's order, seed
  std::vector<SweepRun> runs;   ///< the last axis varies fastest
  SweepPlot plot;
};

/// Most runs that one experiment may have.
inline constexpr std::size_t kMostSweepRuns = 1'000'000;

/// Reads an experiment file, and every base scene with each value of each axis, so that a bad value is found
/// before anything runs. Seeds are read alone, without the scenes.
/// @throws SceneFaults with every fault and its place, in the experiment file or a base scene; IoError if the
/// experiment file cannot be read.
Experiment load_experiment(const std::filesystem::path& file);

/// A value of an axis that is a number, or nothing.
std::optional<double> as_number(const std::string& value);

/// Every key of an experiment file.
std::vector<OptionInfo> experiment_options();

}  // namespace brink
