#include "brink/core/world/steady.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

constexpr double kWidest = 64.0, kNarrowest = 0x1p-30;  ///< cells [s]
constexpr double kUnseen = 1e-6;                        ///< of the size

/// Largest value in the cell of the widest grid; 0 where there is none.
double size_around(const Formula& f, int part, double t) {
  const double begin = std::floor(t / kWidest) * kWidest;
  const TimeBound b = f.time_bound(part, begin, begin + kWidest, false);
  const double size = std::max(std::abs(b.low), std::abs(b.high));
  return std::isfinite(size) ? size : 0.0;
}

/// Between the least and the largest of five values.
double change(const Formula& f, int part, double begin, double width) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int i = 0; i <= 4; ++i) {
    const double t = begin + 0.25 * i * width;
    const TimeBound b = f.time_bound(part, t, t, false);
    low = std::min(low, b.high);
    high = std::max(high, b.low);
  }
  return std::max(0.0, high - low);
}

bool is_steady(const Formula& f, int part, double begin, double width, double size) {
  const double beside = f.time_bound(part, begin, begin + width).second * width * width / 8.0;
  return beside <= kUnseen * size || beside <= 2.0 * change(f, part, begin, width);
}

}  // namespace

double steady_until(const Formula& formula, int part, double t) {
  if (!formula.depends_on_time()) return std::numeric_limits<double>::infinity();
  const double size = size_around(formula, part, t);
  double width = kWidest;
  const auto begin = [&] { return std::floor(t / width) * width; };
  while (width > kNarrowest && !is_steady(formula, part, begin(), width, size)) width *= 0.5;
  return std::max(begin() + width, std::nextafter(t, std::numeric_limits<double>::infinity()));
}

}  // namespace brink
