// Columns are named in one place, for_each_number(): the database, the CSV file, the plot and the table ask
// by these names.
#include "brink/scenes/sweep/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brink {
namespace {

/// Visits every number of a summary by name, each name once.
/// One function for names and values: a column cannot be missing in one of them.
template <class Visit>
void for_each_number(const RunSummary& s, Visit&& visit) {
  const double scale = std::max(std::abs(s.energy_initial), std::abs(s.energy_final));
  visit("end_time", s.end_time);
  visit("collisions", static_cast<double>(s.collisions));
  visit("wall_seconds", s.wall_seconds);
  visit("energy_initial", s.energy_initial);
  visit("energy_final", s.energy_final);
  // Of the larger: a drift from 0 to something is all of it, and both 0 is none.
  visit("energy_drift", scale > 0.0 ? (s.energy_final - s.energy_initial) / scale : 0.0);
  visit("momentum_x", s.momentum.x());
  visit("momentum_y", s.momentum.y());
  visit("angular_momentum", s.angular_momentum);
  visit("max_overlap", s.max_overlap);
  visit("groups_taken", static_cast<double>(s.groups_taken));
  visit("energy_taken", s.energy_taken);
  visit("contacts_lasting", static_cast<double>(s.contacts_lasting));
  visit("island_steps", static_cast<double>(s.island_steps));
  visit("islands_at_rest", static_cast<double>(s.islands_at_rest));
  visit("resting", static_cast<double>(s.resting));
  visit("approach_absorbed", s.approach_absorbed);
  visit("friction_residual", s.friction_residual);
  visit("island_energy", s.island_energy);
  visit("rest_energy", s.rest_energy);
  WorkCounters::for_each(s.work, [&](const char* name, auto value, const char*) {
    // The work counter of that name is the summary's number, told above.
    if (std::string_view(name) != "collisions") visit(name, static_cast<double>(value));
  });
}

}  // namespace

const std::vector<std::string>& sweep_columns() {
  static const std::vector<std::string> columns = [] {
    std::vector<std::string> names;
    for_each_number(RunSummary{}, [&](const char* name, double) { names.emplace_back(name); });
    return names;
  }();
  return columns;
}

SweepResult sweep_result(const RunSummary& summary) {
  SweepResult result;
  result.termination = summary.termination_text();
  // Of `failed` termination_text() has the reason already.
  if (summary.termination == Termination::stopped) result.termination += ": " + summary.why;
  result.state_hash = fmt::format("{:016x}", summary.state_hash);
  for_each_number(summary, [&](const char* name, double value) { result.numbers[name] = value; });
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
