#pragma once
/// How a disc goes that nothing accelerates, in two doubles a number, at four times side by side: for pairs so far from the
/// world's origin that places in doubles do not tell their gaps.

#include <cmath>

#include "brink/core/base/double_double.h"
#include "brink/core/base/wide.h"
#include "brink/integrators/motion.h"

namespace brink {

/// Four numbers as sums of two doubles. Each operation is BasicDoubleDouble's own, to the bit, where its ranges are not left:
/// the caller answers for that.
struct FourReals {
  Four high, low;

  [[gnu::always_inline]] static FourReals quick_sum(const Four& a, const Four& b) {
    const Four sum = a + b;
    return {sum, b - (sum - a)};
  }
  [[gnu::always_inline]] static FourReals sum(const Four& a, const Four& b) {
    const Four sum = a + b, of_b = sum - a;
    return {sum, (a - (sum - of_b)) + (b - of_b)};
  }
  /// Exact, by halves of 26 bits (error_free::product).
  [[gnu::always_inline]] static FourReals product(const Four& a, const Four& b) {
    const Four product = a * b;
    const FourReals x = halves(a), y = halves(b);
    return {product, ((x.high * y.high - product) + x.high * y.low + x.low * y.high) + x.low * y.low};
  }
  [[gnu::always_inline]] static FourReals halves(const Four& a) {
    const Four scaled = 134217729.0 * a;
    const Four high = scaled - (scaled - a);
    return {high, a - high};
  }
  [[gnu::always_inline]] FourReals operator+(const FourReals& b) const {
    const FourReals highs = sum(high, b.high), lows = sum(low, b.low);
    const FourReals r = quick_sum(highs.high, highs.low + lows.high);
    return quick_sum(r.high, lows.low + r.low);
  }
  [[gnu::always_inline]] FourReals operator*(const FourReals& b) const {
    const FourReals r = product(high, b.high);
    return quick_sum(r.high, r.low + (high * b.low + low * b.high));
  }
};

/// A disc's way without acceleration: places with Motion::extended_state's own bits.
class FarWay {
 public:
  /// @pre m is a parabola.
  explicit FarWay(const Motion& m)
      : origin_(m.origin()),
        x_(along(m.start().pose.position.x(), m.start_low().pose.position.x(), m.start().twist.velocity.x(),
                 m.start_low().twist.velocity.x())),
        y_(along(m.start().pose.position.y(), m.start_low().pose.position.y(), m.start().twist.velocity.y(),
                 m.start_low().twist.velocity.y())) {}

  /// True if no product of a time in (origin, 2^100 s] that is 2^-90 s or more, or of its distance from the origin, leaves
  /// the range of two doubles.
  bool is_plain() const { return x_.is_plain() && y_.is_plain() && std::abs(origin_) <= kMost; }

  /// How far this one is at times t from the other, seen as PairView sees a pair in extended precision: both from the other's
  /// place, rounded [m].
  [[gnu::always_inline]] void apart(const FarWay& from, const Four& t, Four& x, Four& y) const {
    const FourReals since = FourReals::sum(t, Four{} - origin_),
                    since_from = FourReals::sum(t, Four{} - from.origin_);
    x_.apart(from.x_, since, since_from, x);
    y_.apart(from.y_, since, since_from, y);
  }

 private:
  static constexpr double kLeast = 0x1p-150, kMost = 0x1p100;

  struct Along {  ///< one axis
    double place, place_low, velocity, velocity_low;

    bool is_plain() const {
      const double speed = std::abs(velocity);
      return std::abs(place) <= kMost && speed <= kMost && (speed == 0.0 || speed >= kLeast);
    }
    [[gnu::always_inline]] FourReals at(const FourReals& since) const {
      const Four none{};
      return FourReals{none + place, none + place_low} +
             since * FourReals{none + velocity, none + velocity_low};
    }
    [[gnu::always_inline]] void apart(const Along& from, const FourReals& since, const FourReals& since_from,
                                      Four& way) const {
      const FourReals here = at(since), there = from.at(since_from);
      // from there.high the other is at there.low, exactly
      const FourReals highs = FourReals::sum(here.high, -there.high);
      const FourReals seen = FourReals::quick_sum(highs.high, highs.low + here.low);
      way = (seen.high + seen.low) - there.low;
    }
  };
  static Along along(double place, double place_low, double velocity, double velocity_low) {
    const error_free::Result at = error_free::sum(place, place_low),
                             by = error_free::sum(velocity, velocity_low);
    return {at.high, at.low, by.high, by.low};
  }

  double origin_;
  Along x_, y_;
};

}  // namespace brink
