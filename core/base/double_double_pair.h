#pragma once
/// Two numbers of two doubles each, side by side: what is done to both is done at once, where registers hold two doubles.

#include "brink/core/base/double_double.h"

namespace brink {

#define BRINK_INLINE [[gnu::always_inline]] inline

/// A plane's vector of two BasicDoubleDouble, and in every operation the same bits as of these one by one: where their
/// ranges are left, one by one is how it is done.
template <class Product>
class DoubleDoublePair {
 public:
  using Number = BasicDoubleDouble<Product>;

  BRINK_INLINE DoubleDoublePair(const Number& x, const Number& y)
      : high_{x.high(), y.high()}, low_{x.low(), y.low()} {}

  BRINK_INLINE Number x() const { return {high_[0], low_[0]}; }
  BRINK_INLINE Number y() const { return {high_[1], low_[1]}; }

  BRINK_INLINE DoubleDoublePair operator-() const { return {-high_, -low_}; }
  BRINK_INLINE friend DoubleDoublePair operator-(const DoubleDoublePair& a, const DoubleDoublePair& b) {
    return a + -b;
  }
  BRINK_INLINE friend DoubleDoublePair operator+(const DoubleDoublePair& a, const DoubleDoublePair& b) {
    const Result highs = sum(a.high_, b.high_), lows = sum(a.low_, b.low_);
    const Result r = quick_sum(highs.high, highs.low + lows.high);
    const DoubleDoublePair both = quick_sum(r.high, lows.low + r.low);
    if (Number::kLooks && !all(finite(both.low_))) [[unlikely]]
      return one_by_one(a, b, [](const Number& u, const Number& v) { return u + v; });
    return both;
  }
  /// Each coordinate plus a double of its own.
  BRINK_INLINE DoubleDoublePair plus(double of_x, double of_y) const {
    const Result r = sum(high_, Two{of_x, of_y});
    const DoubleDoublePair both = quick_sum(r.high, low_ + r.low);
    if (Number::kLooks && !all(finite(both.low_))) [[unlikely]]
      return one_by_one(*this, {of_x, of_y}, [](const Number& u, const Number& v) { return u + v.high(); });
    return both;
  }
  BRINK_INLINE friend DoubleDoublePair operator*(const DoubleDoublePair& a, double by) {
    const Two factor{by, by};
    const Result p = product(a.high_, factor);
    const DoubleDoublePair both = quick_sum(p.high, p.low + a.low_ * factor);
    if (Number::kLooks && !all(in_range(p.high) & finite(both.low_))) [[unlikely]]
      return one_by_one(a, {by, by}, [](const Number& u, const Number& v) { return u * v.high(); });
    return both;
  }
  BRINK_INLINE friend DoubleDoublePair operator*(const DoubleDoublePair& a, const Number& by) {
    return a.times({by, by});
  }
  BRINK_INLINE Number dot(const DoubleDoublePair& b) const {
    const DoubleDoublePair both = times(b);
    return both.x() + both.y();
  }
  /// True if both coordinates' sizes lie between these two.
  BRINK_INLINE bool lies_between(double least, double most) const {
    const Two size = sizes(high_);
    return all((size >= Two{least, least}) & (size <= Two{most, most}));
  }
  /// Sizes of both coordinates.
  BRINK_INLINE double size() const { return std::abs(high_[0]) + std::abs(high_[1]); }

 private:
  using Two = double __attribute__((vector_size(16)));
  using Mask = decltype(Two{} < Two{});
  struct Result {
    Two high, low;
  };

  BRINK_INLINE DoubleDoublePair(Two high, Two low) : high_(high), low_(low) {}
  BRINK_INLINE DoubleDoublePair(const Result& r) : high_(r.high), low_(r.low) {}  // NOLINT: the same

  /// Coordinate by coordinate.
  BRINK_INLINE DoubleDoublePair times(const DoubleDoublePair& b) const {
    const Result p = product(high_, b.high_);
    const DoubleDoublePair both = quick_sum(p.high, p.low + (high_ * b.low_ + low_ * b.high_));
    if (Number::kLooks && !all(in_range(p.high) & finite(both.low_))) [[unlikely]]
      return one_by_one(*this, b, [](const Number& u, const Number& v) { return u * v; });
    return both;
  }

  /// Out of the way: inlined, it would be made ready for before it is known that it is needed.
  template <class Operation>
  [[gnu::noinline, gnu::cold]] static DoubleDoublePair one_by_one(DoubleDoublePair a, DoubleDoublePair b,
                                                                  Operation operation) {
    return {operation(a.x(), b.x()), operation(a.y(), b.y())};
  }

  // as error_free's and BasicDoubleDouble's own
  BRINK_INLINE static Result quick_sum(Two a, Two b) {
    const Two sum = a + b;
    return {sum, b - (sum - a)};
  }
  BRINK_INLINE static Result sum(Two a, Two b) {
    const Two sum = a + b, of_b = sum - a;
    return {sum, (a - (sum - of_b)) + (b - of_b)};
  }
  BRINK_INLINE static Result product(Two a, Two b) {
    const error_free::Result x = Product::product(a[0], b[0]), y = Product::product(a[1], b[1]);
    return {Two{x.high, y.high}, Two{x.low, y.low}};
  }
  BRINK_INLINE static Two sizes(Two x) { return Two{__builtin_fabs(x[0]), __builtin_fabs(x[1])}; }
  BRINK_INLINE static Mask finite(Two x) { return x - x == Two{}; }
  BRINK_INLINE static Mask in_range(Two x) {
    const Two size = sizes(x);
    return (size >= Number::kLeast) & (size <= Number::kMost);
  }
  BRINK_INLINE static bool all(Mask m) { return (m[0] & m[1]) != 0; }

  Two high_, low_;
};

#undef BRINK_INLINE

}  // namespace brink
