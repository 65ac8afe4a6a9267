// A sweep over what the classic detector's answer depends on (spacing, resolution, step, primitives) and
// over what it must not depend on (read-back). docs/classic.md tells what came out.
#include "brink/scenes/bench/classic.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "brink/scenes/bench/csv.h"
#include "brink/scenes/bench/plot.h"
#include "brink/scenes/program/terminal.h"

namespace brink::bench {
namespace {

/// One point of the sweep.
struct Classic {
  double spacing = 0.0;  ///< of the largest body's diameter; 0: exact detectors
  int resolution = 0;
  double step = 0.0;
  std::string primitives = "exact", readback = "window", policy = "global_backup";
};

/// A row of the table with its place in the sweep, which Row does not know.
struct ClassicRow {
  Classic at;
  Row row;
};

// Wide steps, so that few settings show how each of them matters: spacings by a factor of 4, resolutions by
// 3, steps by 5.
constexpr double kSpacings[] = {0.25, 0.0625, 0.015625};
constexpr int kResolutions[] = {16, 48, 144};
constexpr double kSteps[] = {0.01, 0.002};

/// The same problem up to an earlier end.
/// Errors that are measured at `until` and not at the problem's own end are of another size: the heading
/// says so.
Problem shortened(Problem problem, double until) {
  if (until < problem.until) problem.error_of += fmt::format(", in the first {:g} s", until);
  problem.until = until;
  std::erase_if(problem.hits, [until](double t) { return t >= until; });
  return problem;
}

/// Problems of the sweep with ends that keep it to minutes. two_boxes and cradle know their answers at their
/// own ends only.
std::vector<Problem> classic_problems() {
  std::vector<Problem> all;
  for (const Problem& p : problems()) {
    const bool whole = p.name == "two_boxes" || p.name == "cradle";
    all.push_back(whole ? p : shortened(p, std::min(p.until, p.name == "rectangle" ? 4.0 : 1.5)));
  }
  return all;
}

/// The same problem with particles along every body's boundary, `spacing` times its own diameter apart.
Problem sampled(Problem problem, double spacing) {
  for (Body& body : problem.world.bodies) {
    body.sampling.kind = Sampling::Kind::boundary;
    body.sampling.spacing = spacing * 2.0 * body.outline->bounding_radius;
  }
  return problem;
}

/// Collisions after which a run has gone astray: a body caught in a wall rattles there for ever.
/// Five times what is expected leaves room for a contact that is met twice; 20 for problems with few.
std::uint64_t most_collisions(const Problem& problem) { return 20 + 5 * problem.hits.size(); }

/// True if the run did not reach its end, as where it was stopped at most_collisions().
bool astray(const Row& row) { return row.summary.termination != Termination::reached_end; }

/// One run of the classic detector, not repeated: its settings are many.
ClassicRow measure_at(const Problem& problem, const Classic& at, const std::string& series) {
  // Approximate: it may miss contacts, and of its ending nothing is asked.
  Setting setting{
      series, fmt::format("1/{:g} {} px {:g} s", 1.0 / at.spacing, at.resolution, at.step), true, {}};
  setting.options.detector = "depth";
  setting.options.policy = at.policy;
  setting.options.step = at.step;
  setting.options.max_collisions = most_collisions(problem);
  setting.options.field.resolution = at.resolution;
  setting.options.field.primitives = at.primitives;
  setting.options.field.readback = at.readback;
  ClassicRow row{at, measure(sampled(problem, at.spacing), setting, 1)};
  // A body that rattles in a wall ends anywhere: its error has no size.
  if (astray(row.row)) row.row.error = std::numeric_limits<double>::infinity();
  return row;
}

/// The exact detectors under the same policy, for the foot of every panel.
std::vector<ClassicRow> exact_rows(const Problem& problem) {
  std::vector<ClassicRow> rows;
  for (const char* detector : {"field", "pass"}) {
    Setting setting{detector, "exact", false, {}};
    setting.options.policy = "global_backup";
    setting.options.detector = detector;
    rows.push_back({{}, measure(problem, setting, 3)});
  }
  return rows;
}

/// Everything by everything; series name what the plot joins by lines.
void sweep(const Problem& problem, const std::function<void(ClassicRow)>& take) {
  for (ClassicRow& row : exact_rows(problem)) take(std::move(row));
  for (const char* primitives : {"exact", "mesh"})
    for (const char* readback : {"window", "full", "pixel"})
      for (const int resolution : kResolutions)
        for (const double step : kSteps)
          for (const double spacing : kSpacings)
            take(measure_at(problem, {spacing, resolution, step, primitives, readback, "global_backup"},
                            fmt::format("depth {} px", resolution)));
  // fixed_step at the middle spacing and resolution alone.
  for (const double step : {0.02, 0.01, 0.005, 0.002})
    take(measure_at(problem, {kSpacings[1], kResolutions[1], step, "exact", "window", "fixed_step"},
                    "fixed_step"));
}

/// What fits a screen: exact primitives, read back by window.
bool shown(const ClassicRow& r) {
  return r.at.spacing == 0.0 || r.at.policy == "fixed_step" ||
         (r.at.primitives == "exact" && r.at.readback == "window");
}

/// One line on the terminal, seen as it comes.
void print(const ClassicRow& r) {
  const std::string words = r.at.spacing == 0.0
                                ? r.row.setting.series
                                : fmt::format("{:<13} 1/{:<4g} {:>4} px  step {:<6g}", r.at.policy,
                                              1.0 / r.at.spacing, r.at.resolution, r.at.step);
  fmt::print("  {:<44} error {:>8.1e}  {:>8.2f} ms  missed {}/{}{}\n", words, r.row.error,
             1e3 * r.row.wall_seconds, r.row.missed, r.row.expected, astray(r.row) ? "  astray" : "");
  std::fflush(stdout);
}

/// All rows, also those that are not shown.
void write_csv(const std::filesystem::path& file, const std::vector<ClassicRow>& rows) {
  Csv csv(file,
          "problem,detector,policy,spacing,resolution,step,primitives,readback,error,wall_seconds,expected,"
          "collisions,missed,pixels_drawn,pixels_read,passes,termination,state_hash");
  for (const ClassicRow& r : rows) {
    const RunSummary& s = r.row.summary;
    csv.row("{},{},{},{:g},{},{:g},{},{},{:.6g},{:.6g},{},{},{},{},{},{},{},{:016x}", r.row.problem,
            r.row.setting.options.detector, r.row.setting.options.policy, r.at.spacing, r.at.resolution,
            r.at.step, r.at.primitives, r.at.readback, r.row.error, r.row.wall_seconds, r.row.expected,
            r.row.collisions, r.row.missed, s.work.pixels_drawn, s.work.pixels_read, s.work.passes,
            astray(r.row) ? "astray" : "reached_end", s.state_hash);
  }
  csv.close();
}

/// Of the sweep, what a plot can show: read back by window.
std::vector<Row> plotted(const std::vector<ClassicRow>& rows) {
  std::vector<Row> out;
  for (const ClassicRow& r : rows) {
    // The other ways of reading back have the same errors: their points would lie over each other but for
    // time.
    if (r.at.spacing > 0.0 && r.at.readback != "window") continue;
    out.push_back(r.row);
    if (r.at.primitives == "mesh") out.back().setting.series += ", mesh";
  }
  return out;
}

/// Finer pictures are darker, meshes the same in another hue.
std::vector<Look> looks() {
  std::vector<Look> all{{"field", {0.30, 0.02, 260.0}}, {"pass", {0.62, 0.17, 145.0}}};
  for (const auto& [suffix, hue] : {std::pair("", 255.0), std::pair(", mesh", 30.0)})
    for (std::size_t k = 0; k < std::size(kResolutions); ++k)
      all.push_back({fmt::format("depth {} px{}", kResolutions[k], suffix),
                     {0.80 - 0.15 * static_cast<double>(k), 0.14, hue},
                     false});
  all.push_back({"fixed_step", {0.70, 0.16, 85.0}});
  return all;
}

/// "; depth missed 6 of 216 contacts" over all runs of the classic detector on a problem.
std::string missed_text(const Problem& problem, const std::vector<ClassicRow>& rows) {
  std::size_t missed = 0, expected = 0;
  for (const ClassicRow& r : rows) {
    if (r.row.problem != problem.name || r.at.spacing == 0.0) continue;
    missed += r.row.missed;
    expected += r.row.expected;
  }
  return fmt::format("; depth missed {} of {} contacts", missed, expected);
}

}  // namespace

// Some minutes of one core (docs/classic.md).
bool run_classic(const std::filesystem::path& folder) {
  std::vector<ClassicRow> rows;
  std::vector<Problem> all = classic_problems();
  for (Problem& problem : all) {
    fmt::print("{}  {}; error: {}\n", paint(stdout, Paint::heading, problem.name), problem.title,
               problem.error_of);
    sweep(problem, [&](ClassicRow r) {
      if (shown(r)) print(r);
      rows.push_back(std::move(r));
    });
    // Only now are all runs known; the note stands over the panel.
    problem.error_of += missed_text(problem, rows);
  }
  write_csv(folder / "classic.csv", rows);
  write_plot(folder / "classic.png", "The classic detector: error against run time", all, plotted(rows),
             looks());
  fmt::print("table {}, plot {}\n\n", (folder / "classic.csv").string(), (folder / "classic.png").string());
  measure_missed(folder);
  measure_orders(folder);
  measure_options(folder);
  // The exact detectors must have reached the end; of the classic one nothing is asked.
  return std::all_of(rows.begin(), rows.end(), [](const ClassicRow& r) {
    return r.at.spacing > 0.0 || r.row.summary.termination == Termination::reached_end;
  });
}

}  // namespace brink::bench
