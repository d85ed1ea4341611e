#include "fitting/solver/block_tridiagonal.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/base/random.h"

namespace mocurate {
namespace {

Eigen::MatrixXd Draw(Random& random, Eigen::Index rows, Eigen::Index columns) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.Normal(); });
}

/// Random equations of F blocks of n, and the same as one dense matrix.
struct Equations {
  Equations(int blocks, int size) : banded(blocks, size) {
    Random random(11, "equations");
    const Eigen::Index unknowns = blocks * size;
    dense.setZero(unknowns, unknowns);
    gradient.setZero(unknowns);
    // Sum of squares of rows over two neighbouring blocks: positive definite, with the sparsity required.
    for (int f = 0; f < blocks; ++f) {
      Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2 * size, unknowns);
      const int width = f + 1 < blocks ? 2 * size : size;
      rows.middleCols(f * size, width) = Draw(random, rows.rows(), width);
      dense += rows.transpose() * rows;
      gradient += rows.transpose() * Draw(random, rows.rows(), 1);
    }
    for (int f = 0; f < blocks; ++f) banded.SetZero(f);
    for (int f = 0; f < blocks; ++f) {
      banded.Diagonal(f) = dense.block(f * size, f * size, size, size);
      banded.Gradient(f) = gradient.segment(f * size, size);
      if (f + 1 < blocks) banded.Next(f) = dense.block(f * size, (f + 1) * size, size, size);
    }
  }

  BlockTridiagonal banded;
  Eigen::MatrixXd dense;
  Eigen::VectorXd gradient;
};

class Sizes : public testing::TestWithParam<std::array<int, 2>> {};

INSTANTIATE_TEST_SUITE_P(BlockTridiagonal, Sizes,
                         testing::Values(std::array<int, 2>{1, 3}, std::array<int, 2>{2, 4}, std::array<int, 2>{7, 6},
                                         std::array<int, 2>{12, 33}));

TEST_P(Sizes, SolvesLikeADenseFactorisation) {
  const auto [blocks, size] = GetParam();
  Equations equations(blocks, size);
  const Eigen::VectorXd damping = Eigen::VectorXd::LinSpaced(equations.gradient.size(), 0.1, 0.4);
  ASSERT_TRUE(equations.banded.Factor(damping));
  Eigen::MatrixXd damped = equations.dense;
  damped.diagonal() += damping;
  const Eigen::VectorXd expected = -damped.ldlt().solve(equations.gradient);
  EXPECT_LT((equations.banded.Solve() - expected).norm(), 1e-9 * expected.norm());
  EXPECT_EQ(equations.banded.DiagonalEntries(), equations.dense.diagonal());
  EXPECT_EQ(equations.banded.GradientEntries(), equations.gradient);
}

TEST_P(Sizes, ReturnsTheBlocksOfTheInverse) {
  const int blocks = GetParam()[0];
  const int size = GetParam()[1];
  Equations equations(blocks, size);
  ASSERT_TRUE(equations.banded.Factor(Eigen::VectorXd::Zero(equations.gradient.size())));
  const Eigen::MatrixXd inverse = equations.dense.inverse();
  int visited = 0;
  equations.banded.VisitInverse([&](int f, const Eigen::MatrixXd& diagonal, const Eigen::MatrixXd& next) {
    const Eigen::MatrixXd expected = inverse.block(f * size, f * size, size, size);
    EXPECT_LT((diagonal - expected).norm(), 1e-8 * expected.norm()) << "block " << f;
    ++visited;
    ASSERT_EQ(next.size() == 0, f + 1 == blocks);
    if (f + 1 == blocks) return;
    EXPECT_LT((next - inverse.block(f * size, (f + 1) * size, size, size)).norm(), 1e-8 * expected.norm())
        << "between " << f << " and the next";
  });
  EXPECT_EQ(visited, blocks);
}

TEST(BlockTridiagonal, RefusesAMatrixThatIsNotPositiveDefinite) {
  Equations equations(4, 5);
  equations.banded.Diagonal(2)(3, 3) = -1.0;
  EXPECT_FALSE(equations.banded.Factor(Eigen::VectorXd::Zero(20)));
}

TEST(BlockTridiagonal, InvertsOneBlockFromItsUpperTriangle) {
  Random random(12, "block");
  const Eigen::MatrixXd root = Draw(random, 9, 6);
  const Eigen::MatrixXd whole = root.transpose() * root;
  Eigen::MatrixXd matrix = whole;
  matrix.triangularView<Eigen::StrictlyLower>().setConstant(7.0);
  ASSERT_TRUE(InvertInPlace(matrix));
  EXPECT_LT((matrix * whole - Eigen::MatrixXd::Identity(6, 6)).norm(), 1e-9);
  matrix = -whole;
  EXPECT_FALSE(InvertInPlace(matrix));
}

}  // namespace
}  // namespace mocurate
