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

bool SteadyFormula::Cell::holds(double t) const { return begin_of_cell(t, width) == begin; }

bool SteadyFormula::is_steady(double begin, double width) const {
  const TimeBound bound = formula_->time_bound(part_, begin, begin + width, BoundOf::second);
  const double beside = bound.second * width * width / 8.0;
  if (beside <= kUnseen * size_) return true;
  return bound.spread() >= 0.5 * beside && changes_by(0.5 * beside, *formula_, part_, begin, width);
}

/// The widest cell around t that may be steady: those that hold the cell of last time were not.
double SteadyFormula::width_to_try(double t, const Cell& last) {
  const double minute = begin_of_cell(t, kWidest);
  if (minute != minute_) {
    minute_ = minute;
    size_ = largest_value(*formula_, part_, minute, kWidest);
  }
  if (begin_of_cell(last.begin, kWidest) != minute) return kWidest;
  double common = last.width;
  while (begin_of_cell(t, common) != begin_of_cell(last.begin, common)) common *= 2.0;
  return 0.5 * common;
}

SteadyFormula::Cell SteadyFormula::find(double t, const Cell& last) {
  double width = width_to_try(t, last);
  while (width > kNarrowest && !is_steady(begin_of_cell(t, width), width)) width *= 0.5;
  return {begin_of_cell(t, width), width};
}

double SteadyFormula::until(double t) {
  if (!formula_->depends_on_time()) return std::numeric_limits<double>::infinity();
  if (!here_.holds(t)) {
    here_ = next_.holds(t) ? next_ : find(t, here_);
    next_ = find(here_.end(), here_);
  }
  const double end = next_.width < here_.width ? here_.end() : next_.end();
  return std::max(end, std::nextafter(t, std::numeric_limits<double>::infinity()));
}

}  // namespace brink
