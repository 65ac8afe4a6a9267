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

/// True if five values lie as far apart as that, or farther.
bool changes_by(double least, const Formula& f, int part, double begin, double width) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const int quarter : {0, 4, 2, 1, 3}) {  // those that are apart first: often they will do
    const double t = begin + 0.25 * quarter * width;
    const TimeBound b = f.time_bound(part, t, t, BoundOf::value);
    low = std::min(low, b.high);
    high = std::max(high, b.low);
    if (std::max(0.0, high - low) >= least) return true;
  }
  return false;
}

}  // namespace

bool SteadyFormula::is_steady(double begin, double width) const {
  const TimeBound bound = formula_->time_bound(part_, begin, begin + width, BoundOf::second);
  const double beside = bound.second * width * width / 8.0;
  if (beside <= kUnseen * size_) return true;
  return bound.spread() >= 0.5 * beside && changes_by(0.5 * beside, *formula_, part_, begin, width);
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
