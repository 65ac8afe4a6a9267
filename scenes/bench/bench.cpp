/// brink bench: error against run time on problems with known answers.

#include <fmt/format.h>

#include <algorithm>

#include "brink/core/base/error.h"
#include "brink/scenes/bench/classic.h"
#include "brink/scenes/bench/csv.h"
#include "brink/scenes/bench/plot.h"
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

/// Those asked for, in the list's order; all if none is. @throws BadInput on unknown names, one line each.
std::vector<Problem> chosen(std::vector<Problem> all, const std::vector<std::string>& names) {
  if (names.empty()) return all;
  std::string known, faults;
  for (const Problem& p : all) known += (known.empty() ? "" : ", ") + p.name;
  known += fmt::format(", {}", kClassic);
  for (const std::string& name : names)
    if (name != kClassic &&
        std::none_of(all.begin(), all.end(), [&](const Problem& p) { return p.name == name; }))
      faults +=
          fmt::format("{}bench: '{}' is not a problem; allowed: {}", faults.empty() ? "" : "\n", name, known);
  if (!faults.empty()) throw BadInput(faults);
  std::erase_if(
      all, [&](const Problem& p) { return std::find(names.begin(), names.end(), p.name) == names.end(); });
  return all;
}

std::string time_text(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.3g} \u00b5s", 1e6 * seconds);
  return seconds < 1.0 ? fmt::format("{:.3g} ms", 1e3 * seconds) : fmt::format("{:.3g} s", seconds);
}

bool reached(const Row& row) { return row.summary.termination == Termination::reached_end; }

void print_heading(const Problem& p) {
  fmt::print("{}  {}\n", paint(stdout, Paint::heading, p.name), p.title);
  fmt::print("  {:<14} {:<18} {:>10} {:>10} {:>10} {:>7}  {:<16}   error: {}\n", "series", "setting", "error",
             "wall", "collisions", "missed", "state hash", p.error_of);
}

void print(const Row& row) {
  std::string line = fmt::format("  {:<14} {:<18} {:>10.1e} {:>10} {:>10} {:>7}  {:016x}", row.setting.series,
                                 row.setting.label, row.error, time_text(row.wall_seconds), row.collisions,
                                 row.missed, row.summary.state_hash);
  if (!reached(row)) line += "  " + row.summary.termination_text();
  if (!row.same_hash) line += "  repeats differ in their bits";
  const bool bad = !row.same_hash || (!row.setting.approximate && !reached(row));
  fmt::print("{}\n", bad ? paint(stdout, Paint::bad, line) : line);
  std::fflush(stdout);
}

void write_csv(const fs::path& file, const std::vector<Row>& rows) {
  bench::Csv csv(
      file,
      "problem,series,setting,approximate,error,wall_seconds,repeats,expected,collisions,missed,end_time,"
      "termination,state_hash,right_hand_sides");
  for (const Row& r : rows) {
    std::string ending = r.summary.termination_text();
    std::replace(ending.begin(), ending.end(), '"', '\'');
    csv.row("{},{},{},{:d},{:.17g},{:.6g},{},{},{},{},{:.17g},\"{}\",{:016x},{}", r.problem, r.setting.series,
            r.setting.label, r.setting.approximate, r.error, r.wall_seconds, r.repeats, r.expected,
            r.collisions, r.missed, r.summary.end_time, ending, r.summary.state_hash,
            r.summary.work.right_hand_sides);
  }
  csv.close();
}

fs::path make_folder(const std::string& given) {
  const fs::path folder = given.empty() ? default_run_folder("bench", false) : fs::path(given);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw IoError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  return folder;
}

}  // namespace

int bench_command(const BenchArguments& arguments) {
  const std::vector<Problem> problems = chosen(bench::problems(), arguments.names);
  if (arguments.list) {
    for (const Problem& p : problems) fmt::print("{:<14} {}; error: {}\n", p.name, p.title, p.error_of);
    fmt::print("{:<14} the classic detector on these, over spacing, resolution, step and options; minutes\n",
               kClassic);
    return kDone;
  }
  const fs::path folder = make_folder(arguments.out);
  const std::vector<std::string>& names = arguments.names;
  const bool classic = std::find(names.begin(), names.end(), kClassic) != names.end();
  bool good = !classic || bench::run_classic(folder);
  if (problems.empty()) return good ? kDone : kEndedEarly;
  std::vector<Row> rows;
  for (const Problem& problem : problems) {
    print_heading(problem);
    for (const bench::Setting& setting : bench::settings(problem)) {
      rows.push_back(bench::measure(problem, setting, arguments.repeats));
      print(rows.back());
      good = good && rows.back().same_hash && (setting.approximate || reached(rows.back()));
    }
    fmt::print("\n");
  }
  write_csv(folder / "bench.csv", rows);
  bench::write_plot(folder / "bench.png", "Error against run time", problems, rows);
  fmt::print("table {}, plot {}\n", (folder / "bench.csv").string(), (folder / "bench.png").string());
  return good ? kDone : kEndedEarly;
}

}  // namespace brink
