#include "brink/scenes/sweep/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "brink/scenes/draw_canvas.h"

namespace brink {
namespace {

using draw::Canvas;
using draw::Color;
using draw::Oklch;
using draw::Tones;

constexpr int kPanelWidth = 560, kPanelHeight = 380, kColumns = 2, kMargin = 28, kLegend = 88;
constexpr double kLeft = 76.0, kRight = 24.0, kTop = 48.0, kBottom = 54.0;
constexpr double kLogSpan = 20.0;

const Color kInk = Tones::ink.rgb(), kPale = Oklch{0.52, 0.015, 260.0}.rgb();
const Color kGrid = Oklch{0.90, 0.006, 260.0}.rgb(), kPage = Tones::paper.rgb(), kPanel{1.0, 1.0, 1.0};

std::size_t axis_named(const Experiment& experiment, const std::string& name) {
  for (std::size_t k = 0; k < experiment.axes.size(); ++k)
    if (experiment.axes[k].name == name) return k;
  return experiment.axes.size();
}

std::optional<double> as_number(const std::string& text) {
  std::istringstream in(text);
  double x = 0.0;
  return (in >> x) && in.eof() ? std::optional(x) : std::nullopt;
}

struct Tick {
  double place;  ///< 0..1
  std::string label;
};

/// Numbers to places 0..1.
class Scale {
 public:
  explicit Scale(const std::vector<double>& values) {
    if (values.empty()) return;
    low_ = *std::min_element(values.begin(), values.end());
    high_ = *std::max_element(values.begin(), values.end());
    log_ = low_ > 0.0 && high_ > kLogSpan * low_;
    if (log_) {
      low_ = std::floor(std::log10(low_));
      high_ = std::ceil(std::log10(high_));
    } else {
      if (low_ > 0.0 && low_ < 0.5 * high_) low_ = 0.0;
      const double room = high_ > low_ ? 0.05 * (high_ - low_) : std::max(1.0, std::abs(high_));
      high_ += room;
      if (low_ != 0.0) low_ -= room;
    }
  }

  double place(double value) const { return ((log_ ? std::log10(value) : value) - low_) / (high_ - low_); }

  std::vector<Tick> ticks() const {
    std::vector<Tick> ticks;
    const double step =
        log_ ? std::max(1.0, std::ceil((high_ - low_) / 7.0)) : draw::round_length((high_ - low_) / 4.0);
    for (double k = std::ceil(low_ / step); k * step <= high_ + 1e-9 * (high_ - low_); ++k)
      ticks.push_back(
          {(k * step - low_) / (high_ - low_),
           log_ ? fmt::format("1e{}", static_cast<int>(k * step)) : fmt::format("{:g}", k * step)});
    return ticks;
  }

 private:
  double low_ = 0.0, high_ = 1.0;
  bool log_ = false;
};

/// Places of the x axis's values: numbers by their value, names side by side.
struct XPlaces {
  std::vector<double> place;
  std::vector<Tick> ticks;

  explicit XPlaces(const SweepAxis& axis) {
    std::vector<double> numbers;
    for (const std::string& v : axis.values)
      if (const auto x = as_number(v)) numbers.push_back(*x);
    if (numbers.size() == axis.values.size() && numbers.size() > 1) {
      const Scale scale(numbers);
      for (const double x : numbers) place.push_back(scale.place(x));
      ticks = scale.ticks();
      return;
    }
    const auto n = static_cast<double>(axis.values.size());
    for (std::size_t k = 0; k < axis.values.size(); ++k) {
      place.push_back((static_cast<double>(k) + 0.5) / n);
      ticks.push_back({place.back(), axis.values[k]});
    }
  }
};

/// Where one panel lies on the picture, in pixels from the top left corner.
struct Panel {
  double left, right, top, bottom;
  double x(double place) const { return left + place * (right - left); }
  double y(double place) const { return bottom - place * (bottom - top); }
};

class Plot {
 public:
  Plot(const Experiment& experiment, const SweepResults& results)
      : experiment_(experiment),
        results_(results),
        x_axis_(experiment.axes[axis_named(experiment, experiment.plot.x)]),
        places_(x_axis_) {
    const std::size_t series = axis_named(experiment, experiment.plot.series);
    if (series < experiment.axes.size()) names_ = experiment.axes[series].values;
  }

  Picture picture() {
    const int panels = static_cast<int>(experiment_.plot.y.size());
    const int columns = std::min(kColumns, panels), lines = (panels + columns - 1) / columns;
    const int width = columns * (kPanelWidth + kMargin) + kMargin;
    height_ = kLegend + lines * (kPanelHeight + kMargin);
    draw::View view;
    view.window.add(Vec2(0.0, 0.0));
    view.window.add(Vec2(width, height_));
    view.width = width;
    view.height = height_;
    Canvas canvas(view, width, height_, kPage);
    legend(canvas, width);
    for (int k = 0; k < panels; ++k)
      panel(canvas, kMargin + (k % columns) * (kPanelWidth + kMargin),
            kLegend + (k / columns) * (kPanelHeight + kMargin), experiment_.plot.y[k]);
    return canvas.finish();
  }

 private:
  Vec2 at(double x, double y) const { return {x, height_ - y}; }
  static Color color(std::size_t series) {
    return Oklch{0.58, 0.16, 265.0 + 137.5 * static_cast<double>(series)}.rgb();
  }

  void legend(Canvas& canvas, int width) const {
    canvas.text(kMargin, 36, experiment_.title, 20, kInk, Canvas::Align::left, true);
    canvas.text(width - kMargin, 36, "median and range", 13, kPale, Canvas::Align::right);
    double x = kMargin;
    for (std::size_t k = 0; k < names_.size() && x < width - 120; ++k) {
      canvas.dot(at(x + 6, 61), 5.0, color(k));
      x += 18 + canvas.text(x + 18, 66, names_[k], 14, kInk, Canvas::Align::left) + 22;
    }
  }

  void panel(Canvas& canvas, double x0, double y0, const std::string& column) const {
    canvas.rectangle(x0, y0, kPanelWidth, kPanelHeight, kPanel);
    canvas.text(x0 + 18, y0 + 28, column == "energy_drift" ? "|energy_drift|" : column, 14.5, kInk,
                Canvas::Align::left, true);
    const Panel panel{x0 + kLeft, x0 + kPanelWidth - kRight, y0 + kTop, y0 + kPanelHeight - kBottom};
    const auto lines = sweep_lines(experiment_, results_, column);
    std::vector<double> values;
    for (const auto& line : lines)
      for (const SweepPoint& p : line) values.insert(values.end(), {p.low, p.middle, p.high});
    const Scale y_scale(values);
    grid(canvas, panel, y_scale);
    for (std::size_t k = 0; k < lines.size(); ++k) draw_line(canvas, panel, y_scale, lines[k], color(k));
  }

  void grid(Canvas& canvas, const Panel& panel, const Scale& y_scale) const {
    for (const Tick& tick : places_.ticks) {
      const double x = panel.x(tick.place);
      canvas.line(at(x, panel.top), at(x, panel.bottom), kGrid, 1.0);
      canvas.text(x + 3.2 * static_cast<double>(tick.label.size()), panel.bottom + 18, tick.label, 12, kPale,
                  Canvas::Align::right);
    }
    for (const Tick& tick : y_scale.ticks()) {
      const double y = panel.y(tick.place);
      canvas.line(at(panel.left, y), at(panel.right, y), kGrid, 1.0);
      canvas.text(panel.left - 8, y + 4, tick.label, 12, kPale, Canvas::Align::right);
    }
    canvas.text(panel.right, panel.bottom + 40, x_axis_.name, 12.5, kPale, Canvas::Align::right);
  }

  void draw_line(Canvas& canvas, const Panel& panel, const Scale& y_scale,
                 const std::vector<SweepPoint>& line, const Color& ink) const {
    const auto spot = [&](const SweepPoint& p, double value) {
      return at(panel.x(places_.place[p.x]), panel.y(y_scale.place(value)));
    };
    for (std::size_t k = 0; k < line.size(); ++k) {
      if (k > 0) canvas.line(spot(line[k - 1], line[k - 1].middle), spot(line[k], line[k].middle), ink, 2.0);
      if (line[k].high > line[k].low)
        canvas.line(spot(line[k], line[k].low), spot(line[k], line[k].high), ink, 1.2);
      canvas.dot(spot(line[k], line[k].middle), 5.0, ink);
    }
  }

  const Experiment& experiment_;
  const SweepResults& results_;
  const SweepAxis& x_axis_;
  XPlaces places_;
  std::vector<std::string> names_;
  int height_ = 0;
};

}  // namespace

std::vector<std::vector<SweepPoint>> sweep_lines(const Experiment& experiment, const SweepResults& results,
                                                 const std::string& column) {
  const std::size_t x = axis_named(experiment, experiment.plot.x);
  const std::size_t series = axis_named(experiment, experiment.plot.series);
  const bool one = series == experiment.axes.size();
  const std::vector<std::string> single{""};
  const std::vector<std::string>& names = one ? single : experiment.axes[series].values;
  const auto& values = experiment.axes[x].values;
  std::vector<std::vector<std::vector<double>>> found(names.size(),
                                                      std::vector<std::vector<double>>(values.size()));
  const auto index = [](const std::vector<std::string>& all, const std::string& v) {
    return static_cast<std::size_t>(std::find(all.begin(), all.end(), v) - all.begin());
  };
  for (std::size_t k = 0; k < experiment.runs.size(); ++k) {
    if (!results[k]) continue;
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
        lines[s].push_back(
            {k, *std::min_element(v.begin(), v.end()), median(v), *std::max_element(v.begin(), v.end())});
  return lines;
}

Picture sweep_picture(const Experiment& experiment, const SweepResults& results) {
  return Plot(experiment, results).picture();
}

}  // namespace brink
