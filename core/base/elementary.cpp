#include "brink/core/base/elementary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "brink/core/base/sine_cosine.h"

namespace brink {

namespace {

/// ln 2 in two doubles and a rest; so many times the first, short one are exact as have 21 bits.
constexpr double kLog2[] = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56, 0x1.7b57a079a1934p-111};
constexpr double kShortLog2[] = {0x1.62e42ffp-1, -0x1.718432a1b0e26p-35};
constexpr double kDoublingsOfOne = 0x1.71547652b82fep+0;  ///< 1 / ln 2

/// 1 / n! for n from 0.
template <class Number, int count>
constexpr std::array<Number, count> inverse_factorials() {
  std::array<Number, count> of{};
  of[0] = 1.0;
  for (int n = 1; n < count; ++n) of[n] = of[n - 1] / static_cast<double>(n);
  return of;
}

/// x 2^k, where 2^k alone may be beyond a double.
double scaled(double x, int k) { return std::ldexp(x, k); }

}  // namespace

/// 2^k e^r with |r| <= ln 2 / 2, of which the Taylor series is taken.
double exponential(double x) {
  if (!(std::abs(x) < 745.2)) return std::exp(x);  // 0, infinity or NaN
  constexpr auto kTerms = inverse_factorials<double, 15>();
  const double k = std::nearbyint(x * kDoublingsOfOne);
  const error_free::Result r = error_free::sum(x - k * kShortLog2[0], -k * kShortLog2[1]);
  double rest = kTerms.back();
  for (int n = static_cast<int>(kTerms.size()) - 2; n >= 2; --n) rest = rest * r.high + kTerms[n];
  // 1 + (high + (low + high^2 (1/2 + ...))): what is small first
  return scaled(1.0 + (r.high + (r.low + r.high * r.high * rest)), static_cast<int>(k));
}

/// e^r - 1 of a 64th of what is left of x after whole doublings, by its Taylor series; then doubled six times:
/// e^(2 r) - 1 = p (p + 2) with p = e^r - 1.
DoubleDouble exponential(const DoubleDouble& x) {
  constexpr auto kTerms = inverse_factorials<DoubleDouble, 13>();
  const double k = std::nearbyint(x.high() * kDoublingsOfOne);
  DoubleDouble r = x;
  for (const double part : kLog2) r -= DoubleDouble::product(k, part);
  r = DoubleDouble(r.high() / 64.0, r.low() / 64.0);
  DoubleDouble p = kTerms.back();
  for (int n = static_cast<int>(kTerms.size()) - 2; n >= 1; --n) p = p * r + kTerms[n];
  p *= r;
  for (int doubling = 0; doubling < 6; ++doubling) p *= p + 2.0;
  const DoubleDouble e = p + 1.0;
  return {scaled(e.high(), static_cast<int>(k)), scaled(e.low(), static_cast<int>(k))};
}

/// ln x = k ln 2 + ln m with m near 1; y of the library, then y + (m e^-y - 1), which is right to the third order of
/// what y was wrong by.
DoubleDouble logarithm_in_two(double x) {
  int k = 0;
  double m = std::frexp(x, &k);
  if (m < 0.70710678) {
    m *= 2.0;
    --k;
  }
  const double first = std::log(m);
  const DoubleDouble off = m * exponential(DoubleDouble(-first)) - 1.0;
  DoubleDouble sum = (off - 0.5 * off.high() * off.high()) + first;
  if (k != 0)
    for (int part = 2; part >= 0; --part) sum += DoubleDouble::product(k, kLog2[part]);
  return sum;
}

double logarithm(double x) {
  if (!(x > 0.0) || !std::isfinite(x)) return std::log(x);
  return logarithm_in_two(x).high();
}

double power(double x, double y) {
  if (y == 0.0) return 1.0;
  if (y == 1.0) return x;
  if (y == -1.0) return 1.0 / x;
  if (y == 2.0) return x * x;
  if (y == -2.0) return 1.0 / (x * x);
  if (y == 3.0) return x * x * x;
  if (y == 4.0) return (x * x) * (x * x);
  // 0, infinity, NaN, and roots of negative numbers
  if (x == 0.0 || !std::isfinite(x) || !std::isfinite(y) || (x < 0.0 && y != std::nearbyint(y)))
    return std::pow(x, y);
  const DoubleDouble exponent = logarithm_in_two(std::abs(x)) * y;
  const double size = exponent.high() > 709.0    ? std::exp(exponent.high())
                      : exponent.high() < -700.0 ? exponential(exponent.high())
                                                 : exponential(exponent).high();
  const bool odd = std::abs(y) < 0x1p53 && std::fmod(y, 2.0) != 0.0;
  return x < 0.0 && odd ? -size : size;
}

/// The library's angle, turned on by what is left of (x, y) beside it.
double angle_of(double y, double x) {
  const double first = std::atan2(y, x), size = std::max(std::abs(x), std::abs(y));
  if (first == 0.0 || !(size > 0.0) || !std::isfinite(size)) return first;
  int k = 0;
  std::frexp(size, &k);
  const double u = std::ldexp(x, -k), v = std::ldexp(y, -k);
  const SineCosine<DoubleDouble> at = sine_cosine(DoubleDouble(first));
  const DoubleDouble beside = at.cosine * v - at.sine * u, along = at.cosine * u + at.sine * v;
  return (beside / along + first).high();
}

double arc_cosine(double x) {
  if (!(std::abs(x) <= 1.0)) return std::acos(x);
  const DoubleDouble square = DoubleDouble::sum(1.0, x) * DoubleDouble::sum(1.0, -x);
  return angle_of(sqrt(square).high(), x);
}

}  // namespace brink
