#include "brink/core/contacts/lcp.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace brink {

namespace {

/// Lemke's tableau: every row is one equation of w - A z - d z0 = q, solved for its basic variable. Columns
/// are w, z, z0, and the right-hand side.
class Tableau {
 public:
  // The covering vector d is all ones, so that the first pivot on z0 lifts all other
  // right-hand sides by the same amount.
  Tableau(const RealMatrix& A, const RealVector& q) : n_(static_cast<int>(q.size())), rows_(n_, 2 * n_ + 2) {
    rows_.setZero();
    rows_.leftCols(n_).setIdentity();
    rows_.middleCols(n_, n_) = -A;
    rows_.col(z0()).setConstant(-1);
    rows_.col(right()) = q;
    for (int k = 0; k < n_; ++k) basic_.push_back(k);
  }

  /// Brings z0 in where q is most negative: from there on the right-hand side is >= 0. Of rows alike in that
  /// the last: its unit vector is the least, so that all others are lexicographically positive from there
  /// on, without which first() does not keep ties from cycling.
  int begin() {
    const Real least = rows_.col(right()).minCoeff();
    // q has a negative entry: solve_lcp_by_lemke() answers the other problems itself.
    int row = n_ - 1;
    while (rows_(row, right()) > least + kTie) --row;
    return pivot(row, z0());
  }

  /// The row whose basic variable reaches 0 first as variable `entering` grows; -1: none does.
  int leaving_row(int entering) const {
    int best = -1;
    for (int k = 0; k < n_; ++k) {
      if (rows_(k, entering) <= kPivot) continue;
      if (best < 0 || first(k, best, entering)) best = k;
    }
    return best;
  }

  /// Exchanges; returns the variable that left.
  int pivot(int row, int entering) {
    rows_.row(row) /= rows_(row, entering);
    // about half of a row is 0: of the columns that have left the basis, and of bodies far away
    filled_.clear();
    for (Eigen::Index c = 0; c < rows_.cols(); ++c)
      if (rows_(row, c) != 0) filled_.push_back(c);
    for (int k = 0; k < n_; ++k) {
      const Real part = rows_(k, entering);
      if (k == row || part == 0) continue;
      for (const Eigen::Index c : filled_) rows_(k, c) -= part * rows_(row, c);
    }
    std::swap(basic_[row], entering);
    return entering;
  }

  /// w_k and z_k are complementary: at most one of them is ever basic, which keeps z.w = 0 all the way.
  int complement(int variable) const { return variable < n_ ? variable + n_ : variable - n_; }
  int z0() const { return 2 * n_; }

  /// 0 at a solution.
  Real z0_value() const {
    for (int k = 0; k < n_; ++k)
      if (basic_[k] == z0()) return rows_(k, right());
    return 0;
  }

  RealVector solution() const {
    RealVector z = RealVector::Zero(n_);
    for (int k = 0; k < n_; ++k)
      // What is not basic is 0. A basic z below 0 is rounding: every pivot keeps the right-hand side >= 0.
      if (basic_[k] >= n_ && basic_[k] < z0()) z[basic_[k] - n_] = std::max(Real(0), rows_(k, right()));
    return z;
  }

 private:
  static constexpr Real kPivot = 1e-13;  ///< of entries that begin at 1: below is rounding
  static constexpr Real kTie = 1e3 * kRealEpsilon;

  int right() const { return 2 * n_ + 1; }

  /// True if row a comes before row b in the lexicographic order of (right-hand side, inverse basis) / pivot.
  /// Of rows alike in the right-hand side, z0's comes first: it ends the method.
  bool first(int a, int b, int entering) const {
    const Real pa = rows_(a, entering), pb = rows_(b, entering);
    const auto compare = [&](int column) {
      const Real x = rows_(a, column) / pa, y = rows_(b, column) / pb;
      return abs(x - y) <= kTie * std::max({Real(1), abs(x), abs(y)}) ? 0 : (x < y ? -1 : 1);
    };
    if (const int order = compare(right()); order != 0) return order < 0;
    if (basic_[a] == z0() || basic_[b] == z0()) return basic_[a] == z0();
    // The first n columns began as the identity: they hold the inverse of the basis.
    for (int column = 0; column < n_; ++column)
      if (const int order = compare(column); order != 0) return order < 0;
    return false;
  }

  int n_;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows_;
  std::vector<int> basic_;            ///< variable of each row
  std::vector<Eigen::Index> filled_;  ///< columns of the pivot's row that are not 0
};

/// z0 below this is 0, where |q| <= 1.
constexpr Real kZeroOnRay = 1e5 * kRealEpsilon;

/// Below this many rows a dense tableau is as quick as anything.
constexpr Eigen::Index kFewRows = 48;

/// @pre a problem scaled as solve_lcp_by_lemke() does, with a negative entry of q.
LcpAnswer lemke(const RealMatrix& A, const RealVector& q, const GoOn& go_on) {
  // About n pivots are usual. The cap is for matrices of no class for which the method is known to end.
  const int n = static_cast<int>(q.size()), most = 50 * n + 100;
  LcpAnswer answer;
  Tableau tableau(A, q);
  // From here on exactly one pair (w_k, z_k) has neither of its variables basic. One of
  // the two has just left, so the other one enters: there is no choice. The path ends
  // where z0 leaves, or where nothing limits what enters.
  int entering = tableau.complement(tableau.begin());
  for (answer.pivots = 1; answer.pivots < most; ++answer.pivots) {
    if (go_on && !go_on()) {
      answer.status = LcpAnswer::Status::stopped;
      return answer;
    }
    const int row = tableau.leaving_row(entering);
    // On a ray z0 may be 0 to rounding all the same, in a row whose pivot lies below
    // kPivot: also a solution.
    const bool ray = row < 0;
    const int left = ray ? tableau.z0() : tableau.pivot(row, entering);
    if (ray && tableau.z0_value() > kZeroOnRay) {
      answer.status = LcpAnswer::Status::none;
      return answer;
    }
    if (left == tableau.z0()) {
      answer.z = tableau.solution();
      return answer;
    }
    entering = tableau.complement(left);
  }
  answer.status = LcpAnswer::Status::capped;
  return answer;
}

}  // namespace

LcpAnswer solve_lcp_by_lemke(const RealMatrix& A, const RealVector& q, const GoOn& go_on) {
  if (q.size() == 0 || q.minCoeff() >= 0) return {LcpAnswer::Status::solved, RealVector::Zero(q.size()), 0};
  // Scaled to a diagonal of ones and |q| <= 1; a row whose diagonal is not positive is taken as it is. With
  // D = diag(scale) and s = q_size: A' = D A D, q' = D q / s and z = s D z' give w' = D w / s, so that
  // signs and complementarity are kept, and tolerances can be absolute.
  const RealVector scale = A.diagonal().unaryExpr([](Real d) { return d > 0 ? 1 / sqrt(d) : Real(1); });
  const RealVector scaled_q = scale.cwiseProduct(q);
  const Real q_size = scaled_q.cwiseAbs().maxCoeff();
  LcpAnswer answer = lemke(scale.asDiagonal() * A * scale.asDiagonal(), scaled_q / q_size, go_on);
  if (answer.status == LcpAnswer::Status::solved) answer.z = q_size * scale.cwiseProduct(answer.z);
  return answer;
}

LcpAnswer solve_lcp(const SparseRealMatrix& A, const RealVector& q, const GoOn& go_on) {
  return q.size() <= kFewRows ? solve_lcp_by_lemke(RealMatrix(A), q, go_on)
                              : solve_lcp_by_active_set(A, q, go_on);
}

}  // namespace brink
