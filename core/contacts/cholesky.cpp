#include "brink/core/contacts/cholesky.h"

#include <cmath>

namespace brink {

void GrowingCholesky::solve_lower(RealVector& b) const {
  // what comes here most, a column of a sparse matrix, begins with many zeros
  int first = 0;  // leading zeros stay
  while (first < size() && b[first] == 0) ++first;
  for (int i = first; i < size(); ++i) {
    const Real* row = rows_[i].data();
    Real sum = b[i];
    for (int k = first; k < i; ++k) sum -= row[k] * b[k];
    b[i] = sum / row[i];
  }
}

void GrowingCholesky::solve_upper(RealVector& y) const {
  // Row i of L is column i of L^T: each unknown, once known, is taken off those above, so that rows are read
  // as they are stored.
  for (int i = size() - 1; i >= 0; --i) {
    const Real* row = rows_[i].data();
    const Real x = y[i] /= row[i];
    if (x == 0) continue;
    for (int k = 0; k < i; ++k) y[k] -= x * row[k];
  }
}

void GrowingCholesky::append(const RealVector& y, Real left) {
  // The new row r of L has L r = a and r.r + d^2 = A's diagonal entry, so that d^2 is `left`.
  rows_.emplace_back(y.data(), y.data() + y.size());
  rows_.back().push_back(sqrt(left));
}

void GrowingCholesky::remove(int k) {
  // What is left of L, a row short, still has the product that is wanted, but is no triangle from row k on.
  rows_.erase(rows_.begin() + k);
  // every row from k on has an entry too many: turned into the one before it, column by column
  for (int column = k; column < size(); ++column) {
    const Real a = rows_[column][column], b = rows_[column][column + 1];
    // A Givens rotation of two columns of L leaves L L^T as it is, brings b to 0 and keeps the diagonal > 0.
    const Real length = sqrt(a * a + b * b), c = a / length, s = b / length;
    for (int i = column; i < size(); ++i) {
      std::vector<Real>& row = rows_[i];
      const Real left = row[column], right = row[column + 1];
      row[column] = c * left + s * right;
      row[column + 1] = c * right - s * left;
    }
    rows_[column].pop_back();
  }
}

}  // namespace brink
