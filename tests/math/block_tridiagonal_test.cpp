#include "tandem/math/block_tridiagonal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::math {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

MatrixXd random_matrix(int rows, int cols, Rng& rng) {
  MatrixXd m(rows, cols);
  for (double& value : m.reshaped()) value = rng.uniform(-1, 1);
  return m;
}

/// Fills `blocks` so that it is positive definite; what is above the diagonal of the diagonal
/// blocks is rubbish.   @return the same matrix, dense.
MatrixXd fill(BlockTridiagonal& blocks, Rng& rng) {
  const int n = blocks.block_size(), count = blocks.block_count();
  MatrixXd dense = MatrixXd::Zero(n * count, n * count);
  for (int k = 0; k < count; ++k) {
    const MatrixXd root = random_matrix(n, n, rng);
    const MatrixXd D = root * root.transpose() + 2.5 * n * MatrixXd::Identity(n, n);
    blocks.diagonal(k) = D;
    blocks.diagonal(k).triangularView<Eigen::StrictlyUpper>().setConstant(1e300);
    dense.block(k * n, k * n, n, n) = D;
    if (k + 1 == count) continue;
    const MatrixXd E = random_matrix(n, n, rng);
    blocks.lower(k) = E;
    dense.block((k + 1) * n, k * n, n, n) = E;
    dense.block(k * n, (k + 1) * n, n, n) = E.transpose();
  }
  return dense;
}

TEST(BlockTridiagonal, SolvesAsADenseSolverDoes) {
  Rng rng(1);
  for (int size : {1, 2, 5, 6, 7, 8, 12, 13, 14, 21, 28}) {
    for (int count : {1, 2, 3, 18, 40}) {
      BlockTridiagonal blocks(size, count);
      const MatrixXd dense = fill(blocks, rng);
      const VectorXd x = random_matrix(size * count, 1, rng);
      VectorXd b(x.size());
      blocks.multiply(x, b);
      EXPECT_LT((b - dense * x).norm(), 1e-12 * b.norm()) << size << " x " << count;
      ASSERT_TRUE(blocks.factorise());
      blocks.solve_in_place(b);
      EXPECT_LT((b - x).norm(), 1e-12 * x.norm()) << size << " x " << count;
      EXPECT_LT((b - dense.llt().solve(dense * x)).norm(), 1e-12 * x.norm());
    }
  }
}

TEST(BlockTridiagonal, HalvesOfASolveAreItsFactors) {
  Rng rng(3);
  for (int size : {1, 5, 7, 14}) {
    BlockTridiagonal blocks(size, 6);
    const MatrixXd dense = fill(blocks, rng);
    ASSERT_TRUE(blocks.factorise());
    const MatrixXd L = dense.llt().matrixL();
    for (int first : {0, 2, 5, 6}) {
      VectorXd b = random_matrix(6 * size, 1, rng);
      b.head(first * size).setZero();
      VectorXd forward = b, backward = b;
      blocks.forward_in_place(forward, first);
      EXPECT_LT((L * forward - b).norm(), 1e-12 * (1 + b.norm())) << size << ", from " << first;
      EXPECT_EQ(forward.head(first * size), b.head(first * size));
      blocks.backward_in_place(backward);
      EXPECT_LT((L.transpose() * backward - b).norm(), 1e-12 * (1 + b.norm()));
    }
    VectorXd b = VectorXd::Zero(6 * size);
    EXPECT_THROW(blocks.forward_in_place(b, 7), ContractViolation);
    EXPECT_THROW(blocks.backward_in_place(b.head(2)), ContractViolation);
  }
}

TEST(BlockTridiagonal, SaysWhenAMatrixIsNotPositiveDefinite) {
  Rng rng(2);
  for (int size : {1, 3, 7, 14}) {
    for (int broken : {0, 1, 4}) {
      BlockTridiagonal blocks(size, 5);
      const MatrixXd dense = fill(blocks, rng);
      const double least = dense.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
      for (int k = 0; k < 5; ++k) blocks.diagonal(k).diagonal().array() -= 0.5 * least;
      BlockTridiagonal shifted = blocks;
      EXPECT_TRUE(shifted.factorise());
      blocks.diagonal(broken).diagonal().array() -= 1e3;
      EXPECT_FALSE(blocks.factorise()) << size << ", block " << broken;
    }
  }
  BlockTridiagonal zero(4, 3);
  EXPECT_FALSE(zero.factorise());
  zero.diagonal(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(zero.factorise());
}

TEST(BlockTridiagonal, ZeroesItself) {
  Rng rng(3);
  BlockTridiagonal blocks(3, 4);
  fill(blocks, rng);
  blocks.set_zero();
  VectorXd y(12);
  blocks.multiply(VectorXd::Ones(12), y);
  EXPECT_EQ(y, VectorXd::Zero(12));
}

TEST(BlockTridiagonal, RefusesWrongSizes) {
  EXPECT_THROW(BlockTridiagonal(0, 1), ContractViolation);
  EXPECT_THROW(BlockTridiagonal(1, 0), ContractViolation);
  BlockTridiagonal blocks(2, 3);
  VectorXd five(5), six(6);
  EXPECT_THROW(blocks.multiply(five, six), ContractViolation);
  EXPECT_THROW(blocks.solve_in_place(five), ContractViolation);
}

}  // namespace
}  // namespace tandem::math
