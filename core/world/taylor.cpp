/// Taylor arithmetic on intervals. With f_k for f^(k) / k! every operation follows from the equation between
/// a result and its arguments, by comparing the coefficients of t^k:
///
///   product    r = a b         r_k = sum of a_j b_(k-j)
///   quotient   b r = a         r_k = (a_k - sum of b_j r_(k-j), j >= 1) / b_0
///   root       r r = a         r_k = (a_k - sum of r_j r_(k-j), 0 < j < k) / (2 r_0)
///   function   r' = g(t) a'    r_k = sum of j a_j g_(k-j) / k, where g is the series of the slope at a
///
/// The equations hold at each single time, so with intervals of the coefficients over a while they enclose
/// the coefficients at every time of it. An operation costs about the square of the order. Source: Moore
/// 1966, "Interval analysis".
#include "brink/core/world/taylor.h"

#include <algorithm>

namespace brink {

namespace {

namespace lib = boost::numeric;
using lib::interval_lib::pi;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Exactly 0: a coefficient that is known to vanish. Sums leave it out: outward rounding would make
/// [-tiny, tiny] of 0 + 0, and what is constant would not be known to be.
bool is_zero(const Interval& x) { return x.lower() == 0.0 && x.upper() == 0.0; }
bool is_point(const Interval& x) { return x.lower() == x.upper(); }

/// Boost's answer, or nothing known where it is empty.
Interval known(const Interval& x) { return lib::empty(x) ? Interval::whole() : x; }
/// The part of x within [low, high].
Interval within(const Interval& x, double low, double high) {
  return known(lib::intersect(known(x), Interval(low, high)));
}

/// True if x leaves [low, high], where a function has a value, by more than roundings do.
bool leaves(const Interval& x, double low, double high) {
  // Absolute, so meant for arguments of order 1 that come to the border by cancellation, as 1 - cos(t)^2
  // below a root. What is let through is cut back to [low, high] by within().
  constexpr double rounding = 1e-10;
  return x.lower() < low - rounding || x.upper() > high + rounding;
}

/// A value whose derivatives are not known.
Taylor rough(const Interval& value, int order) {
  Taylor r = Taylor::constant(known(value), order);
  std::fill(r.c.begin() + 1, r.c.begin() + order + 1, Interval::whole());
  return r;
}

/// A function that is constant piece by piece (floor, comparisons, signs): derivatives are 0 where the value is one
/// number, and unknown, as there may be a jump, where it is a range.
Taylor stepped(const Interval& value, int order) {
  return is_point(value) ? Taylor::constant(value, order) : rough(value, order);
}

/// sum of x_j y_(k-j) for j = from .. to.
Interval convolved(const Taylor& x, const Taylor& y, int k, int from, int to) {
  Interval sum(0.0);
  for (int j = from; j <= to; ++j)
    if (!is_zero(x.c[j]) && !is_zero(y.c[k - j])) sum += x.c[j] * y.c[k - j];
  return sum;
}

/// 1/k sum of j a_j g_(k-j), j = 1 .. k: coefficient k of what has the derivative g(t) a'(t).
Interval chained(const Taylor& a, const Taylor& g, int k) {
  Interval sum(0.0);
  for (int j = 1; j <= k; ++j)
    if (!is_zero(a.c[j]) && !is_zero(g.c[k - j])) sum += static_cast<double>(j) * a.c[j] * g.c[k - j];
  return is_zero(sum) ? sum : sum / static_cast<double>(k);
}

/// f(a) from its value and the series of f' at a.
Taylor from_slope(const Interval& value, const Taylor& a, const Taylor& slope) {
  Taylor r = Taylor::constant(known(value), a.order);
  for (int k = 1; k <= a.order; ++k) r.c[k] = chained(a, slope, k);
  return r;
}

Taylor number(double x, int order) { return Taylor::constant(Interval(x), order); }
Taylor square(const Taylor& a) {
  Taylor r = a * a;
  // The product takes its factors for independent: of [-1, 2] it makes [-2, 4], the square [0, 4].
  r.c[0] = lib::square(a.c[0]);
  return r;
}

/// Two series that need each other.
struct Pair {
  Taylor first, second;
};

/// Sine and cosine (sign -1), or their hyperbolic sisters (sign 1).
Pair waves(const Taylor& a, const Interval& s0, const Interval& c0, double sign) {
  Pair w{Taylor::constant(s0, a.order), Taylor::constant(c0, a.order)};
  for (int k = 1; k <= a.order; ++k) {
    w.first.c[k] = chained(a, w.second, k);
    w.second.c[k] = sign * chained(a, w.first, k);
  }
  return w;
}
/// Bounds rounded outward may leave [-1, 1], where no value lies.
Interval sine(const Interval& x) { return within(lib::sin(x), -1.0, 1.0); }
Interval cosine(const Interval& x) { return within(lib::cos(x), -1.0, 1.0); }
Pair circular(const Taylor& a) { return waves(a, sine(a.c[0]), cosine(a.c[0]), -1.0); }
Pair hyperbolic(const Taylor& a) {
  const auto& [low, high] = std::pair(a.c[0].lower(), a.c[0].upper());
  OutwardRounding to;
  // cosh is even, least at 0 and grows on either side of it; sinh grows everywhere: ends tell the ranges.
  const double least =
      low <= 0.0 && high >= 0.0 ? 1.0 : to.cosh_down(std::min(std::abs(low), std::abs(high)));
  const Interval cosine(std::max(1.0, least), to.cosh_up(std::max(std::abs(low), std::abs(high))));
  return waves(a, known({to.sinh_down(low), to.sinh_up(high)}), cosine, 1.0);
}

/// A whole exponent by repeated squaring; even powers are not negative.
Taylor whole_power(const Taylor& a, int n) {
  if (n < 0) return number(1.0, a.order) / whole_power(a, -n);
  Taylor r = number(1.0, a.order), factor = a;
  for (int left = n; left > 0; left /= 2) {
    if (left % 2 == 1) r = r * factor;
    if (left > 1) factor = square(factor);
  }
  // Repeated products forget that all factors are one: Boost's power of an interval does not.
  r.c[0] = known(lib::pow(a.c[0], n));
  return r;
}

/// A constant exponent, of a base that is not negative.
Taylor real_power(const Taylor& a, double p) {
  if (leaves(a.c[0], 0.0, kInfinity)) return rough(Interval::whole(), a.order);
  const Interval base = within(a.c[0], 0.0, kInfinity);
  // x^p only rises (p > 0) or only falls (p < 0) where x >= 0: its values lie between those at the ends.
  const auto at = [&](double x) { return x == 0.0 ? (p > 0.0 ? 0.0 : kInfinity) : std::pow(x, p); };
  OutwardRounding to;
  const double x = at(base.lower()), y = at(base.upper());
  const Interval value(std::max(0.0, to.far_below(std::min(x, y))), to.far_above(std::max(x, y)));
  // At 0 the recurrence would divide by 0; from some order on the derivatives of a power that is not whole
  // are infinite there.
  if (!(a.c[0].lower() > 0.0))
    return a.is_constant() ? Taylor::constant(value, a.order) : rough(value, a.order);
  Taylor r = Taylor::constant(value, a.order);
  for (int k = 1; k <= a.order; ++k) {
    // a r' = p a' r, so k a_0 r_k = sum of (p j - (k - j)) a_j r_(k-j) over j = 1 .. k.
    Interval sum(0.0);
    for (int j = 1; j <= k; ++j)
      if (!is_zero(a.c[j]))
        sum += (Interval(p) * static_cast<double>(j) - static_cast<double>(k - j)) * a.c[j] * r.c[k - j];
    r.c[k] = is_zero(sum) ? sum : sum / (static_cast<double>(k) * a.c[0]);
  }
  return r;
}

/// 0, 1, or both: of a condition that holds everywhere, nowhere, or may hold.
Interval truth(bool surely, bool possibly) { return {surely ? 1.0 : 0.0, possibly ? 1.0 : 0.0}; }

}  // namespace

Taylor Taylor::constant(const Interval& value, int order) {
  Taylor r;
  r.order = order;
  r.c[0] = value;
  return r;
}

Taylor Taylor::time(const Interval& range, int order) {
  Taylor r = constant(range, order);
  if (order >= 1) r.c[1] = Interval(1.0);
  return r;
}

bool Taylor::is_constant() const {
  return std::all_of(c.begin() + 1, c.begin() + order + 1, [](const Interval& x) { return is_zero(x); });
}

Taylor operator-(const Taylor& a) {
  Taylor r = a;
  for (int k = 0; k <= a.order; ++k) r.c[k] = -a.c[k];
  return r;
}

Taylor operator+(const Taylor& a, const Taylor& b) {
  Taylor r = a;
  for (int k = 0; k <= a.order; ++k) {
    // An exact 0 adds nothing, and the other summand keeps its bounds unrounded.
    if (is_zero(b.c[k])) continue;
    r.c[k] = is_zero(a.c[k]) ? b.c[k] : a.c[k] + b.c[k];
  }
  return r;
}

Taylor operator-(const Taylor& a, const Taylor& b) { return a + -b; }

Taylor operator*(const Taylor& a, const Taylor& b) {
  Taylor r = Taylor::constant(a.c[0] * b.c[0], a.order);
  for (int k = 1; k <= a.order; ++k) r.c[k] = convolved(a, b, k, 0, k);
  return r;
}

Taylor operator/(const Taylor& a, const Taylor& b) {
  // There may be a pole: neither the value nor any derivative is bounded.
  if (lib::zero_in(b.c[0])) return rough(Interval::whole(), a.order);
  Taylor r = Taylor::constant(a.c[0] / b.c[0], a.order);
  for (int k = 1; k <= a.order; ++k) {
    const Interval lower = convolved(b, r, k, 1, k);
    if (!is_zero(a.c[k]) || !is_zero(lower)) r.c[k] = (a.c[k] - lower) / b.c[0];
  }
  return r;
}

Taylor sqrt(const Taylor& a) {
  if (leaves(a.c[0], 0.0, kInfinity)) return rough(Interval::whole(), a.order);
  const Interval value = known(lib::sqrt(within(a.c[0], 0.0, kInfinity)));
  // The root is vertical at its foot.
  if (!(a.c[0].lower() > 0.0))
    return a.is_constant() ? Taylor::constant(value, a.order) : rough(value, a.order);
  Taylor r = Taylor::constant(value, a.order);
  for (int k = 1; k <= a.order; ++k) {
    const Interval lower = convolved(r, r, k, 1, k - 1);
    if (!is_zero(a.c[k]) || !is_zero(lower)) r.c[k] = (a.c[k] - lower) / (2.0 * r.c[0]);
  }
  return r;
}

Taylor exp(const Taylor& a) {
  // r' = r a'. Rounding outward must not make a bound of what is positive negative.
  const Interval value = lib::exp(a.c[0]);
  Taylor r = Taylor::constant(Interval(std::max(0.0, value.lower()), value.upper()), a.order);
  for (int k = 1; k <= a.order; ++k) r.c[k] = chained(a, r, k);
  return r;
}

Taylor log(const Taylor& a) {
  if (!(a.c[0].lower() > 0.0)) return rough(Interval::whole(), a.order);
  // log' = 1 / a.
  return from_slope(lib::log(a.c[0]), a, number(1.0, a.order) / a);
}

// the sister is needed for derivatives alone
Taylor sin(const Taylor& a) { return a.order == 0 ? Taylor::constant(sine(a.c[0]), 0) : circular(a).first; }
Taylor cos(const Taylor& a) {
  return a.order == 0 ? Taylor::constant(cosine(a.c[0]), 0) : circular(a).second;
}

Taylor tan(const Taylor& a) {
  const Pair w = circular(a);
  Taylor r = w.first / w.second;
  // Sine and cosine are independent to the quotient, whose range is too wide; both enclose the value.
  if (!lib::zero_in(w.second.c[0])) r.c[0] = known(lib::intersect(r.c[0], known(lib::tan(a.c[0]))));
  return r;
}

Taylor asin(const Taylor& a) {
  if (leaves(a.c[0], -1.0, 1.0)) return rough(Interval::whole(), a.order);
  const Interval value = lib::asin(within(a.c[0], -1.0, 1.0));
  // asin' = 1 / sqrt(1 - a^2), which is infinite at the ends: there the value alone is known.
  const Taylor room = number(1.0, a.order) - square(a);
  if (!(room.c[0].lower() > 0.0))
    return a.is_constant() ? Taylor::constant(known(value), a.order) : rough(value, a.order);
  return from_slope(value, a, number(1.0, a.order) / sqrt(room));
}

Taylor acos(const Taylor& a) {
  // acos = pi / 2 - asin: the derivatives are those of -asin, the value has a bound of its own.
  Taylor r = -asin(a);
  if (leaves(a.c[0], -1.0, 1.0)) return r;
  r.c[0] = known(lib::acos(within(a.c[0], -1.0, 1.0)));
  return r;
}

Taylor atan(const Taylor& a) {
  // atan' = 1 / (1 + a^2), without any pole.
  return from_slope(lib::atan(a.c[0]), a, number(1.0, a.order) / (number(1.0, a.order) + square(a)));
}

/// Smooth off the negative x axis, where it jumps.
Taylor atan2(const Taylor& y, const Taylor& x) {
  // By half planes, in each of which one quotient has no pole: x > 0, y > 0, y < 0. A box that lies in
  // none of them holds the origin or touches the negative x axis.
  const Interval half = pi<Interval>() / 2.0;
  if (x.c[0].lower() > 0.0) return atan(y / x);
  if (y.c[0].lower() > 0.0) return Taylor::constant(half, x.order) - atan(x / y);
  if (y.c[0].upper() < 0.0) return -Taylor::constant(half, x.order) - atan(x / y);
  const double most = pi<Interval>().upper();
  return rough(Interval(-most, most), x.order);
}

Taylor sinh(const Taylor& a) { return hyperbolic(a).first; }
Taylor cosh(const Taylor& a) { return hyperbolic(a).second; }

Taylor tanh(const Taylor& a) {
  // tanh' = 1 / cosh^2. It only rises, so the ends of the argument tell the range.
  const Pair w = hyperbolic(a);
  OutwardRounding to;
  return from_slope(within({to.tanh_down(a.c[0].lower()), to.tanh_up(a.c[0].upper())}, -1.0, 1.0), a,
                    number(1.0, a.order) / square(w.second));
}

Taylor asinh(const Taylor& a) {
  OutwardRounding to;
  // asinh' = 1 / sqrt(1 + a^2).
  const Interval value(to.asinh_down(a.c[0].lower()), to.asinh_up(a.c[0].upper()));
  return from_slope(value, a, number(1.0, a.order) / sqrt(number(1.0, a.order) + square(a)));
}

Taylor acosh(const Taylor& a) {
  if (leaves(a.c[0], 1.0, kInfinity)) return rough(Interval::whole(), a.order);
  const Interval x = within(a.c[0], 1.0, kInfinity);
  OutwardRounding to;
  const Interval value(std::max(0.0, to.acosh_down(x.lower())), to.acosh_up(x.upper()));
  // acosh' = 1 / sqrt(a^2 - 1), which is infinite at 1.
  if (!(a.c[0].lower() > 1.0))
    return a.is_constant() ? Taylor::constant(value, a.order) : rough(value, a.order);
  return from_slope(value, a, number(1.0, a.order) / sqrt(square(a) - number(1.0, a.order)));
}

Taylor atanh(const Taylor& a) {
  // atanh' = 1 / (1 - a^2); at the ends the value itself is infinite.
  if (!(a.c[0].lower() > -1.0 && a.c[0].upper() < 1.0)) return rough(Interval::whole(), a.order);
  OutwardRounding to;
  const Interval value(to.atanh_down(a.c[0].lower()), to.atanh_up(a.c[0].upper()));
  return from_slope(value, a, number(1.0, a.order) / (number(1.0, a.order) - square(a)));
}

Taylor pow(const Taylor& a, const Taylor& b) {
  // Whole exponents allow negative bases. Larger ones are taken as real numbers, of bases >= 0.
  constexpr double largest_whole = 1024.0;
  if (!b.is_constant() || !is_point(b.c[0])) {
    // of a negative base only whole exponents have a value, and they may be met
    if (leaves(a.c[0], 0.0, kInfinity)) return rough(Interval::whole(), a.order);
    return exp(b * log(a));
  }
  const double p = b.c[0].lower();
  if (p == std::floor(p) && std::abs(p) <= largest_whole) return whole_power(a, static_cast<int>(p));
  return real_power(a, p);
}

/// abs, min and max are one of their branches, derivatives and all, where the interval decides which. Where
/// it does not there may be a corner, and only the range of the value is known.
Taylor abs(const Taylor& a) {
  if (a.c[0].lower() >= 0.0) return a;
  if (a.c[0].upper() <= 0.0) return -a;
  return rough(lib::abs(a.c[0]), a.order);
}

Taylor min(const Taylor& a, const Taylor& b) {
  if (a.c[0].upper() <= b.c[0].lower()) return a;
  if (b.c[0].upper() <= a.c[0].lower()) return b;
  return rough(lib::min(a.c[0], b.c[0]), a.order);
}

Taylor max(const Taylor& a, const Taylor& b) { return -min(-a, -b); }

Taylor triangle(const Taylor& a) {
  const Interval half = pi<Interval>() / 2.0;
  // which straight piece: the n-th goes through n pi, up where n is even
  const Interval piece = a.c[0] / pi<Interval>() + Interval(0.5);
  const double n = std::floor(piece.lower());
  // So far out doubles hardly tell one piece from the next.
  if (!(std::abs(n) < 1e15)) return rough(Interval(-half.upper(), half.upper()), a.order);
  const Taylor rising = a - Taylor::constant(n * pi<Interval>(), a.order);
  const Taylor first = std::fmod(n, 2.0) == 0.0 ? rising : -rising;
  if (std::floor(piece.upper()) == n) return first;
  if (std::floor(piece.upper()) > n + 1.0) return rough(Interval(-half.upper(), half.upper()), a.order);
  // one corner: from the lesser end up to the peak there, or from the peak down
  const double peak = std::fmod(n, 2.0) == 0.0 ? half.upper() : -half.upper();
  // Behind the corner the wave is its own mirror image at the peak, 2 peak - first.
  const Interval reflected = Interval(2.0) * Interval(peak) - first.c[0];
  const Interval both = lib::hull(first.c[0], reflected);
  return rough(within(both, -half.upper(), half.upper()), a.order);
}

Taylor rint(const Taylor& a) {
  // floor never falls, so that the floors of the ends bound it; likewise the sign.
  const Interval x = a.c[0] + Interval(0.5);
  return stepped(Interval(std::floor(x.lower()), std::floor(x.upper())), a.order);
}

Taylor sign(const Taylor& a) {
  const auto of = [](double x) { return x < 0.0 ? -1.0 : (x > 0.0 ? 1.0 : 0.0); };
  return stepped(Interval(of(a.c[0].lower()), of(a.c[0].upper())), a.order);
}

/// Comparisons of intervals: [1, 1] where every value of the one compares so with every value of the other,
/// [0, 0] where none does, else [0, 1].
Taylor less(const Taylor& a, const Taylor& b) {
  return stepped(truth(a.c[0].upper() < b.c[0].lower(), a.c[0].lower() < b.c[0].upper()), a.order);
}
Taylor less_equal(const Taylor& a, const Taylor& b) {
  return stepped(truth(a.c[0].upper() <= b.c[0].lower(), a.c[0].lower() <= b.c[0].upper()), a.order);
}
Taylor equal(const Taylor& a, const Taylor& b) {
  // Two ranges are equal for sure only where each is one number.
  const bool surely = is_point(a.c[0]) && is_point(b.c[0]) && a.c[0].lower() == b.c[0].lower();
  return stepped(truth(surely, lib::overlap(a.c[0], b.c[0])), a.order);
}
Taylor negation(const Taylor& a) { return stepped(truth(is_zero(a.c[0]), lib::zero_in(a.c[0])), a.order); }

Taylor small(const Taylor& a) {
  const Interval size = lib::abs(a.c[0]);
  return stepped(truth(is_zero(a.c[0]), size.lower() < 1.0), a.order);
}

Taylor choose(const Taylor& condition, const Taylor& yes, const Taylor& no) {
  if (is_zero(condition.c[0])) return no;
  if (!lib::zero_in(condition.c[0])) return yes;
  // It may change from one to the other at any time in here, with a jump.
  return rough(lib::hull(yes.c[0], no.c[0]), yes.order);
}

}  // namespace brink
