#include "tandem/math/tridiagonal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::math {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

VectorXd random_vector(Rng& rng, Eigen::Index n) {
  return VectorXd::NullaryExpr(n, [&] { return rng.uniform(-1, 1); });
}

struct Tridiagonal {
  VectorXd lower, diagonal, upper;
  MatrixXd dense() const {
    const Eigen::Index n = diagonal.size();
    MatrixXd A = MatrixXd::Zero(n, n);
    A.diagonal() = diagonal;
    if (n > 1) {
      A.diagonal(-1) = lower;
      A.diagonal(1) = upper;
    }
    return A;
  }
  TridiagonalLu lu() const { return {lower, diagonal, upper}; }
};

TEST(TridiagonalLu, SolvesLikeADenseFactorisation) {
  Rng rng(1);
  int pivoted = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto n = static_cast<Eigen::Index>(1 + rng.index(12));
    Tridiagonal t{random_vector(rng, n - 1), random_vector(rng, n), random_vector(rng, n - 1)};
    if (i % 3 == 1) t.diagonal *= 4;                     // No exchange needed.
    if (i % 3 == 2 && n % 2 == 0) t.diagonal.setZero();  // Every pivot needs one.
    const MatrixXd A = t.dense();
    if (A.jacobiSvd().singularValues().minCoeff() < 1e-6) continue;
    pivoted += i % 3 != 1;
    const TridiagonalLu lu = t.lu();
    ASSERT_TRUE(lu.ok());
    const RowMatrix B = MatrixXd::NullaryExpr(n, 5, [&] { return rng.uniform(-1, 1); });
    RowMatrix X = B, Y = B;
    lu.solve_in_place(X);
    lu.solve_transposed_in_place(Y);
    EXPECT_LT((A * X - B).norm(), 1e-9);
    EXPECT_LT((A.transpose() * Y - B).norm(), 1e-9);
    EXPECT_LT((X - A.fullPivLu().solve(MatrixXd(B))).norm(), 1e-8 * (1 + X.norm()));
  }
  EXPECT_GT(pivoted, 300);
}

TEST(TridiagonalLu, NoticesSingularMatrices) {
  EXPECT_FALSE((Tridiagonal{VectorXd(0), VectorXd::Zero(1), VectorXd(0)}.lu().ok()));
  // Rows 1 and 2 are equal: (1 2 0), (1 2 0).
  const Tridiagonal equal{Eigen::Vector2d(1, 3), Eigen::Vector3d(1, 2, 1), Eigen::Vector2d(2, 0)};
  EXPECT_FALSE(equal.lu().ok());
  // An odd number of zeros on the diagonal is singular whatever stands beside it.
  Rng rng(2);
  const Tridiagonal odd{random_vector(rng, 4), VectorXd::Zero(5), random_vector(rng, 4)};
  const TridiagonalLu lu = odd.lu();
  EXPECT_FALSE(lu.ok());
  RowMatrix B = RowMatrix::Zero(5, 1);
  EXPECT_THROW(lu.solve_in_place(B), ContractViolation);
}

TEST(TridiagonalLu, AcceptsEntriesOfAnySize) {
  Rng rng(3);
  for (double scale : {1e-150, 1e-6, 1e6, 1e150}) {
    Tridiagonal t{random_vector(rng, 5), 3 * VectorXd::Ones(6), random_vector(rng, 5)};
    t.lower *= scale;
    t.diagonal *= scale;
    t.upper *= scale;
    EXPECT_TRUE(t.lu().ok());
  }
}

TEST(TridiagonalLu, RejectsWrongSizes) {
  EXPECT_THROW(TridiagonalLu(VectorXd(0), VectorXd(0), VectorXd(0)), ContractViolation);
  EXPECT_THROW(TridiagonalLu(VectorXd::Ones(3), VectorXd::Ones(3), VectorXd::Ones(2)),
               ContractViolation);
  const TridiagonalLu lu(VectorXd::Zero(2), VectorXd::Ones(3), VectorXd::Zero(2));
  RowMatrix B = RowMatrix::Ones(2, 2);
  EXPECT_THROW(lu.solve_in_place(B), ContractViolation);
  EXPECT_THROW(lu.solve_transposed_in_place(B), ContractViolation);
}

}  // namespace
}  // namespace tandem::math
