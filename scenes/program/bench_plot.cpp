#include "brink/scenes/program/bench_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "brink/scenes/draw.h"
#include "brink/scenes/draw_canvas.h"

namespace brink::bench {
namespace {

using draw::Canvas;
using draw::Color;
using draw::Oklch;
using draw::Tones;

constexpr int kPanelWidth = 560, kPanelHeight = 400, kColumns = 2, kMargin = 28, kLegend = 84;
constexpr double kLeft = 62.0, kRight = 18.0, kTop = 64.0, kBottom = 50.0;

const Color kInk = Tones::ink.rgb(), kPale = Oklch{0.52, 0.015, 260.0}.rgb();
const Color kGrid = Oklch{0.90, 0.006, 260.0}.rgb(), kPage = Tones::paper.rgb(), kPanel{1.0, 1.0, 1.0};

/// Decades from low to high.
struct Axis {
  int low = 0, high = 1;
  double place(double value) const { return (std::log10(value) - low) / (high - low); }
  void take(double value) {
    low = std::min(low, static_cast<int>(std::floor(std::log10(value))));
    high = std::max(high, static_cast<int>(std::ceil(std::log10(value))));
  }
  int stride(int most) const { return std::max(1, (high - low + most - 1) / most); }
};

Axis axis_of(const std::vector<Row>& rows, const std::function<double(const Row&)>& value) {
  const double first = value(rows.front());
  Axis axis{static_cast<int>(std::floor(std::log10(first))), static_cast<int>(std::ceil(std::log10(first)))};
  for (const Row& row : rows) axis.take(value(row));
  if (axis.high == axis.low) ++axis.high;
  return axis;
}

double drawn_error(const Row& row) { return std::max(row.error, kLeastError); }
double drawn_seconds(const Row& row) { return std::max(row.wall_seconds, 1e-9); }

std::string power_text(int exponent) { return fmt::format("1e{}", exponent); }

std::string seconds_text(int exponent) {
  static const char* units[] = {"ns", "\u00b5s", "ms", "s"};
  const int unit = std::clamp((exponent + 9) / 3, 0, 3);
  return fmt::format("{:g} {}", std::pow(10.0, exponent + 9 - 3 * unit), units[unit]);
}

class Plot {
 public:
  Plot(const std::vector<Problem>& problems, const std::vector<Row>& rows)
      : problems_(problems), rows_(rows) {
    for (const Row& row : rows)
      if (!colors_.contains(row.setting.series)) {
        const auto k = static_cast<double>(colors_.size());
        colors_[row.setting.series] = Oklch{0.58, 0.16, 265.0 + 137.5 * k}.rgb();
        series_.push_back(row.setting.series);
      }
  }

  Picture picture() {
    std::vector<std::vector<Row>> panels;
    for (const Row& row : rows_) {
      if (panels.empty() || panels.back().front().problem != row.problem) panels.emplace_back();
      panels.back().push_back(row);
    }
    const int columns = std::min<int>(kColumns, static_cast<int>(panels.size()));
    const int lines = (static_cast<int>(panels.size()) + columns - 1) / columns;
    const int width = columns * kPanelWidth + (columns + 1) * kMargin;
    height_ = lines * (kPanelHeight + kMargin) + kMargin + kLegend;
    draw::View view;
    view.window.add(Vec2(0.0, 0.0));
    view.window.add(Vec2(width, height_));
    view.width = width;
    view.height = height_;
    Canvas canvas(view, width, height_, kPage);
    legend(canvas, width);
    for (std::size_t k = 0; k < panels.size(); ++k) {
      const auto column = static_cast<int>(k) % columns, line = static_cast<int>(k) / columns;
      panel(canvas, kMargin + column * (kPanelWidth + kMargin), kLegend + line * (kPanelHeight + kMargin),
            panels[k]);
    }
    return canvas.finish();
  }

 private:
  Vec2 at(double x, double y) const { return {x, height_ - y}; }

  void mark(Canvas& canvas, double x, double y, const Color& color, bool ring) const {
    canvas.dot(at(x, y), 5.0, color);
    if (ring) canvas.dot(at(x, y), 3.0, kPanel);
  }

  void legend(Canvas& canvas, int width) const {
    canvas.text(kMargin, 36, "Error against run time", 20, kInk, Canvas::Align::left, true);
    canvas.text(width - kMargin, 36, "left and low is better; rings: contacts were missed", 13, kPale,
                Canvas::Align::right);
    double x = kMargin;
    for (const std::string& series : series_) {
      mark(canvas, x + 6, 59, colors_.at(series), false);
      x += 18 + canvas.text(x + 18, 64, series, 14, kInk, Canvas::Align::left) + 22;
    }
  }

  const Problem& problem(const std::string& name) const {
    return *std::find_if(problems_.begin(), problems_.end(),
                         [&](const Problem& p) { return p.name == name; });
  }

  void panel(Canvas& canvas, double x0, double y0, const std::vector<Row>& rows) const {
    const Problem& p = problem(rows.front().problem);
    canvas.rectangle(x0, y0, kPanelWidth, kPanelHeight, kPanel);
    canvas.text(x0 + 18, y0 + 25, p.title, 14.5, kInk, Canvas::Align::left, true);
    canvas.text(x0 + 18, y0 + 45, p.error_of, 12.5, kPale, Canvas::Align::left);
    const Axis time = axis_of(rows, drawn_seconds), error = axis_of(rows, drawn_error);
    const double left = x0 + kLeft, right = x0 + kPanelWidth - kRight;
    const double top = y0 + kTop, bottom = y0 + kPanelHeight - kBottom;
    const auto x_of = [&](double place) { return left + place * (right - left); };
    const auto y_of = [&](double place) { return bottom - place * (bottom - top); };
    for (int k = time.low; k <= time.high; ++k) {
      const double x = x_of(time.place(std::pow(10.0, k)));
      canvas.line(at(x, top), at(x, bottom), kGrid, 1.0);
      canvas.text(x + 14, bottom + 18, seconds_text(k), 12, kPale, Canvas::Align::right);
    }
    for (int k = error.low; k <= error.high; k += error.stride(8)) {
      const double y = y_of(error.place(std::pow(10.0, k)));
      canvas.line(at(left, y), at(right, y), kGrid, 1.0);
      const bool floor = std::pow(10.0, k) <= kLeastError * 1.0001;
      canvas.text(left - 8, y + 4, floor ? "none" : power_text(k), 12, kPale, Canvas::Align::right);
    }
    canvas.text(right, bottom + 38, "wall time of the simulation", 12.5, kPale, Canvas::Align::right);
    for (const std::string& series : series_) {
      std::vector<std::pair<Vec2, bool>> points;
      for (const Row& row : rows)
        if (row.setting.series == series)
          points.emplace_back(Vec2(x_of(time.place(drawn_seconds(row))), y_of(error.place(drawn_error(row)))),
                              row.missed > 0);
      for (std::size_t k = 1; k < points.size(); ++k)
        canvas.line(at(points[k - 1].first.x(), points[k - 1].first.y()),
                    at(points[k].first.x(), points[k].first.y()), colors_.at(series), 2.0);
      for (const auto& [point, ring] : points) mark(canvas, point.x(), point.y(), colors_.at(series), ring);
    }
  }

  const std::vector<Problem>& problems_;
  const std::vector<Row>& rows_;
  std::map<std::string, Color> colors_;
  std::vector<std::string> series_;
  int height_ = 0;
};

}  // namespace

void write_plot(const std::filesystem::path& file, const std::vector<Problem>& problems,
                const std::vector<Row>& rows) {
  write_png(file, Plot(problems, rows).picture());
}

}  // namespace brink::bench
