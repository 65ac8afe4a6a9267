// A plot has two axes of the experiment, x and series. All others are gathered: what differs in them alone
// becomes one point with its range.
#include "brink/scenes/sweep/plot.h"

#include <algorithm>
#include <cmath>

#include "brink/scenes/draw/chart.h"
#include "brink/scenes/scene/scene.h"

namespace brink {
namespace {

/// The number of axes where there is none of that name: "" means no series.
std::size_t axis_named(const Experiment& experiment, const std::string& name) {
  for (std::size_t k = 0; k < experiment.axes.size(); ++k)
    if (experiment.axes[k].name == name) return k;
  return experiment.axes.size();
}

/// The axis's name with the unit of the key that it sets, where that is a number with one.
std::string name_with_unit(const SweepAxis& axis) {
  const std::vector<OptionInfo> options = scene_options();
  const auto option = std::find_if(options.begin(), options.end(),
                                   [&](const OptionInfo& o) { return o.table + '.' + o.key == axis.path; });
  if (option == options.end() || !option->type.starts_with("a number")) return axis.name;
  const std::size_t unit = option->type.rfind(" in ");
  return unit == std::string::npos ? axis.name : axis.name + " [" + option->type.substr(unit + 4) + "]";
}

/// Numbers by their value, names side by side.
ChartAxis x_axis_of(const SweepAxis& axis) {
  const auto numeric = [](const std::string& v) { return as_number(v).has_value(); };
  // A single number is a name: an axis of numbers needs two.
  const bool numbers = axis.values.size() > 1 && std::all_of(axis.values.begin(), axis.values.end(), numeric);
  return {name_with_unit(axis), numbers ? std::vector<std::string>() : axis.values, false, {}};
}

/// One column over x, a line for each value of the series axis. Of energy_drift the magnitude is shown,
/// since its sign would keep the axis from being logarithmic.
ChartPanel panel_of(const Experiment& experiment, const SweepResults& results, const std::string& column) {
  const SweepAxis& axis = experiment.axes[axis_named(experiment, experiment.plot.x)];
  const std::string unit = sweep_unit(column), name = column == "energy_drift" ? "|energy_drift|" : column;
  ChartPanel panel{unit.empty() ? name : name + " [" + unit + "]", "", x_axis_of(axis), {}, {}};
  for (const auto& points : sweep_lines(experiment, results, column)) {
    ChartLine line{panel.lines.size(), {}, true};
    for (const SweepPoint& p : points) {
      const double x = panel.x.names.empty() ? *as_number(axis.values[p.x]) : static_cast<double>(p.x);
      line.points.push_back({x, p.middle, p.low, p.high});
    }
    panel.lines.push_back(std::move(line));
  }
  return panel;
}

}  // namespace

std::vector<std::vector<SweepPoint>> sweep_lines(const Experiment& experiment, const SweepResults& results,
                                                 const std::string& column) {
  const std::size_t x = axis_named(experiment, experiment.plot.x);
  const std::size_t series = axis_named(experiment, experiment.plot.series);
  const bool one = series == experiment.axes.size();
  const std::vector<std::string> single{""};
  const std::vector<std::string>& names = one ? single : experiment.axes[series].values;
  const auto& values = experiment.axes[x].values;
  // By series and place along x; several seeds meet in one place.
  std::vector<std::vector<std::vector<double>>> found(names.size(),
                                                      std::vector<std::vector<double>>(values.size()));
  // @pre v is one of them, as the values of runs are those of axes.
  const auto index = [](const std::vector<std::string>& all, const std::string& v) {
    return static_cast<std::size_t>(std::find(all.begin(), all.end(), v) - all.begin());
  };
  for (std::size_t k = 0; k < experiment.runs.size(); ++k) {
    if (!results[k]) continue;
    // Rows that could not start, and columns that an earlier Brink did not know, are NaN.
    const double value = results[k]->numbers.at(column);
    if (!std::isfinite(value)) continue;
    const auto& at = experiment.runs[k].values;
    found[one ? 0 : index(names, at[series])][index(values, at[x])].push_back(
        column == "energy_drift" ? std::abs(value) : value);
  }
  std::vector<std::vector<SweepPoint>> lines(names.size());
  for (std::size_t s = 0; s < names.size(); ++s)
    for (std::size_t k = 0; k < values.size(); ++k)
      if (const auto& v = found[s][k]; !v.empty())
        // Where no run is done there is no point, and the line goes on to the next.
        lines[s].push_back(
            {k, *std::min_element(v.begin(), v.end()), median(v), *std::max_element(v.begin(), v.end())});
  return lines;
}

Chart sweep_chart(const Experiment& experiment, const SweepResults& results) {
  Chart chart{experiment.title, "median and range", {}, {}};
  const std::size_t series = axis_named(experiment, experiment.plot.series);
  // One series without a name, which the legend leaves out.
  if (series == experiment.axes.size()) {
    chart.series.emplace_back();
  } else {
    for (const std::string& name : experiment.axes[series].values) chart.series.push_back({name, {}});
  }
  for (const std::string& column : experiment.plot.y)
    chart.panels.push_back(panel_of(experiment, results, column));
  return chart;
}

}  // namespace brink
