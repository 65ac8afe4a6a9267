#pragma once
/// One moment of a run, read from its run file: what a picture needs.

#include <filesystem>
#include <optional>
#include <vector>

#include "brink/core/world/world.h"
#include "brink/scenes/draw/draw.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scheduler/run/lasted_contact.h"

namespace brink {

/// A world at one moment: states of its bodies and poses of its sites, by id.
struct RunMoment {
  double t = 0.0;  ///< [s]
  World world;
  std::vector<BodyState> bodies;
  std::vector<Pose> sites;
  std::vector<LastedContact> contacts;  ///< that last at this moment
};

/// The forces of the moment's contacts on its bodies, where the features that press are at the moment: their
/// forces are those at the ends of their stretches.
/// @throws BadInput if a contact names a sample or a site that its outline does not have.
std::vector<DrawnForce> forces_of(const RunMoment& moment);

/// All that is worth seeing of the run: of some thirty of its frames. Two pictures of a run with it match.
Box extent_of(const RunFile& run, const World& world);
/// Where each body has been at some hundreds of times up to t.
std::vector<std::vector<Vec2>> trails_of(const RunFile& run, double t);
/// Collisions up to t since the frame before it.
std::vector<DrawnContact> contacts_before(const RunFile& run, double t);

/// The run in `file` at time `at`, the end if not given; between two frames its states are interpolated.
/// @throws BadInput if `at` is outside the run; IoError naming file and table where the file cannot be read,
/// or says what cannot be drawn.
RunMoment moment_of_run(const std::filesystem::path& file, std::optional<double> at);

}  // namespace brink
