// Columns are named in one place, for_each_number(): the database, the CSV file, the plot and the table ask
// by these names.
#include "brink/scenes/sweep/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brink {
namespace {

/// Visits every number of a summary by name, with its unit ("1": none), each name once.
/// One function for names, values and units: a column cannot be missing in one of them.
template <class Visit>
void for_each_number(const RunSummary& s, Visit&& visit) {
  const double scale = std::max(std::abs(s.energy_initial), std::abs(s.energy_final));
  visit("end_time", s.end_time, "s");
  visit("collisions", static_cast<double>(s.collisions), "1");
  visit("wall_seconds", s.wall_seconds, "s");
  visit("energy_initial", s.energy_initial, "J");
  visit("energy_final", s.energy_final, "J");
  // Of the larger: a drift from 0 to something is all of it, and both 0 is none.
  visit("energy_drift", scale > 0.0 ? (s.energy_final - s.energy_initial) / scale : 0.0, "1");
  visit("momentum_x", s.momentum.x(), "kg m/s");
  visit("momentum_y", s.momentum.y(), "kg m/s");
  visit("angular_momentum", s.angular_momentum, "kg m^2/s");
  visit("max_overlap", s.max_overlap, "m");
  visit("groups_taken", static_cast<double>(s.groups_taken), "1");
  visit("energy_taken", s.energy_taken, "J");
  visit("contacts_lasting", static_cast<double>(s.contacts_lasting), "1");
  visit("island_steps", static_cast<double>(s.island_steps), "1");
  visit("steps_by_modes", static_cast<double>(s.steps_by_modes), "1");
  visit("small_by_steps", static_cast<double>(s.small_by_steps), "1");
  visit("islands_at_rest", static_cast<double>(s.islands_at_rest), "1");
  visit("resting", static_cast<double>(s.resting), "1");
  visit("approach_absorbed", s.approach_absorbed, "m/s");
  visit("friction_residual", s.friction_residual, "1");
  visit("island_energy", s.island_energy, "J");
  visit("rest_energy", s.rest_energy, "J");
  WorkCounters::for_each(s.work, [&](const char* name, auto value, const char* unit) {
    // The work counter of that name is the summary's number, told above.
    if (std::string_view(name) != "collisions") visit(name, static_cast<double>(value), unit);
  });
}

}  // namespace

const std::vector<std::string>& sweep_columns() {
  static const std::vector<std::string> columns = [] {
    std::vector<std::string> names;
    for_each_number(RunSummary{}, [&](const char* name, double, const char*) { names.emplace_back(name); });
    return names;
  }();
  return columns;
}

std::string sweep_unit(const std::string& column) {
  std::string of;
  for_each_number(RunSummary{}, [&](const char* name, double, const char* unit) {
    if (name == column) of = unit;
  });
  return of == "1" ? "" : of;
}

SweepResult sweep_result(const RunSummary& summary) {
  SweepResult result;
  result.termination = summary.termination_text();
  // Of `failed` termination_text() has the reason already.
  if (summary.termination == Termination::stopped) result.termination += ": " + summary.why;
  result.state_hash = fmt::format("{:016x}", summary.state_hash);
  for_each_number(summary,
                  [&](const char* name, double value, const char*) { result.numbers[name] = value; });
  return result;
}

SweepResult sweep_failure(const std::string& why) {
  SweepResult result;
  result.termination = "failed: " + why;
  // A line break would part a row of the table.
  std::replace(result.termination.begin(), result.termination.end(), '\n', ' ');
  // Every column has an entry, as of a run that was made: readers ask by at().
  for (const std::string& name : sweep_columns()) result.numbers[name] = std::nan("");
  return result;
}

}  // namespace brink
