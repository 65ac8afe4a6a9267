#include "brink/core/world/steady.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

constexpr double kWidest = 64.0, kNarrowest = 0x1p-30;  ///< cells [s]
constexpr double kUnseen = 1e-6;                        ///< of the size

double begin_of_cell(double t, double width) { return std::floor(t / width) * width; }

double largest_value(const Formula& f, int part, double begin, double width) {
  const TimeBound b = f.time_bound(part, begin, begin + width, BoundOf::value);
  const double size = std::max(std::abs(b.low), std::abs(b.high));
  return std::isfinite(size) ? size : 0.0;
}

/// Between the least and the largest of five values.
double change(const Formula& f, int part, double begin, double width) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int i = 0; i <= 4; ++i) {
    const double t = begin + 0.25 * i * width;
    const TimeBound b = f.time_bound(part, t, t, BoundOf::value);
    low = std::min(low, b.high);
    high = std::max(high, b.low);
  }
  return std::max(0.0, high - low);
}

}  // namespace

bool SteadyFormula::is_steady(double begin, double width) const {
  const double second = formula_->time_bound(part_, begin, begin + width, BoundOf::second).second;
  const double beside = second * width * width / 8.0;
  return beside <= kUnseen * size_ || beside <= 2.0 * change(*formula_, part_, begin, width);
}

/// The widest cell around t that may be steady: those that hold the cell of last time were not.
double SteadyFormula::width_to_try(double t) {
  const double minute = begin_of_cell(t, kWidest);
  if (minute != minute_) {
    minute_ = minute;
    size_ = largest_value(*formula_, part_, minute, kWidest);
    return kWidest;
  }
  double common = width_;
  while (begin_of_cell(t, common) != begin_of_cell(begin_, common)) common *= 2.0;
  return 0.5 * common;
}

double SteadyFormula::until(double t) {
  if (!formula_->depends_on_time()) return std::numeric_limits<double>::infinity();
  const bool same = begin_of_cell(t, kWidest) == minute_ && begin_of_cell(t, width_) == begin_;
  if (!same) {
    width_ = width_to_try(t);
    while (width_ > kNarrowest && !is_steady(begin_of_cell(t, width_), width_)) width_ *= 0.5;
    begin_ = begin_of_cell(t, width_);
  }
  return std::max(begin_ + width_, std::nextafter(t, std::numeric_limits<double>::infinity()));
}

}  // namespace brink
