#include "brink/scenes/run_file/run_moment.h"

#include <fmt/format.h>

#include <cmath>

#include "brink/core/base/error.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scheduler/kernel/site_motion.h"

namespace brink {
namespace {

constexpr double kFarthest = 1e20;  // [m], [rad]: squares of differences are finite

bool somewhere(const Pose& pose) {
  return pose.position.norm() <= kFarthest && std::abs(pose.angle) <= kFarthest;
}

[[noreturn]] void nowhere(const std::filesystem::path& file, const char* table, const std::string& name,
                          double t) {
  throw IoError(fmt::format("{}: table {}: '{}' is at no place that can be drawn at t = {} s", file.string(),
                            table, name, t));
}

void require_drawable(const std::filesystem::path& file, const RunMoment& moment) {
  for (std::size_t k = 0; k < moment.sites.size(); ++k)
    if (!somewhere(moment.sites[k])) nowhere(file, "site", moment.world.sites[k].name, moment.t);
  for (std::size_t k = 0; k < moment.bodies.size(); ++k)
    if (!somewhere(moment.bodies[k].pose)) nowhere(file, "frame", moment.world.bodies[k].name, moment.t);
}

}  // namespace

RunMoment moment_of_run(const std::filesystem::path& file, std::optional<double> at) {
  const RunFile run(file);
  const auto [first, last] = run.time_range();
  const double t = at.value_or(last);
  if (!(t >= first && t <= last))
    throw BadInput(fmt::format("--at: {} given; allowed: {} .. {} s", t, first, last));
  RunMoment moment{t, run.world(), run.states_at(t).states, {}};
  for (const FixedSite& site : moment.world.sites) moment.sites.push_back(told_pose(site, t));
  require_drawable(file, moment);
  return moment;
}

}  // namespace brink
