// Charts: where marks fall, and what ticks say.
#include "brink/scenes/draw/chart.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace brink::chart_test {
namespace {

Chart chart_of(std::vector<ChartPoint> points, ChartAxis x = {}, ChartAxis y = {}) {
  Chart chart{"title", "", {{"series", draw::Oklch{0.628, 0.2577, 29.23}}}, {}};  // sRGB's red
  chart.panels.push_back({"panel", "", std::move(x), std::move(y), {{0, std::move(points), false}}});
  return chart;
}

bool is_red(std::uint32_t pixel) {
  return (pixel >> 16 & 0xff) > 240 && (pixel >> 8 & 0xff) < 16 && (pixel & 0xff) < 16;
}

/// Columns and rows of the panel's pixels in the series' colour; the legend's dot is above them.
struct Red {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1, count = 0;

  explicit Red(const Picture& picture, int below = 100) {
    for (int row = below; row < picture.height; ++row)
      for (int column = 0; column < picture.width; ++column)
        if (is_red(picture.at(column, row))) {
          left = std::min(left, column), right = std::max(right, column);
          top = std::min(top, row), bottom = std::max(bottom, row);
          ++count;
        }
  }
};

// On a logarithmic axis 10 lies half way between 1 and 100.
TEST(Chart, DecadesAreEquallyWide) {
  const auto middle_of = [](double x) {
    const Red red(chart_picture(chart_of({{x, 1.0}, {1.0, 1e9}, {100.0, 1e9}}, {}, {})), 300);
    return 0.5 * (red.left + red.right);
  };
  EXPECT_NEAR(middle_of(10.0), 0.5 * (middle_of(1.0) + middle_of(100.0)), 1.0);
  EXPECT_NEAR(middle_of(1.0) + 468.0, middle_of(100.0), 1.0);  // a panel's width between its margins
}

TEST(Chart, InfiniteValuesStandOnTheUpperRim) {
  const ChartPoint far{1.0, std::numeric_limits<double>::infinity()};
  const Red one(chart_picture(chart_of({far}))), both(chart_picture(chart_of({far, {1.0, 1.0}})));
  EXPECT_GT(one.count, 20);
  EXPECT_EQ(one.top, both.top);
  EXPECT_GT(both.bottom, one.bottom + 100);
}

// A ring is a dot with its inside left out.
TEST(Chart, RingsAreHollow) {
  ChartPoint point{1.0, 1.0};
  const Red dot(chart_picture(chart_of({point})));
  point.mark = ChartPoint::Mark::ring;
  const Red ring(chart_picture(chart_of({point})));
  EXPECT_EQ(ring.right - ring.left, dot.right - dot.left);
  EXPECT_LT(ring.count, 0.75 * dot.count);
}

TEST(Chart, WithoutPointsOrPanelsItIsStillAPicture) {
  EXPECT_GT(chart_picture(chart_of({})).width, 500);
  EXPECT_GT(chart_picture({"empty", "", {}, {}}).height, 50);
}

// About a value a little below 1 the axis begins a little below 0, whose tick is come upon from there.
TEST(Chart, ZeroHasNoSign) {
  Chart plain = chart_of({{0.0, 0.999}, {1.0, 0.999}}), named = plain;
  named.panels[0].y.label = [](double value) { return value == 0.0 ? "0" : fmt::format("{:g}", value); };
  EXPECT_EQ(chart_picture(plain).pixels, chart_picture(named).pixels);
}

TEST(Chart, PowersArePrintedRaised) {
  EXPECT_EQ(power_text(-12), "10\u207b\u00b9\u00b2");
  EXPECT_EQ(power_text(3), "10\u00b3");
}

// Red-blind and green-blind eyes (Vienot, Brettel & Mollon 1999) tell the first six series apart, too.
TEST(Chart, SeriesDifferForColourBlindEyes) {
  const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  const auto seen = [&](std::size_t k, bool deuteranope) {
    const draw::Color c = series_color(k).rgb();
    const double r = linear(c.red), g = linear(c.green), b = linear(c.blue);
    if (!deuteranope) return std::array<double, 3>{r, g, b};
    const double yellow = 0.29275 * r + 0.70725 * g;
    return std::array<double, 3>{yellow, yellow, -0.02234 * r + 0.02234 * g + b};
  };
  for (const bool deuteranope : {false, true})
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = a + 1; b < 6; ++b) {
        const auto x = seen(a, deuteranope), y = seen(b, deuteranope);
        double apart = 0.0;
        for (int i = 0; i < 3; ++i) apart = std::max(apart, std::abs(std::cbrt(x[i]) - std::cbrt(y[i])));
        EXPECT_GT(apart, 0.08) << "series " << a << " and " << b << (deuteranope ? " for a deuteranope" : "");
      }
}

TEST(Chart, SeriesHaveMarksOfTheirOwn) {
  std::vector<std::vector<bool>> marks;
  for (std::size_t k = 0; k < 9; ++k) {
    Chart chart = chart_of({{1.0, 1.0}});
    chart.series.assign(k + 1, {"", draw::Oklch{0.628, 0.2577, 29.23}});
    chart.panels[0].lines[0].series = k;
    const Picture picture = chart_picture(chart);
    std::vector<bool>& mark = marks.emplace_back();
    for (int row = 100; row < picture.height; ++row)
      for (int column = 0; column < picture.width; ++column) mark.push_back(is_red(picture.at(column, row)));
    for (std::size_t other = 0; other < k; ++other) EXPECT_NE(mark, marks[other]) << other << " and " << k;
  }
}

// What stands side by side by name has nothing between; what is no number is not drawn.
TEST(Chart, CategoriesAreNotJoinedAndWhatIsNoNumberIsLeftOut) {
  const auto joined = [](ChartAxis x, double middle) {
    Chart chart = chart_of({{0.0, 1.0}, {1.0, middle}, {2.0, 1.0}}, std::move(x));
    chart.panels[0].lines[0].joined = true;
    return Red(chart_picture(chart)).count;
  };
  ChartAxis names_of_three;
  names_of_three.names = {"a", "b", "c"};
  const int numbers = joined({}, 1.0), names = joined(names_of_three, 1.0), gap = joined({}, std::nan(""));
  EXPECT_GT(numbers, 3 * names);
  EXPECT_LT(gap, names);
}

// Who has the same values as another series is seen all the same: beside it where there is room, as a rim around it elsewhere.
TEST(Chart, CoincidentSeriesAreSeen) {
  const auto red_of = [](ChartAxis x, std::size_t others) {
    Chart chart = chart_of({{0.0, 1.0}, {1.0, 2.0}}, std::move(x));
    for (std::size_t k = 0; k < others; ++k) {
      chart.series.push_back({"other", draw::Oklch{0.4, 0.1, 265.0}});
      chart.panels[0].lines.push_back(chart.panels[0].lines[0]);
      chart.panels[0].lines.back().series = k + 1;
    }
    return Red(chart_picture(chart)).count;
  };
  ChartAxis names;
  names.names = {"a", "b"};
  EXPECT_EQ(red_of(names, 2), red_of(names, 0));
  for (const std::size_t others : {1U, 2U, 3U}) EXPECT_GT(red_of({}, others), red_of({}, 0) / 4) << others;
}

// A long note beside a long title would be written over it.
TEST(Chart, ANoteThatDoesNotFitBesideTheTitleStandsBelow) {
  Chart chart = chart_of({{1.0, 1.0}});
  const Picture bare = chart_picture(chart);
  chart.note = "short";
  EXPECT_EQ(chart_picture(chart).height, bare.height);
  chart.title = "Error against run time";
  const int titled = chart_picture(chart).height;
  chart.note = std::string(70, 'm');
  const Picture both = chart_picture(chart);
  EXPECT_GT(both.height, titled);
  chart.note = std::string(70, ' ');
  const Picture without = chart_picture(chart);
  for (int row = 0; row < 45; ++row)
    for (int column = 0; column < both.width; ++column)
      ASSERT_EQ(both.at(column, row), without.at(column, row)) << "ink over the title";
}

}  // namespace
}  // namespace brink::chart_test
