/// A run from its scene to its file. The order of the steps keeps an earlier run file as it is where
/// the request is refused:
///
///     limits of the request; is the run finished already?    no file is touched
///     plan the world; would it start?                        no file is touched
///     resume point, snapshot into the simulator              no file is touched
///     the trace, then the run file, are opened               an earlier run file is moved aside
///     simulate, close the run file whatever happens
#include "brink/scenes/run_file/run_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "brink/core/base/printable.h"
#include "brink/core/world/world_hash.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/trace_file.h"
#include "brink/scenes/scene/start.h"
#include "brink/scenes/scene/tables.h"
#include "brink/scheduler/simulator/simulator.h"

namespace brink {
namespace {

using Clock = std::chrono::steady_clock;

/// Wall-clock seconds.
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The limits of `duration`, and those of the frames, for a time given on the command line; and those of the threads.
double end_of(const Scene& scene, const RunRequest& request) {
  if (request.threads < 1 || request.threads > RunOptions::kMostThreads)
    throw BadInput(fmt::format("--threads {}: out of range; allowed: 1 to {}", request.threads,
                               RunOptions::kMostThreads));
  if (!request.until) return scene.duration;
  const auto refuse = [&](const std::string& why) {
    throw SceneFaults(scene.path, {{0, 0, "--until: " + why, {}}});
  };
  const double until = *request.until;
  if (!duration_range().holds(until))
    refuse("out of range; given " + number_text(until) + ", allowed: " + duration_range().text());
  if (const std::string why = too_many_frames(scene.output, until, scene.world.bodies.size()); !why.empty())
    refuse(why);
  return until;
}

/// The report of a run file that has already got to `until`, or nothing.
/// So a resume of a run that is done does nothing, however often it is asked for, and prints what was
/// printed.
std::optional<RunReport> finished_report(const RunFolder& folder, const RunFile& run, double until) {
  // A run that was stopped or failed is not finished, whatever its time.
  if (run.meta("termination") != "reached_end") return std::nullopt;
  RunReport report;
  report.summary.end_time = run.end_time();
  if (report.summary.end_time < until) return std::nullopt;
  // Of the summary only what the exit status depends on; all else is in its JSON as it was stored.
  report.summary.termination = Termination::reached_end;
  report.json = run.summary();
  // sound() asks for it: a run that was finished before has the exit status that it had.
  if (const auto j = nlohmann::json::parse(report.json, nullptr, false);
      j.is_object() && j.contains("groups_taken") && j["groups_taken"].is_number_unsigned())
    report.summary.groups_taken = j["groups_taken"];
  report.file = folder.file();
  report.finished_before = true;
  return report;
}

/// The same of the run file in `folder`, if it is of this scene.
std::optional<RunReport> finished_before(const Scene& scene, const RunFolder& folder, double until) {
  std::optional<RunReport> report;
  folder.read([&](const RunFile& run) {
    // A file of another scene is no answer to this one.
    run.require_same(scene);
    report = finished_report(folder, run, until);
  });
  return report;
}

/// Waits as long as the request says, and knows how long that was, since it is no part of the simulation.
class Pause {
 public:
  Pause(RunFileRecorder& recorder, const RunRequest& request) : recorder_(&recorder), request_(&request) {}

  /// Rows are committed meanwhile, so that who reads the file sees all up to here.
  void wait() {
    if (!request_->waits || !request_->waits()) return;
    const auto begin = Clock::now();
    do {
      // Fifty times a second: soon enough for a person who lets the run go on.
      recorder_->poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    } while (request_->waits());
    const double waited = seconds_since(begin);
    recorder_->leave_out(waited);
    seconds_ += waited;
  }
  double seconds() const { return seconds_; }

 private:
  RunFileRecorder* recorder_;
  const RunRequest* request_;
  double seconds_ = 0.0;
};

/// What the simulator is told of the scene and the request. The closures keep references: recorder,
/// request and pause outlive the run.
RunOptions run_options(const Scene& scene, const RunRequest& request, double until, RunFileRecorder& recorder,
                       Pause& pause) {
  RunOptions options;
  options.until = until;
  options.frame_interval = scene.output.frame_interval;
  options.look_interval = scene.duration / RunOptions::kLooks;  // wherever this run is to end
  options.checkpoint_seconds = request.checkpoint_seconds;
  options.threads = request.threads;
  // A run that goes on has the frame of the checkpoint's time if the clock has one there; else that is none of its frames,
  // but where it ends there (killed after its last checkpoint).
  const std::optional<ResumePoint>& point = recorder.resume_point();
  options.first_frame = !point || (point->t == until && !recorder.has_frame_of(until));
  options.record_events = scene.output.events;
  options.progress = [&recorder, &request, &pause](double t, std::uint64_t collisions) {
    // Also where no rows come: what has waited long enough is committed now.
    recorder.poll();
    pause.wait();
    // Told after the pause: a stop that was asked for during it takes effect at once.
    return !request.progress || request.progress(t, collisions);
  };
  return options;
}

/// Takes the simulator to where the run file has got to.
/// @throws BadInput where `until` [s] lies before the checkpoint; IoError where the snapshot is not one
/// of this world.
void restore(Simulator& simulator, const RunFolder& folder, const ResumePoint& point, double until) {
  // What is recorded up to the checkpoint stays.
  if (until < point.t)
    throw BadInput(
        fmt::format("--until: {} given, but the run file is already at t = {} s; allowed: that or later",
                    until, point.t));
  try {
    // The seal holds, but the snapshot may still be none of this simulator's.
    simulator.restore(point.state);
  } catch (const BadInput& e) {
    throw IoError(fmt::format("{}: table checkpoint: {}", folder.file().string(), e.what()));
  }
}

/// Records, and tells what has been recorded.
class TellingRecorder final : public Recorder {
 public:
  /// The file first, then the request's own function: what it is told of is on its way to the disk.
  TellingRecorder(RunFileRecorder& file, const RunRequest& request, Pause& pause)
      : file_(&file), request_(&request), pause_(&pause) {}
  bool get_ready(double t) override { return file_->get_ready(t); }
  void frame(double t, std::span<const BodyState> states) override { file_->frame(t, states); }
  void event(const Event& event) override {
    file_->event(event);
    request_->happened(event);
    pause_->wait();
  }
  void contact_lasted(const LastedContact& contact) override { file_->contact_lasted(contact); }
  void knot(const Knot& knot) override { file_->knot(knot); }
  void checkpoint(double t, const std::vector<std::byte>& state) override { file_->checkpoint(t, state); }

 private:
  RunFileRecorder* file_;
  const RunRequest* request_;
  Pause* pause_;
};

/// What the run file says of a run that an exception ended.
/// Energies and counters stay those of a summary that was never filled.
void close_as_failed(RunFileRecorder& recorder, const Simulator& simulator, const std::string& why) {
  RunSummary summary;
  summary.termination = Termination::failed;
  summary.why = why;
  summary.end_time = simulator.time();
  summary.state_hash = simulator.state_hash();
  try {
    recorder.finish(summary, summary_to_json(summary, 0.0));
  } catch (const IoError&) {
    // the file stays at its last commit; what ended the run is told by the exception that did
  }
}

/// Files that the scene reads beside its own.
std::vector<std::string> names_of_data(const Scene& scene) {
  std::vector<std::string> names;
  for (const std::filesystem::path& file : scene.files)
    if (file != scene.path) names.push_back(file.string());
  return names;
}

}  // namespace

Scene scene_of_run(const std::filesystem::path& run_file, const std::vector<std::string>& more) {
  const RunFile run(run_file);
  const auto text = run.meta("scene_text");
  if (!text)
    throw BadInput(fmt::format("{}: does not hold its scene's text: it was written by an earlier Brink",
                               run_file.string()));
  // A run file of before has no overrides, and then none were given.
  const auto json = nlohmann::json::parse(run.meta("overrides").value_or("[]"), nullptr, false);
  const auto is_text = [](const nlohmann::json& j) { return j.is_string(); };
  if (!json.is_array() || !std::all_of(json.begin(), json.end(), is_text))
    throw IoError(fmt::format("{}: table meta: overrides: not a JSON array of strings", run_file.string()));
  auto overrides = json.get<std::vector<std::string>>();
  // In this order, as the last of two overrides of one key holds.
  overrides.insert(overrides.end(), more.begin(), more.end());
  // With the scene's own path: data files that it names are found beside it.
  Scene scene = parse_scene(*text, run.meta("scene").value_or(run_file.string()), overrides);
  // What a data file says is not in the run file.
  const auto was = run.meta("world_hash");
  if (more.empty() && scene.files.size() > 1 && was && *was != world_hash_text(scene.world))
    throw BadInput(fmt::format("{}: a data file of its scene has changed since: {}; allowed: as it was",
                               run_file.string(), fmt::join(names_of_data(scene), ", ")));
  return scene;
}

RunReport run_scene(const Scene& scene, const RunRequest& request) {
  const auto start = Clock::now();
  const double until = end_of(scene, request);
  // What is read or kept by this run must not be written over before it is read.
  std::vector<std::filesystem::path> kept = scene.files;
  kept.push_back(request.dir / "run.db");
  refuse_overwriting(request.trace, "--trace", kept);
  std::optional<RunFolder> folder;
  if (request.resume) {
    // A resume that has nothing to do is told before the world is planned.
    folder.emplace(request.dir);
    if (auto report = finished_before(scene, *folder, until)) return *report;
  }
  // Checks the world and makes its fields: the long part of planning, counted in load_seconds.
  Simulator simulator(scene.world, scene.solver);
  // No run file has been touched yet: a scene that cannot start leaves the earlier one in its place.
  require_start(scene, simulator);
  std::optional<ResumePoint> point;
  if (request.resume) point = folder->resume_point(scene);
  // Before the run file is opened for writing: a snapshot that does not fit changes nothing.
  if (point) restore(simulator, *folder, *point, until);
  std::optional<TraceFile> trace;
  // Before the recorder, which moves an earlier run file aside: a trace that cannot be opened
  // changes nothing.
  if (!request.trace.empty()) trace.emplace(request.trace, simulator.world());
  if (!folder) folder.emplace(request.dir);
  RunFileRecorder recorder(std::move(*folder), scene,
                           request.resume ? RunFileRecorder::Open::resume : RunFileRecorder::Open::fresh,
                           std::move(point));
  RunReport report;
  report.file = recorder.file();
  if (recorder.resume_point()) report.resumed_from = recorder.resume_point()->t;
  recorder.simulation_begins();
  // All up to the first step, checks of a resume and catching up included.
  const double load_seconds = request.load_seconds + seconds_since(start);
  Pause pause(recorder, request);
  RunOptions options = run_options(scene, request, until, recorder, pause);
  options.trace = trace ? &*trace : nullptr;
  // The run file is open, and nothing has moved yet.
  if (request.begins) request.begins();
  try {
    TellingRecorder telling(recorder, request, pause);
    // Without `happened` there is nobody to tell: events go straight to the file.
    report.summary = simulator.run(options, request.happened ? static_cast<Recorder*>(&telling) : &recorder);
  } catch (const std::exception& e) {
    // The file says how it ended; who called is told all the same.
    close_as_failed(recorder, simulator, e.what());
    throw;
  }
  // The end of a run that failed is none of the frame clock's: one that fails there again has it still.
  const double end = report.summary.end_time;
  if (report.summary.termination == Termination::failed && report.resumed_from == end &&
      !recorder.has_frame_of(end))
    recorder.frame(end, simulator.states());
  report.summary.wall_seconds -= pause.seconds();
  // The simulator has counted from the checkpoint on.
  if (recorder.resume_point()) report.summary.wall_seconds += recorder.resume_point()->wall_seconds;
  report.json = summary_to_json(report.summary, load_seconds);
  recorder.finish(report.summary, report.json);
  // After the run file: a trace that could not be written costs nothing of the run.
  if (trace) trace->finish();
  return report;
}

// Other programs read these keys: `brink run --json` prints them, meta's `summary` keeps them. NaN and
// infinity have no word in JSON and become null.
std::string summary_to_json(const RunSummary& summary, double load_seconds) {
  nlohmann::ordered_json work;
  WorkCounters::for_each(summary.work,
                         [&work](const char* name, auto value, const char*) { work[name] = value; });
  const nlohmann::ordered_json j = {{"termination", summary.termination_text()},
                                    {"end_time", summary.end_time},
                                    {"collisions", summary.collisions},
                                    {"wall_seconds", summary.wall_seconds},
                                    {"load_seconds", load_seconds},
                                    {"energy_initial", summary.energy_initial},
                                    {"energy_final", summary.energy_final},
                                    {"momentum_x", summary.momentum.x()},
                                    {"momentum_y", summary.momentum.y()},
                                    {"angular_momentum", summary.angular_momentum},
                                    {"max_overlap", summary.max_overlap},
                                    {"groups_taken", summary.groups_taken},
                                    {"energy_taken", summary.energy_taken},
                                    {"first_taken", summary.first_taken},
                                    {"moved_at_start", summary.moved_at_start},
                                    {"moved_by", summary.moved_by},
                                    {"contacts_lasting", summary.contacts_lasting},
                                    {"island_steps", summary.island_steps},
                                    {"steps_by_modes", summary.steps_by_modes},
                                    {"small_by_steps", summary.small_by_steps},
                                    {"islands_at_rest", summary.islands_at_rest},
                                    {"resting", summary.resting},
                                    {"approach_absorbed", summary.approach_absorbed},
                                    {"friction_residual", summary.friction_residual},
                                    {"island_energy", summary.island_energy},
                                    {"rest_energy", summary.rest_energy},
                                    // As text: JSON's numbers are doubles for many readers, which would
                                    // round 64 bits.
                                    {"state_hash", fmt::format("{:016x}", summary.state_hash)},
                                    {"work", std::move(work)}};
  // A reason may quote bytes of a file that are no UTF-8: they are replaced, as dump() would throw.
  return j.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace brink
