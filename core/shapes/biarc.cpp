#include "brink/core/shapes/biarc.h"

#include <algorithm>
#include <numbers>

#include "brink/core/base/elementary.h"
#include "brink/core/base/error.h"
#include "brink/core/base/sine_cosine.h"
#include "brink/core/shapes/curve_site.h"
#include "brink/core/shapes/distance.h"
#include "brink/core/shapes/text.h"

namespace brink {

namespace {

/// The curve between two parameters; the ends are given, so that pieces join bit for bit.
struct Piece {
  double t0 = 0.0, t1 = 0.0;
  Vec2 p0 = Vec2::Zero(), p1 = Vec2::Zero();
};

/// How near a point of the curve is to what was fitted.
struct Nearness {
  double distance = std::numeric_limits<double>::infinity();
  std::size_t site = 0;
};

/// Places h apart in parameter, and the most by which the distance between two of them exceeds the greater of
/// the two, as long as one site is the nearest.
struct Step {
  int places = 0;
  double rise = 0.0;
};

/// Fits one curve. Sites are appended only when a piece is accepted, so that what was tried in vain leaves no
/// trace; deviation() is the greatest bound of the pieces so far [m].
class Fitter {
 public:
  Fitter(const SmoothCurve& curve, double tolerance, double radius, std::vector<Site>& sites)
      : curve_(curve), tolerance_(tolerance), radius_(radius), sites_(sites) {}

  void fit(const Piece& piece);
  double deviation() const { return deviation_; }

 private:
  bool try_biarc(const Piece& piece);
  bool accept_if_near(const Piece& piece, const std::vector<Site>& fitted);
  bool add_tangent_arc(const Vec2& a, const Vec2& direction, const Vec2& b, std::vector<Site>& fitted) const;
  Nearness at(double t, const std::vector<Site>& fitted) const;
  double most_between(double from, double to, const std::vector<Site>& fitted) const;
  Step step_for(double span, const std::vector<Site>& fitted) const;
  Vec2 direction(double t, double towards) const;
  /// No longer than the tolerance. As that is at least 1e-10 of the speed bound, halving ends: a piece
  /// whose parameters span a quarter turn is tiny after 34 times.
  bool is_tiny(const Piece& piece) const {
    return curve_.speed_bound() * std::abs(piece.t1 - piece.t0) <= tolerance_;
  }

  const SmoothCurve& curve_;
  double tolerance_, radius_;
  std::vector<Site>& sites_;
  double deviation_ = 0.0;
};

/// Direction of travel at t, as the limit from inside the piece where the derivative vanishes (a cusp).
Vec2 Fitter::direction(double t, double towards) const {
  const Vec2 d = curve_.derivative(t);
  if (d.norm() > 1e-7 * curve_.speed_bound()) return d.normalized();
  // where B' = 0, B'(t + h) = h B'' + ...: a little further in it has the direction of the limit
  return curve_.derivative(t + 1e-4 * (towards - t)).normalized();
}

/// The nearest of the fitted sites to the curve's point at t. Cost: all of them, which are two at most.
Nearness Fitter::at(double t, const std::vector<Site>& fitted) const {
  const Vec2 p = curve_.point(t);
  Nearness nearest;
  for (std::size_t k = 0; k < fitted.size(); ++k)
    if (const double d = nearest_on(fitted[k], p).distance; d < nearest.distance) nearest = {d, k};
  return nearest;
}

/// The distance where the curve passes from one site to the next: it may be greater than before and after.
double Fitter::most_between(double from, double to, const std::vector<Site>& fitted) const {
  // Bisection for the parameter at which another site becomes the nearest: on each side of it the distance is
  // that to one site, and the rise of a step bounds it.
  const std::size_t before = at(from, fitted).site;
  double most = 0.0;
  // to 1e-6 of the step
  for (int k = 0; k < 20; ++k) {
    const double middle = std::lerp(from, to, 0.5);
    const Nearness there = at(middle, fitted);
    most = std::max(most, there.distance);
    (there.site == before ? from : to) = middle;
  }
  return most;
}

/// So many places that the rise is a 32nd of the tolerance, where that is not too many.
Step Fitter::step_for(double span, const std::vector<Site>& fitted) const {
  // Where `most` are too few the rise is the larger for it: the piece may be halved needlessly, never accepted
  // wrongly.
  constexpr int least = 16, most = 20000;
  const double speed = curve_.speed_bound(), allowed = tolerance_ / 32;
  // d = |p - c| - R has d'' = p'' . u + (|p'|^2 - (p' . u)^2) / |p - c|, u the unit vector from c to p
  double bend = curve_.bend_bound();
  bool is_tight = false;
  for (const Site& s : fitted) {
    if (s.kind != SiteKind::arc) continue;
    is_tight |= s.arc_radius < 2 * tolerance_;
    // where it counts the curve is within the tolerance of the arc, so that |p - c| >= R - tolerance
    bend = std::max(bend, curve_.bend_bound() + speed * speed / (s.arc_radius - tolerance_));
  }
  // within the tolerance of a tight arc the curve may come to its centre, where the bend has no bound; but no
  // place is farther than h / 2 of the way from one that is looked at
  // without a tight arc: between two places h apart a function with |d''| <= bend exceeds the greater of its
  // two values there by at most h^2 bend / 8
  const double wanted = is_tight ? span * speed / (2 * allowed) : span * std::sqrt(bend / (8 * allowed));
  const int n = static_cast<int>(std::clamp(std::ceil(wanted), double(least), double(most)));
  return {n, is_tight ? span / n * speed / 2 : span / n * span / n * bend / 8};
}

/// Appends the sites if the whole piece is sure to be within the tolerance of them.
bool Fitter::accept_if_near(const Piece& piece, const std::vector<Site>& fitted) {
  constexpr int coarse = 8;
  // a piece that is far off is turned down by few places
  for (int k = 1; k < coarse; ++k)
    if (at(std::lerp(piece.t0, piece.t1, double(k) / coarse), fitted).distance > tolerance_) return false;
  const Step step = step_for(std::abs(piece.t1 - piece.t0), fitted);
  const auto parameter = [&](int k) { return std::lerp(piece.t0, piece.t1, double(k) / step.places); };
  // Then densely: the worst of all places, of all changes of site between two of them, and the rise.
  Nearness before = at(piece.t0, fitted);
  double worst = before.distance;
  for (int k = 1; k <= step.places; ++k) {
    const Nearness now = at(parameter(k), fitted);
    worst = std::max(worst, now.distance);
    if (now.site != before.site)
      worst = std::max(worst, most_between(parameter(k - 1), parameter(k), fitted));
    before = now;
  }
  worst += step.rise;
  if (worst > tolerance_) return false;
  deviation_ = std::max(deviation_, worst);
  sites_.insert(sites_.end(), fitted.begin(), fitted.end());
  return true;
}

/// Adds the arc from a that leaves in `direction` and reaches b, a segment if it is flat. False if it turns
/// by more than a quarter.
bool Fitter::add_tangent_arc(const Vec2& a, const Vec2& direction, const Vec2& b,
                             std::vector<Site>& fitted) const {
  const Vec2 chord = b - a;
  const double size = chord.norm();
  // the joint lies on this end: the other arc is the whole biarc
  if (!(size > 0.0)) return true;
  // the angle of tangent and chord is half of the arc's turn
  const double half = angle_of(cross(direction, chord), direction.dot(chord));
  if (std::abs(half) > kQuarterTurn / 2) return false;
  // tan(h / 2) = sin h / (1 + cos h)
  const auto [sine, cosine] = sine_cosine(std::abs(half));
  const double sagitta = size / 2 * sine / (1.0 + cosine);
  // off by a fiftieth of the tolerance, which accept_if_near() measures with the rest; or so flat that
  // the radius, chord^2 / (8 sagitta), is more than 1e7 chords and its centre's digits are lost
  if (sagitta <= std::max(0.02 * tolerance_, 1e-8 * size)) {
    fitted.push_back(segment_site(a, b, radius_));
    return true;
  }
  const double signed_radius = size / (2 * std::copysign(sine, half));
  const Vec2 center = a + signed_radius * perp(direction);
  add_arc(fitted, a, b, center, std::abs(signed_radius), 2 * half, radius_);
  return true;
}

/// False if the piece turns too much for a biarc, or is farther off than the tolerance: it is to be halved.
bool Fitter::try_biarc(const Piece& piece) {
  const Vec2 d0 = direction(piece.t0, piece.t1), d1 = direction(piece.t1, piece.t0);
  const Vec2 chord = piece.p1 - piece.p0;
  // ends that turn by a quarter or more, or back against the chord, are left to halving
  if (!(d0.dot(d1) > 0.0) || !(chord.dot(d0) > 0.0 && chord.dot(d1) > 0.0)) return false;
  // the two tangents have one length l: the joint is the middle of p0 + l d0
  // and p1 - l d1, which are 2 l apart, so slack l^2 + 2 along l = c2. This
  // form of the positive root holds for slack = 0 (d0 = d1) too
  const double along = chord.dot(d0 + d1), c2 = chord.squaredNorm();
  const double slack = (d0 - d1).squaredNorm();  // = 2 (1 - d0 . d1)
  const double reach = c2 / (along + std::sqrt(along * along + slack * c2));
  const Vec2 joint = 0.5 * (piece.p0 + piece.p1) + 0.5 * reach * (d0 - d1);
  std::vector<Site> fitted;
  if (!add_tangent_arc(piece.p0, d0, joint, fitted)) return false;
  // the second arc is found backwards from its far end, so that it has the curve's tangent there
  std::vector<Site> back;
  if (!add_tangent_arc(piece.p1, -d1, joint, back)) return false;
  for (auto s = back.rbegin(); s != back.rend(); ++s) fitted.push_back(reversed(*s));
  return !fitted.empty() && accept_if_near(piece, fitted);
}

/// A biarc, or a chord where the piece is tiny, or else both halves. Pieces come in order along the curve.
void Fitter::fit(const Piece& piece) {
  if (is_tiny(piece)) {  // shorter than the tolerance: its chord is at most half of that away
    if (piece.p0 != piece.p1) sites_.push_back(segment_site(piece.p0, piece.p1, radius_));
    deviation_ = std::max(deviation_, curve_.speed_bound() * std::abs(piece.t1 - piece.t0) / 2);
    return;
  }
  if (try_biarc(piece)) return;
  const double middle = std::lerp(piece.t0, piece.t1, 0.5);
  const Vec2 p = curve_.point(middle);
  fit({piece.t0, middle, piece.p0, p});
  fit({middle, piece.t1, p, piece.p1});
}

}  // namespace

double fit_arcs(const SmoothCurve& curve, const Vec2& start, const Vec2& end, double tolerance, double radius,
                std::vector<Site>& sites) {
  // of the curve's coordinates, up to a small factor
  const double size = curve.speed_bound() + start.cwiseAbs().maxCoeff();
  if (!(tolerance >= 1e-10 * size))
    throw BadInput("curve_tolerance is " + text(tolerance) +
                   " m; for a curve of this size it must be at least " + text(1e-10 * size) + " m");
  Fitter fitter(curve, tolerance, radius, sites);
  const std::vector<double> ts = curve.breaks();
  Vec2 p = start;
  for (std::size_t k = 0; k + 1 < ts.size(); ++k) {
    const Vec2 q = k + 2 == ts.size() ? end : curve.point(ts[k + 1]);
    // between two breaks a curve turns to one side only: inflections and cusps are joints
    fitter.fit({ts[k], ts[k + 1], p, q});
    p = q;
  }
  return fitter.deviation();
}

}  // namespace brink
