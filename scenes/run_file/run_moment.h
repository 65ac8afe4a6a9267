#pragma once
/// One moment of a run, read from its run file: what a picture needs.

#include <filesystem>
#include <optional>
#include <vector>

#include "brink/core/world/world.h"

namespace brink {

/// A world at one moment: states of its bodies and poses of its sites, by id.
struct RunMoment {
  double t = 0.0;  ///< [s]
  World world;
  std::vector<BodyState> bodies;
  std::vector<Pose> sites;
};

/// The run in `file` at time `at`, the end if not given; between two frames its states are interpolated.
/// @throws BadInput if `at` is outside the run; IoError naming file and table where the file cannot be read,
/// or says what cannot be drawn.
RunMoment moment_of_run(const std::filesystem::path& file, std::optional<double> at);

}  // namespace brink
