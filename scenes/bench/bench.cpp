/// brink bench: error against run time on problems with known answers.

#include <fmt/format.h>

#include <algorithm>

#include "brink/core/base/error.h"
#include "brink/scenes/bench/classic.h"
#include "brink/scenes/bench/plot.h"
#include "brink/scenes/bench/rest.h"
#include "brink/scenes/bench/rows.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scenes/program/commands.h"
#include "brink/scenes/program/run_folder.h"
#include "brink/scenes/program/terminal.h"

namespace brink {
namespace {

namespace fs = std::filesystem;
using bench::Problem;
using bench::Row;

/// The sweep of the classic detector: not a problem, but asked for like one, and only by name.
constexpr const char* kClassic = "classic";
/// Contacts that last, likewise.
constexpr const char* kRest = "rest";

/// Those asked for, in the list's order; all if none is. @throws BadInput on unknown names, one line each.
std::vector<Problem> chosen(std::vector<Problem> all, const std::vector<std::string>& names) {
  // The two sweeps are not among them: they run only by name.
  if (names.empty()) return all;
  std::string known, faults;
  for (const Problem& p : all) known += (known.empty() ? "" : ", ") + p.name;
  // The two sweeps are allowed names, but no problems of the list.
  known += fmt::format(", {}, {}", kRest, kClassic);
  for (const std::string& name : names)
    if (name != kClassic && name != kRest &&
        std::none_of(all.begin(), all.end(), [&](const Problem& p) { return p.name == name; }))
      faults +=
          fmt::format("{}bench: '{}' is not a problem; allowed: {}", faults.empty() ? "" : "\n", name, known);
  if (!faults.empty()) throw BadInput(faults);
  // In the list's order, each once, however they were named.
  std::erase_if(
      all, [&](const Problem& p) { return std::find(names.begin(), names.end(), p.name) == names.end(); });
  return all;
}

/// The folder given, or runs/bench-<n>, made. @throws IoError.
fs::path make_folder(const std::string& given) {
  const fs::path folder = given.empty() ? default_run_folder("bench", false) : fs::path(given);
  made_folder(folder);
  for (const char* name :
       {"bench.csv", "bench.png", "bench.svg", "rest.csv", "rest.png", "rest.svg", "settling.csv"})
    refuse_overwriting(folder / name, "--out", {});
  return folder;
}

}  // namespace

int bench_command(const BenchArguments& arguments) {
  const std::vector<Problem> problems = chosen(bench::problems(), arguments.names);
  if (arguments.list) {
    for (const Problem& p : problems) fmt::print("{:<14} {}; error: {}\n", p.name, p.title, p.error_of);
    fmt::print(
        "{:<14} contacts that last: error against run time, and heaps that settle, with peers; half a "
        "minute\n",
        kRest);
    fmt::print("{:<14} the classic detector on these, over spacing, resolution, step and options; minutes\n",
               kClassic);
    return kDone;
  }
  // Made when names are known to be right: a misspelt one leaves no empty folder.
  const fs::path folder = make_folder(arguments.out);
  const std::vector<std::string>& names = arguments.names;
  const auto asked = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  // Each runs though one before has ended early: all results are written.
  bool good = !asked(kClassic) || bench::run_classic(folder);
  if (asked(kRest)) good = bench::run_rest(folder, arguments.repeats) && good;
  // Only sweeps were asked for.
  if (problems.empty()) return good ? kDone : kEndedEarly;
  std::vector<Row> rows;
  for (const Problem& problem : problems) {
    bench::print_heading(problem);
    for (const bench::Setting& setting : bench::settings(problem)) {
      rows.push_back(bench::measure(problem, setting, arguments.repeats));
      bench::print(rows.back());
      // A bad row is marked where it stands; those after it are measured all the same.
      good = good && bench::is_good(rows.back());
    }
    fmt::print("\n");
  }
  bench::write_csv(folder / "bench.csv", rows);
  bench::write_plot(folder / "bench.png", "Error against run time", problems, rows);
  fmt::print("table {}, plot {}\n", (folder / "bench.csv").string(), (folder / "bench.png").string());
  return good ? kDone : kEndedEarly;
}

}  // namespace brink
