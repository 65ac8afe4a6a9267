#pragma once
/// A scene: what a scene file says, parsed, checked and ready to run.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "brink/core/world/world.h"
#include "brink/scenes/toml/option_info.h"
#include "brink/scenes/toml/scene_faults.h"
#include "brink/scheduler/run/options.h"

namespace brink {

inline constexpr double kLongestRun = 1e12;  ///< no run and no picture goes farther [s]

struct OutputOptions {
  double frame_interval = 0.01;  ///< [s]; 0 = events only
  bool events = true;
  std::int64_t max_knots = 5'000'000;         ///< rows of knots: of more a run records the first ones
  std::int64_t max_frame_rows = 100'000'000;  ///< frames times bodies; a scene that asks for more is refused
};

/// A place in the scene file; both count from 1, and are 0 where the command line's --set said it.
struct ScenePlace {
  int line = 1, column = 1;
};

struct Scene {
  std::filesystem::path path;
  std::vector<std::filesystem::path>
      files;                           ///< all that was read for it: the scene file, then its data files
  std::string text;                    ///< of the file
  std::vector<std::string> overrides;  ///< PATH=VALUE
  World world;
  std::vector<ScenePlace> body_places;  ///< where the entry of each body begins
  double duration = 1.0;                ///< [s]
  SolverOptions solver;
  OutputOptions output;
  std::vector<std::string> notes;  ///< for people: achieved curve deviations, sampling limits ...
  std::string options_json;        ///< every option as used, for the run file
};

/// Reads, overrides ("solver.policy=global_backup", dotted paths as in the file; arrays by index:
/// "bodies.0.mass=2"), and validates a scene file.
/// @throws SceneFaults with all faults; IoError if the file cannot be read.
Scene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text (for tests and tools); `name` stands for the file in messages.
Scene parse_scene(std::string_view text, const std::string& name,
                  const std::vector<std::string>& overrides = {});

/// Every key of the scene file, table by table, from the declarations that the reader itself uses.
std::vector<OptionInfo> scene_options();

}  // namespace brink
