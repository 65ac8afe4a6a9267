/// A page from the top: title and note in one line if they fit, the legend in as many lines as it takes, panels in rows
/// of two. All panels are of one size; the page grows. Within a panel a Scale takes values to places 0..1,
/// and a PanelFrame takes places to pixels.
///
/// Everything is placed in pixels from the top left corner, y downward. The canvas's own plane has y
/// upward, with one metre a pixel (ChartSheet::view()), so that its lines and marks can be used: at() turns
/// one into the other.
#include "brink/scenes/draw/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "brink/scenes/draw/canvas.h"

namespace brink {
namespace {

using draw::Canvas;
using draw::Color;
using draw::Oklch;
using draw::Tones;
using Align = Canvas::Align;

/// Of panels, and of the plot within one [pixels].
constexpr int kPanelWidth = 560, kPanelHeight = 390, kColumns = 2, kMargin = 28, kHead = 56, kLegendLine = 26;
constexpr double kLeft = 70.0, kRight = 22.0, kTop = 64.0, kBottom = 56.0;
constexpr double kLogSpan = 20.0;  // beyond this factor axes are logarithmic
constexpr int kMostTicks = 8;
/// Series of one name are so far apart [pixels]; marks in one square of that side count as one place, and who is
/// covered shows so wide a rim for each above it, for no more than some.
constexpr double kBeside = 14.0, kSamePlace = 3.0, kRim = 2.2;
constexpr int kMostRims = 3;

const Color kInk = Tones::ink.rgb(), kPale = Oklch{0.52, 0.015, 260.0}.rgb();
const Color kGrid = Oklch{0.90, 0.006, 260.0}.rgb(), kPage = Tones::paper.rgb(), kPanel{1.0, 1.0, 1.0};

// Five styles beside the nine forms of draw_spot(): both together repeat after 45 series.
const std::vector<double> kDashes[] = {{}, {9, 4}, {2, 3}, {9, 3, 2, 3}, {14, 4}};  ///< one a series [pixels]

struct Tick {
  double place;  ///< 0..1
  std::string label;
};

/// Values of one axis to places 0..1.
/// Linear, logarithmic or of names, as ChartAxis says. In logarithms low_ and high_ are exponents of ten.
class Scale {
 public:
  Scale(const ChartAxis& axis, std::vector<double> values) : axis_(axis) {
    // What is infinite stands on the rim, and must not stretch the axis.
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (!axis.names.empty()) {
      // Half a place free at both ends, so that the first and the last name stand inside.
      low_ = -0.5, high_ = static_cast<double>(axis.names.size()) - 0.5;
    } else if (!values.empty()) {
      const auto [least, most] = std::minmax_element(values.begin(), values.end());
      log_ = axis.decades || (*least > 0.0 && *most > kLogSpan * *least);
      log_ ? span_decades(*least, *most) : span_numbers(*least, *most);
    }
  }

  /// Where a value stands, 0..1 from the lower end. @pre not NaN; on a logarithmic axis > 0.
  double place(double value) const {
    // What is infinite stands on the upper rim.
    if (std::isinf(value)) return 1.0;
    return ((log_ ? std::log10(value) : value) - low_) / (high_ - low_);
  }

  /// Names, one each; else round values, in ascending order.
  std::vector<Tick> ticks() const {
    std::vector<Tick> ticks;
    for (std::size_t k = 0; k < axis_.names.size(); ++k)
      ticks.push_back({place(static_cast<double>(k)), axis_.names[k]});
    if (!ticks.empty()) return ticks;
    // Decades: so many to a tick that there are at most kMostTicks. Numbers: four to ten steps
    // of a round length.
    const double step =
        log_ ? std::ceil((high_ - low_) / kMostTicks) : draw::round_length((high_ - low_) / 4.0);
    // A tick at the upper end must not be lost to a rounding.
    for (double k = std::ceil(low_ / step); k * step <= high_ + 1e-9 * (high_ - low_); ++k)
      ticks.push_back({(k * step - low_) / (high_ - low_), label(k * step)});
    return ticks;
  }

 private:
  /// Whole decades around the values, so that the grid's lines are the ends of the axis.
  void span_decades(double least, double most) {
    low_ = std::floor(std::log10(least));
    // At least one decade, though all values are equal.
    high_ = std::max(low_ + 1.0, std::ceil(std::log10(most)));
  }
  /// The values with a twentieth of their range on either side.
  void span_numbers(double least, double most) {
    // Values that reach below half of the largest are shown from 0.
    if (least > 0.0 && least < 0.5 * most) least = 0.0;
    // All equal: room by their own size, so that they stand in the middle.
    const double room = most > least ? 0.05 * (most - least) : std::max(1.0, std::abs(most));
    high_ = most + room;
    // An axis that begins at 0 has no room below it.
    low_ = least == 0.0 ? 0.0 : least - room;
  }
  /// `at`: the value, or on a logarithmic axis its exponent; the axis's own function is asked by value.
  std::string label(double at) const {
    if (axis_.label) return axis_.label(log_ ? std::pow(10.0, at) : at);
    return log_ ? power_text(static_cast<int>(std::lround(at))) : fmt::format("{:g}", at + 0.0);  // never -0
  }

  const ChartAxis& axis_;
  double low_ = 0.0, high_ = 1.0;
  bool log_ = false;
};

std::vector<double> all_x(const ChartPanel& panel) {
  std::vector<double> values;
  for (const ChartLine& line : panel.lines)
    for (const ChartPoint& p : line.points) values.push_back(p.x);
  return values;
}

/// With both ends of ranges: these are drawn, too, and must lie within the panel.
std::vector<double> all_y(const ChartPanel& panel) {
  std::vector<double> values;
  for (const ChartLine& line : panel.lines)
    for (const ChartPoint& p : line.points) {
      values.push_back(p.y);
      if (p.high > p.low) values.insert(values.end(), {p.low, p.high});
    }
  return values;
}

/// Where one panel's plot lies on the picture [pixels from the top left corner].
struct PanelFrame {
  double left, right, top, bottom;
  double x(double place) const { return left + place * (right - left); }
  double y(double place) const { return bottom - place * (bottom - top); }
};

/// The page laid out: its size is known once it is made, and it may be drawn on any paper.
class ChartSheet {
 public:
  explicit ChartSheet(const Chart& chart)
      : chart_(chart),
        // Members in the order of their declaration, each from those before: place_legend() reads width_.
        columns_(std::clamp(static_cast<int>(chart.panels.size()), 1, kColumns)),
        width_(columns_ * (kPanelWidth + kMargin) + kMargin),
        // Estimates, as the legend's.
        note_below_(12.6 * static_cast<double>(chart.title.size()) +
                        6.8 * static_cast<double>(chart.note.size()) >
                    width_ - 3 * kMargin),
        head_(kHead + (note_below_ && !chart.note.empty() ? 22 : 0)),
        // The legend's lines decide where panels begin: it is laid out once without being drawn.
        legend_lines_(place_legend(nullptr)),
        top_(head_ + legend_lines_ * kLegendLine + 10) {
    const int rows = (static_cast<int>(chart.panels.size()) + columns_ - 1) / columns_;
    height_ = top_ + rows * (kPanelHeight + kMargin);
  }

  Picture picture() const {
    Canvas canvas(view(), width_, height_, kPage);
    draw(canvas);
    return canvas.finish();
  }
  void write_svg(const std::filesystem::path& file) const {
    Canvas canvas(view(), width_, height_, kPage, {draw::Paper::Kind::svg, file});
    draw(canvas);
    canvas.finish_file();
  }

 private:
  /// Both papers get the same: a PNG and the SVG beside it show one page.
  void draw(Canvas& canvas) const {
    canvas.text(kMargin, 38, chart_.title, 21, kInk, Align::left, true);
    if (note_below_)
      canvas.text(kMargin, 60, chart_.note, 13, kPale, Align::left);
    else
      canvas.text(width_ - kMargin, 38, chart_.note, 13, kPale, Align::right);
    place_legend(&canvas);
    for (int k = 0; k < static_cast<int>(chart_.panels.size()); ++k)
      draw_panel(canvas, kMargin + (k % columns_) * (kPanelWidth + kMargin),
                 top_ + (k / columns_) * (kPanelHeight + kMargin), chart_.panels[k]);
  }

  /// A world of pixels.
  /// Charts are laid out in pixels from the top left; the canvas is a plane with y upward.
  draw::View view() const {
    draw::View view;
    view.window.add(Vec2(0.0, 0.0));
    view.window.add(Vec2(width_, height_));
    view.width = width_;
    view.height = height_;
    return view;
  }
  /// A place in pixels from the top left corner in the canvas's plane; its text and rectangles take pixels
  /// as they are.
  Vec2 at(double x, double y) const { return {x, height_ - y}; }

  /// Its own, or the next of the row.
  Color color(std::size_t series) const {
    const auto& given = chart_.series[series].color;
    return (given ? *given : series_color(series)).rgb();
  }

  /// Writes the legend, or without a canvas only counts its lines.
  int place_legend(Canvas* canvas) const {
    double x = kMargin;
    int line = 0;
    for (std::size_t k = 0; k < chart_.series.size(); ++k) {
      const std::string& name = chart_.series[k].name;
      // A chart of one series without a name has no legend.
      if (name.empty()) continue;
      // An estimate: without a canvas the widths of letters are not known.
      // By bytes: a name with other letters than ASCII has more room than it needs.
      const double wide = 40.0 + 8.6 * static_cast<double>(name.size());
      if (x > kMargin && x + wide > width_ - kMargin) x = kMargin, ++line;
      if (canvas) {
        const double y = head_ + (line + 0.5) * kLegendLine;
        draw_spot(*canvas, at(x + 6, y - 5), 5.0, k, color(k));
        canvas->text(x + 18, y, name, 14, kInk, Align::left);
      }
      x += wide;
    }
    return x > kMargin ? line + 1 : 0;
  }

  /// A panel with its upper left corner at (x0, y0). Its scales are of its own values: panels share nothing
  /// but the series.
  void draw_panel(Canvas& canvas, double x0, double y0, const ChartPanel& panel) const {
    canvas.rectangle(x0, y0, kPanelWidth, kPanelHeight, kPanel);
    canvas.text(x0 + 18, y0 + 26, panel.title, 14.5, kInk, Align::left, true);
    canvas.text(x0 + 18, y0 + 46, panel.note, 12.5, kPale, Align::left);
    const PanelFrame frame{x0 + kLeft, x0 + kPanelWidth - kRight, y0 + kTop, y0 + kPanelHeight - kBottom};
    const Scale x(panel.x, all_x(panel)), y(panel.y, all_y(panel));
    draw_grid(canvas, frame, panel, x, y);
    // Of names there is room beside each: who has the same value stands there.
    const double lines = static_cast<double>(panel.lines.size()),
                 names = static_cast<double>(panel.x.names.size());
    const double step = names > 0 ? std::min(kBeside, 0.8 * (frame.right - frame.left) / names / lines) : 0.0;
    std::vector<std::vector<Spot>> spots;
    for (std::size_t k = 0; k < panel.lines.size(); ++k)
      spots.push_back(
          spots_of(panel.lines[k], frame, x, y, step * (static_cast<double>(k) - 0.5 * (lines - 1.0))));
    enlarge_covered(spots);
    for (std::size_t k = 0; k < panel.lines.size(); ++k)
      draw_line(canvas, panel.lines[k], spots[k], names > 0);
  }

  /// Where a point stands, with both ends of its range, and by what its mark is larger than others.
  struct Spot {
    Vec2 place, low, high;
    double more;  ///< [pixels]
  };

  /// Of all points of a line, set aside by some pixels. @post NaN where a value is none.
  std::vector<Spot> spots_of(const ChartLine& line, const PanelFrame& frame, const Scale& x, const Scale& y,
                             double aside) const {
    std::vector<Spot> spots;
    for (const ChartPoint& p : line.points) {
      const auto spot = [&](double value) {
        return at(frame.x(x.place(p.x)) + aside, frame.y(y.place(value)));
      };
      spots.push_back({spot(p.y), spot(p.low), spot(p.high), 0.0});
    }
    return spots;
  }

  /// Marks of later lines would cover earlier ones at the same place: these show a rim.
  static void enlarge_covered(std::vector<std::vector<Spot>>& lines) {
    std::map<std::pair<long, long>, int> above;
    for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
      std::set<std::pair<long, long>> own;
      for (Spot& spot : *line) {
        if (!spot.place.allFinite()) continue;
        const std::pair<long, long> pixel(std::lround(spot.place.x() / kSamePlace),
                                          std::lround(spot.place.y() / kSamePlace));
        spot.more = kRim * std::min(above[pixel], kMostRims);
        own.insert(pixel);
      }
      for (const auto& pixel : own) ++above[pixel];
    }
  }

  /// Ticks with their lines and labels, and the titles of both axes, set to the right.
  void draw_grid(Canvas& canvas, const PanelFrame& f, const ChartPanel& panel, const Scale& x,
                 const Scale& y) const {
    for (const Tick& tick : x.ticks()) {
      const double px = f.x(tick.place);
      canvas.line(at(px, f.top), at(px, f.bottom), kGrid, 1.0);
      canvas.text(px, f.bottom + 18, tick.label, 12, kPale, Align::middle);
    }
    for (const Tick& tick : y.ticks()) {
      const double py = f.y(tick.place);
      canvas.line(at(f.left, py), at(f.right, py), kGrid, 1.0);
      canvas.text(f.left - 8, py + 4, tick.label, 12, kPale, Align::right);
    }
    canvas.text(f.right, f.bottom + 40, panel.x.title, 12.5, kPale, Align::right);
    canvas.text(f.right, f.top - 18, panel.y.title, 12.5, kPale, Align::right);
  }

  /// One series in a panel: the way first, marks over it, so that a mark hides the joint of its line.
  void draw_line(Canvas& canvas, const ChartLine& line, const std::vector<Spot>& spots,
                 bool categories) const {
    const Color ink = color(line.series);
    // A NaN parts a line into pieces.
    std::vector<Vec2> way;  // through what is finite; categories have nothing between them
    const auto draw_way = [&] {
      if (way.size() > 1) canvas.path(way, ink, 2.0, kDashes[line.series % std::size(kDashes)]);
      way.clear();
    };
    for (std::size_t k = 0; k < spots.size(); ++k)
      // An infinite value stays on the way: it is drawn on the rim, where its mark is.
      if (line.joined && !categories && !std::isnan(line.points[k].y))
        way.push_back(spots[k].place);
      else
        draw_way();
    draw_way();
    for (std::size_t k = 0; k < spots.size(); ++k) {
      const ChartPoint& p = line.points[k];
      if (std::isnan(p.y)) continue;
      if (p.high > p.low) canvas.line(spots[k].low, spots[k].high, ink, 1.2);
      draw_mark(canvas, spots[k].place, spots[k].more, p.mark, line.series, ink);
    }
  }

  /// The form tells the series, the mark how the point came about: a ring is its form with a hole in the
  /// panel's white, a cross is the same for all. `more`: by that larger.
  static void draw_mark(Canvas& canvas, const Vec2& p, double more, ChartPoint::Mark mark, std::size_t series,
                        const Color& ink) {
    const double arm = 4.0 + more;
    switch (mark) {
      case ChartPoint::Mark::dot:
        return draw_spot(canvas, p, 5.0 + more, series, ink);
      case ChartPoint::Mark::small_dot:
        return draw_spot(canvas, p, 3.0 + more, series, ink);
      case ChartPoint::Mark::ring:
        draw_spot(canvas, p, 5.0 + more, series, ink);
        return draw_spot(canvas, p, 2.6 + more, series, kPanel);
      case ChartPoint::Mark::cross:
        canvas.line(p + Vec2(-arm, -arm), p + Vec2(arm, arm), ink, 2.0);
        canvas.line(p + Vec2(-arm, arm), p + Vec2(arm, -arm), ink, 2.0);
    }
  }

  /// One form a series, told apart without colour: disc, square, triangle, diamond, triangle on its tip, star, plus, bar,
  /// hexagon.
  static void draw_spot(Canvas& canvas, const Vec2& p, double size, std::size_t series, const Color& ink) {
    // Corners of each form, by what part of a turn it is turned, how far every second corner is in, and how wide it is.
    struct Form {
      int corners;
      double turned, in, wide;
    };
    static constexpr Form forms[] = {{0, 0, 1, 1},         {4, 0.125, 1, 1},    {3, 0.25, 1, 1},
                                     {4, 0.25, 1, 1},      {3, 0.75, 1, 1},     {10, 0.25, 0.45, 1.25},
                                     {8, 0.0, 0.35, 1.35}, {4, 0.125, 1, 0.45}, {6, 0.0, 1, 1}};
    const Form& form = forms[series % std::size(forms)];
    if (form.corners == 0) return canvas.dot(p, size, ink);
    std::vector<Vec2> points;
    for (int k = 0; k < form.corners; ++k) {
      const double angle = 2.0 * std::numbers::pi * (form.turned + static_cast<double>(k) / form.corners);
      // Corners on a circle a quarter larger: a square then has the area of the disc of that size, as 2 *
      // 1.25^2 = 3.1 is nearly pi. A bar is as much higher as it is narrower.
      const double r = 1.25 * size * (k % 2 == 1 ? form.in : 1.0);
      const double wide = form.wide, high = wide < 1.0 ? 1.0 / (2.0 * wide) + 0.3 : wide;
      points.push_back(p + r * Vec2(wide * std::cos(angle), high * std::sin(angle)));
    }
    canvas.area(points, ink);
  }

  const Chart& chart_;
  int columns_, width_;
  bool note_below_;
  int head_, legend_lines_, top_, height_ = 0;
};

}  // namespace

// Unicode's raised digits: a text of the canvas is one line of one size.
std::string power_text(int exponent) {
  static const char* const digits[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                       "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string text = exponent < 0 ? "10\u207b" : "10";
  for (const char c : std::to_string(std::abs(exponent))) text += digits[c - '0'];
  return text;
}

// Hues go on by the golden angle: however many there are, neighbours are far apart.
Oklch series_color(std::size_t series) {
  // lightness differs where hues look alike to some
  static constexpr double lightness[] = {0.50, 0.68, 0.38, 0.78, 0.58, 0.46};
  return {lightness[series % std::size(lightness)], 0.16, 265.0 + 137.5 * static_cast<double>(series)};
}

Picture chart_picture(const Chart& chart) { return ChartSheet(chart).picture(); }

void write_chart(const std::filesystem::path& png, const Chart& chart) {
  const ChartSheet sheet(chart);
  write_png(png, sheet.picture());
  sheet.write_svg(std::filesystem::path(png).replace_extension(".svg"));
}

}  // namespace brink
