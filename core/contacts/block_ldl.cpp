/// Three phases, the first of which is done once for a graph:
///
///   analyse   an order of elimination with little fill, the blocks that L will have, and for every product of
///             the third phase the place where it is taken from
///   begin     numbers of A are put into the blocks of L; blocks that only fill makes begin at 0
///   factor    by columns, each pushed into what stands to the right of it (right-looking)
///
/// Everything below is numbered by place in the order of elimination.
#include "brink/core/contacts/block_ldl.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

#include "brink/core/base/wide.h"

namespace brink {

namespace {

/// Each entry of a block in all places of a register: read once for many products with it.
struct Spread {
  Four at[3][3];

  explicit Spread(const Block& B) {
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) at[c][r] = Four{} + B.at[c][r];
  }
};

/// C -= A B^T
inline void subtract_product(Block& C, const Block& A, const Spread& B) {
  const Four a0 = four(A.at[0]), a1 = four(A.at[1]), a2 = four(A.at[2]);
  const Four c0 = four(C.at[0]) - (a0 * B.at[0][0] + a1 * B.at[1][0] + a2 * B.at[2][0]);
  const Four c1 = four(C.at[1]) - (a0 * B.at[0][1] + a1 * B.at[1][1] + a2 * B.at[2][1]);
  const Four c2 = four(C.at[2]) - (a0 * B.at[0][2] + a1 * B.at[1][2] + a2 * B.at[2][2]);
  four(C.at[0]) = c0;
  four(C.at[1]) = c1;
  four(C.at[2]) = c2;
}

/// x -= A y
inline void subtract_product(Triple& x, const Block& A, const Triple& y) {
  four(x.at) = four(x.at) - (four(A.at[0]) * y.at[0] + four(A.at[1]) * y.at[1] + four(A.at[2]) * y.at[2]);
}

/// What products A^T y of a column of blocks add up to, whose parts are summed at the end.
struct TransposedProducts {
  Four parts[3] = {};

  void add(const Block& A, const Triple& y) {
    for (int c = 0; c < 3; ++c) parts[c] = parts[c] + four(A.at[c]) * four(y.at);
  }
  double sum(int c) const { return parts[c][0] + parts[c][1] + parts[c][2]; }
};

}  // namespace

bool BlockLdl::analyse(int n, std::vector<Edge> edges, const GoOn& go_on) {
  // in one order and without repeats, so that equal graphs have equal lists
  for (Edge& e : edges) e = std::minmax({e.first, e.second});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (n == size() && edges == edges_) return true;
  edges_ = std::move(edges);
  order_.resize(n);
  find_order();
  if (!find_blocks(go_on) || !find_targets(go_on)) {
    order_.clear();  // the same graph is a new one, then
    edges_.clear();
    return false;
  }
  diagonal_.resize(n);
  per_pivot_.resize(n);
  below_.resize(rows_.size());
  int longest = 0;
  for (int k = 0; k < n; ++k) longest = std::max(longest, begins_[k + 1] - begins_[k]);
  undivided_.resize(longest);
  return true;
}

void BlockLdl::find_order() {
  const int n = size();
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < n; ++k) entries.emplace_back(k, k, 1.0);
  for (const auto& [i, j] : edges_) {
    // The ordering reads the pattern alone: values are of no meaning.
    entries.emplace_back(i, j, 1.0);
    entries.emplace_back(j, i, 1.0);
  }
  Eigen::SparseMatrix<double> graph(n, n);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::AMDOrdering<int>::PermutationType order;
  if (n > 0) Eigen::AMDOrdering<int>()(graph, order);
  place_.resize(n);
  // Any permutation gives a right factor; how much fills in depends on it.
  for (int k = 0; k < n; ++k) place_[order_[k] = order.indices()[k]] = k;
}

/// Symbolic factorisation along the elimination tree. The parent of a column is its first row below the
/// diagonal. Source: Davis 2006, "Direct methods for sparse linear systems", ch. 4.
bool BlockLdl::find_blocks(const GoOn& go_on) {
  const int n = size();
  std::vector<std::vector<int>> columns(n), children(n);
  for (const auto& [i, j] : edges_) {
    // Whoever is eliminated first has the block in its column.
    const auto [first, last] = std::minmax(place_[i], place_[j]);
    columns[first].push_back(last);
  }
  begins_.assign(1, 0);
  rows_.clear();
  for (int k = 0; k < n; ++k) {
    if (go_on && !go_on()) return false;
    // what is eliminated leaves its neighbours joined: column k takes over those of its children in the tree
    std::vector<int>& column = columns[k];
    for (const int child : children[k])
      // without the child's first row, which is k itself
      column.insert(column.end(), columns[child].begin() + 1, columns[child].end());
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    if (!column.empty()) children[column[0]].push_back(k);
    rows_.insert(rows_.end(), column.begin(), column.end());
    begins_.push_back(static_cast<int>(rows_.size()));
  }
  return true;
}

/// Walks through pairs in the very order in which factor() will use up the list. Eliminating column
/// k joins any two of its rows, so that block (q, p) of such a pair is sure to be found in column p.
bool BlockLdl::find_targets(const GoOn& go_on) {
  targets_.clear();
  for (int k = 0; k < size(); ++k) {
    if (go_on && !go_on()) return false;
    for (int p = begins_[k]; p < begins_[k + 1]; ++p) {
      // Rows of a column ascend, so that one walk through column rows_[p] finds the targets of all q.
      int target = begins_[rows_[p]];
      for (int q = p + 1; q < begins_[k + 1]; ++q) {
        while (rows_[target] < rows_[q]) ++target;
        targets_.push_back(target);
      }
    }
  }
  return true;
}

int BlockLdl::slot(int row, int column) const {
  const auto begin = rows_.begin() + begins_[column], end = rows_.begin() + begins_[column + 1];
  return static_cast<int>(std::lower_bound(begin, end, row) - rows_.begin());
}

void BlockLdl::begin(const std::vector<Triple>& diagonal) {
  // All that is added from here on is positive semidefinite, so no pivot can come below these but by
  // rounding.
  least_ = diagonal;
  for (int k = 0; k < size(); ++k) {
    diagonal_[k] = {};
    for (int c = 0; c < 3; ++c) diagonal_[k].at[c][c] = diagonal[k].at[c];
  }
  // fill as well: factor() left numbers of the last matrix in it
  std::fill(below_.begin(), below_.end(), Block{});
}

/// Cost: for a column of n blocks about n^2 / 2 products of blocks.
BRINK_WIDE bool BlockLdl::factor(const GoOn& go_on) {
  const int* target = targets_.data();
  for (int k = 0; k < size(); ++k) {
    if (go_on && !go_on()) return false;
    // The diagonal block becomes its own factor: D on the diagonal, L below it.
    double(&a)[3][4] = diagonal_[k].at;
    const Triple& least = least_[k];
    a[0][0] = std::max(a[0][0], least.at[0]);
    // a10, a20, a21: entries of L D, before the division. Only what lies on or below the
    // diagonal is ever read.
    const double a10 = a[0][1], a20 = a[0][2];
    a[0][1] /= a[0][0];
    a[0][2] /= a[0][0];
    a[1][1] = std::max(a[1][1] - a[0][1] * a10, least.at[1]);
    const double a21 = a[1][2] - a[0][2] * a10;
    a[1][2] = a21 / a[1][1];
    a[2][2] = std::max(a[2][2] - a[0][2] * a20 - a[1][2] * a21, least.at[2]);
    const int begin = begins_[k], end = begins_[k + 1];
    const double l10 = a[0][1], l20 = a[0][2], l21 = a[1][2];
    Triple& per_pivot = per_pivot_[k];
    per_pivot = {{1.0 / a[0][0], 1.0 / a[1][1], 1.0 / a[2][2], 0.0}};
    // With A = L D L^T: each row of undivided_ becomes a row of L D by forward substitution with the unit
    // triangle of the diagonal block, and of L by division by the pivots.
    for (int p = begin; p < end; ++p) {
      Block &u = undivided_[p - begin], &L = below_[p];
      for (int r = 0; r < 4; ++r) {
        const double u0 = L.at[0][r], u1 = L.at[1][r] - l10 * u0, u2 = L.at[2][r] - (l20 * u0 + l21 * u1);
        u.at[0][r] = u0;
        u.at[1][r] = u1;
        u.at[2][r] = u2;
        L.at[0][r] = u0 * per_pivot.at[0];
        L.at[1][r] = u1 * per_pivot.at[1];
        L.at[2][r] = u2 * per_pivot.at[2];
      }
    }
    // What column k takes from the rest: L_p D L_p^T from diagonals, L_q D L_p^T below them.
    for (int p = begin; p < end; ++p) {
      const Spread column(undivided_[p - begin]);
      subtract_product(diagonal_[rows_[p]], below_[p], column);
      for (int q = p + 1; q < end; ++q) subtract_product(below_[*target++], below_[q], column);
    }
  }
  return true;
}

BRINK_WIDE void BlockLdl::solve(std::vector<Triple>& b) const {
  // L y = b by columns: once y of k is known, it is taken off all rows below.
  for (int k = 0; k < size(); ++k) {
    const double(&d)[3][4] = diagonal_[k].at;
    double(&x)[4] = b[k].at;
    x[1] -= d[0][1] * x[0];
    x[2] -= d[0][2] * x[0] + d[1][2] * x[1];
    for (int p = begins_[k]; p < begins_[k + 1]; ++p) subtract_product(b[rows_[p]], below_[p], b[k]);
  }
  // L^T from the last place back; D is divided out on the way
  for (int k = size() - 1; k >= 0; --k) {
    const double(&d)[3][4] = diagonal_[k].at;
    double(&x)[4] = b[k].at;
    four(x) = four(x) * four(per_pivot_[k].at);
    TransposedProducts later;
    for (int p = begins_[k]; p < begins_[k + 1]; ++p) later.add(below_[p], b[rows_[p]]);
    for (int c = 0; c < 3; ++c) x[c] -= later.sum(c);
    x[1] -= d[1][2] * x[2];
    x[0] -= d[0][1] * x[1] + d[0][2] * x[2];
  }
}

}  // namespace brink
