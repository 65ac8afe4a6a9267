#pragma once
/// Charts: panels of points and lines that share their series, as pictures.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "brink/scenes/draw/color.h"
#include "brink/scenes/draw/draw.h"

namespace brink {

struct ChartPoint {
  enum class Mark { dot, small_dot, ring, cross };
  double x = 0.0, y = 0.0;       ///< y infinite: on the panel's upper rim
  double low = 0.0, high = 0.0;  ///< a range of y, drawn where high > low
  Mark mark = Mark::dot;
};

struct ChartLine {
  std::size_t series = 0;  ///< index into Chart::series
  std::vector<ChartPoint> points;
  bool joined = true;  ///< in their order
};

/// One axis. Without names it is linear, or logarithmic where all values are > 0 and span more than a factor
/// of 20 or whole decades are asked for.
struct ChartAxis {
  std::string title;
  std::vector<std::string> names;            ///< not empty: x counts these, side by side
  bool decades = false;                      ///< logarithmic, from decade to decade; all values > 0
  std::function<std::string(double)> label;  ///< of a tick at a value; empty: the number
};

struct ChartPanel {
  std::string title, note;
  ChartAxis x, y;
  std::vector<ChartLine> lines;
};

struct ChartSeries {
  std::string name;
  std::optional<draw::Oklch> color;  ///< none: the next of an endless row of hues
};

struct Chart {
  std::string title, note;
  std::vector<ChartSeries> series;
  std::vector<ChartPanel> panels;  ///< set in rows of two
};

/// Ten to a whole power, as it is printed.
std::string power_text(int exponent);

/// The colour of a series that is not given one: hue, and lightness, which differs where hues look alike to some.
draw::Oklch series_color(std::size_t series);

/// The chart with its legend: a colour, a form of mark and a style of line a series. Infinite points are on the upper rim,
/// those that are no number are left out, categories are not joined and their series stand beside each other, and a mark
/// that others cover is larger than they.
Picture chart_picture(const Chart& chart);

/// Writes it as PNG, and as SVG beside it. @throws IoError naming the file.
void write_chart(const std::filesystem::path& png, const Chart& chart);

}  // namespace brink
