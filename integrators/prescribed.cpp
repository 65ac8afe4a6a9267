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

/// Chebyshev-Lobatto points on [-1, 1], the checking points between them, and the map from values at the
/// former to monomial coefficients.
struct Nodes {
  std::array<double, kDegree + 1> at;
  std::array<double, kDegree> check;
  Eigen::Matrix<double, kDegree + 1, kDegree + 1> to_monomial;

  Nodes() {
    using Matrix = Eigen::Matrix<long double, kDegree + 1, kDegree + 1>;
    for (int j = 0; j <= kDegree; ++j) at[j] = -std::cos(kPi * j / kDegree);
    at[0] = -1.0, at[kDegree / 2] = 0.0, at[kDegree] = 1.0;
    for (int j = 0; j < kDegree; ++j) check[j] = -std::cos(kPi * (j + 0.5) / kDegree);
    // values -> Chebyshev coefficients (discrete cosine transform), then T_k in monomials by their recurrence
    Matrix transform, monomials = Matrix::Zero();
    for (int k = 0; k <= kDegree; ++k)
      for (int j = 0; j <= kDegree; ++j) {
        const long double ends =
            (j == 0 || j == kDegree ? 0.5L : 1.0L) * (k == 0 || k == kDegree ? 0.5L : 1.0L);
        transform(k, j) =
            ends * 2.0L / kDegree * std::cos(3.14159265358979323846264L * k * (kDegree - j) / kDegree);
      }
    monomials(0, 0) = monomials(1, 1) = 1.0L;
    for (int k = 2; k <= kDegree; ++k) {
      monomials.col(k) = -monomials.col(k - 2);
      for (int i = 1; i <= kDegree; ++i) monomials(i, k) += 2.0L * monomials(i - 1, k - 1);
    }
    to_monomial = (monomials * transform).cast<double>();
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
    const bool fitted = fit(next_cell_, kCellWidth, 0);
    next_cell_ += kCellWidth;
    if (!fitted && last_) {
      close(*last_, last_->rate_end);
      last_.reset();
    }
  }
  if (track_->pieces.empty() || end() < t) return {Extent::Status::failed, end(), failure_};
  return {Extent::Status::reached, end(), {}};
}

/// Interpolates the function on the cell; *error is the worst misfit as a multiple of the tolerance. False
/// where a value is not finite (why is then in failure_ if the cell cannot be halved).
bool PrescribedMotion::sample(double begin, double width, Fitted& cell, double* error) {
  const Nodes& n = nodes();
  const double middle = begin + 0.5 * width, half = 0.5 * width;
  Eigen::Matrix<double, kDegree + 1, 3> at;
  for (int j = 0; j <= kDegree; ++j) at.row(j) = pose_(middle + half * n.at[j]).transpose();
  if (!at.allFinite()) return false;
  const Eigen::Matrix<double, kDegree + 1, 3> monomials = n.to_monomial * at;
  cell.piece.begin = begin;
  cell.piece.end = begin + width;
  cell.piece.origin = middle;
  cell.piece.degree = kDegree;
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
  *error = 0.0;
  for (double u : n.check) {
    const Vector3d value = pose_(middle + half * u);
    if (!value.allFinite()) return false;
    const Vector3d misfit = (value - values(cell.piece.state(middle + half * u).pose)).cwiseAbs();
    for (int i = 0; i < 3; ++i)
      if (misfit[i] > 0.0) *error = std::max(*error, misfit[i] / std::max(cell.tolerance[i], 1e-300));
  }
  return true;
}

/// True if the fit is good, or as good as the function's own noise lets it be.
bool PrescribedMotion::settled(const Fitted&, int depth, double error) {
  if (error <= 1.0) return true;
  const bool halving_helps = depth < 3 || error < 0.5 * errors_[depth - 3];
  return !halving_helps && error * kFitTolerance <= kNoiseTolerance;
}

bool PrescribedMotion::fit(double begin, double width, int depth) {
  Fitted cell;
  double error = 0.0;
  const bool finite = sample(begin, width, cell, &error);
  errors_[depth] = finite ? error : std::numeric_limits<double>::infinity();
  if (finite && settled(cell, depth, error)) {
    worst_fit_ = std::max(worst_fit_, error * cell.tolerance.maxCoeff());
    join_next(cell);
    return true;
  }
  if (depth + 1 < kDepths)
    return fit(begin, 0.5 * width, depth + 1) && fit(begin + 0.5 * width, 0.5 * width, depth + 1);
  if (!finite) return fail(begin, "is not finite");
  return take_corner(std::move(cell), depth, error);
}

/// A cell too small to halve. The misfit of a corner halves with the cell; that of a jump stays.
bool PrescribedMotion::take_corner(Fitted cell, int depth, double error) {
  if (!(error < 0.25 * errors_[depth - 8])) return fail(cell.piece.begin, "jumps, or is infinitely fast,");
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
