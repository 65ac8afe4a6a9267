#pragma once
/// L D L^T of a sparse symmetric positive definite matrix of 3x3 blocks, one row of blocks a body.

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "brink/core/base/go_on.h"

namespace brink {

using Vec3 = Eigen::Vector3d;

/// Three numbers of one body, with a fourth that is 0: registers hold four.
struct alignas(32) Triple {
  double at[4];

  static Triple of(const Vec3& v) { return {{v[0], v[1], v[2], 0.0}}; }
  Vec3 vector() const { return {at[0], at[1], at[2]}; }
  double dot(const Triple& b) const { return at[0] * b.at[0] + at[1] * b.at[1] + at[2] * b.at[2]; }
  void add(double weight, const Triple& a) {
    for (int r = 0; r < 4; ++r) at[r] += weight * a.at[r];
  }
};

/// A 3x3 block by columns: entry (row, column) is at[column][row]. The fourth row is 0.
struct alignas(32) Block {
  double at[3][4];

  /// *this += weight * a b^T
  void add(double weight, const Triple& a, const Triple& b) {
    for (int c = 0; c < 3; ++c) {
      const double w = weight * b.at[c];
      for (int r = 0; r < 4; ++r) at[c][r] += w * a.at[r];
    }
  }
};

/// The factor of A = (a positive diagonal) + (a positive semidefinite matrix on a given graph). Rows are
/// eliminated in an order of few new blocks (approximate minimum degree: Amestoy, Davis & Duff 1996); which
/// blocks there will be is found once for a graph.
///
/// Inside a block the factor is that of scalars: triangular solves, never a 3x3 inverse, which loses what is
/// light beside stiff contacts. A pivot is never less than its entry of the diagonal given, as the Schur
/// complement of such a matrix is not: where rounding says otherwise, that entry is taken, so that a factor
/// always exists. Source: Golub & Van Loan, "Matrix Computations", 4.1 and 11.1; Wright 1999, "Modified
/// Cholesky factorizations in interior-point algorithms".
class BlockLdl {
 public:
  using Edge = std::pair<int, int>;

  /// The graph: rows of blocks 0 .. n-1, and the pairs that may have a block (in any order, any number of
  /// times). The same graph as before costs a comparison. False: it was stopped, and there is no graph.
  /// @pre no edge from a row to itself
  bool analyse(int n, std::vector<Edge> edges, const GoOn& go_on = {});

  int size() const { return static_cast<int>(order_.size()); }
  /// Number of blocks below the diagonal of L.
  int blocks() const { return static_cast<int>(rows_.size()); }
  /// When row k of the matrix is eliminated. All that follows is numbered by it.
  int place(int k) const { return place_[k]; }
  /// Where block (row, column) is stored. @pre row > column, and an edge joins the two.
  int slot(int row, int column) const;

  /// A becomes the diagonal. @pre every entry > 0
  void begin(const std::vector<Triple>& diagonal);
  Block& diagonal(int place) { return diagonal_[place]; }
  Block& below(int slot) { return below_[slot]; }
  /// A is replaced by its factor. False: it was stopped, and is half done.
  bool factor(const GoOn& go_on = {});
  /// A x = b, in place. @pre factor() was called
  void solve(std::vector<Triple>& b) const;

 private:
  void find_order();
  bool find_blocks(const GoOn& go_on);
  bool find_targets(const GoOn& go_on);

  std::vector<Edge> edges_;
  std::vector<int> order_, place_;  ///< order_[place_[k]] == k
  std::vector<int> begins_, rows_;  ///< of column k the rows below the diagonal: rows_[begins_[k] ...]
  std::vector<int> targets_;        ///< slots that a column's pairs of blocks change, as factor() meets them
  std::vector<Triple> least_;       ///< pivots
  std::vector<Triple> per_pivot_;   ///< 1 / D
  std::vector<Block> diagonal_, below_;
  std::vector<Block> undivided_;  ///< a column of L D
};

}  // namespace brink
