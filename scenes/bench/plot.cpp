// A panel a problem, a line a series. Rows are taken in their order, so points of a series are joined by
// tolerance or step and not by time.
#include "brink/scenes/bench/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace brink::bench {
namespace {

/// A whole decade of seconds in the unit that shows it with at most three digits: "10 ms".
std::string seconds_text(double seconds) {
  static const char* const units[] = {"ns", "\u00b5s", "ms", "s"};
  const int exponent = static_cast<int>(std::lround(std::log10(seconds)));
  // Powers of a thousand from 1 ns on.
  const int unit = std::clamp((exponent + 9) / 3, 0, 3);
  return fmt::format("{:g} {}", std::pow(10.0, exponent + 9 - 3 * unit), units[unit]);
}

/// A tick's value is a power taken of its exponent, and may be a rounding above the least error.
/// A decade of errors; the least one stands for "none".
std::string error_text(double error) {
  return error <= 1.0001 * kLeastError ? "none"
                                       : power_text(static_cast<int>(std::lround(std::log10(error))));
}

/// Time and error kept above 0, for both axes are logarithmic.
ChartPoint point_of(const Row& row) {
  using Mark = ChartPoint::Mark;
  ChartPoint point{std::max(row.wall_seconds, 1e-9), std::max(row.error, kLeastError)};
  if (row.missed > 0) point.mark = Mark::ring;
  // Astray says more than missed.
  if (std::isinf(row.error)) point.mark = Mark::cross;
  return point;
}

/// The chart in the making: panels, series and lines come as rows ask for them.
class PlotMaker {
 public:
  PlotMaker(const std::string& title, const std::vector<Problem>& problems, const std::vector<Look>& looks)
      : problems_(problems), looks_(looks) {
    chart_.title = title;
    chart_.note = "left and low is better; rings: contacts were missed; crosses: the run went astray";
    // Series with looks come first, in their order; others as they come.
    for (const Look& look : looks) chart_.series.push_back({look.series, look.color});
  }

  void add(const Row& row) {
    const Problem& p = *std::find_if(problems_.begin(), problems_.end(),
                                     [&](const Problem& q) { return q.name == row.problem; });
    // Rows of a problem follow each other: another title begins a panel.
    if (chart_.panels.empty() || chart_.panels.back().title != p.title) {
      const ChartAxis time{"wall time of the simulation", {}, true, seconds_text};
      chart_.panels.push_back({p.title, p.error_of, time, {"", {}, true, error_text}, {}});
    }
    line_of(row.setting.series).points.push_back(point_of(row));
  }

  const Chart& chart() const { return chart_; }

 private:
  /// Its index, made if need be: one colour and mark for a series in all panels.
  std::size_t series_named(const std::string& name) {
    const auto found = std::find_if(chart_.series.begin(), chart_.series.end(),
                                    [&](const ChartSeries& s) { return s.name == name; });
    const auto k = static_cast<std::size_t>(found - chart_.series.begin());
    if (found == chart_.series.end()) chart_.series.push_back({name, {}});
    return k;
  }

  /// The line of a series in the panel that is being filled, made if need be.
  ChartLine& line_of(const std::string& name) {
    std::vector<ChartLine>& lines = chart_.panels.back().lines;
    const std::size_t series = series_named(name);
    const auto found =
        std::find_if(lines.begin(), lines.end(), [&](const ChartLine& l) { return l.series == series; });
    if (found != lines.end()) return *found;
    // Series with looks come first (constructor), so their indices are those of looks_; others are joined.
    lines.push_back({series, {}, series >= looks_.size() || looks_[series].joined});
    return lines.back();
  }

  const std::vector<Problem>& problems_;
  const std::vector<Look>& looks_;
  Chart chart_;
};

}  // namespace

void write_plot(const std::filesystem::path& file, const std::string& title,
                const std::vector<Problem>& problems, const std::vector<Row>& rows,
                const std::vector<Look>& looks) {
  PlotMaker maker(title, problems, looks);
  for (const Row& row : rows) maker.add(row);
  write_chart(file, maker.chart());
}

}  // namespace brink::bench
