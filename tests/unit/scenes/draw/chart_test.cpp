// Charts: where marks fall, and what ticks say.
#include "brink/scenes/draw/chart.h"

#include <gtest/gtest.h>

namespace brink {
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

TEST(Chart, PowersArePrintedRaised) {
  EXPECT_EQ(power_text(-12), "10\u207b\u00b9\u00b2");
  EXPECT_EQ(power_text(3), "10\u00b3");
}

}  // namespace
}  // namespace brink
