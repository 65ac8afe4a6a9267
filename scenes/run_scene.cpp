#include "brink/scenes/run_scene.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "brink/scenes/run_file.h"
#include "brink/scenes/trace_file.h"
#include "brink/scheduler/simulator.h"

namespace brink {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double end_of(const Scene& scene, const RunRequest& request) {
  const double until = request.until.value_or(scene.duration);
  if (!(until > 0.0) || !std::isfinite(until)) {
    throw BadInput(fmt::format("--until: {} given; allowed: a finite time > 0 s", until));
  }
  return until;
}

/// The report of a run file that has already got to `until`, or nothing.
std::optional<RunReport> finished_report(const Scene& scene, const std::filesystem::path& file,
                                         double until) {
  if (!is_run_file(file)) return std::nullopt;
  const RunFile run(file);
  run.require_same(scene);
  if (run.meta("termination") != "reached_end") return std::nullopt;
  RunReport report;
  report.summary.end_time = std::stod(run.meta("end_time").value_or("0"));
  if (report.summary.end_time < until) return std::nullopt;
  report.summary.termination = Termination::reached_end;
  report.json = run.meta("summary").value_or("{}");
  if (const auto j = nlohmann::json::parse(report.json, nullptr, false); j.is_object())
    report.summary.groups_taken = j.value("groups_taken", std::uint64_t{0});
  report.file = file;
  report.finished_before = true;
  return report;
}

RunOptions run_options(const Scene& scene, const RunRequest& request, double until,
                       RunFileRecorder& recorder) {
  RunOptions options;
  options.until = until;
  options.frame_interval = scene.output.frame_interval;
  options.checkpoint_seconds = request.checkpoint_seconds;
  options.first_frame = !recorder.resume_point();
  options.record_events = scene.output.events;
  options.progress = [&recorder, &request](double t, std::uint64_t collisions) {
    recorder.poll();
    return !request.progress || request.progress(t, collisions);
  };
  return options;
}

void restore(Simulator& simulator, const RunFileRecorder& recorder, double until) {
  const auto& point = recorder.resume_point();
  if (!point) return;
  if (until < point->t) {
    throw BadInput(
        fmt::format("--until: {} given, but the run file is already at t = {} s; allowed: that or later",
                    until, point->t));
  }
  simulator.restore(point->state);
}

/// What the run file says of a run that an exception ended.
void close_as_failed(RunFileRecorder& recorder, const Simulator& simulator, const std::string& why) {
  RunSummary summary;
  summary.termination = Termination::failed;
  summary.why = why;
  summary.end_time = simulator.time();
  summary.state_hash = simulator.state_hash();
  recorder.finish(summary, summary_to_json(summary, 0.0));
}

}  // namespace

RunReport run_scene(const Scene& scene, const RunRequest& request) {
  const auto start = Clock::now();
  const double until = end_of(scene, request);
  if (request.resume) {
    if (auto report = finished_report(scene, request.dir / "run.db", until)) return *report;
  }
  Simulator simulator(scene.world, scene.solver);
  if (const std::string why = simulator.start_fault(); !why.empty())
    throw SceneFaults(scene.path, {{1, 1, why, {}}});
  RunFileRecorder recorder(request.dir, scene,
                           request.resume ? RunFileRecorder::Open::resume : RunFileRecorder::Open::fresh);
  restore(simulator, recorder, until);
  RunReport report;
  report.file = recorder.file();
  if (recorder.resume_point()) report.resumed_from = recorder.resume_point()->t;
  const double load_seconds = request.load_seconds + seconds_since(start);
  std::optional<TraceFile> trace;
  if (!request.trace.empty()) trace.emplace(request.trace, simulator.world());
  RunOptions options = run_options(scene, request, until, recorder);
  options.trace = trace ? &*trace : nullptr;
  if (request.begins) request.begins();
  try {
    report.summary = simulator.run(options, &recorder);
  } catch (const std::exception& e) {
    close_as_failed(recorder, simulator, e.what());
    throw;
  }
  if (recorder.resume_point()) report.summary.wall_seconds += recorder.resume_point()->wall_seconds;
  report.json = summary_to_json(report.summary, load_seconds);
  recorder.finish(report.summary, report.json);
  if (trace) trace->finish();
  return report;
}

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
                                    {"state_hash", fmt::format("{:016x}", summary.state_hash)},
                                    {"work", std::move(work)}};
  return j.dump();
}

}  // namespace brink
