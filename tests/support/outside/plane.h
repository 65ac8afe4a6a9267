#pragma once
/// The plane in extended precision, for checks that share no code with the framework: its vectors, turns and
/// poses are written again here, on purpose.

#include <cmath>
#include <limits>

namespace brink::outside {

using Real = long double;
constexpr Real kNever = std::numeric_limits<Real>::infinity();
constexpr Real kUlp = std::numeric_limits<double>::epsilon();  ///< of the doubles that are checked

struct Vec {
  Real x = 0, y = 0;
  Vec operator+(const Vec& o) const { return {x + o.x, y + o.y}; }
  Vec operator-(const Vec& o) const { return {x - o.x, y - o.y}; }
  Vec operator*(Real s) const { return {x * s, y * s}; }
  Vec operator-() const { return {-x, -y}; }
};
inline Real dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y; }
inline Real wedge(const Vec& a, const Vec& b) { return a.x * b.y - a.y * b.x; }
inline Real norm(const Vec& a) { return std::hypot(a.x, a.y); }
/// a turned by +90 degrees.
inline Vec left_of(const Vec& a) { return {-a.y, a.x}; }

/// Where a shape's frame is: its origin [m] and angle [rad].
struct Place {
  Vec at;
  Real angle = 0;
};

/// A turn by an angle, its sine and cosine taken once.
struct Turn {
  Real c = 1, s = 0;
  explicit Turn(Real angle) : c(std::cos(angle)), s(std::sin(angle)) {}
  Vec operator()(const Vec& p) const { return {c * p.x - s * p.y, s * p.x + c * p.y}; }
};

}  // namespace brink::outside
