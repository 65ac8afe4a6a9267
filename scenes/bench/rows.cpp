#include "brink/scenes/bench/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "brink/scenes/bench/csv.h"
#include "brink/scenes/program/terminal.h"
#include "brink/scenes/sweep/table.h"

namespace brink::bench {

namespace {

/// True if the run came to its end.
bool reached(const Row& row) { return row.summary.termination == Termination::reached_end; }

}  // namespace

// An approximate policy may end early; its repeats must give the same bits all the same.
bool is_good(const Row& row) { return row.same_hash && (row.setting.approximate || reached(row)); }

void print_heading(const Problem& p) {
  fmt::print("{}  {}\n", paint(stdout, Paint::heading, p.name), p.title);
  fmt::print("  {:<14} {:<18} {:>10} {:>10} {:>10} {:>7}  {:<16}   error: {}\n", "series", "setting", "error",
             "wall", "collisions", "missed", "state hash", p.error_of);
}

void print(const Row& row) {
  std::string line = fmt::format("  {:<14} {:<18} {:>10.1e} {:>10} {:>10} {:>7}  {:016x}", row.setting.series,
                                 row.setting.label, row.error, duration_text(row.wall_seconds),
                                 row.collisions, row.missed, row.summary.state_hash);
  // What is wrong stands behind the numbers, so that columns stay where they are.
  if (!reached(row)) line += "  " + row.summary.termination_text();
  if (!row.same_hash) line += "  repeats differ in their bits";
  fmt::print("{}\n", !is_good(row) ? paint(stdout, Paint::bad, line) : line);
  // A run may take long: each line is seen as it comes.
  std::fflush(stdout);
}

void write_csv(const std::filesystem::path& file, const std::vector<Row>& rows) {
  Csv csv(file,
          "problem,series,setting,approximate,error,wall_seconds,repeats,expected,collisions,missed,end_time,"
          "termination,state_hash,right_hand_sides");
  for (const Row& r : rows) {
    std::string ending = r.summary.termination_text();
    // Within quotes, a quote would end the cell.
    std::replace(ending.begin(), ending.end(), '"', '\'');
    csv.row("{},{},{},{:d},{:.17g},{:.6g},{},{},{},{},{:.17g},\"{}\",{:016x},{}", r.problem, r.setting.series,
            r.setting.label, r.setting.approximate, r.error, r.wall_seconds, r.repeats, r.expected,
            r.collisions, r.missed, r.summary.end_time, ending, r.summary.state_hash,
            r.summary.work.right_hand_sides);
  }
  csv.close();
}

}  // namespace brink::bench
