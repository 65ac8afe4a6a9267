/// As a quadratic program: A is symmetric positive semidefinite, and z.A z / 2 + q.z is least over z >= 0
/// where 0 <= z _|_ A z + q >= 0. In the terms of Goldfarb and Idnani z are multipliers and w the
/// constraints:
///
///   z = 0, J empty
///   while a row is violated, w_r < 0, take the worst:
///     raise z_r, with z of J following so that w of J stays 0, until w_r is 0 or a z of J is
///     w_r is 0: r joins J.   a z of J is 0: its row leaves J, and r is raised further
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "brink/core/contacts/cholesky.h"
#include "brink/core/contacts/lcp.h"

namespace brink {

namespace {

// of problems with a diagonal of ones and |q| <= 1:
constexpr Real kViolated = 1e3 * kRealEpsilon;  ///< w below minus this is violated
constexpr Real kDependent = 1e-13;  ///< a row with less of its own hangs on those that have joined
constexpr Real kYields = 1e-13;     ///< less is rounding, where entries begin at 1
constexpr Real kHopeless = 1e5 * kRealEpsilon;  ///< violated by more, and nothing can be done: no solution
constexpr int kMostPolishes = 8;

/// z and w = A z + q as they stand, and the rows that have joined: w = 0 there.
class ActiveSet {
 public:
  ActiveSet(const SparseRealMatrix& A, const RealVector& q)
      : A_(A), q_(q), z_(RealVector::Zero(q.size())), w_(q), place_(q.size(), kOutside) {}

  /// Until no row is violated.
  LcpAnswer run(const GoOn& go_on) {
    LcpAnswer answer;
    const int most = 50 * static_cast<int>(q_.size()) + 100;
    for (int polishes = 0; answer.pivots < most;) {
      const int row = most_violated();
      // The cap on polishes is for rows at the very border, which rounding may show violated again and again.
      if (row < 0 && (polishes++ >= kMostPolishes || !polish())) {
        answer.z = z_;
        return answer;
      }
      if (row >= 0 && !join(row, go_on, answer)) return answer;
    }
    answer.status = LcpAnswer::Status::capped;
    return answer;
  }

 private:
  static constexpr int kOutside = -1, kGivenUp = -2;

  /// -1: none is violated. Rows that were given up are not asked again.
  int most_violated() const {
    int worst = -1;
    for (int i = 0; i < q_.size(); ++i)
      if (place_[i] == kOutside && w_[i] < -kViolated && (worst < 0 || w_[i] < w_[worst])) worst = i;
    return worst;
  }

  /// Raises z of a row until its w is 0. False, and the answer says why, if that cannot be.
  bool join(int row, const GoOn& go_on, LcpAnswer& answer) {
    for (;;) {
      ++answer.pivots;
      if (go_on && !go_on()) return ended(answer, LcpAnswer::Status::stopped);
      // With J the rows that have joined, A_JJ = L L^T and a this row's column in J: y = L^-1 a. `own`
      // is the Schur complement A_rr - a.A_JJ^-1 a, the rate at which w of this row rises with its z
      // while w of J is held at 0.
      RealVector y = column(row);
      factor_.solve_lower(y);
      const Real own = A_.coeff(row, row) - y.squaredNorm();
      RealVector yielding = y;  // of those that have joined, a unit of z of this row
      factor_.solve_upper(yielding);
      const int first = first_to_leave(yielding);
      const bool independent = own > kDependent;
      // `full` brings w of this row to 0; `part` brings the first z of J to 0. The
      // shorter of the two is taken.
      const Real full = independent ? -w_[row] / own : kForever;
      const Real part = first < 0 ? kForever : z_[joined_[first]] / yielding[first];
      if (first < 0 && !independent) {
        // The direction d (1 in this row, -yielding in J) has d.A d = own = 0, so A d = 0 and no w
        // changes along it; all z stay >= 0 for ever, and the dual objective rises by -w of this row a
        // unit. So it has no bound, and the primal problem no solution.
        if (-w_[row] > kHopeless) return ended(answer, LcpAnswer::Status::none);
        place_[row] = kGivenUp;  // it was rounding
        return true;
      }
      step(row, yielding, std::min(full, part));
      // On a tie the row joins; the one whose z came to 0 stays with z = 0, and leaves by
      // a step of 0 if it must.
      if (full <= part) {
        place_[row] = static_cast<int>(joined_.size());
        joined_.push_back(row);
        factor_.append(y, own);
        w_[row] = 0;
        return true;
      }
      // `row` is violated still; the next round goes on with one row less in J.
      leave(first);
    }
  }

  /// False, for join() to return.
  static bool ended(LcpAnswer& answer, LcpAnswer::Status status) {
    answer.status = status;
    return false;
  }

  /// A's entries of that column, in the rows that have joined.
  RealVector column(int row) const {
    RealVector entries = RealVector::Zero(static_cast<Eigen::Index>(joined_.size()));
    for (SparseRealMatrix::InnerIterator it(A_, row); it; ++it)
      if (const int place = place_[it.row()]; place >= 0) entries[place] = it.value();
    return entries;
  }

  /// Whose z comes to 0 first; of several the lowest row, whenever it joined. -1: nobody's.
  int first_to_leave(const RealVector& yielding) const {
    int first = -1;
    Real least = kForever;
    for (int k = 0; k < yielding.size(); ++k) {
      if (!(yielding[k] > kYields)) continue;
      const Real part = z_[joined_[k]] / yielding[k];
      if (part < least || (part == least && joined_[k] < joined_[first])) {
        least = part;
        first = k;
      }
    }
    return first;
  }

  /// z of `row` grows by `by`, and z of J gives way so that w of J stays 0.
  void step(int row, const RealVector& yielding, Real by) {
    if (by == 0) return;
    push(row, by);
    for (int k = 0; k < yielding.size(); ++k) push(joined_[k], -by * yielding[k]);
  }
  void push(int row, Real by) {
    if (by == 0) return;
    z_[row] = std::max(Real(0), z_[row] + by);
    for (SparseRealMatrix::InnerIterator it(A_, row); it; ++it)
      // in J w is 0 by the choice of the direction; sums would only gather roundings there
      if (place_[it.row()] < 0) w_[it.row()] += it.value() * by;
  }

  /// Row joined_[k] goes back to those that may be violated.
  void leave(int k) {
    const int row = joined_[k];
    z_[row] = 0;
    place_[row] = kOutside;
    // It was held at 0, and push() has kept no sum of it.
    w_[row] = 0;
    joined_.erase(joined_.begin() + k);
    for (std::size_t i = k; i < joined_.size(); ++i) place_[joined_[i]] = static_cast<int>(i);
    factor_.remove(k);
  }

  /// Takes out what roundings have left in w of the rows that have joined. True if one is violated by then.
  bool polish() {
    // One round of iterative refinement, A_JJ dz = -w_J with w computed afresh. Afterwards w of the
    // other rows is afresh too, without the roundings that push() has summed up.
    RealVector w = A_ * z_ + q_;
    RealVector wrong(static_cast<Eigen::Index>(joined_.size()));
    for (std::size_t k = 0; k < joined_.size(); ++k) wrong[k] = w[joined_[k]];
    factor_.solve_lower(wrong);
    factor_.solve_upper(wrong);
    for (std::size_t k = 0; k < joined_.size(); ++k)
      z_[joined_[k]] = std::max(Real(0), z_[joined_[k]] - wrong[k]);
    w = A_ * z_ + q_;
    for (int i = 0; i < w_.size(); ++i) w_[i] = place_[i] >= 0 ? Real(0) : w[i];
    return most_violated() >= 0;
  }

  static constexpr Real kForever = std::numeric_limits<Real>::infinity();

  const SparseRealMatrix& A_;
  const RealVector& q_;
  RealVector z_, w_;
  std::vector<int> place_;   ///< of each row in joined_, kOutside or kGivenUp
  std::vector<int> joined_;  ///< rows, in the order of the factor
  GrowingCholesky factor_;   ///< of A's rows and columns that have joined
};

}  // namespace

LcpAnswer solve_lcp_by_active_set(const SparseRealMatrix& A, const RealVector& q, const GoOn& go_on) {
  if (q.size() == 0 || q.minCoeff() >= 0) return {LcpAnswer::Status::solved, RealVector::Zero(q.size()), 0};
  // to a diagonal of ones and |q| <= 1, as in solve_lcp_by_lemke; here every diagonal entry is > 0
  const RealVector scale = A.diagonal().cwiseSqrt().cwiseInverse();
  const RealVector scaled_q = scale.cwiseProduct(q);
  const Real q_size = scaled_q.cwiseAbs().maxCoeff();
  const SparseRealMatrix scaled = scale.asDiagonal() * A * scale.asDiagonal();
  const RealVector unit_q = scaled_q / q_size;
  LcpAnswer answer = ActiveSet(scaled, unit_q).run(go_on);
  if (answer.status == LcpAnswer::Status::solved) answer.z = q_size * scale.cwiseProduct(answer.z);
  return answer;
}

}  // namespace brink
