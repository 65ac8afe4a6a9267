#pragma once
/// Taylor coefficients in time as intervals (Moore 1966): what a formula and its derivatives can be over a
/// while.

#include <array>
#include <span>

#include "brink/core/world/interval.h"

namespace brink {

/// Encloses f^(k) / k! over an interval of time, for k up to `order`. Where f may have a corner or a jump its
/// derivatives are unbounded; where it may have no value (sqrt of what may be negative), so is its value.
struct Taylor {
  static constexpr int kMostOrder = 11;
  int order = 0;
  std::array<Interval, kMostOrder + 1> c{};

  static Taylor constant(const Interval& value, int order);
  /// The time itself, in `range`.
  static Taylor time(const Interval& range, int order);
  const Interval& value() const { return c[0]; }
  bool is_constant() const;
};

Taylor operator-(const Taylor& a);
Taylor operator+(const Taylor& a, const Taylor& b);
Taylor operator-(const Taylor& a, const Taylor& b);
Taylor operator*(const Taylor& a, const Taylor& b);
Taylor operator/(const Taylor& a, const Taylor& b);

Taylor sqrt(const Taylor& a);
Taylor exp(const Taylor& a);
Taylor log(const Taylor& a);
Taylor sin(const Taylor& a);
Taylor cos(const Taylor& a);
Taylor tan(const Taylor& a);
Taylor asin(const Taylor& a);
Taylor acos(const Taylor& a);
Taylor atan(const Taylor& a);
Taylor atan2(const Taylor& y, const Taylor& x);
Taylor sinh(const Taylor& a);
Taylor cosh(const Taylor& a);
Taylor tanh(const Taylor& a);
Taylor asinh(const Taylor& a);
Taylor acosh(const Taylor& a);
Taylor atanh(const Taylor& a);
Taylor pow(const Taylor& a, const Taylor& b);
Taylor abs(const Taylor& a);
Taylor min(const Taylor& a, const Taylor& b);
Taylor max(const Taylor& a, const Taylor& b);
/// asin(sin(a)), the triangle wave: straight between its corners.
Taylor triangle(const Taylor& a);
/// floor(a + 1/2), as muParser's rint.
Taylor rint(const Taylor& a);
Taylor sign(const Taylor& a);
/// 1 where a < b, else 0; and so on.
Taylor less(const Taylor& a, const Taylor& b);
Taylor less_equal(const Taylor& a, const Taylor& b);
Taylor equal(const Taylor& a, const Taylor& b);
/// 1 where a is 0, else 0.
Taylor negation(const Taylor& a);
/// 1 where a is 0, 0 where |a| >= 1; between, either.
Taylor small(const Taylor& a);
/// `yes` where `condition` is not 0, else `no`.
Taylor choose(const Taylor& condition, const Taylor& yes, const Taylor& no);

}  // namespace brink
