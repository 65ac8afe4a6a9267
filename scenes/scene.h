#pragma once
/// A scene: what a scene file says, parsed, checked and ready to run.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "brink/core/base/error.h"
#include "brink/core/world/world.h"
#include "brink/scheduler/options.h"

namespace brink {

inline constexpr double kLongestRun = 1e12;  ///< no run and no picture goes farther [s]

struct OutputOptions {
  double frame_interval = 0.01;  ///< [s]; 0 = events only
  bool events = true;
  std::int64_t max_frame_rows = 100'000'000;  ///< frames times bodies; a scene that asks for more is refused
};

struct Scene {
  std::filesystem::path path;
  World world;
  double duration = 1.0;  ///< [s]
  SolverOptions solver;
  OutputOptions output;
  std::vector<std::string> notes;  ///< for people: achieved curve deviations, sampling limits ...
  std::string options_json;        ///< every option as used, for the run file
};

/// One fault of a scene file; line and column count from 1 (0: the command line's --set).
struct SceneFault {
  int line = 0, column = 0;
  std::string message;  ///< what is wrong, what was given, what is allowed
  std::string file;     ///< a data file that the scene names; empty: the scene file itself
};

/// Every fault of a file at once; what() has one "FILE:LINE:COLUMN: message" a line.
class SceneFaults : public BadInput {
 public:
  SceneFaults(const std::filesystem::path& file, std::vector<SceneFault> faults);
  const std::vector<SceneFault>& faults() const { return faults_; }

 private:
  std::vector<SceneFault> faults_;
};

/// Reads, overrides ("solver.policy=global_backup", dotted paths as in the file; arrays by index:
/// "bodies.0.mass=2"), and validates a scene file.
/// @throws SceneFaults with all faults; IoError if the file cannot be read.
Scene load_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text (for tests and tools); `name` stands for the file in messages.
Scene parse_scene(std::string_view text, const std::string& name,
                  const std::vector<std::string>& overrides = {});

/// One key that a scene file may hold.
struct OptionInfo {
  std::string table;  ///< "world", "solver", "bodies", "disc" ...
  std::string key;
  std::string type;           ///< what is allowed, with the unit
  std::string default_value;  ///< as TOML, or in words; "needed" where there is none
  std::string meaning;
};

/// Every key of the scene file, table by table, from the declarations that the reader itself uses.
std::vector<OptionInfo> scene_options();

}  // namespace brink
