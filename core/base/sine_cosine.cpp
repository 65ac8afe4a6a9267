/// An angle is a number of quarters of a turn, a multiple of 1/64 and a rest: sines and cosines of the multiples are in a
/// table, of the rest a few terms of the Taylor series are enough, and the sum is put together by the addition
/// theorems (Gal & Bachelis, "An accurate elementary mathematical library", ACM TOMS 17(1), 1991).
#include "brink/core/base/sine_cosine.h"

#include <array>
#include <cmath>
#include <cstdint>

#include "brink/core/base/sine_cosine_pair.h"

namespace brink {

namespace {

/// A quarter of a turn, pi / 2, in four doubles; and in three, of which so many times the first two are exact as
/// have 20 bits (Cody & Waite 1980).
constexpr double kQuarter[] = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54, -0x1.f1976b7ed8fbcp-110,
                               0x1.4cf98e804177dp-164};
constexpr double kShortQuarter[] = {0x1.921fb544p+0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
constexpr double kQuartersOfOne = 0x1.45f306dc9c883p-1;  ///< 2 / pi
constexpr double kFewQuarters = 0x1p20, kMostRadians = 0x1p45;

/// The nearest integer, to even in the middle. @pre |x| < 2^51.
double nearest_integer(double x) {
  constexpr double bias = 0x1.8p52;  // the last place of what is as large is 1
  return (x + bias) - bias;
}

/// The quarters that are taken off an angle, and what is left of it: an eighth of a turn and a rounding at most.
struct Reduced {
  double quarters;
  DoubleDouble rest;
};

/// @pre |angle| < kFewQuarters.
Reduced reduced(double angle) {
  const double n = nearest_integer(angle * kQuartersOfOne);
  // the first difference is exact, as its two numbers are within a factor of two of each other (Sterbenz 1974)
  const error_free::Result r = error_free::sum(angle - n * kShortQuarter[0], -n * kShortQuarter[1]);
  const error_free::Result rest = error_free::quick_sum(r.high, r.low - n * kShortQuarter[2]);
  return {n, {rest.high, rest.low}};
}

/// The angle less so many quarters of a turn.
DoubleDouble less_quarters(const DoubleDouble& angle, double quarters) {
  DoubleDouble rest = angle;
  for (const double part : kQuarter) rest -= DoubleDouble::product(quarters, part);
  return rest;
}

/// @pre |angle| < kMostRadians.
Reduced reduced(const DoubleDouble& angle) {
  const double n = std::nearbyint(angle.high() * kQuartersOfOne);
  return {n, less_quarters(angle, n)};
}

constexpr int kSteps = 64;  ///< of the table in a radian
constexpr int kLast = 51;   ///< pi / 4 = 50.3 / 64
using Table = std::array<SineCosine<DoubleDouble>, 2 * kLast + 1>;

/// By their Taylor series at k / 64, k from -51 to 51.
constexpr Table make_table() {
  Table table{};
  for (int k = 0; k <= kLast; ++k) {
    const DoubleDouble x = DoubleDouble(k) / kSteps;
    DoubleDouble term = 1.0, sums[] = {0.0, 0.0};
    for (int n = 0; n < 32; ++n) {
      sums[n % 2] += n % 4 < 2 ? term : -term;
      term = term * x / (n + 1.0);
    }
    table[kLast + k] = {sums[1], sums[0]};
    table[kLast - k] = {-sums[1], sums[0]};
  }
  return table;
}
constexpr Table kTable = make_table();

/// The entry of the table that is nearest to an angle within an eighth of a turn, and what is left of the angle.
struct Entry {
  const SineCosine<DoubleDouble>& at;
  double angle;
};
std::size_t place_in_table(double k) { return static_cast<std::size_t>(static_cast<int>(k) + kLast); }
Entry entry_of(double angle) {
  const double k = nearest_integer(angle * kSteps);
  return {kTable[place_in_table(k)], k / kSteps};
}

/// Of the angle so many quarters of a turn further on. Without a branch: of what turns, nobody can tell which it is.
template <class Number>
SineCosine<Number> turned(const SineCosine<Number>& of, double quarters) {
  // in two's complement the lowest bits tell the quadrant of negative numbers too
  const auto quadrant = static_cast<long long>(quarters);
  const bool across = quadrant & 1;
  const Number s = across ? of.cosine : of.sine, c = across ? of.sine : of.cosine;
  return {quadrant & 2 ? -s : s, (quadrant + 1) & 2 ? -c : c};
}

/// Of what is left within an eighth of a turn, rounded to doubles.
SineCosine<double> in_double(const DoubleDouble& angle) {
  const Entry entry = entry_of(angle.high());
  const double d = (angle.high() - entry.angle) + angle.low(), d2 = d * d;
  const double sine = d + d * d2 * (-1.0 / 6 + d2 * (1.0 / 120 - d2 / 5040));
  const double less = d2 * (-0.5 + d2 * (1.0 / 24 - d2 / 720));  // cosine - 1
  const DoubleDouble &s = entry.at.sine, &c = entry.at.cosine;
  return {s.high() + (s.low() + (s.high() * less + c.high() * sine)),
          c.high() + (c.low() + (c.high() * less - s.high() * sine))};
}

using Two = double __attribute__((vector_size(16), aligned(alignof(double)), may_alias));
using TwoBits = std::int64_t __attribute__((vector_size(16)));

/// reduced(), in_double() and turned() of two angles: the same operations in the same order.
void turned_in_double(Two angle, SineCosinePair& found) {
  constexpr double bias = 0x1.8p52;
  const Two n = (angle * kQuartersOfOne + bias) - bias;
  const Two first = angle - n * kShortQuarter[0], second = -n * kShortQuarter[1];
  const Two sum = first + second, of_second = sum - first;
  const Two third = ((first - (sum - of_second)) + (second - of_second)) - n * kShortQuarter[2];
  const Two high = sum + third, low = third - (high - sum);
  const Two k = (high * kSteps + bias) - bias;
  const SineCosine<DoubleDouble>&a = kTable[place_in_table(k[0])], &b = kTable[place_in_table(k[1])];
  const Two s = {a.sine.high(), b.sine.high()}, s_low = {a.sine.low(), b.sine.low()},
            c = {a.cosine.high(), b.cosine.high()}, c_low = {a.cosine.low(), b.cosine.low()};
  const Two d = (high - k / kSteps) + low, d2 = d * d;
  const Two sine = d + d * d2 * (-1.0 / 6 + d2 * (1.0 / 120 - d2 / 5040));
  const Two less = d2 * (-0.5 + d2 * (1.0 / 24 - d2 / 720));
  const Two of_rest = s + (s_low + (s * less + c * sine)), across_rest = c + (c_low + (c * less - s * sine));
  const TwoBits quadrant = {static_cast<std::int64_t>(n[0]), static_cast<std::int64_t>(n[1])};
  const TwoBits across = -(quadrant & 1);
  const Two plain_sine = across ? across_rest : of_rest, plain_cosine = across ? of_rest : across_rest;
  // the sign is the highest bit
  const Two sines = reinterpret_cast<Two>(reinterpret_cast<TwoBits>(plain_sine) ^ (quadrant & 2) << 62),
            cosines =
                reinterpret_cast<Two>(reinterpret_cast<TwoBits>(plain_cosine) ^ ((quadrant + 1) & 2) << 62);
  // each at once: who reads both, as a frame does, need not wait
  reinterpret_cast<Two&>(found.of_a) = Two{sines[0], cosines[0]};
  reinterpret_cast<Two&>(found.of_b) = Two{sines[1], cosines[1]};
}

/// Terms of which 53 bits are enough are doubles.
SineCosine<DoubleDouble> in_two(const DoubleDouble& angle) {
  constexpr DoubleDouble kSixth = DoubleDouble(1.0) / 6.0;
  const Entry entry = entry_of(angle.high());
  const DoubleDouble d = angle - entry.angle, d2 = d * d;
  const double x = d2.high();
  const DoubleDouble sine = d + d * (d2 * (x * (1.0 / 120 - x * (1.0 / 5040 - x / 362880)) - kSixth));
  const DoubleDouble less = d2 * -0.5 + x * x * (1.0 / 24 - x * (1.0 / 720 - x / 40320));
  const DoubleDouble &s = entry.at.sine, &c = entry.at.cosine;
  return {s + (s * less + c * sine), c + (c * less - s * sine)};
}

}  // namespace

SineCosine<double> sine_cosine(double angle) {
  if (angle == 0.0) return {angle, 1.0};  // most of what stands
  const double size = std::abs(angle);
  if (size < kFewQuarters) {
    const Reduced r = reduced(angle);
    return turned(in_double(r.rest), r.quarters);
  }
  if (!(size < kMostRadians)) return {std::sin(angle), std::cos(angle)};
  const Reduced r = reduced(DoubleDouble(angle));
  return turned(in_double(r.rest), r.quarters);
}

SineCosinePair sine_cosine(double a, double b) {
  const auto turns_little = [](double x) { return x != 0.0 && std::abs(x) < kFewQuarters; };
  if (!turns_little(a) || !turns_little(b)) return {sine_cosine(a), sine_cosine(b)};
  SineCosinePair found;
  turned_in_double(Two{a, b}, found);
  return found;
}

SineCosine<DoubleDouble> sine_cosine(const DoubleDouble& angle) {
  if (!(std::abs(angle.high()) < kMostRadians)) {
    const DoubleDouble s = std::sin(angle.high()), c = std::cos(angle.high());
    const double sine = std::sin(angle.low()), cosine = std::cos(angle.low());
    return {s * cosine + c * sine, c * cosine - s * sine};
  }
  const Reduced r = reduced(angle);
  return turned(in_two(r.rest), r.quarters);
}

DoubleDouble within_half_a_turn(const DoubleDouble& angle) {
  if (std::abs(angle.high()) < kMostRadians)
    return less_quarters(angle, 4.0 * std::nearbyint(0.25 * kQuartersOfOne * angle.high()));
  const SineCosine<DoubleDouble> of = sine_cosine(angle);
  return std::atan2(of.sine.high(), of.cosine.high());
}

}  // namespace brink
