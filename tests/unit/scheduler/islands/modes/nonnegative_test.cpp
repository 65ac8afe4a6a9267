#include "brink/scheduler/islands/modes/nonnegative.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/seeded_random.h"

namespace brink::nonnegative_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// n random unit columns of length m.
MatrixXd columns(SeededRandom& random, int m, int n) {
  MatrixXd A(m, n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < m; ++i) A(i, j) = random.uniform(-1, 1);
    A.col(j).normalize();
  }
  return A;
}

NonNegativeFit fit_of(const MatrixXd& A, const VectorXd& b) {
  return fit_nonnegative(A.cast<PlainDouble>(), b.cast<PlainDouble>());
}

TEST(FitNonnegative, FindsWhatIsInTheCone) {
  SeededRandom random(3);
  for (int n = 0; n < 300; ++n) {
    const MatrixXd A = columns(random, 3, 1 + n % 12);
    VectorXd x(A.cols());
    for (Eigen::Index j = 0; j < x.size(); ++j) x[j] = std::max(0.0, random.uniform(-1, 1));
    const VectorXd b = A * x;
    EXPECT_LT(fit_of(A, b).residual, 1e-13) << n;
  }
}

// Kuhn and Tucker: x >= 0, A'(A x - b) >= 0, and one of both is zero.
TEST(FitNonnegative, IsBestWhereNothingFits) {
  SeededRandom random(4);
  for (int n = 0; n < 300; ++n) {
    const MatrixXd A = columns(random, 5, 1 + n % 9);
    const VectorXd b = columns(random, 5, 1);
    const VectorXd x = fit_of(A, b).x.cast<double>();
    const VectorXd slope = A.transpose() * (A * x - b);
    EXPECT_GE(x.minCoeff(), 0.0) << n;
    EXPECT_GE(slope.minCoeff(), -1e-12) << n;
    EXPECT_LT(std::abs(slope.dot(x)), 1e-12) << n;
  }
}

TEST(FitNonnegative, ColumnsThatAreThereTwiceDoNoHarm) {
  MatrixXd A(2, 4);
  A << 1, 1, 0, 0, 0, 0, 1, 1;
  const NonNegativeFit fit = fit_of(A, Eigen::Vector2d(2, 3));
  EXPECT_LT(fit.residual, 1e-15);
  EXPECT_NEAR(double(fit.x[0] + fit.x[1]), 2.0, 1e-14);
}

}  // namespace
}  // namespace brink::nonnegative_test
