// The factor in blocks beside a dense one, and its order of elimination.
#include "brink/core/contacts/block_ldl.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "brink/core/base/random.h"

namespace brink::block_ldl_test {
namespace {

/// diagonal + sum of weight a a^T, a with a part on each end of an edge.
struct Matrix {
  int n;
  std::vector<BlockLdl::Edge> edges;
  std::vector<Vec3> diagonal, on_first, on_second;
  std::vector<double> weights;

  Matrix(int size, std::vector<BlockLdl::Edge> graph, Random& random) : n(size), edges(std::move(graph)) {
    const auto vec = [&] {
      return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    };
    for (int k = 0; k < n; ++k) diagonal.push_back(vec().cwiseAbs() + Vec3::Ones());
    for (std::size_t e = 0; e < edges.size(); ++e) {
      on_first.push_back(vec());
      on_second.push_back(vec());
      weights.push_back(std::exp2(random.uniform(-6, 6)));
    }
  }

  Eigen::MatrixXd dense() const {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (int k = 0; k < n; ++k) A.diagonal().segment<3>(3 * k) = diagonal[k];
    for (std::size_t e = 0; e < edges.size(); ++e) {
      Eigen::VectorXd a = Eigen::VectorXd::Zero(3 * n);
      a.segment<3>(3 * edges[e].first) = on_first[e];
      a.segment<3>(3 * edges[e].second) = on_second[e];
      A += weights[e] * a * a.transpose();
    }
    return A;
  }

  void fill(BlockLdl& ldl) const {
    ldl.analyse(n, edges);
    std::vector<Triple> placed(n);
    for (int k = 0; k < n; ++k) placed[ldl.place(k)] = Triple::of(diagonal[k]);
    ldl.begin(placed);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const int i = ldl.place(edges[e].first), j = ldl.place(edges[e].second);
      const Triple first = Triple::of(on_first[e]), second = Triple::of(on_second[e]);
      ldl.diagonal(i).add(weights[e], first, first);
      ldl.diagonal(j).add(weights[e], second, second);
      if (i > j) ldl.below(ldl.slot(i, j)).add(weights[e], first, second);
      if (j > i) ldl.below(ldl.slot(j, i)).add(weights[e], second, first);
    }
    ldl.factor();
  }
};

std::vector<Vec3> solve(const BlockLdl& ldl, const std::vector<Vec3>& b) {
  std::vector<Triple> placed(b.size());
  std::vector<Vec3> x(b.size());
  for (std::size_t k = 0; k < b.size(); ++k) placed[ldl.place(static_cast<int>(k))] = Triple::of(b[k]);
  ldl.solve(placed);
  for (std::size_t k = 0; k < b.size(); ++k) x[k] = placed[ldl.place(static_cast<int>(k))].vector();
  return x;
}

std::vector<BlockLdl::Edge> random_graph(int n, int count, Random& random) {
  std::vector<BlockLdl::Edge> edges;
  while (n > 1 && static_cast<int>(edges.size()) < count) {
    const int i = static_cast<int>(random.below(n)), j = static_cast<int>(random.below(n));
    if (i != j) edges.emplace_back(i, j);
  }
  return edges;
}

TEST(BlockLdl, SolvesWhatADenseFactorSolves) {
  BlockLdl ldl;  // the same for all: what it keeps of one graph must not stain the next
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const int n = static_cast<int>(random.below(30));
    const Matrix matrix(n, random_graph(n, static_cast<int>(random.below(3 * n + 1)), random), random);
    std::vector<Vec3> b(n);
    Eigen::VectorXd stacked(3 * n);
    for (int k = 0; k < n; ++k) {
      b[k] = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      stacked.segment<3>(3 * k) = b[k];
    }
    matrix.fill(ldl);
    const std::vector<Vec3> x = solve(ldl, b);
    if (n == 0) continue;
    const Eigen::VectorXd expected = matrix.dense().llt().solve(stacked);
    for (int k = 0; k < n; ++k)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(x[k][c], expected[3 * k + c], 1e-11) << k;
    if (HasFailure()) return;
  }
}

// A tree can be eliminated leaf by leaf, without a block that is not an edge; the natural order of this one,
// root first, leaves a full matrix. The order found is an approximate one.
TEST(BlockLdl, TreeNeedsFewBlocksButItsEdges) {
  std::vector<BlockLdl::Edge> edges;
  for (int k = 1; k < 200; ++k) edges.emplace_back(k, k / 2);
  BlockLdl ldl;
  ldl.analyse(200, edges);
  EXPECT_LE(ldl.blocks(), 300);
}

// Eliminated by rows, a square lattice of k x k needs k^3 blocks.
TEST(BlockLdl, LatticeNeedsFewerBlocksThanByRows) {
  const int k = 40;
  std::vector<BlockLdl::Edge> edges;
  for (int row = 0; row < k; ++row)
    for (int column = 0; column < k; ++column) {
      if (column > 0) edges.emplace_back(row * k + column, row * k + column - 1);
      if (row > 0) edges.emplace_back(row * k + column, row * k + column - k);
    }
  BlockLdl ldl;
  ldl.analyse(k * k, edges);
  EXPECT_LE(ldl.blocks(), k * k * k / 2);
}

TEST(BlockLdl, AGraphWhoseLookWasStoppedIsLookedAtAnew) {
  std::vector<BlockLdl::Edge> edges;
  for (int k = 1; k < 200; ++k) edges.emplace_back(k, k / 2);
  BlockLdl fresh, stopped;
  EXPECT_TRUE(fresh.analyse(200, edges));
  for (const int after : {0, 150, 350}) {
    int asked = 0;
    EXPECT_FALSE(stopped.analyse(200, edges, [&] { return asked++ < after; })) << after;
    EXPECT_EQ(stopped.size(), 0);
  }
  EXPECT_TRUE(stopped.analyse(200, edges));
  EXPECT_EQ(stopped.blocks(), fresh.blocks());
  for (int k = 0; k < 200; ++k) EXPECT_EQ(stopped.place(k), fresh.place(k));
}

TEST(BlockLdl, EdgesTwiceAndTurnedAreTheSameGraph) {
  BlockLdl ldl;
  ldl.analyse(3, {{0, 1}, {1, 2}});
  const int place = ldl.place(2), blocks = ldl.blocks();
  ldl.analyse(3, {{2, 1}, {1, 0}, {0, 1}, {1, 2}});
  EXPECT_EQ(ldl.place(2), place);
  EXPECT_EQ(ldl.blocks(), blocks);
}

// Two masses of 1 held together by 1e30: in doubles their sum is lost, and yet they fall at the mean.
TEST(BlockLdl, StiffTieLeavesPivotsPositive) {
  BlockLdl ldl;
  ldl.analyse(2, {{0, 1}});
  const Triple one = Triple::of(Vec3::Ones()), a = Triple::of(Vec3::UnitX()),
               minus_a = Triple::of(-Vec3::UnitX());
  ldl.begin({one, one});
  ldl.diagonal(0).add(1e30, a, a);
  ldl.diagonal(1).add(1e30, a, a);
  ldl.below(ldl.slot(1, 0)).add(1e30, a, minus_a);
  ldl.factor();
  std::vector<Triple> x = {one, one};
  ldl.solve(x);
  for (const Triple& v : x) EXPECT_TRUE(v.vector().allFinite() && v.at[0] > 0.0) << v.vector().transpose();
}

}  // namespace
}  // namespace brink::block_ldl_test
