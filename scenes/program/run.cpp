/// brink run: simulate.

// The scene, or that of a run; a folder for the run file; with --watch a page; the run; then the summary,
// while the page stays until Ctrl-C. What is printed is for people, or one line of JSON for programs.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "brink/core/base/printable.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/live_page.h"
#include "brink/scenes/program/run_folder.h"
#include "brink/scenes/program/stopping.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/run_file/run_scene.h"

namespace brink {
namespace {

/// How the run ended, in one line with its time and reason. Colours are those of standard output.
std::string ending(const RunSummary& s) {
  switch (s.termination) {
    case Termination::reached_end:
      return paint(stdout, Paint::good, fmt::format("reached the end at t = {} s", s.end_time));
    case Termination::stopped:
      return paint(stdout, Paint::bad,
                   fmt::format("stopped at t = {} s{}{}", s.end_time, s.why.empty() ? "" : ": ", s.why));
    case Termination::failed:
      return paint(stdout, Paint::bad, fmt::format("failed at t = {} s: {}", s.end_time, s.why));
    case Termination::not_run:
      break;
  }
  return paint(stdout, Paint::bad, "did not run");
}

/// Of what there was; where that is next to nothing beside what there is, of that, as energy may pass 0.
std::string change(double before, double after) {
  const double scale = std::abs(std::abs(before) > 1e-6 * std::abs(after) ? before : after);
  return scale > 0 ? fmt::format("{:.3g} of it", (after - before) / scale) : std::string("none");
}

/// What groups took that have no end under the restitution of their materials.
std::string taken(const RunSummary& s) {
  return fmt::format("{} without a rebound, as they do not end otherwise: {:.6g} J gone; the first {}",
                     s.groups_taken, s.energy_taken - s.rest_energy, s.first_taken);
}

/// What came of contacts that last. Where bodies slid or rolled on them, that is exact to first order alone.
std::string lasting(const RunSummary& s) {
  return fmt::format(
      "{} captured, {} island(s) at rest at the end; {} steps by modes; {} of order 1{}, which took "
      "approaches "
      "up to {:.3g} m/s as plastic, friction to {:.2g} of the largest force, and made {:.2g} J; rest_speed "
      "took {:.2g} J",
      s.contacts_lasting, s.islands_at_rest, s.steps_by_modes, s.island_steps - s.steps_by_modes,
      s.small_by_steps > 0 ? fmt::format(" ({} of few contacts)", s.small_by_steps) : "", s.approach_absorbed,
      s.friction_residual, s.island_energy, s.rest_energy);
}

/// What the policy did and what of it was in vain.
void print_work(const WorkCounters& w) {
  fmt::print("  work             {} passes, {} searches, {} distance queries, {} queue operations\n",
             w.passes, w.pair_searches, w.distance_queries, w.queue_operations);
  fmt::print(
      "  in vain          {} bodies backed up, {} rolled back ({:.3g} body-seconds), {} certificates stale\n",
      w.backups, w.rollbacks, w.body_seconds_thrown_away, w.certificates_stale);
}

/// Wall-clock seconds by stages.
void print_profile(const RunSummary& s) {
  const WorkCounters& w = s.work;
  const std::pair<const char*, double> stages[] = {
      {"looking around", w.seconds_look},      {"first contacts", w.seconds_search},
      {"integrators", w.seconds_motion},       {"collisions", w.seconds_response},
      {"lasting contacts", w.seconds_islands}, {"recording", w.seconds_record}};
  // What no stage has counted. Stages are timed by samples, so it may come out a little below 0.
  double untimed = s.wall_seconds;
  const auto line = [&](const char* name, double seconds) {
    fmt::print("    {:<17}{:<9.3g} {:3.0f} %\n", name, seconds, 100.0 * seconds / s.wall_seconds);
    untimed -= seconds;
  };
  fmt::print("  seconds by stage\n");
  for (const auto& [name, seconds] : stages) line(name, seconds);
  line("policy, the rest", std::max(0.0, untimed));
}

/// The summary for people. What did not happen (groups taken, contacts that last, a resume) has no line.
void print_summary(const Scene& scene, const RunReport& report) {
  const RunSummary& s = report.summary;
  const std::string title = scene.world.title.empty() ? scene.path.stem().string() : scene.world.title;
  fmt::print("{}: {}\n", paint(stdout, Paint::heading, title), ending(s));
  fmt::print("  collisions       {}\n", s.collisions);
  fmt::print("  energy           {:.9g} J -> {:.9g} J (change: {})\n", s.energy_initial, s.energy_final,
             change(s.energy_initial, s.energy_final));
  fmt::print("  momentum         ({:.6g}, {:.6g}) kg m/s, angular {:.6g} kg m^2/s\n", s.momentum.x(),
             s.momentum.y(), s.angular_momentum);
  // The deepest gap below zero at any event or frame: some roundings of places where all is well.
  fmt::print("  deepest overlap  {:.3g} m\n", s.max_overlap);
  if (s.moved_at_start > 0)
    fmt::print("  moved at start   {} {} a wire, to just before it, by at most {:.3g} m\n", s.moved_at_start,
               s.moved_at_start == 1 ? "body that stood across" : "bodies that stood across", s.moved_by);
  if (s.groups_taken > 0) fmt::print("  groups taken     {}\n", paint(stdout, Paint::bad, taken(s)));
  if (s.contacts_lasting > 0) fmt::print("  lasting contacts {}\n", lasting(s));
  fmt::print("  wall time        {:.3g} s\n", s.wall_seconds);
  print_work(s.work);
  fmt::print("  state hash       {:016x}\n", s.state_hash);
  if (report.resumed_from) fmt::print("  resumed from     t = {} s\n", *report.resumed_from);
  fmt::print("  run file         {}\n", printable(report.file.string()));
}

/// The summary, the JSON or nothing, as the options say. A resume of a finished run has no summary to
/// print: of that only end and exit status are known.
void print_report(const RunArguments& arguments, const Scene& scene, const RunReport& report) {
  if (report.finished_before && !arguments.quiet && !arguments.json) {
    fmt::print("{}: has already reached t = {} s; nothing to do\n", printable(report.file.string()),
               report.summary.end_time);
  } else if (!arguments.quiet && !arguments.json) {
    print_summary(scene, report);
    if (arguments.profile) print_profile(report.summary);
  }
  // With --json nothing else stands on standard output, whose last line a program reads.
  if (arguments.json) fmt::print("{}\n", report.json);
}

/// The scene, of a run from its run file.
Scene loaded(const RunArguments& arguments, bool shown) {
  // Wiped when the scene is there. A large one takes a while to be read.
  StatusLine line(shown);
  line.say("loading " + printable(arguments.scene));
  const std::filesystem::path run = run_file_of(arguments.scene);
  // A run file is a scene, too: the one that it was made of.
  return run.empty() ? load_scene(arguments.scene, arguments.overrides)
                     : scene_of_run(run, arguments.overrides);
}

}  // namespace

int run_command(const RunArguments& arguments) {
  // Reading the scene counts as loading, which the summary tells apart from the run's own wall time.
  const auto start = std::chrono::steady_clock::now();
  // A bar is drawn on standard error, which may be a terminal though standard output is a pipe.
  const bool shown = on_terminal(stderr) && !arguments.quiet;
  const Scene scene = loaded(arguments, shown);
  RunRequest request;
  request.dir = arguments.out.empty() ? default_run_folder(scene.path, arguments.resume)
                                      : std::filesystem::path(arguments.out);
  // All limits of the request are run_scene()'s to check, which refuses before it touches a file.
  request.until = arguments.until;
  request.trace = arguments.trace;
  request.resume = arguments.resume;
  request.threads = arguments.threads;
  request.begins = stop_on_signals;  // a signal before that ends the program at once: nothing is lost
  request.load_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // Before the run: the address can be opened from its first moment.
  std::optional<LivePage> page;
  if (arguments.watch) {
    page.emplace(request);
    fmt::print(stderr, "{}\n", page->address());
  }
  const RunReport report = run_shown(scene, request, shown);
  print_report(arguments, scene, report);
  // Before waiting for Ctrl-C: the summary is read by then.
  std::fflush(stdout);
  if (page) page->stay();
  // sound(): the end was reached and no group of collisions was taken with a loss that it should not have.
  if (report.summary.sound()) return kDone;
  // Without a summary a bad ending would be told by the exit status alone.
  if (arguments.quiet || arguments.json) fmt::print(stderr, "brink: {}\n", ending(report.summary));
  if ((arguments.quiet || arguments.json) && report.summary.groups_taken > 0)
    fmt::print(stderr, "brink: groups taken {}\n", taken(report.summary));
  return kEndedEarly;
}

}  // namespace brink
