#pragma once
/// Numbers of two doubles each, side by side: a plane's vector, and two of them. What is done to all is done at once, where
/// registers hold as many doubles.

#include "brink/core/base/double_double.h"
#include "brink/core/base/wide.h"

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

/// Two such vectors, and in every operation the same bits as of these one by one. Where ranges are looked at, one by one is
/// how it is done.
template <class Product, bool looks = Product::kLooks>
class DoubleDoublePairs {
 public:
  using Pair = DoubleDoublePair<Product>;
  using Number = BasicDoubleDouble<Product>;

  BRINK_INLINE DoubleDoublePairs(const Pair& first, const Pair& second) : first_(first), second_(second) {}
  BRINK_INLINE Pair first() const { return first_; }
  BRINK_INLINE Pair second() const { return second_; }

  BRINK_INLINE friend DoubleDoublePairs operator+(const DoubleDoublePairs& a, const DoubleDoublePairs& b) {
    return {a.first_ + b.first_, a.second_ + b.second_};
  }
  /// Each vector plus one of doubles.
  BRINK_INLINE DoubleDoublePairs plus(double x, double y, double second_x, double second_y) const {
    return {first_.plus(x, y), second_.plus(second_x, second_y)};
  }
  /// Each vector times a number of its own.
  BRINK_INLINE DoubleDoublePairs times(const Number& first, const Number& second) const {
    return {first_ * first, second_ * second};
  }
  BRINK_INLINE DoubleDoublePairs times(double first, double second) const {
    return {first_ * first, second_ * second};
  }

 private:
  Pair first_, second_;
};

template <class Product>
class DoubleDoublePairs<Product, false> {
 public:
  using Pair = DoubleDoublePair<Product>;
  using Number = BasicDoubleDouble<Product>;

  BRINK_INLINE DoubleDoublePairs(const Pair& first, const Pair& second)
      : high_{first.x().high(), first.y().high(), second.x().high(), second.y().high()},
        low_{first.x().low(), first.y().low(), second.x().low(), second.y().low()} {}
  BRINK_INLINE Pair first() const { return {{high_[0], low_[0]}, {high_[1], low_[1]}}; }
  BRINK_INLINE Pair second() const { return {{high_[2], low_[2]}, {high_[3], low_[3]}}; }

  BRINK_INLINE friend DoubleDoublePairs operator+(const DoubleDoublePairs& a, const DoubleDoublePairs& b) {
    const DoubleDoublePairs highs = sum(a.high_, b.high_), lows = sum(a.low_, b.low_);
    const DoubleDoublePairs r = quick_sum(highs.high_, highs.low_ + lows.high_);
    return quick_sum(r.high_, lows.low_ + r.low_);
  }
  BRINK_INLINE DoubleDoublePairs plus(double x, double y, double second_x, double second_y) const {
    const DoubleDoublePairs r = sum(high_, Four{x, y, second_x, second_y});
    return quick_sum(r.high_, low_ + r.low_);
  }
  BRINK_INLINE DoubleDoublePairs times(const Number& first, const Number& second) const {
    const Four high{first.high(), first.high(), second.high(), second.high()},
        low{first.low(), first.low(), second.low(), second.low()};
    const DoubleDoublePairs p = product(high_, high);
    return quick_sum(p.high_, p.low_ + (high_ * low + low_ * high));
  }
  BRINK_INLINE DoubleDoublePairs times(double first, double second) const {
    const Four factor{first, first, second, second};
    const DoubleDoublePairs p = product(high_, factor);
    return quick_sum(p.high_, p.low_ + low_ * factor);
  }

 private:
  BRINK_INLINE DoubleDoublePairs(const Four& high, const Four& low) : high_(high), low_(low) {}

  BRINK_INLINE static DoubleDoublePairs quick_sum(const Four& a, const Four& b) {
    const Four sum = a + b;
    return {sum, b - (sum - a)};
  }
  BRINK_INLINE static DoubleDoublePairs sum(const Four& a, const Four& b) {
    const Four sum = a + b, of_b = sum - a;
    return {sum, (a - (sum - of_b)) + (b - of_b)};
  }
  BRINK_INLINE static DoubleDoublePairs product(const Four& a, const Four& b) {
    const error_free::Result r[] = {Product::product(a[0], b[0]), Product::product(a[1], b[1]),
                                    Product::product(a[2], b[2]), Product::product(a[3], b[3])};
    return {Four{r[0].high, r[1].high, r[2].high, r[3].high}, Four{r[0].low, r[1].low, r[2].low, r[3].low}};
  }

  Four high_, low_;
};

#undef BRINK_INLINE

}  // namespace brink
