/// How cells become pieces:
///
///   fit_next   takes the next cell, interpolates it, and asks for the bound; halves it where that is not met
///   join_next  a fitted cell waits in last_ until the one after it is fitted: it may stand for that as well, or else
///              the twist at which the two meet needs both
///   close      appends the waiting cell, with its end values and the twists at both of its ends
///
/// So the track is one cell behind what has been fitted, and nothing in it is changed later.
#include "brink/integrators/prescribed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "brink/core/base/elementary.h"
#include "brink/core/base/sine_cosine.h"
#include "brink/integrators/dense_output.h"
#include "brink/integrators/stepping.h"

namespace brink {

namespace {

using Eigen::Vector3d;

/// A polynomial of degree 10 has eleven nodes, and its error goes by the eleventh derivative.
constexpr int kDegree = 10;
constexpr double kCellWidth = 0.0625;     // 2^-4 s
constexpr double kFitTolerance = 1e-13;   // of the cell's largest value
constexpr double kNothing = 1e-18;        // [m or rad]: smaller is not followed
constexpr double kNoiseTolerance = 1e-9;  // the same, of a range of values that cannot be halved
constexpr double kStrip = 0.25;           // of a corner's cell
constexpr double kAlikeNoise = 64.0;      // roundings of values in one cell differ by less,
constexpr double kRough = 1e-7;           // or are no more than some roots of a rounding
constexpr double kMeets = 16.0;           // tolerances of the fit by which it may be off between its nodes
constexpr double kPi = 3.14159265358979323846;

using Matrix = Eigen::Matrix<double, kDegree + 1, kDegree + 1>;
using Columns = Eigen::Matrix<double, kDegree + 1, 3>;  // x, y, angle

/// Eigen's own would have other last bits on processors with fused products.
Columns product(const Matrix& a, const Columns& b) {
  Columns sums = Columns::Zero();
  for (int column = 0; column < sums.cols(); ++column)
    for (int k = 0; k <= kDegree; ++k)
      for (int row = 0; row <= kDegree; ++row) sums(row, column) += a(row, k) * b(k, column);
  return sums;
}

/// Chebyshev-Lobatto points on [-1, 1] and one between each two of them; the maps from values at the
/// former to Chebyshev coefficients, and from those to monomials. Two maps, because their product would
/// cancel.
struct Nodes {
  std::array<double, kDegree + 1> at;
  std::array<double, kDegree> between;
  Matrix to_chebyshev, to_monomial = Matrix::Zero();

  Nodes() {
    for (int j = 0; j <= kDegree; ++j) at[j] = -sine_cosine(kPi * j / kDegree).cosine;
    // cos() of these is off by a rounding; neighbouring cells must share their ends to the bit
    at[0] = -1.0, at[kDegree / 2] = 0.0, at[kDegree] = 1.0;
    for (int j = 0; j < kDegree; ++j) between[j] = -sine_cosine(kPi * (j + 0.5) / kDegree).cosine;
    const auto half_at_ends = [](int i) { return i == 0 || i == kDegree ? 0.5 : 1.0; };
    // The discrete cosine transform of the values: node j is cos(pi (n - j) / n), ends count half.
    for (int k = 0; k <= kDegree; ++k)
      for (int j = 0; j <= kDegree; ++j)
        to_chebyshev(k, j) = half_at_ends(j) * half_at_ends(k) * 2.0 / kDegree *
                             sine_cosine(kPi * (k * (kDegree - j)) / kDegree).cosine;
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
    Columns chebyshev = product(to_chebyshev, values);
    for (int i = 0; i < 3; ++i) {
      const double rounding =
          2.0 * std::numeric_limits<double>::epsilon() * values.col(i).cwiseAbs().maxCoeff();
      for (int k = kDegree; k > 0 && std::abs(chebyshev(k, i)) <= rounding; --k) chebyshev(k, i) = 0.0;
    }
    return product(to_monomial, chebyshev);
  }
};

const Nodes& nodes() {
  static const Nodes made;
  return made;
}

/// x, y, angle as one vector, of rates and of values.
Vector3d rates(const Twist& twist) { return {twist.velocity.x(), twist.velocity.y(), twist.omega}; }
Vector3d values(const Pose& pose) { return {pose.position.x(), pose.position.y(), pose.angle}; }

}  // namespace

/// A cell's interpolant, and what is known of it.
struct PrescribedMotion::Fitted {
  PolynomialPiece piece;
  bool corner = false;  ///< too small to halve: only its end values count
  bool meets = false;   ///< the function between its nodes, too
  Vector3d value_begin = Vector3d::Zero(), value_end = Vector3d::Zero();
  Vector3d rate_begin = Vector3d::Zero(), rate_end = Vector3d::Zero();
  Vector3d tolerance = Vector3d::Zero();      ///< of the fit
  Vector3d noise_on_grid = Vector3d::Zero();  ///< see Noise
  Vector3d scale = Vector3d::Zero();          ///< largest value
  double cell_width = 0.0;                    ///< of the cell that it has been fitted to [s]
  /// The function at the nodes of all cells that it stands for.
  std::vector<std::pair<double, Vector3d>> told;

  double width() const { return piece.end - piece.begin; }
  /// What the end rates may be off by: n^2 times the fit over the half width (Markov's inequality).
  Vector3d rate_tolerance() const { return (2.0 * kDegree * kDegree / cell_width) * tolerance; }
  /// True if another's polynomial, continued, is as near to the function here as its own.
  bool continues(const PolynomialPiece& other) const {
    return std::all_of(told.begin(), told.end(), [&](const auto& node) {
      return ((values(other.state(node.first).pose) - node.second).cwiseAbs().array() <= tolerance.array())
          .all();
    });
  }
};

PrescribedMotion::PrescribedMotion(const Vector3d& base, Function pose, Bound bound, std::string name)
    : base_(base), pose_(std::move(pose)), bound_(std::move(bound)), name_(std::move(name)) {}
PrescribedMotion::~PrescribedMotion() = default;
PrescribedMotion::PrescribedMotion(PrescribedMotion&&) noexcept = default;
PrescribedMotion& PrescribedMotion::operator=(PrescribedMotion&&) noexcept = default;

Extent PrescribedMotion::extend(double t, std::uint64_t most_cells) {
  check_finite_time(t);
  const auto end = [this] { return begun() ? track_->end() : 0.0; };
  for (std::uint64_t n = 0; (!begun() || end() < t) && failure_.empty() && n < most_cells; ++n) {
    fit_next();
    // Nothing follows: what was fitted before the failure ends with its own rate, so that
    // the motion covers it.
    if (failure_.empty() || !last_) continue;
    close(*last_, last_->rate_end);
    last_.reset();
  }
  if (begun() || failure_.empty()) return extent_at(end(), t, failure_);
  return {Extent::Status::failed, 0.0, failure_};
}

/// Fits the next cell, or halves it.
void PrescribedMotion::fit_next() {
  // The halves of the present grid cell first; the next cell of the grid when all of them are done.
  if (cells_.empty()) {
    cells_.push_back({next_cell_, kCellWidth, 0});
    next_cell_ += kCellWidth;
  }
  const Cell at = cells_.back();
  cells_.pop_back();
  Fitted cell;
  const bool finite = interpolate(at, cell);
  // distances and speeds are told by their squares
  if (finite &&
      !std::isfinite((cell.scale + cell.rate_begin.cwiseAbs() + cell.rate_end.cwiseAbs()).squaredNorm()))
    return fail(at.begin, "is too fast, or goes too far,");
  const Certainty known = bound(at);
  if (finite && cell.meets && (known.remainder.array() <= cell.tolerance.array()).all()) {
    corners_in_a_row_ = 0;
    return join_next(cell);
  }
  const double half = 0.5 * at.width;
  if (at.depth + 1 < kDepths) {
    // a stack: the left half is to be fitted first
    cells_.push_back({at.begin + half, half, at.depth + 1});
    cells_.push_back({at.begin, half, at.depth + 1});
    return;
  }
  if (!finite) return fail(at.begin, "is not finite");
  take_corner(std::move(cell), known);
}

/// Interpolates the function on the cell. False where a value is not finite, at the nodes or between them.
bool PrescribedMotion::interpolate(const Cell& at, Fitted& cell) {
  const Nodes& n = nodes();
  const double half = 0.5 * at.width, middle = at.begin + half;
  Columns y;
  // Cells share their ends to the bit, and so the values there: pieces meet without a jump.
  for (int j = 0; j <= kDegree; ++j) {
    const double t = middle + half * n.at[j];
    const Vector3d value = pose_(t);
    y.row(j) = value.transpose();
    cell.told.emplace_back(t, value);
  }
  if (!y.allFinite()) return false;
  cell.cell_width = at.width;
  const Columns monomials = n.monomials(y);
  cell.piece.begin = at.begin;
  cell.piece.end = at.begin + at.width;
  cell.piece.origin = middle;
  cell.piece.degree = kDegree;
  while (cell.piece.degree > 1 && monomials.row(cell.piece.degree).isZero(0.0)) --cell.piece.degree;
  // from u in [-1, 1] to seconds: u = (t - middle) / half
  double power = 1.0;
  for (int k = 0; k <= kDegree; ++k, power /= half) cell.piece.c[k] = power * monomials.row(k).transpose();
  cell.value_begin = y.row(0).transpose();
  cell.value_end = y.row(kDegree).transpose();
  cell.rate_begin = rates(cell.piece.state(cell.piece.begin).twist);
  cell.rate_end = rates(cell.piece.state(cell.piece.end).twist);
  cell.scale = y.cwiseAbs().colwise().maxCoeff().transpose();
  // The function's own roundings cannot be followed, and are allowed for: no halving would make them less.
  const Noise of_values = noise(at, cell.scale);
  cell.noise_on_grid = of_values.on_grid;
  cell.tolerance = kFitTolerance * cell.scale + of_values.roundings + Vector3d::Constant(kNothing);
  // Bounds hold inside: a jump right at an end of the cell they may not see, but its node does.
  const Vector3d most_off = kMeets * cell.tolerance + kRough * cell.scale.cwiseMax(1.0);
  cell.meets = true;
  for (const double u : n.between) {
    const double t = middle + half * u;
    const Vector3d value = pose_(t), off = values(cell.piece.state(t).pose) - value;
    if (!value.allFinite()) return false;
    cell.meets = cell.meets && (off.cwiseAbs().array() <= most_off.array()).all();
  }
  return true;
}

/// What roundings make of the function's value: its bounds at single times. Where it jumps right at a time of the grid, they are
/// as far apart as it jumps: much more than at times that no jump lies at, and than roots and arc sines are rough, is no rounding.
PrescribedMotion::Noise PrescribedMotion::noise(const Cell& at, const Vector3d& scale) const {
  const auto most_of = [&](std::initializer_list<double> parts) {
    Vector3d most = Vector3d::Zero();
    for (const double part : parts)
      for (int i = 0; i < 3; ++i) {
        const double t = at.begin + part * at.width, spread = bound_(i, t, t, BoundOf::value).spread();
        if (std::isfinite(spread)) most[i] = std::max(most[i], spread);
      }
    return most;
  };
  const Vector3d on_grid = most_of({0.0, 0.5, 1.0}), rough = kRough * scale.cwiseMax(1.0);
  if ((on_grid.array() <= rough.array()).all()) return {on_grid, on_grid};
  const Vector3d elsewhere = most_of({0.381966, 0.723607});
  const Vector3d believed = (kAlikeNoise * elsewhere).cwiseMax(rough);
  return {(on_grid.array() <= believed.array()).select(on_grid, elsewhere), on_grid};
}

/// The interpolant in n + 1 nodes misses f by at most |f^(n+1)| / (n+1)! times the product of the distances
/// to the nodes, which for Chebyshev-Lobatto points is at most (w / 2)^(n+1) / 2^(n-1).
PrescribedMotion::Certainty PrescribedMotion::bound(const Cell& at) const {
  static_assert(kDegree == 10, "the eleventh derivative belongs to eleven nodes");
  const double product = std::ldexp(power(0.5 * at.width, kDegree + 1), 1 - kDegree);
  Certainty known;
  for (int i = 0; i < 3; ++i) {
    const TimeBound b = bound_(i, at.begin, at.begin + at.width, BoundOf::eleventh);
    known.spread[i] = b.spread();
    known.remainder[i] = b.eleventh == 0.0 ? 0.0 : product * b.eleventh;
  }
  return known;
}

/// A cell too small to halve. The range of values over a corner shrinks with the cell, over a square root's
/// foot as its root, over a jump not at all; where it is next to nothing it does not matter. Corners that do
/// not end are none: there the bounds say nothing.
void PrescribedMotion::take_corner(Fitted cell, const Certainty& known) {
  if (++corners_in_a_row_ > kMostCornersInARow)
    return fail(cell.piece.begin,
                "cannot be bounded by interval arithmetic (it may have corners everywhere)");
  for (int i = 0; i < 3; ++i) {
    // With 128 of its widths on both sides, so that the range is that of the corner's steeper side wherever in the cell that is, a
    // corner's is at least 128 times as large, over a square root's foot 11 times, over a jump the same: 0.03 lies between
    // the first two.
    const double spread = std::max(known.spread[i], std::abs(cell.value_end[i] - cell.value_begin[i]));
    // a jump in a part of the formula that others take back, as of t - rint(t) in its absolute value, is none if no value shows it
    const bool taken_back = cell.meets && spread <= 8.0 * cell.noise_on_grid[i];
    const bool small = taken_back || spread <= kNoiseTolerance * cell.scale[i] + 8.0 * cell.tolerance[i];
    const double around = 128.0 * cell.cell_width, from = std::max(0.0, cell.piece.begin - around);
    const double wide = bound_(i, from, cell.piece.end + around, BoundOf::value).spread();
    const bool shrinks = std::isfinite(wide) && spread < 0.03 * wide;
    if (!small && !shrinks) return fail(cell.piece.begin, "jumps, or is infinitely fast,");
  }
  cell.corner = true;
  cell.rate_begin = cell.rate_end = (cell.value_end - cell.value_begin) / cell.width();
  join_next(cell);
}

/// Beside a corner cells are halved and halved, and in narrow ones roundings of the values would be accelerations. There the wider
/// one's polynomial is taken for both, where it is as near to the function. A corner at an end of its cell is seen from the other
/// side, too: two cells are one then. False: `next` is a piece of its own.
bool PrescribedMotion::is_merged(Fitted& next) {
  Fitted& last = *last_;
  if (last.corner && next.corner && last.piece.end - last.piece.begin < 1.5 * next.cell_width) {
    last.piece.end = next.piece.end;
    last.value_end = next.value_end;
    last.rate_begin = last.rate_end = (last.value_end - last.value_begin) / last.width();
    return true;
  }
  if (last.corner || next.corner || std::min(last.cell_width, next.cell_width) == kCellWidth) return false;
  const bool grows = next.cell_width > last.cell_width;
  if (!(grows ? last.continues(next.piece) : next.continues(last.piece))) return false;
  if (grows) {
    next.piece.begin = last.piece.begin;
    next.value_begin = last.value_begin;
    std::swap(last, next);
  } else {
    last.piece.end = next.piece.end;
    last.value_end = next.value_end;
    last.rate_end = rates(last.piece.state(last.piece.end).twist);
  }
  last.told.insert(last.told.end(), next.told.begin(), next.told.end());
  return true;
}

/// Where two cells meet is moved to t, on the one of them that is no corner.
void PrescribedMotion::move_join(Fitted& left, Fitted& right, double t) {
  const BodyState at = (left.corner ? right : left).piece.state(t);
  left.piece.end = right.piece.begin = t;
  left.value_end = right.value_begin = values(at.pose);
  (left.corner ? right.rate_begin : left.rate_end) = rates(at.twist);
}

/// Decides the twist at the join of last_ and `next`, and closes last_ with it.
void PrescribedMotion::join_next(Fitted next) {
  // The first cell: nothing came before, and its own rate is where the motion begins.
  if (!last_) {
    rate_begin_ = next.rate_begin;
    last_ = std::make_unique<Fitted>(std::move(next));
    return;
  }
  if (is_merged(next)) return;
  // A corner takes a strip from either side, so that it does not lie at an end of its cell.
  const double corner_width = std::ldexp(kCellWidth, 1 - kDepths), strip = kStrip * corner_width;
  if (last_->corner != next.corner)
    move_join(*last_, next, last_->piece.end + (next.corner ? -strip : strip));
  // Both rates are right to their fits; the wider cell's is the better, as rate errors go by 1 / width.
  Vector3d rate = (last_->cell_width * last_->rate_end + next.cell_width * next.rate_begin) /
                  (last_->cell_width + next.cell_width);
  // a corner's own rate is a chord's: the smooth neighbour's is right
  if (last_->corner != next.corner) rate = last_->corner ? next.rate_begin : last_->rate_end;
  const Vector3d jump = (next.rate_begin - last_->rate_end).cwiseAbs();
  const bool smooth = (jump.array() <= (last_->rate_tolerance() + next.rate_tolerance()).array()).all();
  if (!smooth && !last_->corner && !next.corner &&
      std::min(last_->width(), next.width()) > 2.0 * corner_width) {
    // a corner on the grid itself: a corner cell of its own, half of it from either side
    const double at = last_->piece.end;
    Fitted turn = *last_;
    turn.corner = true;
    move_join(*last_, turn, at - 0.5 * corner_width);
    close(*last_, last_->rate_end);
    rate_begin_ = last_->rate_end;
    *last_ = std::move(turn);
    move_join(*last_, next, at + 0.5 * corner_width);
    // The corner cell turns from the left piece's rate to the right one's.
    rate = next.rate_begin;
  }
  close(*last_, rate);
  rate_begin_ = rate;
  *last_ = std::move(next);
}

/// Appends a piece that begins with rate_begin_ and ends with rate_end, its end values the function's but for
/// the rounding of the base.
void PrescribedMotion::close(const Fitted& fitted, const Vector3d& rate_end) {
  if (fitted.corner) return close_corner(fitted, rate_end);
  PolynomialPiece piece = fitted.piece;
  const BodyState begin = piece.state(piece.begin), end = piece.state(piece.end);
  add_cubic(piece, fitted.value_begin - values(begin.pose), rate_begin_ - rates(begin.twist),
            fitted.value_end - values(end.pose), rate_end - rates(end.twist));
  // last: beside a base far away the fit would have lost its digits
  piece.c[0] += base_;
  track_->pieces.push_back(piece);
}

/// Where the corner is, is known from the end values: the rate goes straight from the one to the other about there, and is
/// never beyond them. (A cubic over the whole cell would be a third faster for a moment, and throw what lies on the site.)
void PrescribedMotion::close_corner(const Fitted& cell, const Vector3d& rate_end) {
  const double width = cell.width();
  const Vector3d rise = cell.value_end - cell.value_begin;
  int sharpest = 0;
  (rate_end - rate_begin_).cwiseAbs().maxCoeff(&sharpest);
  const double part =
      (rise[sharpest] / width - rate_end[sharpest]) / (rate_begin_[sharpest] - rate_end[sharpest]);
  double low = 0.0, high = width;
  // no corner between the two rates (a square root's foot): one cubic
  if (part > 0.0 && part < 1.0) {
    const double half = std::min(part, 1.0 - part) * width;
    low = std::max(0.0, part * width - half);
    high = std::min(width, part * width + half);
  }
  const Vector3d at_low = cell.value_begin + low * rate_begin_,
                 at_high = cell.value_end - (width - high) * rate_end;
  const double begin = cell.piece.begin, from = begin + low,
               to = high < width ? begin + high : cell.piece.end;
  const auto add = [&](double t0, double t1, int degree, auto&& fill) {
    if (!(t1 > t0)) return;
    PolynomialPiece piece;
    piece.begin = piece.origin = t0;
    piece.end = t1;
    piece.degree = degree;
    fill(piece);
    piece.c[0] += base_;
    track_->pieces.push_back(piece);
  };
  // straight to the bit: roundings of a cubic would be accelerations here
  const auto line = [&](double t0, double t1, const Vector3d& value, const Vector3d& rate) {
    add(t0, t1, 1, [&](PolynomialPiece& p) { p.c[0] = value, p.c[1] = rate; });
  };
  line(begin, from, cell.value_begin, rate_begin_);
  const double turns = to - from;
  const Vector3d off = at_high - at_low - 0.5 * turns * (rate_begin_ + rate_end);
  if ((off.cwiseAbs().array() <= 4.0 * cell.tolerance.array()).all())
    add(from, to, 2, [&](PolynomialPiece& p) {
      p.c[0] = at_low, p.c[1] = rate_begin_, p.c[2] = (rate_end - rate_begin_) / (2.0 * turns);
    });
  else
    add(from, to, 0, [&](PolynomialPiece& p) { add_cubic(p, at_low, rate_begin_, at_high, rate_end); });
  line(to, cell.piece.end, at_high, rate_end);
}

/// Lasting. The motion ends with what has been fitted before; extend() closes it.
void PrescribedMotion::fail(double t, const std::string& what) {
  failure_ =
      name_ + " " + what + " near t = " + time_text(t) + " s; allowed: finite, continuous functions of t";
}

}  // namespace brink
