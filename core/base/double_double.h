#pragma once
/// Numbers as the unevaluated sum of two doubles: 106 bits of mantissa by IEEE 754 operations of doubles alone, so that
/// every compiler and every 64-bit machine gives the same bits.
///
/// Sums and products of doubles come with their exact error (Knuth 1969; Dekker 1971); from these the operations are
/// put together as in Joldes, Muller & Popescu, "Tight and rigorous error bounds for basic building blocks of
/// double-word arithmetic", ACM TOMS 44(2), 2017. The relative error of each is below DoubleDouble's epsilon, 2^-100.
/// Beyond what the low part can hold (products below 2^-960, what is not finite) it is 0: as good as a double, and
/// never NaN where a double is none.
///
/// @pre the rounding mode is to nearest, and sums are not contracted with products (-ffp-contract=off).

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <type_traits>

namespace brink {

// Within a function for processors with fused products everything must be compiled for these.
#define BRINK_INLINE [[gnu::always_inline]] inline constexpr

/// Error-free transformations: high is the operation's rounded result, and high + low its exact one.
namespace error_free {

struct Result {
  double high, low;
};

/// @pre |a| >= |b|, or a = 0.
BRINK_INLINE Result quick_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

BRINK_INLINE Result sum(double a, double b) {
  const double sum = a + b, of_b = sum - a;
  return {sum, (a - (sum - of_b)) + (b - of_b)};
}

/// Two halves of 26 bits: a = high + low. @pre |a| < 2^996.
BRINK_INLINE Result halves(double a) {
  const double scaled = 134217729.0 * a;  // 2^27 + 1
  const double high = scaled - (scaled - a);
  return {high, a - high};
}

/// Exact where |a b| is 2^-960 or more, |a| and |b| are below 2^996 and nothing overflows; else low is 0, NaN or any
/// rounding. 17 operations (Dekker 1971).
BRINK_INLINE Result product(double a, double b) {
  const double product = a * b;
  const Result x = halves(a), y = halves(b);
  return {product, ((x.high * y.high - product) + x.high * y.low + x.low * y.high) + x.low * y.low};
}

#if defined(__x86_64__) && !defined(__FP_FAST_FMA)
/// Whether this processor has fused products. Until that is known Plain does without.
inline const bool has_fused_products = __builtin_cpu_supports("fma");
#endif

/// product(), with the same bits where that is exact, on every processor: of x86-64 some have fused products.
struct Plain {
  static constexpr bool kLooks = true;
  BRINK_INLINE static Result product(double a, double b) {
#if defined(__x86_64__) && !defined(__FP_FAST_FMA)
    if (!std::is_constant_evaluated() && has_fused_products) {
      const double product = a * b;
      double low = product;
      asm("vfmsub231sd %2, %1, %0" : "+x"(low) : "x"(a), "x"(b));  // a b - low, rounded once
      return {product, low};
    }
#endif
    return error_free::product(a, b);
  }
};

/// The same bits by two operations. @pre the caller runs where the processor has fused products.
struct Fused {
  static constexpr bool kLooks = true;
  BRINK_INLINE static Result product(double a, double b) {
    if (std::is_constant_evaluated()) return error_free::product(a, b);  // to clang it is no constant
    const double product = a * b;
    return {product, __builtin_fma(a, b, -product)};
  }
};

/// The same, of which no operation looks whether its range was left: the same bits in two thirds of the time. @pre the
/// caller has seen to it that every product lies between BasicDoubleDouble's kLeast and kMost, and nothing overflows.
template <class Product>
struct InRange : Product {
  static constexpr bool kLooks = false;
};

#ifdef __FP_FAST_FMA
using Default = Fused;
#else
using Default = Plain;
#endif

}  // namespace error_free

/// `Product`: error_free::Plain or Fused, or InRange of one of them.
template <class Product>
class BasicDoubleDouble {
 public:
  BRINK_INLINE BasicDoubleDouble() = default;
  BRINK_INLINE BasicDoubleDouble(double value) : high_(value) {}  // NOLINT: widening
  /// @pre high is the sum, rounded.
  BRINK_INLINE BasicDoubleDouble(double high, double low) : high_(high), low_(low) {}

  /// Rounded to the nearest double.
  BRINK_INLINE double high() const { return high_; }
  /// What that leaves over.
  BRINK_INLINE double low() const { return low_; }
  BRINK_INLINE explicit operator double() const { return high_; }

  /// Of any two doubles, exactly.
  BRINK_INLINE static BasicDoubleDouble sum(double a, double b) {
    const error_free::Result r = error_free::sum(a, b);
    return finite(r.low) ? BasicDoubleDouble(r.high, r.low) : BasicDoubleDouble(r.high);
  }
  /// Of any two doubles, exactly where error_free::Plain is.
  BRINK_INLINE static BasicDoubleDouble product(double a, double b) {
    const error_free::Result r = Product::product(a, b);
    return exact(r) ? BasicDoubleDouble(r.high, r.low) : BasicDoubleDouble(r.high);
  }

  BRINK_INLINE BasicDoubleDouble operator-() const { return {-high_, -low_}; }
  BRINK_INLINE BasicDoubleDouble operator+() const { return *this; }

  BRINK_INLINE friend BasicDoubleDouble operator+(const BasicDoubleDouble& a, double b) {
    const error_free::Result r = error_free::sum(a.high_, b);
    return normalized(r.high, a.low_ + r.low, r.high);
  }
  BRINK_INLINE friend BasicDoubleDouble operator+(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    const error_free::Result highs = error_free::sum(a.high_, b.high_),
                             lows = error_free::sum(a.low_, b.low_);
    const error_free::Result r = error_free::quick_sum(highs.high, highs.low + lows.high);
    return normalized(r.high, lows.low + r.low, highs.high);
  }
  BRINK_INLINE friend BasicDoubleDouble operator*(const BasicDoubleDouble& a, double b) {
    const error_free::Result r = Product::product(a.high_, b);
    return in_range(r.high) ? normalized(r.high, r.low + a.low_ * b, r.high) : BasicDoubleDouble(r.high);
  }
  BRINK_INLINE friend BasicDoubleDouble operator*(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    const error_free::Result r = Product::product(a.high_, b.high_);
    const double crossed = a.high_ * b.low_ + a.low_ * b.high_;
    return in_range(r.high) ? normalized(r.high, r.low + crossed, r.high) : BasicDoubleDouble(r.high);
  }
  BRINK_INLINE friend BasicDoubleDouble operator/(const BasicDoubleDouble& a, double b) {
    const double first = a.high_ / b;
    if (!in_range(first) || !in_range(b)) return first;
    const BasicDoubleDouble rest = a - product(first, b);
    return normalized(first, rest.high_ / b, first);
  }
  BRINK_INLINE friend BasicDoubleDouble operator/(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    const double first = a.high_ / b.high_;
    if (!in_range(first) || !in_range(b.high_)) return first;
    const BasicDoubleDouble rest = a - b * first;
    return normalized(first, rest.high_ / b.high_, first);
  }
  BRINK_INLINE friend BasicDoubleDouble operator+(double a, const BasicDoubleDouble& b) { return b + a; }
  BRINK_INLINE friend BasicDoubleDouble operator-(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    return a + -b;
  }
  BRINK_INLINE friend BasicDoubleDouble operator-(const BasicDoubleDouble& a, double b) { return a + -b; }
  BRINK_INLINE friend BasicDoubleDouble operator-(double a, const BasicDoubleDouble& b) { return -b + a; }
  BRINK_INLINE friend BasicDoubleDouble operator*(double a, const BasicDoubleDouble& b) { return b * a; }
  BRINK_INLINE friend BasicDoubleDouble operator/(double a, const BasicDoubleDouble& b) {
    return BasicDoubleDouble(a) / b;
  }
  BRINK_INLINE BasicDoubleDouble& operator+=(const BasicDoubleDouble& b) { return *this = *this + b; }
  BRINK_INLINE BasicDoubleDouble& operator-=(const BasicDoubleDouble& b) { return *this = *this - b; }
  BRINK_INLINE BasicDoubleDouble& operator*=(const BasicDoubleDouble& b) { return *this = *this * b; }
  BRINK_INLINE BasicDoubleDouble& operator/=(const BasicDoubleDouble& b) { return *this = *this / b; }

  BRINK_INLINE friend bool operator==(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    return a.high_ == b.high_ && a.low_ == b.low_;
  }
  BRINK_INLINE friend bool operator!=(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    return !(a == b);
  }
  BRINK_INLINE friend bool operator<(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    return a.high_ < b.high_ || (a.high_ == b.high_ && a.low_ < b.low_);
  }
  BRINK_INLINE friend bool operator<=(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    return a.high_ < b.high_ || (a.high_ == b.high_ && a.low_ <= b.low_);
  }
  BRINK_INLINE friend bool operator>(const BasicDoubleDouble& a, const BasicDoubleDouble& b) { return b < a; }
  BRINK_INLINE friend bool operator>=(const BasicDoubleDouble& a, const BasicDoubleDouble& b) {
    return b <= a;
  }

  BRINK_INLINE friend BasicDoubleDouble abs(const BasicDoubleDouble& a) { return a.high_ < 0.0 ? -a : a; }
  BRINK_INLINE friend bool isfinite(const BasicDoubleDouble& a) { return a.high_ - a.high_ == 0.0; }
  BRINK_INLINE friend bool isnan(const BasicDoubleDouble& a) { return a.high_ != a.high_; }
  BRINK_INLINE friend bool isinf(const BasicDoubleDouble& a) { return !isfinite(a) && !isnan(a); }
  /// NaN below 0.
  [[gnu::always_inline]] friend BasicDoubleDouble sqrt(const BasicDoubleDouble& a) {
    const double first = std::sqrt(a.high_);
    if (!in_range(first)) return first;
    const BasicDoubleDouble rest = a - product(first, first);
    return normalized(first, rest.high_ / (2.0 * first), first);
  }

  /// False if the caller answers for the range (error_free::InRange).
  static constexpr bool kLooks = Product::kLooks;
  /// The sizes of products whose low part is their error.
  static constexpr double kLeast = 0x1p-960, kMost = 0x1p995;

 private:
  BRINK_INLINE static bool finite(double x) { return !kLooks || x - x == 0.0; }
  /// True where low is the error of a product, not where that is no double or halves() overflowed.
  BRINK_INLINE static bool exact(const error_free::Result& product) {
    return in_range(product.high) && finite(product.low);
  }
  BRINK_INLINE static bool in_range(double x) {
    const double size = __builtin_fabs(x);  // a branch would be foreseen wrongly
    return !kLooks || ((size >= kLeast) & (size <= kMost));
  }
  /// The sum of the two; where its low part is no number, `else_high` alone. @pre |high| >= |low|, or high = 0.
  BRINK_INLINE static BasicDoubleDouble normalized(double high, double low, double else_high) {
    const error_free::Result r = error_free::quick_sum(high, low);
    return finite(r.low) ? BasicDoubleDouble(r.high, r.low) : BasicDoubleDouble(else_high);
  }

  double high_ = 0.0, low_ = 0.0;
};

using DoubleDouble = BasicDoubleDouble<error_free::Default>;

#undef BRINK_INLINE

}  // namespace brink

template <>
class std::numeric_limits<brink::DoubleDouble> : public std::numeric_limits<double> {
 public:
  static constexpr int digits = 106, digits10 = 31, max_digits10 = 33;
  /// Bounds the relative error of every operation; neighbours are nearer to each other.
  static constexpr brink::DoubleDouble epsilon() noexcept { return 0x1p-100; }
  static constexpr brink::DoubleDouble infinity() noexcept { return numeric_limits<double>::infinity(); }
  static constexpr brink::DoubleDouble quiet_NaN() noexcept { return numeric_limits<double>::quiet_NaN(); }
  static constexpr brink::DoubleDouble max() noexcept { return numeric_limits<double>::max(); }
  static constexpr brink::DoubleDouble lowest() noexcept { return numeric_limits<double>::lowest(); }
  static constexpr brink::DoubleDouble min() noexcept { return 0x1p-960; }
};

template <>
struct Eigen::NumTraits<brink::DoubleDouble> : Eigen::GenericNumTraits<brink::DoubleDouble> {
  using Real = brink::DoubleDouble;
  using NonInteger = brink::DoubleDouble;
  using Nested = brink::DoubleDouble;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 20,
    MulCost = 30
  };
  static Real epsilon() { return std::numeric_limits<Real>::epsilon(); }
  static Real dummy_precision() { return 1e-28; }
  static Real highest() { return std::numeric_limits<Real>::max(); }
  static Real lowest() { return std::numeric_limits<Real>::lowest(); }
  static int digits10() { return std::numeric_limits<Real>::digits10; }
};
