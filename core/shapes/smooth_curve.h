#pragma once
/// Parametric curves that are to become arcs: cubic Beziers and elliptical arcs.

#include <array>
#include <vector>

#include "brink/core/base/geometry.h"

namespace brink {

class SmoothCurve {
 public:
  virtual ~SmoothCurve() = default;
  virtual Vec2 point(double t) const = 0;
  virtual Vec2 derivative(double t) const = 0;
  /// Upper bounds on the lengths of the first and second derivative over the whole curve.
  virtual double speed_bound() const = 0;
  virtual double bend_bound() const = 0;
  /// Parameters to cut at, ends included, increasing: inflections, cusps, ends of symmetry axes.
  virtual std::vector<double> breaks() const = 0;
};

/// B(t) = sum of Bernstein polynomials times control points, t in [0, 1].
class CubicBezier : public SmoothCurve {
 public:
  explicit CubicBezier(const std::array<Vec2, 4>& control);
  Vec2 point(double t) const override;
  Vec2 derivative(double t) const override;
  double speed_bound() const override { return speed_bound_; }
  double bend_bound() const override { return bend_bound_; }
  /// Inflections: where B' x B'' = 0, a quadratic in t.
  std::vector<double> breaks() const override;

 private:
  std::array<Vec2, 4> control_;
  std::array<Vec2, 3> first_;   ///< control points of B'
  std::array<Vec2, 2> second_;  ///< control points of B''
  double speed_bound_ = 0.0;
  double bend_bound_ = 0.0;
};

/// c + u cos t + v sin t for t between two angles [rad]; u and v are the half axes.
class EllipticalArc : public SmoothCurve {
 public:
  EllipticalArc(const Vec2& center, const Vec2& u, const Vec2& v, double from, double to);
  Vec2 point(double t) const override;
  Vec2 derivative(double t) const override;
  double speed_bound() const override { return longest_; }
  double bend_bound() const override { return longest_; }
  /// The ends of the axes within the arc: curvature is monotone in between.
  std::vector<double> breaks() const override;

 private:
  Vec2 center_, u_, v_;
  double from_, to_, longest_;
};

}  // namespace brink
