#include "brink/integrators/prescribed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "brink/integrators/dense_output.h"
#include "brink/integrators/stepping.h"

namespace brink {

namespace {

using Eigen::Vector3d;

constexpr int kDegree = 10;
constexpr double kCellWidth = 0.0625;     // 2^-4 s
constexpr double kFitTolerance = 1e-13;   // of the cell's largest value
constexpr double kNoiseTolerance = 1e-9;  // the same, where halving no longer helps
constexpr double kPi = 3.14159265358979323846;

using Matrix = Eigen::Matrix<double, kDegree + 1, kDegree + 1>;
using Columns = Eigen::Matrix<double, kDegree + 1, 3>;  // x, y, angle

/// Chebyshev-Lobatto points on [-1, 1] and the checking points between them; the maps from values at the
/// former to Chebyshev coefficients, and from those to monomials. Two maps, because their product would
/// cancel.
struct Nodes {
  std::array<double, kDegree + 1> at;
  std::array<double, kDegree> check;
  Matrix to_chebyshev, to_monomial = Matrix::Zero();

  Nodes() {
    for (int j = 0; j <= kDegree; ++j) at[j] = -std::cos(kPi * j / kDegree);
    at[0] = -1.0, at[kDegree / 2] = 0.0, at[kDegree] = 1.0;
    for (int j = 0; j < kDegree; ++j) check[j] = -std::cos(kPi * (j + 0.5) / kDegree);
    const auto half_at_ends = [](int i) { return i == 0 || i == kDegree ? 0.5 : 1.0; };
    for (int k = 0; k <= kDegree; ++k)
      for (int j = 0; j <= kDegree; ++j)
        to_chebyshev(k, j) =
            half_at_ends(j) * half_at_ends(k) * 2.0 / kDegree * std::cos(kPi * (k * (kDegree - j)) / kDegree);
    // T_k = 2 u T_(k-1) - T_(k-2)
    to_monomial(0, 0) = to_monomial(1, 1) = 1.0;
    for (int k = 2; k <= kDegree; ++k) {
      to_monomial.col(k) = -to_monomial.col(k - 2);
      for (int i = 1; i <= kDegree; ++i) to_monomial(i, k) += 2.0 * to_monomial(i - 1, k - 1);
    }
  }

  /// Monomial coefficients of the interpolant. Trailing Chebyshev coefficients that are rounding of the
  /// values are dropped: they would only be amplified in the rates.
  Columns monomials(const Columns& values) const {
    Columns chebyshev = to_chebyshev * values;
    for (int i = 0; i < 3; ++i) {
      const double rounding =
          2.0 * std::numeric_limits<double>::epsilon() * values.col(i).cwiseAbs().maxCoeff();
      for (int k = kDegree; k > 0 && std::abs(chebyshev(k, i)) <= rounding; --k) chebyshev(k, i) = 0.0;
    }
    return to_monomial * chebyshev;
  }
};

const Nodes& nodes() {
  static const Nodes made;
  return made;
}

Vector3d rates(const Twist& twist) { return {twist.velocity.x(), twist.velocity.y(), twist.omega}; }
Vector3d values(const Pose& pose) { return {pose.position.x(), pose.position.y(), pose.angle}; }

}  // namespace

/// A cell's interpolant, and what is known of it.
struct PrescribedMotion::Fitted {
  PolynomialPiece piece;
  bool corner = false;  ///< too small to halve: only its end values count
  Vector3d value_begin = Vector3d::Zero(), value_end = Vector3d::Zero();
  Vector3d rate_begin = Vector3d::Zero(), rate_end = Vector3d::Zero();
  Vector3d tolerance = Vector3d::Zero();  ///< of the fit
  Vector3d scale = Vector3d::Zero();      ///< largest value
  bool fits = true;                       ///< within the tolerance at every checking point
  double misfit = 0.0;                    ///< the worst that is beyond it, in units of the base scale
  double worst = 0.0;                     ///< the worst, in units of the pose

  double width() const { return piece.end - piece.begin; }
  /// What the end rates may be off by: n^2 times the fit over the half width (Markov's inequality).
  Vector3d rate_tolerance() const { return (2.0 * kDegree * kDegree / width()) * tolerance; }
};

PrescribedMotion::PrescribedMotion(Function pose, std::string name)
    : pose_(std::move(pose)), name_(std::move(name)) {}
PrescribedMotion::~PrescribedMotion() = default;
PrescribedMotion::PrescribedMotion(PrescribedMotion&&) noexcept = default;
PrescribedMotion& PrescribedMotion::operator=(PrescribedMotion&&) noexcept = default;

Extent PrescribedMotion::extend(double t) {
  check_finite_time(t);
  const auto end = [this] { return track_->pieces.empty() ? 0.0 : track_->end(); };
  while ((track_->pieces.empty() || end() < t) && failure_.empty()) {
    const bool fitted = fit(next_cell_, kCellWidth, 0, nullptr);
    next_cell_ += kCellWidth;
    if (!fitted && last_) {
      close(*last_, last_->rate_end);
      last_.reset();
    }
  }
  if (track_->pieces.empty() || end() < t) return {Extent::Status::failed, end(), failure_};
  return {Extent::Status::reached, end(), {}};
}

/// Interpolates the function on the cell, and measures the misfit at the checking points. False where a value
/// is not finite.
bool PrescribedMotion::sample(double begin, double width, const Vector3d* base_scale, Fitted& cell) {
  const Nodes& n = nodes();
  const double middle = begin + 0.5 * width, half = 0.5 * width;
  Columns at;
  for (int j = 0; j <= kDegree; ++j) at.row(j) = pose_(middle + half * n.at[j]).transpose();
  if (!at.allFinite()) return false;
  const Columns monomials = n.monomials(at);
  cell.piece.begin = begin;
  cell.piece.end = begin + width;
  cell.piece.origin = middle;
  cell.piece.degree = kDegree;
  while (cell.piece.degree > 1 && monomials.row(cell.piece.degree).isZero(0.0)) --cell.piece.degree;
  double power = 1.0;
  for (int k = 0; k <= kDegree; ++k, power /= half) cell.piece.c[k] = power * monomials.row(k).transpose();
  cell.value_begin = at.row(0).transpose();
  cell.value_end = at.row(kDegree).transpose();
  cell.rate_begin = rates(cell.piece.state(begin).twist);
  cell.rate_end = rates(cell.piece.state(begin + width).twist);
  cell.scale = at.cwiseAbs().colwise().maxCoeff().transpose();
  // a time is known to half a bit: what the function makes of that is noise
  const Vector3d slope = 3.0 / width * (at.colwise().maxCoeff() - at.colwise().minCoeff()).transpose();
  const double time_rounding = 4.0 * std::numeric_limits<double>::epsilon() * (begin + width);
  cell.tolerance = kFitTolerance * cell.scale + time_rounding * slope;
  const Vector3d scale =
      cell.scale.cwiseMax(base_scale ? *base_scale : Vector3d(cell.scale)).cwiseMax(1e-300);
  double& worst = cell.worst;
  for (double u : n.check) {
    const Vector3d value = pose_(middle + half * u);
    if (!value.allFinite()) return false;
    const Vector3d misfit = (value - values(cell.piece.state(middle + half * u).pose)).cwiseAbs();
    for (int i = 0; i < 3; ++i) {
      if (!(misfit[i] > cell.tolerance[i])) continue;
      cell.fits = false;
      cell.misfit = std::max(cell.misfit, misfit[i] / scale[i]);
    }
    worst = std::max(worst, misfit.maxCoeff());
  }
  return true;
}

/// True if the fit is good, or as good as the function's own noise lets it be.
bool PrescribedMotion::settled(const Fitted& cell, int depth) const {
  if (cell.fits) return true;
  const bool halving_helps = depth < 3 || cell.misfit < 0.5 * misfits_[depth - 3];
  return !halving_helps && cell.misfit <= kNoiseTolerance;
}

/// `base_scale`: of the largest cell around this one that is finite throughout; null: none yet.
bool PrescribedMotion::fit(double begin, double width, int depth, const Vector3d* base_scale) {
  Fitted cell;
  const bool finite = sample(begin, width, base_scale, cell);
  misfits_[depth] = finite ? cell.misfit : std::numeric_limits<double>::infinity();
  if (finite && settled(cell, depth)) {
    worst_fit_ = std::max(worst_fit_, cell.worst);
    join_next(cell);
    return true;
  }
  const double half = 0.5 * width;
  const Vector3d* scale = base_scale || !finite ? base_scale : &cell.scale;
  if (depth + 1 < kDepths)
    return fit(begin, half, depth + 1, scale) && fit(begin + half, half, depth + 1, scale);
  if (!finite) return fail(begin, "is not finite");
  return take_corner(std::move(cell), depth);
}

/// A cell too small to halve. The misfit of a corner halves with the cell, a square root's falls by sqrt(2),
/// a jump's stays. (Next to the cell's edge a corner's may stay too, but is then far below the noise.)
bool PrescribedMotion::take_corner(Fitted cell, int depth) {
  const bool shrinks = cell.misfit < 0.03 * misfits_[depth - 8];
  if (!shrinks && cell.misfit > kNoiseTolerance)
    return fail(cell.piece.begin, "jumps, or is infinitely fast,");
  cell.corner = true;
  cell.rate_begin = cell.rate_end = (cell.value_end - cell.value_begin) / cell.width();
  join_next(cell);
  return true;
}

/// Decides the twist at the join of last_ and `next`, and closes last_ with it.
void PrescribedMotion::join_next(const Fitted& next) {
  if (!last_) {
    rate_begin_ = next.rate_begin;
    last_ = std::make_unique<Fitted>(next);
    return;
  }
  Fitted& last = *last_;
  Vector3d rate =
      (last.width() * last.rate_end + next.width() * next.rate_begin) / (last.width() + next.width());
  if (last.corner != next.corner) rate = last.corner ? next.rate_begin : last.rate_end;
  const Vector3d jump = (next.rate_begin - last.rate_end).cwiseAbs();
  const bool smooth = (jump.array() <= (last.rate_tolerance() + next.rate_tolerance()).array()).all();
  const double corner_width = std::ldexp(kCellWidth, 1 - kDepths);
  if (!smooth && !last.corner && !next.corner && last.width() > 2.0 * corner_width) {
    // a corner on the grid itself: a corner cell of its own, taken from the end of the left piece
    const double cut = last.piece.end - corner_width;
    const BodyState at_cut = last.piece.state(cut);
    Fitted corner = last;
    last.piece.end = corner.piece.begin = cut;
    last.value_end = corner.value_begin = values(at_cut.pose);
    last.rate_end = rates(at_cut.twist);
    corner.corner = true;
    close(last, last.rate_end);
    rate_begin_ = last.rate_end;
    *last_ = corner;
    rate = next.rate_begin;
  }
  close(*last_, rate);
  rate_begin_ = rate;
  *last_ = next;
}

/// Appends a piece that begins with rate_begin_ and ends with rate_end, its end values exactly the
/// function's.
void PrescribedMotion::close(const Fitted& fitted, const Vector3d& rate_end) {
  PolynomialPiece piece = fitted.piece;
  if (fitted.corner) {
    piece.origin = piece.begin;
    piece.degree = 0;
    piece.c[0].setZero();
  }
  const BodyState begin = piece.state(piece.begin), end = piece.state(piece.end);
  add_cubic(piece, fitted.value_begin - values(begin.pose), rate_begin_ - rates(begin.twist),
            fitted.value_end - values(end.pose), rate_end - rates(end.twist));
  track_->pieces.push_back(piece);
}

bool PrescribedMotion::fail(double t, const std::string& what) {
  failure_ =
      name_ + " " + what + " near t = " + time_text(t) + " s; allowed: finite, continuous functions of t";
  return false;
}

}  // namespace brink
