/// brink sweep: many runs over options.

#include <fmt/format.h>

#include <algorithm>

#include "brink/core/base/error.h"
#include "brink/core/base/printable.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/stopping.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/sweep/plot.h"
#include "brink/scenes/sweep/shell_word.h"
#include "brink/scenes/sweep/sweep.h"

namespace brink {
namespace {

namespace fs = std::filesystem;

/// How many runs are not done.
std::size_t waiting(const SweepResults& results) {
  return static_cast<std::size_t>(
      std::count_if(results.begin(), results.end(), [](const auto& r) { return !r; }));
}

/// Says on a terminal how far the sweep is, on one line that is wiped at the end.
class Tally {
 public:
  Tally(std::size_t done, std::size_t all, bool shown) : done_(done), all_(all), shown_(shown) { show(); }
  ~Tally() {
    if (shown_) fmt::print(stderr, "\r\033[K");
  }
  Tally(const Tally&) = delete;
  Tally& operator=(const Tally&) = delete;
  /// Called by one thread at a time (SweepRequest::done).
  void one_more() {
    ++done_;
    show();
  }

 private:
  void show() const {
    if (shown_) fmt::print(stderr, "\r\033[K{} of {} runs", done_, all_);
  }
  std::size_t done_, all_;
  bool shown_;
};

/// A `brink run` command for each run, which gives the row's state hash: scene, overrides in their order,
/// end.
void list_runs(const Experiment& experiment) {
  for (const SweepRun& run : experiment.runs) {
    // A path that begins with a dash would be taken for an option.
    const std::string scene = run.scene.string();
    std::string line = "brink run " + shell_word((scene.starts_with('-') ? "./" : "") + scene);
    for (const std::string& o : run.overrides) line += " --set " + shell_word(o);
    if (experiment.until) line += fmt::format(" --until {}", *experiment.until);
    fmt::print("{}\n", line);
  }
}

/// Tables, CSV and plot of what is done. Returns how many runs are not.
std::size_t report(const Experiment& experiment, SweepStore& store, const fs::path& folder, bool quiet) {
  // Read again from the database: what other processes have made is in it.
  const SweepResults results = store.results(experiment);
  write_sweep_csv(folder / "sweep.csv", experiment, results);
  // Drawn of what there is: a sweep that was stopped has its table and plot as well.
  write_chart(folder / "sweep.png", sweep_chart(experiment, results));
  // Files are written all the same.
  if (quiet) return waiting(results);
  fmt::print("{}\n{}", paint(stdout, Paint::heading, experiment.title), sweep_table(experiment, results));
  if (const std::string agreement = policy_agreement(experiment, results); !agreement.empty())
    fmt::print("{}\n", agreement);
  fmt::print("table {}, plot {}, database {}\n", printable((folder / "sweep.csv").string()),
             printable((folder / "sweep.png").string()), printable(store.file().string()));
  return waiting(results);
}

}  // namespace

int sweep_command(const SweepArguments& arguments) {
  const Experiment experiment = load_experiment(arguments.experiment);
  // The experiment has been checked by then: a list is of runs that can be read.
  if (arguments.dry) return list_runs(experiment), kDone;
  // Named after the experiment, without a number: the same command finds its results again.
  const fs::path folder =
      arguments.out.empty() ? fs::path("runs") / experiment.path.stem() : fs::path(arguments.out);
  // Before the folder is made: nothing of the experiment may be lost.
  for (const char* name : {"sweep.csv", "sweep.png", "sweep.svg"})
    refuse_overwriting(folder / name, "--out", {experiment.files.begin(), experiment.files.end()});
  // Before the store is opened: a signal from here on lets go of runs and leaves the database whole.
  stop_on_signals();
  // Opened after the experiment is known to be sound: what it adds to the database can be run.
  SweepStore store(folder, experiment);
  // The tally is wiped before the report is printed.
  {
    const std::size_t left = waiting(store.results(experiment));
    // Runs of an earlier sweep in the same folder count as done.
    Tally tally(experiment.runs.size() - left, experiment.runs.size(),
                on_terminal(stderr) && !arguments.quiet);
    SweepRequest request;
    request.jobs = arguments.jobs;
    request.stop = [] { return stop_asked(); };
    request.done = [&](const SweepRun&, const SweepResult&) { tally.one_more(); };
    run_sweep(experiment, store, request);
  }
  const std::size_t left = report(experiment, store, folder, arguments.quiet);
  if (left == 0) return kDone;
  // What was not stopped here has been taken by another process, which may go on.
  fmt::print(stderr, "brink: {} of {} runs are not done{}; the same command goes on\n", left,
             experiment.runs.size(), stop_asked() ? "" : " (another process has taken them)");
  return kEndedEarly;
}

}  // namespace brink
