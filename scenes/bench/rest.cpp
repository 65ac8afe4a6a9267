#include "brink/scenes/bench/rest.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "brink/scenes/bench/csv.h"
#include "brink/scenes/bench/lasting_problems.h"
#include "brink/scenes/bench/plot.h"
#include "brink/scenes/bench/rows.h"
#include "brink/scenes/bench/settling.h"
#include "brink/scenes/program/terminal.h"

namespace brink::bench {

namespace {

/// Error against run time of lasting_problems() under lasting_settings(). False if a run ended early or
/// repeats differ.
bool problems_with_answers(const std::filesystem::path& folder, int repeats) {
  const std::vector<Problem> problems = lasting_problems();
  std::vector<Row> rows;
  bool good = true;
  for (const Problem& problem : problems) {
    print_heading(problem);
    for (const Setting& setting : lasting_settings()) {
      rows.push_back(measure(problem, setting, repeats));
      print(rows.back());
      good = good && is_good(rows.back());
    }
    fmt::print("\n");
  }
  write_csv(folder / "rest.csv", rows);
  write_plot(folder / "rest.png", "Contacts that last: error against run time", problems, rows);
  return good;
}

// Peers stand beside Brink in the same process, one after another on the same heap.
using Settle = Settled (*)(const Heap&);
constexpr Settle kEngines[] = {
    settle_with_brink,
#ifdef BRINK_BOX2D
    settle_with_box2d,
#endif
#ifdef BRINK_CHIPMUNK
    settle_with_chipmunk,
#endif
};

/// The table of heaps and engines. False if Brink ended early; of the peers nothing is asked.
bool heaps_that_settle(const std::filesystem::path& folder) {
  fmt::print("{}  heaps poured into a bin, friction 0.5, restitution 0, 8 s\n",
             paint(stdout, Paint::heading, "settling"));
  fmt::print("  {:<12} {:<14} {:>12} {:>10} {:>16}\n", "heap", "engine", "at rest [s]", "CPU [s]",
             "overlap [m]");
  Csv csv(folder / "settling.csv", "heap,engine,at_rest,cpu_seconds,overlap");
  bool good = true;
  for (const Heap& heap : heaps())
    for (const Settle settle : kEngines) {
      const Settled s = settle(heap);
      fmt::print("  {:<12} {:<14} {:>12} {:>10.3g} {:>16.1e}\n", heap.name, s.engine,
                 std::isfinite(s.at_rest) ? fmt::format("{:.2f}", s.at_rest) : "not by 8", s.cpu_seconds,
                 s.overlap);
      std::fflush(stdout);
      // A heap that did not come to rest has "inf" there.
      csv.row("{},{},{:.17g},{:.6g},{:.6g}", heap.name, s.engine, s.at_rest, s.cpu_seconds, s.overlap);
      if (!s.why.empty()) fmt::print("  {}\n", s.why);
      good = good && s.why.empty();
    }
  csv.close();
#ifndef BRINK_BOX2D
  fmt::print("  (Box2D was not there when Brink was built: libbox2d-dev)\n");
#endif
#ifndef BRINK_CHIPMUNK
  fmt::print("  (Chipmunk was not there when Brink was built: libchipmunk-dev)\n");
#endif
  return good;
}

}  // namespace

bool run_rest(const std::filesystem::path& folder, int repeats) {
  // Both are run, whatever the first says.
  const bool answers = problems_with_answers(folder, repeats);
  return heaps_that_settle(folder) && answers;
}

}  // namespace brink::bench
