#include "brink/core/shapes/smooth_curve.h"

#include <algorithm>
#include <numbers>

#include "brink/core/base/sine_cosine.h"

namespace brink {

namespace {

/// Real roots of a + b t + c t^2, without cancellation.
/// q is a sum of two terms of one sign; the second root comes from the product of both, a / c.
void add_roots(double a, double b, double c, std::vector<double>& roots) {
  if (c == 0.0) {
    if (b != 0.0) roots.push_back(-a / b);
    return;
  }
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0.0) return;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b)) / 2;
  roots.push_back(q / c);
  // q = 0: both roots are 0
  if (q != 0.0) roots.push_back(a / q);
}

}  // namespace

CubicBezier::CubicBezier(const std::array<Vec2, 4>& control) : control_(control) {
  for (int k = 0; k < 3; ++k) {
    // a Bezier curve lies in the hull of its control points: no B' is longer than the longest of them
    first_[k] = 3 * (control[k + 1] - control[k]);
    speed_bound_ = std::max(speed_bound_, first_[k].norm());
  }
  for (int k = 0; k < 2; ++k) {
    // B'' is linear: longest at an end
    second_[k] = 2 * (first_[k + 1] - first_[k]);
    bend_bound_ = std::max(bend_bound_, second_[k].norm());
  }
}

Vec2 CubicBezier::point(double t) const {
  const double s = 1 - t;
  return s * s * s * control_[0] + 3 * s * s * t * control_[1] + 3 * s * t * t * control_[2] +
         t * t * t * control_[3];
}

Vec2 CubicBezier::derivative(double t) const {
  const double s = 1 - t;
  return s * s * first_[0] + 2 * s * t * first_[1] + t * t * first_[2];
}

std::vector<double> CubicBezier::breaks() const {
  // B' = p + q t + r t^2, so B' x B'' = p x q + 2 (p x r) t + (q x r) t^2
  const Vec2 p = first_[0], q = 2 * (first_[1] - first_[0]), r = first_[0] - 2 * first_[1] + first_[2];
  // a cusp, where B' = 0, is a double root, which rounding may lose; fit_arcs() halves its way to it then
  std::vector<double> roots, ts{0.0};
  add_roots(cross(p, q), 2 * cross(p, r), cross(q, r), roots);
  std::sort(roots.begin(), roots.end());
  for (double t : roots)
    // a cut at an end, or twice at one place, would leave a piece of no length
    if (t > ts.back() + 1e-9 && t < 1 - 1e-9) ts.push_back(t);
  ts.push_back(1.0);
  return ts;
}

/// u and v are at right angles: u cos t + v sin t and its derivatives are at most as long as the longer.
EllipticalArc::EllipticalArc(const Vec2& center, const Vec2& u, const Vec2& v, double from, double to)
    : center_(center), u_(u), v_(v), from_(from), to_(to), longest_(std::max(u.norm(), v.norm())) {}

Vec2 EllipticalArc::point(double t) const {
  const auto [sine, cosine] = sine_cosine(t);
  return center_ + cosine * u_ + sine * v_;
}

Vec2 EllipticalArc::derivative(double t) const {
  const auto [sine, cosine] = sine_cosine(t);
  const Vec2 d = cosine * v_ - sine * u_;
  // in the direction of travel, also where the parameter falls
  return to_ > from_ ? d : Vec2(-d);
}

std::vector<double> EllipticalArc::breaks() const {
  const double low = std::min(from_, to_), high = std::max(from_, to_);
  std::vector<double> ts{low};
  // at whole quarters of the parameter the point is at the end of an axis
  for (double k = std::ceil(low / kQuarterTurn); k * kQuarterTurn < high - 1e-9; ++k)
    if (k * kQuarterTurn > low + 1e-9) ts.push_back(k * kQuarterTurn);
  ts.push_back(high);
  if (from_ > to_) std::reverse(ts.begin(), ts.end());
  return ts;
}

}  // namespace brink
