/// brink view: a replay page of a run, or a page that follows a run as it goes.

// What becomes of the subject:
//
//     a run               its page is written, beside it or to -o
//     a scene with -o     it is run to its end, then its page is written
//     a scene             its page is served from before the run begins until Ctrl-C
//
// In each case the exit status is that of the run that was made here, if one was.
#include "brink/scenes/view/replay_page.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <vector>

#include "brink/core/base/printable.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/live_page.h"
#include "brink/scenes/program/run_folder.h"
#include "brink/scenes/program/stopping.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/run_file/run_file.h"
#include "brink/scenes/run_file/run_scene.h"
#include "brink/scenes/sweep/shell_word.h"

namespace brink {
namespace {

namespace fs = std::filesystem;

/// Quoted for the shell: paths come from people.
void open_in_browser(const std::string& page) {
  const std::string command = "xdg-open " + shell_word(page) + " >/dev/null 2>&1";
  if (std::system(command.c_str()) != 0)
    fmt::print(stderr, "brink: no browser could be opened; open {} yourself\n", printable(page));
}

/// Runs the scene; `stays`: while its page follows it, which is there until Ctrl-C.
RunReport run_here(const ViewArguments& arguments, bool stays) {
  const Scene scene = load_scene(arguments.subject, arguments.overrides);
  // Before the run, which may take long.
  refuse_overwriting(arguments.out, "-o", scene.files);
  RunRequest request;
  request.dir = default_run_folder(scene.path, false);
  request.begins = stop_on_signals;
  std::optional<LivePage> page;
  if (stays) {
    page.emplace(request);
    fmt::print("{}\n", page->address());
    // Before the run: a program that reads the address through a pipe gets it now.
    std::fflush(stdout);
    if (arguments.open) open_in_browser(page->address());
  }
  RunReport report = run_shown(scene, request, on_terminal(stderr));
  if (page) page->stay();
  return report;
}

}  // namespace

int view_command(const ViewArguments& arguments) {
  // Empty: the subject is a scene, to be run here first.
  fs::path run = run_file_of(arguments.subject);
  // What a run was made of cannot be changed any more.
  if (!run.empty() && !arguments.overrides.empty())
    throw BadInput("--set: is for scenes; a run has been made");
  if (run.empty() && !arguments.trace.empty())
    throw BadInput("--trace: is for runs; of a scene: brink run SCENE --trace FILE first");
  // Of a scene without -o the page is served as the run goes; with -o it is written when the run has ended.
  const bool live = run.empty() && arguments.out.empty();
  RunSummary summary;  // of the run that is made here, if one is
  if (run.empty()) {
    const RunReport report = run_here(arguments, live);
    summary = report.summary;
    run = report.file;
  }
  if (!live) {
    const fs::path page = arguments.out.empty() ? run.parent_path() / "replay.html" : fs::path(arguments.out);
    std::vector<fs::path> read = RunFile(run).files();
    read.push_back(arguments.trace);
    refuse_overwriting(page, "-o", read);
    // The defaults bound the size of the page; only the trace is the caller's.
    ReplayLimits limits;
    limits.trace = arguments.trace;
    write_replay_page(run, page, limits);
    fmt::print("{}\n", printable(page.string()));
    if (arguments.open) open_in_browser(fs::absolute(page).string());
  }
  // No run was made here, or it came to a sound end.
  if (summary.termination == Termination::not_run || summary.sound()) return kDone;
  // Of `failed` termination_text() has the reason already.
  const bool stopped = summary.termination == Termination::stopped && !summary.why.empty();
  fmt::print(stderr, "brink: {}{} (t = {} s)\n", summary.termination_text(),
             stopped ? ": " + printable(summary.why) : "", summary.end_time);
  return kEndedEarly;
}

}  // namespace brink
