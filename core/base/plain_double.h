#pragma once
/// A double that Eigen knows nothing of but its operations, for the algebra of Eigen's whose answer decides bits.
///
/// Of doubles Eigen adds up as many at a time as the processor's registers hold, and by fused products where there are
/// any, whatever -ffp-contract says: products of matrices and what is made of them have other last bits with SSE2, AVX
/// and NEON. Of these each operation is done by itself, one after the other. Cost: up to that of these registers.

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace brink {

class PlainDouble {
 public:
  constexpr PlainDouble() = default;
  constexpr PlainDouble(double value) : value_(value) {}  // NOLINT: it is one
  constexpr explicit operator double() const { return value_; }

  constexpr PlainDouble operator-() const { return -value_; }
  constexpr PlainDouble& operator+=(PlainDouble b) { return *this = *this + b; }
  constexpr PlainDouble& operator-=(PlainDouble b) { return *this = *this - b; }
  constexpr PlainDouble& operator*=(PlainDouble b) { return *this = *this * b; }
  constexpr PlainDouble& operator/=(PlainDouble b) { return *this = *this / b; }
  friend constexpr PlainDouble operator+(PlainDouble a, PlainDouble b) { return a.value_ + b.value_; }
  friend constexpr PlainDouble operator-(PlainDouble a, PlainDouble b) { return a.value_ - b.value_; }
  friend constexpr PlainDouble operator*(PlainDouble a, PlainDouble b) { return a.value_ * b.value_; }
  friend constexpr PlainDouble operator/(PlainDouble a, PlainDouble b) { return a.value_ / b.value_; }
  friend constexpr bool operator==(PlainDouble a, PlainDouble b) { return a.value_ == b.value_; }
  friend constexpr auto operator<=>(PlainDouble a, PlainDouble b) { return a.value_ <=> b.value_; }

  friend PlainDouble abs(PlainDouble a) { return std::abs(a.value_); }
  friend PlainDouble sqrt(PlainDouble a) { return std::sqrt(a.value_); }
  friend bool isfinite(PlainDouble a) { return std::isfinite(a.value_); }
  friend bool isnan(PlainDouble a) { return std::isnan(a.value_); }
  friend bool isinf(PlainDouble a) { return std::isinf(a.value_); }

 private:
  double value_ = 0.0;
};

using PlainMatrix = Eigen::Matrix<PlainDouble, Eigen::Dynamic, Eigen::Dynamic>;
using PlainVector = Eigen::Matrix<PlainDouble, Eigen::Dynamic, 1>;

}  // namespace brink

template <>
class std::numeric_limits<brink::PlainDouble> : public std::numeric_limits<double> {};

template <>
struct Eigen::NumTraits<brink::PlainDouble> : Eigen::GenericNumTraits<brink::PlainDouble> {
  using Real = brink::PlainDouble;
  using NonInteger = brink::PlainDouble;
  using Nested = brink::PlainDouble;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
  static Real dummy_precision() { return 1e-12; }
};
