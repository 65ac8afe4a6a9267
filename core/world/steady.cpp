/// How a cell is judged. Over a width w a function lies beside its chord by at most w^2 / 8 times a bound of
/// its second derivative, computed over the whole cell. That must be next to nothing beside its size, or no
/// more than twice what the function changes by in the cell: then points tried in it have seen the change. A
/// cell that fails is halved.
#include "brink/core/world/steady.h"

#include <algorithm>
#include <cmath>

namespace brink {

namespace {

constexpr double kWidest = 64.0, kNarrowest = 0x1p-30;  ///< cells [s]
constexpr double kUnseen = 1e-6;                        ///< of the size

/// The cell of that width that holds t begins here. Exact, as widths are powers of two.
double begin_of_cell(double t, double width) { return std::floor(t / width) * width; }

/// A bound of |f| over a cell; 0 where nothing is known, so that no change counts as unseen there.
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
    // Of a value only an interval is known. Two values differ for sure by what lies between their intervals.
    low = std::min(low, b.high);
    high = std::max(high, b.low);
    if (std::max(0.0, high - low) >= least) return true;
  }
  return false;
}

}  // namespace

bool SteadyFormula::Cell::holds(double t) const { return begin_of_cell(t, width) == begin; }

/// See above. The spread over the cell is no less than any change in it, and is known already: where it is
/// too small no value needs to be asked.
bool SteadyFormula::is_steady(double begin, double width) const {
  const TimeBound bound = formula_->time_bound(part_, begin, begin + width, BoundOf::second);
  const double beside = bound.second * width * width / 8.0;
  if (beside <= kUnseen * size_) return true;
  return bound.spread() >= 0.5 * beside && changes_by(0.5 * beside, *formula_, part_, begin, width);
}

/// The widest cell around t that may be steady: those that hold the cell of last time were not.
double SteadyFormula::width_to_try(double t, const Cell& last) {
  const double minute = begin_of_cell(t, kWidest);
  // The size is that of the widest cell around t: a part is small beside what it is in this minute.
  if (minute != minute_) {
    minute_ = minute;
    size_ = largest_value(*formula_, part_, minute, kWidest);
  }
  if (begin_of_cell(last.begin, kWidest) != minute) return kWidest;
  // Every wider cell that holds the last one has failed: it was tried on the way there, or holds a cell before
  // that for which the same is true. The smallest that holds t too is one of them, as t is not in the last.
  double common = last.width;
  while (begin_of_cell(t, common) != begin_of_cell(last.begin, common)) common *= 2.0;
  return 0.5 * common;
}

SteadyFormula::Cell SteadyFormula::find(double t, const Cell& last) {
  // At the least width a cell is taken as it is: around a jump none is steady.
  double width = width_to_try(t, last);
  while (width > kNarrowest && !is_steady(begin_of_cell(t, width), width)) width *= 0.5;
  return {begin_of_cell(t, width), width};
}

double SteadyFormula::until(double t) {
  if (!formula_->depends_on_time()) return std::numeric_limits<double>::infinity();
  if (!here_.holds(t)) {
    // The next cell was found as any is; time mostly goes on into it.
    here_ = next_.holds(t) ? next_ : find(t, here_);
    next_ = find(here_.end(), here_);
  }
  // Up to the end of both, unless the second is narrower: then steps are to end where the first does. Far
  // from t = 0 the narrowest cell may be lost in rounding, and the answer must still be later than t.
  const double end = next_.width < here_.width ? here_.end() : next_.end();
  return std::max(end, std::nextafter(t, std::numeric_limits<double>::infinity()));
}

}  // namespace brink
