// brink bench classic: missed contacts against sampling spacing and wedge angle.
// The classic detector sees a contact only where a particle is. A box with particles `spacing` apart comes
// down on a tip that lies u from the nearest one (0 <= u <= spacing / 2). No particle feels the tip itself:
// contact is told when that particle meets the flank, u / tan(half angle) below the tip. The share missed
// is that of offsets for which this is deeper than kReach. Exact detectors miss none, whatever the angle.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "brink/core/base/random.h"
#include "brink/scenes/bench/classic.h"
#include "brink/scenes/bench/classic_worlds.h"
#include "brink/scenes/bench/csv.h"
#include "brink/scenes/draw/chart.h"
#include "brink/scenes/program/terminal.h"

namespace brink::bench {
namespace {

// Shares come in steps of a sixtieth, 1.7 %.
constexpr int kBoxes = 60;
// So deep may a box come before it counts as missed: particles off the tip meet its flanks late, but they
// do.
constexpr double kReach = 0.2;  // [m] beyond first contact, in boxes of side 1
constexpr std::uint64_t kSeedOfMissed = 1;

/// Of half of an angle given in degrees.
double half_tangent(double degrees) { return std::tan(0.5 * degrees * std::numbers::pi / 180.0); }

/// The share of boxes of side 1 that move down onto the tip of an upright wedge, each off its middle by an
/// offset of its own, and are not stopped before they are kReach deep. A box a world: backing up costs as
/// much as there are bodies.
double missed_share(double spacing, double degrees, const char* detector) {
  // A wedge 0.6 m high: deeper than anybody comes.
  const double half = 0.6 * half_tangent(degrees);
  const Shape wedge = make_polygon({{-half, -0.6}, {half, -0.6}, {0.0, 0.0}});
  SolverOptions options = backing_up(detector);
  options.max_collisions = 1;
  Random random(kSeedOfMissed);
  int missed = 0;
  for (int k = 0; k < kBoxes; ++k) {
    World world;
    // Over half the box's bottom: a whole number of every spacing, so that no offset is
    // likelier than another.
    const Vec2 place(random.uniform(-0.25, 0.25), 0.55);
    // From 0.05 m above the tip at 1 m/s: contact at 0.05 s, kReach deep kReach seconds later.
    world.bodies.push_back(sampled_body(make_box(1, 1), {place, 0.0}, {{0.0, -1.0}, 0.0}, spacing));
    add_fixed(world, wedge);
    missed += hits_of(world, options, 0.05 + kReach).empty();
  }
  return static_cast<double>(missed) / kBoxes;
}

/// [m], of boxes of side 1.
constexpr double kFineSpacings[] = {0.5, 0.25, 0.125, 0.0625, 0.03125};

/// Shares missed at one wedge, per cent.
struct Shares {
  std::vector<double> depth;  ///< one a spacing
  double exact = 0.0;         ///< the larger of pass and field
};

/// Measures, prints and writes.
/// One wedge over all spacings and detectors: a line of the table, rows of the CSV file.
Shares measure_wedge(double degrees, Csv& csv) {
  Shares shares;
  fmt::print("  wedge {:>3} deg:", degrees);
  for (const double spacing : kFineSpacings) {
    const double missed = missed_share(spacing, degrees, "depth");
    // a particle at distance u from the tip meets the flank u / tan(half angle) beyond the first contact
    // On average over the offset, which is uniform: missed is who lies farther than kReach * tan(half
    // angle) from the nearest particle, and particles are `spacing` apart.
    const double expected = std::max(0.0, 1.0 - 2.0 * kReach * half_tangent(degrees) / spacing);
    fmt::print("  1/{:<2g} m {:>3.0f} %", 1.0 / spacing, 100.0 * missed);
    csv.row("depth,{:g},{:g},{:.4f},{:.4f}", spacing, degrees, missed, expected);
    shares.depth.push_back(100.0 * missed);
  }
  for (const char* detector : {"pass", "field"}) {
    // The exact detectors do not use particles: one spacing stands for all.
    const double missed = missed_share(0.5, degrees, detector);
    fmt::print("  {} {:.0f} %", detector, 100.0 * missed);
    csv.row("{},,{:g},{:.4f},0", detector, degrees, missed);
    shares.exact = std::max(shares.exact, 100.0 * missed);
  }
  fmt::print("\n");
  std::fflush(stdout);
  return shares;
}

/// The chart so far: one panel, spacings side by side.
class MissedChart {
 public:
  explicit MissedChart(const std::string& what) {
    chart_.title = "Missed contacts";
    chart_.panels.push_back({"share against spacing", what, {}, {}, {}});
    for (const double spacing : kFineSpacings)
      chart_.panels[0].x.names.push_back(fmt::format("1/{:g} m", std::round(1.0 / spacing)));
  }
  /// Shares [per cent], one a spacing.
  void add(const std::string& series, const std::vector<double>& shares) {
    ChartLine line{chart_.series.size(), {}, true};
    for (std::size_t k = 0; k < shares.size(); ++k)
      line.points.push_back({static_cast<double>(k), shares[k]});
    chart_.series.push_back({series, {}});
    chart_.panels[0].lines.push_back(std::move(line));
  }
  void write(const std::filesystem::path& file) const { write_chart(file, chart_); }

 private:
  Chart chart_;
};

}  // namespace

void measure_missed(const std::filesystem::path& folder) {
  const std::string what =
      fmt::format("of {} boxes (side 1 m), not stopped within {:g} m of a wedge's tip [%]", kBoxes, kReach);
  fmt::print("{}  share {}, against spacing\n", paint(stdout, Paint::heading, "missed contacts"), what);
  MissedChart chart(what);
  Csv csv(folder / "classic_missed.csv", "detector,spacing,wedge_degrees,missed,expected");
  double exact = 0.0;
  for (const double degrees : {10.0, 30.0, 60.0, 90.0, 120.0}) {
    const Shares shares = measure_wedge(degrees, csv);
    chart.add(fmt::format("depth, {:g}\u00b0", degrees), shares.depth);
    exact = std::max(exact, shares.exact);
  }
  chart.add("pass, field", std::vector<double>(std::size(kFineSpacings), exact));
  chart.write(folder / "classic_missed.png");
  csv.close();
  fmt::print("table {}, plot {}\n\n", (folder / "classic_missed.csv").string(),
             (folder / "classic_missed.png").string());
}

}  // namespace brink::bench
