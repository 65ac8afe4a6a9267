/// brink draw: a picture of a scene or of a run.

// A picture is of one moment of a subject:
//
//     a scene     is simulated up to the time, in memory; nothing is written but the picture
//     a run       is read at the time; between two of its frames bodies are interpolated
//
// Either gives a RunMoment; from there on both are drawn alike. Only a run has a past, for trails and
// collisions.
#include "brink/scenes/draw/draw.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "brink/scenes/files/written_file.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/run_folder.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_moment.h"
#include "brink/scenes/scene/scene.h"
#include "brink/scenes/scene/start.h"
#include "brink/scheduler/kernel/site_motion.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink {
namespace {

namespace fs = std::filesystem;

/// A view is at least this part of all that there is to see. A closer one shows a line without its other side, and takes the
/// longer the closer it is, as a curve is drawn by pieces of a size with its pixels.
constexpr double kClosest = 1e-9;

/// Keeps the contacts that last at the end of a run.
class LastContacts final : public Recorder {
 public:
  explicit LastContacts(double end) : end_(end) {}
  // Stretches that ended before are of contacts that changed their mode or are gone.
  void contact_lasted(const LastedContact& contact) override {
    if (contact.to >= end_) contacts.push_back(contact);
  }
  std::vector<LastedContact> contacts;

 private:
  double end_;
};

// A scene is run up to the time without recording anything but what lasts then.
RunMoment moment_of_scene(const DrawArguments& arguments, const Scene& scene) {
  const double t = arguments.at.value_or(0.0);
  if (!(t >= 0.0 && t <= kLongestRun))
    throw BadInput(fmt::format("--at: {} given; allowed: 0 .. {} s", t, kLongestRun));
  Simulator simulator(scene.world, scene.solver);
  // Contacts that outlast the run are told last, with its end as their own.
  LastContacts last(t);
  RunOptions options;
  options.until = t;
  options.checkpoint_seconds = -1.0;
  // At 0 the simulator stands at the start: nothing to run, and overlaps may be looked at.
  if (t > 0.0) {
    require_start(scene, simulator);
    const RunSummary summary = simulator.run(options, &last);
    // A picture of another time than the one asked for would not be noticed: refused.
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

/// @throws BadInput for a view that is too close to see anything of `all`, the extent of what there is [m].
void require_not_too_close(const std::string& text, const Box& view, const Box& all) {
  const double least = kClosest * all.extent().maxCoeff(), side = view.extent().minCoeff();
  if (side >= least) return;
  throw BadInput(fmt::format(
      "--view: {} given, with a side of {:.3g} m; allowed: {:.3g} m or more, {:g} of what there is to see",
      text, side, least, kClosest));
}

/// All that is seen of a scene at its start [m].
Box extent_at_start(const Scene& scene) {
  std::vector<BodyState> bodies;
  for (const Body& body : scene.world.bodies) bodies.push_back(body.initial);
  std::vector<Pose> sites;
  for (const FixedSite& site : scene.world.sites) sites.push_back(told_pose(site, 0.0));
  return automatic_view(scene.world, bodies, sites);
}

/// The subject at the time asked for; the field's options are set to the scene's own. What is read is not written over.
RunMoment moment_of(const DrawArguments& arguments, const fs::path& run, DrawOptions& options) {
  if (!run.empty()) {
    const RunFile file(run);
    refuse_overwriting(arguments.out, "-o", file.files());
    options.field = file.field_options();
    if (options.view) require_not_too_close(arguments.view, *options.view, extent_of(file, file.world()));
    return moment_of_run(run, arguments.at);
  }
  const Scene scene = load_scene(arguments.subject, arguments.overrides);
  refuse_overwriting(arguments.out, "-o", scene.files);
  options.field = scene.solver.field;
  if (options.view) require_not_too_close(arguments.view, *options.view, extent_at_start(scene));
  RunMoment moment = moment_of_scene(arguments, scene);
  if (!options.view && moment.t > 0.0 && options.layer.kind != DrawLayer::Kind::pass) {
    // all that there is to see at the start, and where bodies are by then
    options.view = automatic_view(moment.world, moment.bodies, moment.sites);
    const Box at_start = extent_at_start(scene);
    options.view->add(at_start.low);
    options.view->add(at_start.high);
  }
  return moment;
}

/// "X0,Y0,X1,Y1" [m]. @throws BadInput.
Box parse_view(const std::string& text) {
  double n[4] = {};
  const char *at = text.data(), *end = at + text.size();
  bool good = true;
  for (int i = 0; i < 4 && good; ++i) {
    const auto [stop, error] = std::from_chars(at, end, n[i]);
    // A comma after each number but the last, which must end the text: no spaces, nothing left over.
    good = error == std::errc() && std::isfinite(n[i]) && (i < 3 ? stop != end && *stop == ',' : stop == end);
    at = stop + 1;
  }
  if (!good || !(n[0] < n[2] && n[1] < n[3]))
    throw BadInput(
        fmt::format("--view: {} given; allowed: X0,Y0,X1,Y1 in metres with X0 < X1 and Y0 < Y1", text));
  Box box;
  box.add({n[0], n[1]});
  box.add({n[2], n[3]});
  return box;
}

/// What a run's picture has beside its moment.
void add_history(const DrawArguments& arguments, const fs::path& file, const RunMoment& moment,
                 DrawOptions& options) {
  const RunFile run(file);
  // One camera for all pictures of a run; a pass has its own.
  if (!options.view && options.layer.kind != DrawLayer::Kind::pass)
    options.view = extent_of(run, moment.world);
  if (arguments.trails) options.trails = trails_of(run, moment.t);
  if (arguments.contacts) options.contacts = contacts_before(run, moment.t);
}

}  // namespace

int draw_command(const DrawArguments& arguments) {
  // Names of layers, sizes and files are checked before a scene is run, which may take long.
  require_picture_name(arguments.out);
  DrawOptions options;
  options.layer = parse_layer(arguments.layer);
  options.size = parse_size(arguments.size);
  if (!arguments.view.empty()) {
    // What is asked for is seen to the number, without a margin; square pixels may show more on two sides.
    options.view = parse_view(arguments.view);
    options.margin = 0.0;
  }
  // --plain takes both: a paper has its own caption.
  options.diagram = options.caption = !arguments.plain;
  options.axes = arguments.axes;
  options.names = arguments.names;
  options.velocities = arguments.velocities;
  if (options.layer.kind == DrawLayer::Kind::depth &&
      (arguments.names || arguments.trails || arguments.velocities || arguments.contacts))
    throw BadInput(
        "--names, --trails, --velocities, --contacts: are drawn over layer scene, color, forces or pass; "
        "given "
        "--layer depth");
  const fs::path run = run_file_of(arguments.subject);
  // What a run was made of cannot be changed any more.
  if (!run.empty() && !arguments.overrides.empty())
    throw BadInput("--set: is for scenes; a run has been made");
  // A scene is run to one moment here, and nothing of what was before is kept.
  if (run.empty() && (arguments.trails || arguments.contacts))
    throw BadInput("--trails, --contacts: are of runs; a scene has none yet");
  // Everything that can be refused without it has been: a scene is now run up to the time.
  const RunMoment moment = moment_of(arguments, run, options);
  options.time = moment.t;
  if (options.layer.kind == DrawLayer::Kind::forces) options.forces = forces_of(moment);
  if (!run.empty()) add_history(arguments, run, moment, options);
  if (!run.empty() && arguments.at) tell_unknown(RunFile(run));
  draw_file(arguments.out, moment.world, moment.bodies, moment.sites, options);
  return kDone;
}

}  // namespace brink
