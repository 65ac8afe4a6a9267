/// Three ways to read results: a table with a line a setting, in which seeds are summed up by medians; a
/// check that exact policies agree bit for bit; and CSV with everything, for programs.
#include "brink/scenes/sweep/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "brink/core/base/printable.h"
#include "brink/scenes/files/csv_cell.h"
#include "brink/scenes/files/written_file.h"
#include "brink/scheduler/policies/policy.h"

namespace brink {
namespace {

// "failed: why" counts as "failed", whatever the reason.
std::string bare_ending(const SweepResult& result) {
  return result.termination.substr(0, result.termination.find(':'));
}

/// "5 reached_end", "3 reached_end, 2 failed", "4 waiting".
std::string endings(const SweepGroup& group, const SweepResults& results) {
  std::map<std::string, std::size_t> count;
  for (const std::size_t k : group.runs) ++count[bare_ending(*results[k])];
  if (group.waiting > 0) count["waiting"] = group.waiting;
  std::string text;
  for (const auto& [ending, n] : count) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, ending);
  return text;
}

/// The one state hash of the group's runs, how many there are if they differ, or "-" where none has one.
/// Seeds make them differ, so of several seeds a count is what is to be expected.
std::string hash_text(const SweepGroup& group, const SweepResults& results) {
  std::set<std::string> hashes;
  for (const std::size_t k : group.runs) hashes.insert(results[k]->state_hash);
  if (hashes.size() == 1) return hashes.begin()->empty() ? "-" : *hashes.begin();
  return hashes.empty() ? "-" : fmt::format("{} hashes", hashes.size());
}

/// Lines of cells, each column as wide as its widest; the first line is the heading.
std::string aligned(const std::vector<std::vector<std::string>>& lines) {
  // Counts code points, as a terminal does: bytes that continue a character of UTF-8
  // (10xxxxxx) have no width.
  const auto width = [](const std::string& s) {
    return static_cast<std::size_t>(
        std::count_if(s.begin(), s.end(), [](char c) { return (c & 0xc0) != 0x80; }));
  };
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const auto& line : lines)
    for (std::size_t k = 0; k < line.size(); ++k) widths[k] = std::max(widths[k], width(line[k]));
  std::string text;
  for (const auto& line : lines) {
    std::string row;
    for (std::size_t k = 0; k < line.size(); ++k)
      row += "  " + line[k] + std::string(widths[k] - width(line[k]), ' ');
    // Nothing is padded behind the last word: lines can be compared and copied.
    row.erase(row.find_last_not_of(' ') + 1);
    text += row + '\n';
  }
  return text;
}

/// Axes that tell groups apart: more than one value, and not the seed.
std::vector<std::size_t> telling_axes(const Experiment& experiment) {
  std::vector<std::size_t> axes;
  for (std::size_t k = 0; k < experiment.axes.size(); ++k)
    // The scene is named even where there is one alone, so that every line says something.
    if (experiment.axes[k].path != "world.seed" && (k == 0 || experiment.axes[k].values.size() > 1))
      axes.push_back(k);
  return axes;
}

/// Those that are to give the same events: not known to be approximate.
/// A policy that this program does not have is taken to be exact: then a difference is told.
bool exact(const std::string& policy) {
  // Asked of a policy itself: one that the program has added knows what it is, too.
  for (const Choice& choice : policies())
    if (choice.name == policy) return !make_policy(policy)->approximate();
  return true;
}

}  // namespace

std::string duration_text(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.3g} \u00b5s", 1e6 * seconds);
  return seconds < 1.0 ? fmt::format("{:.3g} ms", 1e3 * seconds) : fmt::format("{:.3g} s", seconds);
}

double median(std::vector<double> values) {
  // A run that could not start has no numbers: it counts among the endings and not here.
  std::erase_if(values, [](double x) { return std::isnan(x); });
  if (values.empty()) return std::nan("");
  // The lower middle: a value that some run has, where a mean of two would be nobody's.
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<SweepGroup> sweep_groups(const Experiment& experiment, const SweepResults& results) {
  // Groups keep the order in which their first run comes; the map only finds them again.
  std::map<std::vector<std::string>, std::size_t> index;
  std::vector<SweepGroup> groups;
  for (std::size_t k = 0; k < experiment.runs.size(); ++k) {
    std::vector<std::string> values = experiment.runs[k].values;
    for (std::size_t a = 0; a < values.size(); ++a)
      // One group a setting: the seed's value is left out.
      if (experiment.axes[a].path == "world.seed") values[a].clear();
    const auto [at, fresh] = index.try_emplace(values, groups.size());
    if (fresh) groups.push_back({values, {}, 0});
    SweepGroup& group = groups[at->second];
    if (results[k])
      group.runs.push_back(k);
    else
      ++group.waiting;
  }
  return groups;
}

std::string sweep_table(const Experiment& experiment, const SweepResults& results) {
  const std::vector<std::size_t> axes = telling_axes(experiment);
  std::vector<std::vector<std::string>> lines(1);
  for (const std::size_t k : axes) lines[0].push_back(printable(experiment.axes[k].name));
  for (const char* heading : {"runs", "collisions", "wall", "energy drift", "overlap", "state hash"})
    lines[0].emplace_back(heading);
  for (const SweepGroup& group : sweep_groups(experiment, results)) {
    const auto middle = [&](const char* column) {
      std::vector<double> values;
      for (const std::size_t k : group.runs) values.push_back(results[k]->numbers.at(column));
      return median(values);
    };
    std::vector<std::string>& line = lines.emplace_back();
    for (const std::size_t k : axes) line.push_back(printable(group.values[k]));
    line.push_back(endings(group, results));
    // what has not run yet has no numbers
    const auto number = [&](const char* column, const auto& text) {
      const double value = middle(column);
      line.push_back(std::isnan(value) ? "" : text(value));
    };
    number("collisions", [](double x) { return fmt::format("{}", x); });
    number("wall_seconds", duration_text);
    number("energy_drift", [](double x) { return fmt::format("{:.1e}", x); });
    number("max_overlap", [](double x) { return fmt::format("{:.1e} m", x); });
    line.push_back(hash_text(group, results));
  }
  return aligned(lines);
}

std::string policy_agreement(const Experiment& experiment, const SweepResults& results) {
  // The axis of policies, if there is one: agreement is among its values.
  std::size_t policy = 0;
  while (policy < experiment.axes.size() && experiment.axes[policy].path != "solver.policy") ++policy;
  if (policy == experiment.axes.size()) return "";
  std::map<std::vector<std::string>, std::vector<std::string>> hashes;  // of exact policies
  for (std::size_t k = 0; k < experiment.runs.size(); ++k) {
    // The same settings without the policy: what all exact policies must agree in.
    std::vector<std::string> setting = experiment.runs[k].values;
    const std::string name = std::exchange(setting[policy], "");
    // A run that could not start has no bits.
    if (!results[k] || results[k]->state_hash.empty() || !exact(name)) continue;
    hashes[setting].push_back(results[k]->state_hash);
  }
  std::erase_if(hashes, [](const auto& setting) { return setting.second.size() < 2; });
  if (hashes.empty()) return "";
  std::size_t same = 0;
  std::string others;
  for (const auto& [setting, of_policies] : hashes) {
    if (std::set(of_policies.begin(), of_policies.end()).size() == 1) {
      ++same;
      continue;
    }
    std::string where;
    for (const std::string& value : setting)
      if (!value.empty()) where += (where.empty() ? "" : ", ") + printable(value);
    // By the values of all other axes, the seed's too: with them the runs can be made again one by one.
    others += "\n  not the same: " + where;
  }
  return fmt::format("same bits from all exact policies: {} of {}{}", same, hashes.size(), others);
}

void write_sweep_csv(const std::filesystem::path& file, const Experiment& experiment,
                     const SweepResults& results) {
  std::ofstream out(file);
  for (const SweepAxis& axis : experiment.axes) out << csv_text(axis.name) << ',';
  out << "termination,state_hash";
  for (const std::string& name : sweep_columns()) out << ',' << name;
  out << '\n';
  for (std::size_t k = 0; k < experiment.runs.size(); ++k) {
    for (const std::string& value : experiment.runs[k].values) out << csv_text(value) << ',';
    // Two cells: of a run that waits the hash is empty, so that every line has the same number.
    out << (results[k] ? csv_cell(results[k]->termination) + ',' + csv_cell(results[k]->state_hash)
                       : "waiting,");
    for (const std::string& name : sweep_columns()) {
      out << ',';
      if (results[k] && !std::isnan(results[k]->numbers.at(name)))
        // The shortest text that reads back as the same double. Where there is no number the cell is empty.
        out << fmt::format("{}", results[k]->numbers.at(name));
    }
    out << '\n';
  }
  out.close();
  if (!out) throw_not_written(file);
}

}  // namespace brink
