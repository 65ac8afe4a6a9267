/// brink draw: a picture of a scene or of a run.

#include "brink/scenes/draw/draw.h"

#include <fmt/format.h>

#include "brink/scenes/files/written_file.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/run_folder.h"
#include "brink/scenes/run_file/run_moment.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink {
namespace {

namespace fs = std::filesystem;

/// Keeps the contacts that last at the end of a run.
class LastContacts final : public Recorder {
 public:
  explicit LastContacts(double end) : end_(end) {}
  void contact_lasted(const LastedContact& contact) override {
    if (contact.to >= end_) contacts.push_back(contact);
  }
  std::vector<LastedContact> contacts;

 private:
  double end_;
};

RunMoment moment_of_scene(const DrawArguments& arguments, const Scene& scene) {
  const double t = arguments.at.value_or(0.0);
  if (!(t >= 0.0 && t <= kLongestRun))
    throw BadInput(fmt::format("--at: {} given; allowed: 0 .. {} s", t, kLongestRun));
  Simulator simulator(scene.world, scene.solver);
  LastContacts last(t);
  RunOptions options;
  options.until = t;
  options.checkpoint_seconds = -1.0;
  if (t > 0.0) {
    const RunSummary summary = simulator.run(options, &last);
    if (summary.termination != Termination::reached_end) {
      throw BadInput(fmt::format("--at: {} given, but the scene ended at t = {} s: {}", t, summary.end_time,
                                 summary.why));
    }
  }
  RunMoment moment{t, scene.world, simulator.states(), {}, last.contacts};
  for (std::size_t k = 0; k < scene.world.sites.size(); ++k) {
    moment.sites.push_back(simulator.site_pose(static_cast<int>(k)));
  }
  return moment;
}

RunMoment moment_of(const DrawArguments& arguments, const fs::path& run, FieldOptions& field) {
  if (!run.empty()) return moment_of_run(run, arguments.at);
  const Scene scene = load_scene(arguments.subject, arguments.overrides);
  field = scene.solver.field;
  return moment_of_scene(arguments, scene);
}

}  // namespace

int draw_command(const DrawArguments& arguments) {
  DrawOptions options;
  options.layer = parse_layer(arguments.layer);
  options.size = parse_size(arguments.size);
  const fs::path run = run_file_of(arguments.subject);
  refuse_overwriting(arguments.out, "-o", {run.empty() ? fs::path(arguments.subject) : run});
  const RunMoment moment = moment_of(arguments, run, options.field);
  options.time = moment.t;
  if (options.layer.kind == DrawLayer::Kind::forces) options.forces = forces_of(moment);
  draw_png(arguments.out, moment.world, moment.bodies, moment.sites, options);
  return kDone;
}

}  // namespace brink
