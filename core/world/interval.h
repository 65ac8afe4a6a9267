#pragma once
/// Intervals of real numbers: Boost.Interval with bounds that are rounded outward by the next double.

#include <bit>
#include <boost/numeric/interval.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace brink {

/// Rounds every bound one double outward, and those of functions of the C library (right to two) by four. The
/// processor's rounding mode stays as it is, so that a compiler may reorder what it likes. What is not a
/// number becomes unbounded.
struct OutwardRounding {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static double below(double x) { return -above(-x); }
  /// The next double above x, in line: the library's own takes a tenth of all that a formula's bounds cost.
  static double above(double x) {
    if (!(x < kInfinity)) return kInfinity;
    if (x == 0.0) return std::numeric_limits<double>::denorm_min();
    return std::bit_cast<double>(std::bit_cast<std::int64_t>(x) + (x > 0.0 ? 1 : -1));
  }
  static double far_below(double x) { return below(below(below(below(x)))); }
  static double far_above(double x) { return above(above(above(above(x)))); }

  using unprotected_rounding = OutwardRounding;
  void init() {}

  double add_down(double x, double y) { return below(x + y); }
  double add_up(double x, double y) { return above(x + y); }
  double sub_down(double x, double y) { return below(x - y); }
  double sub_up(double x, double y) { return above(x - y); }
  double mul_down(double x, double y) { return x == 0.0 || y == 0.0 ? 0.0 : below(x * y); }
  double mul_up(double x, double y) { return x == 0.0 || y == 0.0 ? 0.0 : above(x * y); }
  double div_down(double x, double y) { return x == 0.0 ? 0.0 : below(x / y); }
  double div_up(double x, double y) { return x == 0.0 ? 0.0 : above(x / y); }
  double sqrt_down(double x) { return x == 0.0 ? 0.0 : below(std::sqrt(x)); }
  double sqrt_up(double x) { return x == 0.0 ? 0.0 : above(std::sqrt(x)); }
  double median(double x, double y) { return 0.5 * x + 0.5 * y; }
  double int_down(double x) { return std::floor(x); }
  double int_up(double x) { return std::ceil(x); }
  template <class T>
  double conv_down(T x) {
    return static_cast<double>(x);
  }
  template <class T>
  double conv_up(T x) {
    return static_cast<double>(x);
  }

#define BRINK_ROUNDED(name)                                        \
  double name##_down(double x) { return far_below(std::name(x)); } \
  double name##_up(double x) { return far_above(std::name(x)); }
  BRINK_ROUNDED(exp)
  BRINK_ROUNDED(log)
  BRINK_ROUNDED(sin)
  BRINK_ROUNDED(cos)
  BRINK_ROUNDED(tan)
  BRINK_ROUNDED(asin)
  BRINK_ROUNDED(acos)
  BRINK_ROUNDED(atan)
  BRINK_ROUNDED(sinh)
  BRINK_ROUNDED(cosh)
  BRINK_ROUNDED(tanh)
  BRINK_ROUNDED(asinh)
  BRINK_ROUNDED(acosh)
  BRINK_ROUNDED(atanh)
#undef BRINK_ROUNDED
};

using Interval = boost::numeric::interval<
    double, boost::numeric::interval_lib::policies<OutwardRounding,
                                                   boost::numeric::interval_lib::checking_base<double>>>;

}  // namespace brink
